//! A profile as people read it: what each part of it does, with which forces and times, and for which hand.

use super::controls;
use super::named;
use super::settings::{self, amount};
use super::values;
use crate::pipeline::mapping::profile::sketch::{ButtonForces, EffectLabel, Sketch};
use crate::pipeline::mapping::profile::{Direction, Gain, Labelled, PointerMode, Profile, Source};

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
    /// What the hand does: `press into the plate, short press`.
    pub hand: String,
    /// What comes of it: `A: jump`.
    pub gives: String,
    /// With which forces and times: `press force 2 N, let-go force 1.4 N`.
    pub numbers: String,
}

/// A setting with its number and unit: `press force 2 N`.
fn said(place: &str, value: f64) -> String {
    format!("{} {}", settings::word(place), amount(place, value))
}

impl Summary {
    /// Of a profile.
    pub fn of(profile: &Profile) -> Self {
        let sketch = Sketch::of(profile);
        let mut does = directions(profile);
        does.extend(moved(profile));
        does.extend(sketch.buttons.iter().flat_map(presses));
        Self { name: profile.name.clone(), output: profile.output.name(), does, hand: hand(profile) }
    }
}

fn directions(profile: &Profile) -> Vec<Part> {
    let Some(dpad) = &profile.dpad else { return Vec::new() };
    let numbers = format!(
        "from {} on, {}, {}",
        amount("dpad.centre_radius_mm", dpad.centre_radius_mm.into()),
        said("dpad.min_force_n", dpad.min_force_n.into()),
        said("dpad.release_force_n", dpad.release_force_n.into())
    );
    let keys = [&dpad.up, &dpad.down, &dpad.left, &dpad.right];
    let is_named = |it: &Direction| profile.labels.of(Labelled::Direction(*it)).is_some();
    if !Direction::ALL.iter().any(is_named) {
        let gives = keys.map(controls::all_of).join(", ");
        return vec![Part { hand: "touch above, below, left, right of the middle".into(), gives, numbers }];
    }
    let one = |(direction, keys): (Direction, _)| {
        let label = profile.labels.of(Labelled::Direction(direction));
        Part {
            hand: format!("touch {}", beside(direction)),
            gives: named::with_label(&controls::all_of(keys), label),
            numbers: if direction == Direction::Up { numbers.clone() } else { "the same".into() },
        }
    };
    Direction::ALL.into_iter().zip(keys).map(one).collect()
}

const fn beside(direction: Direction) -> &'static str {
    match direction {
        Direction::Up => "above the middle",
        Direction::Down => "below the middle",
        Direction::Left => "left of the middle",
        Direction::Right => "right of the middle",
    }
}

/// What follows the finger: pointer, sticks, triggers.
fn moved(profile: &Profile) -> Vec<Part> {
    let pointer = profile.pointer.iter().map(|it| {
        let mode = if it.mode == PointerMode::Relative { "relative" } else { "absolute" };
        Part {
            hand: "touch".into(),
            gives: format!("mouse pointer: {}", values::word("pointer.mode", mode)),
            numbers: said("pointer.min_force_n", it.min_force_n.into()),
        }
    });
    let sticks = profile.sticks.iter().map(|it| {
        let (hand, place) = match it.source {
            Source::Place => ("touch", "stick.full_radius_mm"),
            Source::Shear => ("push sideways", "stick.full_n"),
        };
        let numbers = format!("at its end from {} on", amount(place, it.full.into()));
        Part { hand: hand.into(), gives: named::stick(profile, it.side), numbers }
    });
    let triggers = profile.triggers.iter().map(|it| Part {
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
fn presses(button: &ButtonForces) -> Vec<Part> {
    let place = button.zone.as_ref().map_or_else(String::new, |zone| format!(" in {zone}"));
    let layer = match button.layer.as_deref() {
        None => String::new(),
        Some("base") => ", while no layer is on".into(),
        Some(layer) => format!(", while layer {layer} is on"),
    };
    let forces = [
        Some(said("button.press_n", button.press_n.into())),
        Some(said("button.release_n", button.release_n.into())),
        button.dwell_ms.map(|ms| said("button.dwell_ms", ms as f64)),
    ];
    let forces = forces.into_iter().flatten().collect::<Vec<_>>().join(", ");
    let one = |(index, does): (usize, &EffectLabel)| {
        let own = match does.role {
            "hold" => button.long_press_ms.map(|ms| said("button.long_press_ms", ms as f64)),
            "double" => button.double_press_ms.map(|ms| said("button.double_press_ms", ms as f64)),
            "hard" => button.hard_press_n.map(|n| said("button.hard_press_n", n.into())),
            _ => None,
        };
        let all = [(index == 0).then(|| forces.clone()), own];
        let kind = if does.role == "out" { String::new() } else { format!(", {}", does.role_word) };
        Part {
            hand: format!("{}{place}{kind}{layer}", values::word("button.force", button.force)),
            gives: does.word.clone(),
            numbers: all.into_iter().flatten().collect::<Vec<_>>().join(", "),
        }
    };
    button.does.iter().enumerate().map(one).collect()
}

fn hand(profile: &Profile) -> Vec<(String, String)> {
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
    told.into_iter().map(|(place, value)| (word(place), amount(place, value))).collect()
}
