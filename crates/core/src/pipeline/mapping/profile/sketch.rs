//! A profile as it is drawn: all numbers resolved, mirrored for the left hand as it is played, names as a profile writes them, and
//! beside them the words that people read.

use std::collections::BTreeMap;

use serde::Serialize;

use super::place::{Direction, Dpad, Pointer, Zone};
use super::sector;
use super::word_places::WordPlaces;
use super::words::{COMMANDS, DPAD_MODES, FORCES, POINTER_MODES, SIDES, SOURCES, word};
use super::{
    Action, Button, ButtonPlace, Command, Effect, Mode, Output, Profile, Role, Stick, Trigger, When,
};
use crate::pipeline::mapping::plain::{controls, named, settings};

/// A profile as it is drawn. Angles in degrees counter-clockwise from right; `centre_mm` is where the hand has its centre.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sketch {
    /// The profile's name for people.
    pub name: String,
    /// The device of its output.
    pub output: &'static str,
    /// Directions, zones and rings are around this place.
    pub centre_mm: [f32; 2],
    /// Window of the mean filter.
    pub filter_samples: usize,
    /// Its directions.
    pub dpad: Option<DpadSketch>,
    /// Its zones, in the file's order.
    pub zones: Vec<ZoneSketch>,
    /// The rings that move the pointer.
    pub pointer: Option<PointerRings>,
    /// Its sticks.
    pub sticks: Vec<StickReach>,
    /// Its triggers.
    pub triggers: Vec<TriggerForces>,
    /// Its buttons, in the file's order.
    pub buttons: Vec<ButtonForces>,
    /// What controls do in the game, by the controls.
    pub labels: BTreeMap<String, String>,
}

/// Directions as they are drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DpadSketch {
    /// `4way`, `4way-sticky` or `8way`.
    pub mode: &'static str,
    /// A direction starts at this distance from the centre,
    pub centre_radius_mm: f32,
    /// and ends closer than this.
    pub release_radius_mm: f32,
    /// See [`Dpad::rotation_deg`].
    pub rotation_deg: f32,
    /// See [`Dpad::diagonal_deg`].
    pub diagonal_deg: f32,
    /// See [`Dpad::hysteresis_deg`].
    pub hysteresis_deg: f32,
    /// See [`Dpad::hysteresis_mm`].
    pub hysteresis_mm: f32,
    /// See [`Dpad::min_force_n`].
    pub min_force_n: f32,
    /// See [`Dpad::release_force_n`].
    pub release_force_n: f32,
    /// The parts of the plate, counter-clockwise from right.
    pub sectors: Vec<SectorOutline>,
}

/// A sector of the plate and what is held there; nothing where the last direction stays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SectorOutline {
    /// It begins
    pub from_deg: f32,
    /// and ends.
    pub to_deg: f32,
    /// The names of the directions.
    pub directions: Vec<&'static str>,
    /// What people read there,
    pub word: String,
    /// at this place of the plate.
    pub word_at_mm: [f32; 2],
}

/// A zone as it is drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ZoneSketch {
    /// Its name.
    pub name: String,
    /// It begins; nothing for a ring.
    pub from_deg: Option<f32>,
    /// It ends.
    pub to_deg: Option<f32>,
    /// It begins at this distance from the centre.
    pub inner_radius_mm: f32,
    /// It ends at this one.
    pub outer_radius_mm: f32,
    /// Its name stands at this place of the plate.
    pub name_at_mm: [f32; 2],
}

/// The pointer's rings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointerRings {
    /// `relative` or `absolute`.
    pub mode: &'static str,
    /// See [`Pointer::centre_radius_mm`].
    pub centre_radius_mm: f32,
    /// See [`Pointer::full_radius_mm`].
    pub full_radius_mm: f32,
    /// See [`Pointer::min_force_n`].
    pub min_force_n: f32,
    /// See [`Pointer::release_force_n`].
    pub release_force_n: f32,
    /// Its name stands at this place of the plate.
    pub word_at_mm: [f32; 2],
}

/// From where to where a stick moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StickReach {
    /// `left` or `right`.
    pub stick: &'static str,
    /// `place`: what follows is in millimetres; `shear`: in newtons.
    pub from: &'static str,
    /// Up to here it rests.
    pub centre: f32,
    /// From here on it is at its end.
    pub full: f32,
    /// What people read of it,
    pub word: String,
    /// at this place of the plate, where the place moves it.
    pub word_at_mm: [f32; 2],
}

/// From where to where a trigger moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TriggerForces {
    /// `left` or `right`.
    pub trigger: &'static str,
    /// Up to here it rests.
    pub from_n: f32,
    /// From here on it is at its end.
    pub full_n: f32,
    /// What people read of it.
    pub word: String,
}

/// A button's thresholds and times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ButtonForces {
    /// Its number in the file, from 1.
    pub number: usize,
    /// What people call it: what it does.
    pub word: String,
    /// `fz`, `fx`, `-fx`, `fy` or `-fy`.
    pub force: &'static str,
    /// See [`Button::press_n`].
    pub press_n: f32,
    /// See [`Button::release_n`].
    pub release_n: f32,
    /// From here on a press is hard, if there are hard ones,
    pub hard_press_n: Option<f32>,
    /// and below this no longer.
    pub hard_release_n: Option<f32>,
    /// From here on a press is long, if there are long ones.
    pub long_press_ms: Option<u64>,
    /// A second press this soon makes a double one, if there are double ones.
    pub double_press_ms: Option<u64>,
    /// A press counts after this rest, if it needs one.
    pub dwell_ms: Option<u64>,
    /// The zone or direction where it counts; everywhere without.
    pub zone: Option<String>,
    /// The layer in which it counts; always without.
    pub layer: Option<String>,
    /// Effects of its kinds of press.
    pub does: Vec<EffectLabel>,
}

/// Effect of a kind of press.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectLabel {
    /// The kind of press, as its key in the profile.
    pub role: &'static str,
    /// The same for people: `short press`; `press` where none is long.
    pub role_word: &'static str,
    /// Names of controls with `+` between them, or what it acts on in words.
    pub keys: String,
    /// What people read of it: `A: jump`.
    pub word: String,
}

impl Sketch {
    /// Of a profile.
    pub fn of(profile: &Profile) -> Self {
        let mut words = WordPlaces::on(PLATE_MM, profile.centre_mm);
        Self {
            name: profile.name.clone(),
            output: profile.output.name(),
            centre_mm: profile.centre_mm,
            filter_samples: profile.filter_samples,
            dpad: profile.dpad.as_ref().map(|dpad| DpadSketch::of(dpad, profile, &mut words)),
            zones: profile.zones.iter().map(|it| ZoneSketch::of(it, profile.centre_mm, &mut words)).collect(),
            pointer: profile.pointer.as_ref().map(|it| PointerRings::of(it, profile.centre_mm, &mut words)),
            sticks: profile.sticks.iter().map(|it| StickReach::of(it, profile, &mut words)).collect(),
            triggers: profile.triggers.iter().map(|it| TriggerForces::of(it, profile)).collect(),
            buttons: (1..)
                .zip(&profile.buttons)
                .map(|(number, it)| ButtonForces::of(number, it, profile))
                .collect(),
            labels: named::labels(profile),
        }
    }
}

/// Radius of the plate that profiles count on.
pub const PLATE_MM: f32 = 30.0;
/// The word of a direction stands so far from the hand's centre at best.
const DIRECTION_MM: f32 = 23.0;
/// Between up and the diagonal, and other angles where the word of a ring may stand.
const RING_WORD_DEG: [f32; 8] = [60.0, 120.0, -60.0, -120.0, 30.0, 150.0, -30.0, -150.0];
/// The name of a zone stands so far from its inner edge at most, where the words of directions leave room.
const ZONE_NAME_MM: f32 = 3.5;

/// A place by its angle and its distance from a centre.
pub fn polar(centre_mm: [f32; 2], deg: f32, radius_mm: f32) -> [f32; 2] {
    let (sin, cos) = libm::sincosf(deg.to_radians());
    [centre_mm[0] + radius_mm * cos, centre_mm[1] + radius_mm * sin]
}

/// Places in a direction, the one at `best_mm` first, then nearer ones down to `from_mm` and farther ones up to beside the plate.
fn along(centre_mm: [f32; 2], deg: f32, best_mm: f32, from_mm: f32) -> impl Iterator<Item = [f32; 2]> {
    let nearer =
        (1..30).map(move |step| best_mm - step as f32).take_while(move |radius_mm| *radius_mm > from_mm);
    let farther = (1..40).map(move |step| best_mm + step as f32);
    [best_mm].into_iter().chain(nearer).chain(farther).map(move |radius_mm| polar(centre_mm, deg, radius_mm))
}

/// Where the word of a ring may stand: inside of it, else outside.
fn beside_ring(centre_mm: [f32; 2], radius_mm: f32) -> impl Iterator<Item = [f32; 2]> {
    let radii_mm = [-2.2, 2.2, -4.4, 4.4].map(|beside_mm| radius_mm + beside_mm);
    let at = move |radius_mm| RING_WORD_DEG.map(|deg| polar(centre_mm, deg, radius_mm));
    radii_mm.into_iter().flat_map(at)
}

impl DpadSketch {
    fn of(dpad: &Dpad, profile: &Profile, words: &mut WordPlaces) -> Self {
        Self {
            mode: word(&DPAD_MODES, &dpad.mode),
            centre_radius_mm: dpad.centre_radius_mm,
            release_radius_mm: dpad.centre_radius_mm - dpad.radius_hysteresis_mm,
            rotation_deg: dpad.rotation_deg,
            diagonal_deg: dpad.diagonal_deg,
            hysteresis_deg: dpad.hysteresis_deg,
            hysteresis_mm: dpad.hysteresis_mm,
            min_force_n: dpad.min_force_n,
            release_force_n: dpad.release_force_n,
            sectors: sector::parts(dpad)
                .map(|(from_deg, to_deg, held)| SectorOutline::of([from_deg, to_deg], held, profile, words))
                .collect(),
        }
    }
}

impl SectorOutline {
    fn of(
        [from_deg, to_deg]: [f32; 2],
        held: impl Fn(Direction) -> bool,
        profile: &Profile,
        words: &mut WordPlaces,
    ) -> Self {
        let held: Vec<_> = Direction::ALL.into_iter().filter(|direction| held(*direction)).collect();
        let word = match held[..] {
            [] => "keeps the last".into(),
            [direction] => named::direction(profile, direction),
            _ => held.iter().map(|it| it.name()).collect::<Vec<_>>().join(" + "),
        };
        let deg = from_deg + 0.5 * (to_deg - from_deg).rem_euclid(360.0);
        let starts_mm = profile.dpad.as_ref().map_or(0.0, |dpad| dpad.centre_radius_mm);
        let places = along(profile.centre_mm, deg, DIRECTION_MM, starts_mm);
        let word_at_mm = words.place(&word, starts_mm, places);
        let directions = held.into_iter().map(Direction::name).collect();
        Self { from_deg, to_deg, directions, word, word_at_mm }
    }
}

impl ZoneSketch {
    fn of(zone: &Zone, centre_mm: [f32; 2], words: &mut WordPlaces) -> Self {
        let edges = (zone.half_width_deg < 180.0)
            .then_some((zone.middle_deg - zone.half_width_deg, zone.middle_deg + zone.half_width_deg));
        let middle_mm = (zone.inner_radius_mm + zone.outer_radius_mm.min(PLATE_MM - 3.0)) / 2.0;
        let (deg, radius_mm) = match edges {
            Some(_) if zone.inner_radius_mm > 0.0 => {
                (zone.middle_deg, middle_mm.min(zone.inner_radius_mm + ZONE_NAME_MM))
            }
            Some(_) => (zone.middle_deg, middle_mm),
            None if zone.inner_radius_mm == 0.0 => (90.0, 0.0),
            None => (90.0, middle_mm),
        };
        let turned = [0.0, 15.0, -15.0, 180.0].into_iter().take(if edges.is_some() { 3 } else { 4 });
        let places =
            turned.flat_map(|by_deg| along(centre_mm, deg + by_deg, radius_mm, zone.inner_radius_mm));
        Self {
            name: zone.name.clone(),
            from_deg: edges.map(|(from_deg, _)| from_deg),
            to_deg: edges.map(|(_, to_deg)| to_deg),
            inner_radius_mm: zone.inner_radius_mm,
            outer_radius_mm: zone.outer_radius_mm,
            name_at_mm: words.place(&zone.name, zone.inner_radius_mm, places),
        }
    }
}

impl PointerRings {
    fn of(pointer: &Pointer, centre_mm: [f32; 2], words: &mut WordPlaces) -> Self {
        Self {
            mode: word(&POINTER_MODES, &pointer.mode),
            centre_radius_mm: pointer.centre_radius_mm,
            full_radius_mm: pointer.full_radius_mm,
            min_force_n: pointer.min_force_n,
            release_force_n: pointer.release_force_n,
            word_at_mm: words.place("pointer", 0.0, beside_ring(centre_mm, pointer.full_radius_mm)),
        }
    }
}

impl StickReach {
    fn of(stick: &Stick, profile: &Profile, words: &mut WordPlaces) -> Self {
        let name = named::stick(profile, stick.side);
        let from = word(&SOURCES, &stick.source);
        // Newtons are no place.
        let places = beside_ring(profile.centre_mm, stick.full).take_while(|_| from == "place");
        let word_at_mm = words.place(&name, 0.0, places);
        Self {
            stick: word(&SIDES, &stick.side),
            from,
            centre: stick.rest,
            full: stick.full,
            word: name,
            word_at_mm,
        }
    }
}

impl TriggerForces {
    fn of(trigger: &Trigger, profile: &Profile) -> Self {
        Self {
            trigger: word(&SIDES, &trigger.side),
            from_n: trigger.from_n,
            full_n: trigger.full_n,
            word: named::trigger(profile, trigger.side),
        }
    }
}

impl ButtonForces {
    fn of(number: usize, button: &Button, profile: &Profile) -> Self {
        let ms = |us: u64| us / 1_000;
        let (hard_press_n, hard_release_n) = match button.action {
            Action::ByForce { hard_press_n, hard_release_n, .. } => {
                (Some(hard_press_n), Some(hard_release_n))
            }
            Action::Hold(_) | Action::ByTime { .. } => (None, None),
        };
        let (double, hold) = match button.action {
            Action::ByTime { double, hold, .. } => (double, hold),
            Action::Hold(_) | Action::ByForce { .. } => (None, None),
        };
        let effects = Role::ALL.into_iter().zip(button.effects());
        let index = number - 1;
        Self {
            number,
            word: named::button(profile, index).unwrap_or_default(),
            force: word(&FORCES, &button.force),
            press_n: button.press_n,
            release_n: button.release_n,
            hard_press_n,
            hard_release_n,
            long_press_ms: hold.map(|it| ms(it.us)),
            double_press_ms: double.map(|it| ms(it.us)),
            dwell_ms: button.dwell.map(|it| ms(it.us)),
            zone: button.place.and_then(|place| place_name(place, profile)),
            layer: layer_name(button.when, profile),
            does: effects
                .filter_map(|(role, effect)| {
                    let is_any = role == Role::Tap && hold.is_none();
                    Some(EffectLabel::of(index, role, is_any, &effect?, profile))
                })
                .collect(),
        }
    }
}

fn place_name(place: ButtonPlace, profile: &Profile) -> Option<String> {
    match place {
        ButtonPlace::Zone(number) => profile.zones.get(number).map(|zone| zone.name.clone()),
        ButtonPlace::Direction(direction) => Some(direction.name().into()),
    }
}

fn layer_name(when: When, profile: &Profile) -> Option<String> {
    match when {
        When::Always => None,
        When::Base => Some("base".into()),
        When::Layer(number) => profile.layers.get(number).map(|layer| layer.name.clone()),
    }
}

impl EffectLabel {
    /// `is_any` where it comes of each press, however long.
    fn of(index: usize, role: Role, is_any: bool, effect: &Effect, profile: &Profile) -> Self {
        let acts_on = match &effect.output {
            Output::Keys(_) => effect
                .output
                .bindings()
                .map(|it| controls::written(it.code, it.value))
                .collect::<Vec<_>>()
                .join("+"),
            Output::Layer(number) => {
                profile.layers.get(*number).map_or_else(String::new, |it| format!("layer {}", it.name))
            }
            Output::Macro(number) => {
                profile.macros.get(*number).map_or_else(String::new, |it| format!("macro {}", it.name))
            }
            Output::Bridge(Command::Profile(name)) => format!("profile {name}"),
            Output::Bridge(command) => word(&COMMANDS, command).into(),
        };
        let follows = match effect.mode {
            Mode::Plain => String::new(),
            Mode::Toggle => ", toggle".into(),
            Mode::Sticky => ", sticky".into(),
            Mode::Turbo { period_us } => format!(", turbo {} ms", period_us / 1_000),
        };
        Self {
            role: role.name(),
            role_word: settings::word(if is_any { Role::Out.place() } else { role.place() }),
            keys: acts_on + &follows,
            word: named::effect(profile, index, role, effect),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::mapping::profile::word_places::WordBox;
    use crate::pipeline::mapping::read::check::{OutputChoice, read};
    use crate::pipeline::mapping::read::shipped;

    fn sketch(name: &str) -> Sketch {
        Sketch::of(&read(shipped::text(name).unwrap(), OutputChoice::AsWritten).0.unwrap())
    }

    #[test]
    fn eight_ways_cover_the_circle_without_a_gap() {
        let dpad = sketch("contra").dpad.unwrap();
        assert_eq!((dpad.mode, dpad.release_radius_mm, dpad.sectors.len()), ("8way", 6.5, 8));
        for (part, next) in dpad.sectors.iter().zip(dpad.sectors.iter().cycle().skip(1)) {
            let step_deg = (next.from_deg - part.to_deg).rem_euclid(360.0);
            assert!(step_deg.min(360.0 - step_deg) < 1e-3, "{part:?} {next:?}");
        }
        assert_eq!((dpad.sectors[0].from_deg, &*dpad.sectors[0].directions), (-22.5, &["right"][..]));
        assert_eq!(dpad.sectors[1].directions, ["up", "right"]);
    }

    #[test]
    fn four_ways_have_no_diagonals_and_sticky_ones_hold_nothing() {
        assert_eq!(sketch("super-mario").dpad.map(|it| it.sectors.len()), Some(4));
        let sticky = sketch("tetris").dpad.unwrap();
        assert_eq!(
            (sticky.mode, sticky.sectors.len(), sticky.sectors[1].directions.len()),
            ("4way-sticky", 8, 0)
        );
    }

    #[test]
    fn buttons_say_what_their_presses_do() {
        let sketch = sketch("super-mario");
        let [first, ..] = &sketch.buttons[..] else { panic!("no button") };
        let does: Vec<_> =
            first.does.iter().map(|it| (it.role, it.keys.as_str(), it.word.as_str())).collect();
        let expected = vec![("tap", "BTN_SOUTH", "A: jump"), ("hold", "BTN_EAST", "B: run and fire")];
        assert_eq!((first.force, does), ("fz", expected));
        assert_eq!(
            (first.word.as_str(), first.does[1].role_word),
            ("A: jump / B: run and fire", "long press")
        );
        assert_eq!(sketch.labels.get("BTN_EAST").map(String::as_str), Some("run and fire"));
        assert!(first.long_press_ms.is_some() && first.double_press_ms.is_none());
    }

    /// The words of a plate, each with what it fills.
    fn words(sketch: &Sketch) -> Vec<(&str, WordBox)> {
        let directions =
            sketch.dpad.iter().flat_map(|dpad| &dpad.sectors).map(|it| (&*it.word, it.word_at_mm));
        let zones = sketch.zones.iter().map(|it| (&*it.name, it.name_at_mm));
        let pointer = sketch.pointer.iter().map(|it| ("pointer", it.word_at_mm));
        let sticks =
            sketch.sticks.iter().filter(|it| it.from == "place").map(|it| (&*it.word, it.word_at_mm));
        let all = directions.chain(zones).chain(pointer).chain(sticks);
        all.map(|(word, at_mm)| (word, WordBox::of(word, at_mm))).collect()
    }

    #[test]
    fn no_word_covers_another_or_stands_where_nothing_counts_whatever_the_radii() {
        let beside = "[pointer]\ncentre_radius_mm = 3\nfull_radius_mm = FULL\n[[zone]]\nname = \"rim\"\nfrom_deg = 60\nto_deg = 120\ninner_radius_mm = 24\n\
                      [[button]]\nforce = \"fz\"\npress_n = 2\nzone = \"rim\"\nout = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\", label = \"jump\" }\n";
        for mode in ["4way", "8way"] {
            for (radius_mm, x_mm) in (2..=29).flat_map(|radius_mm| [(radius_mm, 0), (radius_mm, 8)]) {
                for full_mm in [8, 16, 24, 29] {
                    let text = format!(
                        "schema = 1\nname = \"words\"\noutput = \"gamepad\"\ncentre_x_mm = {x_mm}\n[dpad]\nmode = \"{mode}\"\ncentre_radius_mm = {radius_mm}\nradius_hysteresis_mm = 1\n{}",
                        beside.replace("FULL", &full_mm.to_string())
                    );
                    let (profile, errors) = read(&text, OutputChoice::AsWritten);
                    let sketch = Sketch::of(&profile.unwrap_or_else(|| panic!("{errors:?}")));
                    let words = words(&sketch);
                    for (index, (word, it)) in words.iter().enumerate() {
                        for (other, taken) in &words[..index] {
                            assert!(it.overlap_mm2(taken) < 1e-3, "{word} covers {other}: {text}");
                        }
                    }
                    for (word, it) in words.iter().take(sketch.dpad.as_ref().unwrap().sectors.len()) {
                        let [near_mm, _] = it.distances_mm(sketch.centre_mm);
                        assert!(near_mm >= radius_mm as f32, "{word} stands {near_mm} mm out: {text}");
                    }
                }
            }
        }
    }
}
