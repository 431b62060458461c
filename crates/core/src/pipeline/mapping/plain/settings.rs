//! The plain word and the unit of each setting of a profile.

use serde::Serialize;

use crate::pipeline::mapping::read::common::limits::{RELEASE_RATIO, RELEASE_SHARE};

/// The unit of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// N.
    Newton,
    /// mm.
    Millimetre,
    /// Degrees.
    Degree,
    /// ms.
    Millisecond,
    /// Hz.
    Hertz,
    /// Hz for each mm/s.
    HertzPerSpeed,
    /// Counts of a mouse in a second.
    CountPerSecond,
    /// Samples of the pad.
    Sample,
    /// None: so many times as much.
    Factor,
    /// None: the power of a curve.
    Power,
    /// None: it is no number.
    NoNumber,
}

impl Unit {
    /// As it stands behind a number.
    pub const fn sign(self) -> &'static str {
        match self {
            Self::Newton => "N",
            Self::Millimetre => "mm",
            Self::Degree => "°",
            Self::Millisecond => "ms",
            Self::Hertz => "Hz",
            Self::HertzPerSpeed => "Hz per mm/s",
            Self::CountPerSecond => "counts per s",
            Self::Sample => "samples",
            Self::Factor => "×",
            Self::Power | Self::NoNumber => "",
        }
    }

    /// By how much one step of an arrow key changes it.
    const fn step(self) -> f64 {
        match self {
            Self::Millimetre => 0.5,
            Self::Degree | Self::Sample => 1.0,
            Self::Millisecond | Self::CountPerSecond => 10.0,
            Self::Hertz => 0.1,
            Self::HertzPerSpeed => 0.01,
            Self::Newton | Self::Factor | Self::Power | Self::NoNumber => 0.05,
        }
    }
}

/// A setting. Its place is its tables and its key with points between them; `*` is any of a button's kinds of press, or of devices.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Such as `button.press_n`.
    pub place: &'static str,
    /// Its plain word.
    pub word: &'static str,
    /// The unit of its number.
    pub unit: Unit,
}

const fn plain(place: &'static str, word: &'static str) -> Setting {
    Setting { place, word, unit: Unit::NoNumber }
}

const fn number(place: &'static str, word: &'static str, unit: Unit) -> Setting {
    Setting { place, word, unit }
}

/// All, in the order of the language's description.
pub const SETTINGS: &[Setting] = &[
    plain("schema", "version of the language"),
    plain("name", "name"),
    plain("output", "what is played"),
    number("filter_samples", "smoothing", Unit::Sample),
    plain("filter_adapts", "no smoothing over quick changes"),
    number("min_press_ms", "shortest press", Unit::Millisecond),
    plain("left_handed", "left-handed"),
    number("centre_x_mm", "middle of the hand, to the right", Unit::Millimetre),
    number("centre_y_mm", "middle of the hand, upwards", Unit::Millimetre),
    plain("program", "game that it is for"),
    plain("program.class", "class of its window"),
    plain("program.executable", "its program"),
    plain("access", "help for hands"),
    number("access.slow_ms", "how long a press must last", Unit::Millisecond),
    number("access.bounce_ms", "pause before the next press counts", Unit::Millisecond),
    number("access.tremor_hz", "calms trembling faster than", Unit::Hertz),
    number("access.tremor_per_mm", "less calming while the finger moves", Unit::HertzPerSpeed),
    number("access.rest_n", "ignores a resting hand below", Unit::Newton),
    number("access.rest_ms", "how soon a hand counts as resting", Unit::Millisecond),
    plain("gain", "reach of each side"),
    number("gain.up", "upwards", Unit::Factor),
    number("gain.down", "downwards", Unit::Factor),
    number("gain.left", "to the left", Unit::Factor),
    number("gain.right", "to the right", Unit::Factor),
    plain("dpad", "directions"),
    plain("dpad.mode", "kind of directions"),
    number("dpad.centre_radius_mm", "how far out a direction starts", Unit::Millimetre),
    number("dpad.radius_hysteresis_mm", "how much closer it ends", Unit::Millimetre),
    number("dpad.diagonal_deg", "width of the diagonals", Unit::Degree),
    number("dpad.hysteresis_deg", "how far a direction is kept beyond its edges, as an angle", Unit::Degree),
    number("dpad.hysteresis_mm", "how far a direction is kept beyond its edges", Unit::Millimetre),
    number("dpad.min_force_n", "touch force", Unit::Newton),
    number("dpad.release_force_n", "let-go force", Unit::Newton),
    number("dpad.rotation_deg", "turn of all directions", Unit::Degree),
    plain("dpad.gamepad", "directions on the gamepad"),
    plain("dpad.keyboard", "directions on the keyboard"),
    plain("dpad.label", "what the directions do in the game"),
    plain("dpad.*.up", "up"),
    plain("dpad.*.down", "down"),
    plain("dpad.*.left", "left"),
    plain("dpad.*.right", "right"),
    plain("pointer", "mouse pointer"),
    plain("pointer.mode", "how the touch moves the pointer"),
    number("pointer.centre_radius_mm", "where it rests: up to", Unit::Millimetre),
    number("pointer.full_radius_mm", "where it has its full speed: from", Unit::Millimetre),
    number("pointer.speed_counts_per_s", "full speed", Unit::CountPerSecond),
    number("pointer.curve", "how fine it is near the middle", Unit::Power),
    number("pointer.min_force_n", "touch force", Unit::Newton),
    number("pointer.release_force_n", "let-go force", Unit::Newton),
    plain("zone", "zone"),
    plain("zone.name", "name"),
    number("zone.from_deg", "first edge", Unit::Degree),
    number("zone.to_deg", "second edge", Unit::Degree),
    number("zone.inner_radius_mm", "begins at", Unit::Millimetre),
    number("zone.outer_radius_mm", "ends at", Unit::Millimetre),
    number("zone.hysteresis_deg", "how far it is kept beyond its sides, as an angle", Unit::Degree),
    number("zone.hysteresis_mm", "how far it is kept beyond its sides", Unit::Millimetre),
    number("zone.radius_hysteresis_mm", "how far it is kept inwards and outwards", Unit::Millimetre),
    plain("layer", "layer"),
    plain("layer.name", "name"),
    plain("layer.gamepad", "directions on the gamepad"),
    plain("layer.keyboard", "directions on the keyboard"),
    plain("layer.*.up", "up"),
    plain("layer.*.down", "down"),
    plain("layer.*.left", "left"),
    plain("layer.*.right", "right"),
    plain("macro", "macro"),
    plain("macro.name", "name"),
    plain("macro.steps", "steps"),
    plain("macro.steps.gamepad", "on the gamepad"),
    plain("macro.steps.keyboard", "on the keyboard"),
    plain("macro.steps.pointer", "on the mouse"),
    number("macro.steps.for_ms", "how long it is down", Unit::Millisecond),
    number("macro.steps.wait_ms", "pause", Unit::Millisecond),
    plain("stick", "stick"),
    plain("stick.stick", "which stick"),
    plain("stick.from", "what moves it"),
    plain("stick.label", "what it does in the game"),
    number("stick.centre_radius_mm", "where it rests: up to", Unit::Millimetre),
    number("stick.full_radius_mm", "where it is at its end: from", Unit::Millimetre),
    number("stick.centre_n", "push at which it rests: up to", Unit::Newton),
    number("stick.full_n", "push at which it is at its end: from", Unit::Newton),
    number("stick.curve", "how fine it is near the middle", Unit::Power),
    number("stick.min_force_n", "touch force", Unit::Newton),
    number("stick.release_force_n", "let-go force", Unit::Newton),
    plain("trigger", "trigger"),
    plain("trigger.trigger", "which trigger"),
    plain("trigger.label", "what it does in the game"),
    number("trigger.from_n", "force at which it rests: up to", Unit::Newton),
    number("trigger.full_n", "force at which it is at its end: from", Unit::Newton),
    number("trigger.curve", "how fine it is near its rest", Unit::Power),
    plain("trigger.zone", "where it counts"),
    plain("button", "button"),
    plain("button.force", "what presses it"),
    number("button.press_n", "press force", Unit::Newton),
    number("button.release_n", "let-go force", Unit::Newton),
    number("button.hair_n", "hair trigger: let go when it eases by", Unit::Newton),
    number("button.dwell_ms", "how long the finger must rest first", Unit::Millisecond),
    number("button.dwell_mm", "how still the finger must rest: within", Unit::Millimetre),
    plain("button.zone", "where it counts"),
    plain("button.layer", "in which layer it counts"),
    plain("button.out", "press"),
    plain("button.tap", "short press"),
    plain("button.double", "double press"),
    plain("button.hold", "long press"),
    plain("button.light", "light press"),
    plain("button.hard", "hard press"),
    number("button.double_press_ms", "how soon a double press follows", Unit::Millisecond),
    number("button.long_press_ms", "how long a long press takes", Unit::Millisecond),
    plain("button.permissive_hold", "also long if another press begins and ends during it"),
    plain("button.hold_on_other_key_press", "also long as soon as another press begins"),
    number("button.hard_press_n", "hard-press force", Unit::Newton),
    number("button.hard_release_n", "hard-press let-go force", Unit::Newton),
    plain("button.skip", "light on the way to hard"),
    number("button.skip_ms", "how quick a hard press is", Unit::Millisecond),
    plain("button.*.label", "what it does in the game"),
    plain("button.*.gamepad", "on the gamepad"),
    plain("button.*.keyboard", "on the keyboard"),
    plain("button.*.pointer", "on the mouse"),
    plain("button.*.layer", "layer that it switches on"),
    plain("button.*.macro", "macro that it begins"),
    plain("button.*.bridge", "what it asks of tactpad"),
    plain("button.*.toggle", "stays down until the next press"),
    plain("button.*.sticky", "stays down for one more press"),
    number("button.*.turbo_ms", "pressed again and again, once in", Unit::Millisecond),
];

/// Whether a pattern such as `button.*.toggle` stands for this place, such as `button.out.toggle`.
pub(super) fn fits(pattern: &str, place: &str) -> bool {
    let (mut parts, mut steps) = (pattern.split('.'), place.split('.'));
    parts.by_ref().zip(steps.by_ref()).all(|(part, step)| part == "*" || part == step)
        && pattern.matches('.').count() == place.matches('.').count()
}

/// The setting at a place such as `button.out.toggle`: numbers of tables in lists are left out.
pub fn find(place: &str) -> Option<&'static Setting> {
    SETTINGS.iter().find(|setting| fits(setting.place, place))
}

/// The plain word of the setting at a place; its key where it has none.
pub fn word(place: &str) -> &str {
    find(place).map_or_else(|| place.rsplit('.').next().unwrap_or(place), |setting| setting.word)
}

/// A number with the unit of the setting at a place, to a hundredth: `2.5 N`.
pub fn amount(place: &str, value: f64) -> String {
    let unit = find(place).map_or(Unit::NoNumber, |setting| setting.unit);
    let value = (value * 100.0).round() / 100.0;
    match unit {
        Unit::Degree | Unit::Factor => format!("{value}{}", unit.sign()),
        Unit::Power | Unit::NoNumber => value.to_string(),
        _ => format!("{value} {}", unit.sign()),
    }
}

/// The same for who reads no milliseconds: `0.4 seconds`.
pub fn spoken_amount(place: &str, value: f64) -> String {
    match (find(place).map(|setting| setting.unit), value / 1e3) {
        (Some(Unit::Millisecond), 0.5) => "half a second".into(),
        (Some(Unit::Millisecond), 1.0) => "1 second".into(),
        (Some(Unit::Millisecond), s) => format!("{s} seconds"),
        _ => amount(place, value),
    }
}

/// The let-go force of a press force that is not written: its key, and its share of the press force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LetGo {
    key: &'static str,
    share: f64,
}

/// The let-go force that belongs to the press force at a place.
fn let_go(place: &str) -> Option<LetGo> {
    let (key, share) = match place {
        "button.press_n" => ("release_n", RELEASE_SHARE),
        "button.hard_press_n" => ("hard_release_n", RELEASE_SHARE),
        "dpad.min_force_n" | "pointer.min_force_n" | "stick.min_force_n" => {
            ("release_force_n", RELEASE_RATIO.recip())
        }
        _ => return None,
    };
    // No more digits than the share has.
    Some(LetGo { key, share: (f64::from(share) * 1e6).round() / 1e6 })
}

/// A setting as a page reads it.
#[derive(Serialize)]
pub struct Field {
    word: &'static str,
    unit: &'static str,
    step: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    let_go: Option<LetGo>,
}

/// All settings, by their places.
pub fn fields() -> impl Iterator<Item = (&'static str, Field)> {
    SETTINGS.iter().map(|Setting { place, word, unit }| {
        (*place, Field { word, unit: unit.sign(), step: unit.step(), let_go: let_go(place) })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_finds_its_setting_and_no_other() {
        assert_eq!(word("button.press_n"), "press force");
        assert_eq!(word("button.tap.turbo_ms"), "pressed again and again, once in");
        assert_eq!(find("access.tremor_per_mm").map(|it| it.unit.sign()), Some("Hz per mm/s"));
        assert_eq!((word("button.out"), word("dpad.label.up")), ("press", "up"));
        assert!(
            find("button").is_some() && find("button.out.press_n").is_none() && find("press_n").is_none()
        );
    }

    #[test]
    fn within_a_table_each_word_stands_once() {
        let table = |place: &'static str| place.rsplit_once('.').map_or("", |(table, _)| table);
        for (index, setting) in SETTINGS.iter().enumerate() {
            let same = SETTINGS[..index]
                .iter()
                .find(|it| table(it.place) == table(setting.place) && it.word == setting.word);
            assert!(same.is_none(), "{} has the word of {}", setting.place, same.map_or("", |it| it.place));
        }
    }
}
