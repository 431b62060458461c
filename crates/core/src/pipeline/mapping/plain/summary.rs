//! A profile as people read it: what each part of it does, with which forces and times, and for which hand.

use super::controls;
use super::named;
use super::settings::{self, amount};
use super::values;
use crate::pipeline::mapping::profile::sketch::{ButtonForces, EffectLabel, Sketch};
use crate::pipeline::mapping::profile::{
    Direction, Gain, Labelled, PointerMode, Profile, RestRejection, Source,
};

/// A profile in words.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The profile's name for people.
    pub name: String,
    /// What is played: `gamepad` or `keyboard`.
    pub output: &'static str,
    /// What does something: each as what a hand does, what comes of it, and with which numbers.
    pub does: Vec<Part>,
    /// How it fits the hand: each setting with its value. Only what is not as it always is.
    pub hand: Vec<(String, String)>,
}

/// A part of a profile that does something.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The button of the profile that it is of, from 1.
    pub button: Option<usize>,
    /// What the hand does: `press into the plate, long press`.
    pub hand: String,
    /// What comes of it: `A: jump`.
    pub gives: String,
    /// With which forces and times: `press force 2 N, let-go force 1.4 N`.
    pub numbers: String,
}

/// Settings that say nothing to who plays, or helps to play.
const FINE: [&str; 6] = [
    "filter_samples",
    "min_press_ms",
    "access.tremor_per_mm",
    "access.rest_ms",
    "dpad.release_force_n",
    "button.release_n",
];

/// For whom a profile is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// Who plays, or helps to play.
    Player,
    /// Who looks after the settings.
    Tuner,
}

impl Reader {
    fn wants(self, place: &str) -> bool {
        self == Self::Tuner || !FINE.contains(&place)
    }

    fn amount(self, place: &str, value: f64) -> String {
        if self == Self::Tuner { amount(place, value) } else { settings::spoken_amount(place, value) }
    }

    /// The touch force: for who plays the one that counts, where a resting hand is ignored up to a larger one.
    fn touch_n(self, profile: &Profile, min_force_n: f32) -> f64 {
        let rest_n = profile.access.rest.filter(|_| self == Self::Player).map_or(0.0, |rest| rest.n);
        min_force_n.max(rest_n).into()
    }

    /// Settings with their numbers and units: `press force 2 N, let-go force 1.4 N`.
    fn said<'a>(self, all: impl IntoIterator<Item = (&'a str, f64)>) -> String {
        let wanted = all.into_iter().filter(|(place, _)| self.wants(place));
        let said =
            wanted.map(|(place, value)| format!("{} {}", settings::word(place), self.amount(place, value)));
        said.collect::<Vec<_>>().join(", ")
    }
}

impl Summary {
    /// Of a profile.
    pub fn of(profile: &Profile, reader: Reader) -> Self {
        let sketch = Sketch::of(profile);
        let mut does = directions(profile, reader);
        does.extend(moved(profile, reader));
        does.extend(sketch.buttons.iter().flat_map(|button| presses(button, reader)));
        Self { name: profile.name.clone(), output: profile.output.name(), does, hand: hand(profile, reader) }
    }
}

fn directions(profile: &Profile, reader: Reader) -> Vec<Part> {
    let Some(dpad) = &profile.dpad else { return Vec::new() };
    let forces = [
        ("dpad.min_force_n", reader.touch_n(profile, dpad.min_force_n)),
        ("dpad.release_force_n", dpad.release_force_n.into()),
    ];
    let numbers = format!(
        "from {} on, {}",
        amount("dpad.centre_radius_mm", dpad.centre_radius_mm.into()),
        reader.said(forces)
    );
    let keys = [&dpad.up, &dpad.down, &dpad.left, &dpad.right];
    let is_named = |it: &Direction| profile.labels.of(Labelled::Direction(*it)).is_some();
    if dpad.rotation_deg == 0.0 && !Direction::ALL.iter().any(is_named) {
        let gives = keys.map(controls::all_of).join(", ");
        let hand = "touch above, below, left, right of the middle".into();
        return vec![Part { button: None, hand, gives, numbers }];
    }
    let one = |(direction, keys): (Direction, _)| {
        let label = profile.labels.of(Labelled::Direction(direction));
        Part {
            button: None,
            hand: format!("touch {} the middle", beside(direction, dpad.rotation_deg)),
            gives: named::with_label(&controls::all_of(keys), label),
            numbers: if direction == Direction::Up {
                numbers.clone()
            } else {
                "with the forces of up".into()
            },
        }
    };
    Direction::ALL.into_iter().zip(keys).map(one).collect()
}

/// Where places lie, seen from the middle: eight, counter-clockwise from right.
const PLACES: [&str; 8] = [
    "right of",
    "to the upper right of",
    "above",
    "to the upper left of",
    "left of",
    "to the lower left of",
    "below",
    "to the lower right of",
];
/// A place that lies farther than this beside one of the eight is told as near it.
const PLACE_DEG: f32 = 10.0;

/// Where a direction lies, seen from the middle, with all directions turned by so much.
fn beside(direction: Direction, rotation_deg: f32) -> String {
    let usual_deg = match direction {
        Direction::Right => 0.0,
        Direction::Up => 90.0,
        Direction::Left => 180.0,
        Direction::Down => 270.0,
    };
    let deg = (usual_deg + rotation_deg).rem_euclid(360.0);
    let nearest = libm::roundf(deg / 45.0);
    let about = if (deg - 45.0 * nearest).abs() > PLACE_DEG { "roughly " } else { "" };
    format!("{about}{}", PLACES[nearest as usize % PLACES.len()])
}

/// What follows the finger: pointer, sticks, triggers.
fn moved(profile: &Profile, reader: Reader) -> Vec<Part> {
    let pointer = profile.pointer.iter().map(|it| {
        let mode = if it.mode == PointerMode::Relative { "relative" } else { "absolute" };
        Part {
            button: None,
            hand: "touch".into(),
            gives: format!("mouse pointer: {}", values::word("pointer.mode", mode)),
            numbers: reader.said([("pointer.min_force_n", reader.touch_n(profile, it.min_force_n))]),
        }
    });
    let sticks = profile.sticks.iter().map(|it| {
        let (hand, place) = match it.source {
            Source::Place => ("touch", "stick.full_radius_mm"),
            Source::Shear => ("push sideways", "stick.full_n"),
        };
        let numbers = format!("at its end from {} on", amount(place, it.full.into()));
        Part { button: None, hand: hand.into(), gives: named::stick(profile, it.side), numbers }
    });
    let triggers = profile.triggers.iter().map(|it| Part {
        button: None,
        hand: values::word("button.force", "fz").into(),
        gives: named::trigger(profile, it.side),
        numbers: format!(
            "from {} to {}",
            amount("trigger.from_n", it.from_n.into()),
            amount("trigger.full_n", it.full_n.into())
        ),
    });
    pointer.chain(sticks).chain(triggers).collect()
}

/// The kinds of press of a button; the forces stand with the first one, and with each the number that tells it.
fn presses(button: &ButtonForces, reader: Reader) -> Vec<Part> {
    let place = button.zone.as_ref().map_or_else(String::new, |zone| format!(" in {zone}"));
    let layer = match button.layer.as_deref() {
        None => String::new(),
        Some("base") => ", while no layer is on".into(),
        Some(layer) => format!(", while layer {layer} is on"),
    };
    let forces = [
        Some(("button.press_n", button.press_n.into())),
        Some(("button.release_n", button.release_n.into())),
        button.dwell_ms.map(|ms| ("button.dwell_ms", ms as f64)),
    ];
    let one = |(index, does): (usize, &EffectLabel)| {
        let own = match does.role {
            "hold" => button.long_press_ms.map(|ms| ("button.long_press_ms", ms as f64)),
            "double" => button.double_press_ms.map(|ms| ("button.double_press_ms", ms as f64)),
            "hard" => button.hard_press_n.map(|n| ("button.hard_press_n", n.into())),
            _ => None,
        };
        let forces = forces.into_iter().flatten().filter(|_| index == 0);
        let is_any = does.role_word == settings::word("button.out");
        let kind = if is_any { String::new() } else { format!(", {}", does.role_word) };
        Part {
            button: Some(button.number),
            hand: format!("{}{place}{kind}{layer}", values::word("button.force", button.force)),
            gives: does.word.clone(),
            numbers: reader.said(forces.chain(own)),
        }
    };
    button.does.iter().enumerate().map(one).collect()
}

fn hand(profile: &Profile, reader: Reader) -> Vec<(String, String)> {
    let ms = |us: u64| us as f64 / 1e3;
    let access = &profile.access;
    let mut told: Vec<(&str, f64)> =
        vec![("min_press_ms", ms(profile.min_press_us)), ("filter_samples", profile.filter_samples as f64)];
    let [x_mm, y_mm] = profile.centre_mm.map(f64::from);
    let Gain { up, down, left, right } = profile.gain;
    let optional = [
        ("centre_x_mm", x_mm, x_mm != 0.0),
        ("centre_y_mm", y_mm, y_mm != 0.0),
        ("access.slow_ms", ms(access.slow_us), access.slow_us > 0),
        ("access.bounce_ms", ms(access.bounce_us), access.bounce_us > 0),
        ("gain.up", up.into(), up != 1.0),
        ("gain.down", down.into(), down != 1.0),
        ("gain.left", left.into(), left != 1.0),
        ("gain.right", right.into(), right != 1.0),
    ];
    told.extend(optional.into_iter().filter(|(.., is_set)| *is_set).map(|(place, value, _)| (place, value)));
    if let Some(tremor) = &access.tremor {
        told.push(("access.tremor_hz", tremor.cutoff_hz.into()));
        told.push(("access.tremor_per_mm", tremor.per_mm.into()));
    }
    if let Some(rest) = &access.rest {
        told.push(("access.rest_n", rest.n.into()));
        told.push(("access.rest_ms", ms(rest.us)));
    }
    let word = |place: &str| {
        let word = settings::word(place);
        if place.starts_with("gain.") { format!("reach {word}") } else { word.to_owned() }
    };
    let wanted = told.into_iter().filter(|(place, _)| reader.wants(place));
    let said = |(place, value)| {
        let amount = reader.amount(place, value);
        let quick = access.rest.filter(|_| place == "access.rest_n" && reader == Reader::Player);
        let quick =
            quick.map(|rest| format!("; a touch grows by more than {} in a second", quickness(&rest)));
        (word(place), amount + &quick.unwrap_or_default())
    };
    wanted.map(said).collect()
}

/// By how much a touch grows in a second at least where a resting hand is ignored: `1 N`.
fn quickness(rest: &RestRejection) -> String {
    amount("access.rest_n", f64::from(rest.n) * 1e6 / rest.us.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::mapping::read::check::{OutputChoice, read};
    use crate::pipeline::mapping::read::shipped;

    fn told(change: impl FnOnce(&str) -> String) -> Summary {
        let text = change(shipped::text("super-mario").unwrap());
        Summary::of(&read(&text, OutputChoice::AsWritten).0.unwrap(), Reader::Player)
    }

    #[test]
    fn places_of_directions_follow_their_turn() {
        let touched = |deg: &str| {
            let does = told(|text| text.replace("rotation_deg = 0.0", &format!("rotation_deg = {deg}"))).does;
            does.into_iter()
                .filter(|it| it.button.is_none())
                .map(|it| it.gives + ": " + &it.hand)
                .collect::<Vec<_>>()
        };
        let usual = "up, down, left, right: touch above, below, left, right of the middle";
        assert_eq!(touched("0.0"), [usual]);
        let turned = [
            "up: touch to the upper left of the middle",
            "down: touch to the lower right of the middle",
            "left: touch to the lower left of the middle",
            "right: touch to the upper right of the middle",
        ];
        assert_eq!(touched("45.0"), turned);
        assert_eq!(touched("20.0")[2], "left: touch roughly left of the middle");
    }

    #[test]
    fn a_resting_hand_says_how_quick_a_touch_is_and_from_which_force_it_counts() {
        let told = told(|text| format!("{text}\n[access]\nrest_n = 0.5\n"));
        let rest = "0.5 N; a touch grows by more than 1 N in a second";
        assert!(told.hand.contains(&("ignores a resting hand below".into(), rest.into())), "{:?}", told.hand);
        assert!(told.does[0].numbers.ends_with("touch force 0.5 N"), "{}", told.does[0].numbers);
    }

    #[test]
    fn a_press_is_short_only_beside_a_long_one() {
        let hands = |summary: Summary| summary.does.into_iter().skip(1).map(|it| it.hand).collect::<Vec<_>>();
        let both = ["press into the plate, short press", "press into the plate, long press"];
        assert_eq!(hands(told(str::to_owned)), both);
        assert_eq!(told(str::to_owned).does[2].numbers, "how long a long press takes 0.4 seconds");
        assert_eq!(
            hands(told(|text| text.split("hold = ").next().unwrap().to_owned())),
            ["press into the plate"]
        );
    }
}
