//! The numbers of a profile that are fitted, and the values that are tried.

use std::collections::BTreeMap;

use tactpad_core::pipeline::contact::touch;
use tactpad_core::pipeline::mapping::profile::{Action, Button, ButtonPlace, Dpad, DpadMode, Force, Profile};
use tactpad_core::toml_text::edit::{self, Edit, Table, Value};

/// A number's place in the profile.
pub type Key = (Table, &'static str);

/// What numbers say instead of what is written.
pub type Settings = BTreeMap<Key, f64>;

/// How values follow each other.
#[derive(Clone, Copy, Debug)]
enum Steps {
    /// Each so much more than the one before, from one to another.
    Even(f64, f64, f64),
    /// Each this part more than the one before, from one share of the present value to another.
    Growing(f64, f64, f64),
}

/// A number and the values that it could have.
#[derive(Clone, Debug)]
pub struct Knob {
    /// Where it stands.
    pub key: Key,
    /// What it is; for one that is not there and means nothing then, what comes first.
    pub present: Option<f64>,
    /// In order. `None` is the present state of what is not there.
    pub values: Vec<Option<f64>>,
    /// Another number that is written and keeps its share of this one.
    partner: Option<(&'static str, f64)>,
}

impl Knob {
    /// The settings with another value of this number.
    pub fn turned(&self, settings: &Settings, value: Option<f64>) -> Settings {
        let mut turned = settings.clone();
        if value == self.value(settings) {
            return turned;
        }
        let (table, key) = self.key;
        let partner = self.partner.map(|(name, present)| {
            let share = settings.get(&(table, name)).copied().unwrap_or(present)
                / settings.get(&self.key).copied().or(self.present).unwrap_or(1.0);
            (name, share)
        });
        match value {
            Some(value) if Some(value) != self.present => turned.insert((table, key), value),
            _ => turned.remove(&self.key),
        };
        if let Some((name, share)) = partner {
            if value == self.present {
                turned.remove(&(table, name));
            } else {
                turned.insert((table, name), rounded(name, share * value.unwrap_or_default()));
            }
        }
        turned
    }

    /// What it is with these settings.
    pub fn value(&self, settings: &Settings) -> Option<f64> {
        settings.get(&self.key).copied().or(self.present)
    }
}

/// The changes of the text that settings mean.
pub fn edits(settings: &Settings) -> Vec<Edit> {
    let edit = |(&(table, key), &value): (&Key, &f64)| Edit {
        table,
        key,
        value: Some(if key.ends_with("_ms") {
            Value::Whole(value.round() as i64)
        } else {
            Value::Real(value)
        }),
    };
    settings.iter().map(edit).collect()
}

/// To what people would write: whole milliseconds in tens, forces and places to a hundredth and a tenth.
pub fn rounded(key: &str, value: f64) -> f64 {
    match key.rsplit('_').next() {
        Some("ms") => 10.0 * (value / 10.0).round(),
        Some("n") => (100.0 * value).round() / 100.0,
        Some("deg") => value.round(),
        _ => (10.0 * value).round() / 10.0,
    }
}

/// Less normal force is no touch.
const TOUCH_N: f64 = touch::ON_N as f64;

/// A force is tried from a twentieth of what it is up to four times that.
const FORCE: Steps = Steps::Growing(0.05, 4.0, 1.12);
/// A time from a quarter up to four times.
const TIME: Steps = Steps::Growing(0.25, 4.0, 1.15);
const RADIUS: Steps = Steps::Even(2.0, 29.0, 0.5);
const SLACK: Steps = Steps::Even(0.0, 8.0, 0.5);
const ARC: Steps = Steps::Even(0.0, 5.0, 0.5);
const DIAGONAL: Steps = Steps::Even(5.0, 85.0, 5.0);
/// Calmer and calmer.
const TREMOR_HZ: [f64; 9] = [6.0, 4.5, 3.5, 2.5, 2.0, 1.6, 1.3, 1.0, 0.8];
const SLOW: Steps = Steps::Even(0.0, 400.0, 20.0);
const BOUNCE: Steps = Steps::Even(0.0, 400.0, 40.0);

/// All numbers of a profile that can be fitted, in the order in which they are.
pub fn all(profile: &Profile, text: &str) -> Vec<Knob> {
    let mut knobs = Vec::new();
    let mut add = |key: Key, present: f32, steps: Steps, partner: Option<(&'static str, f32)>| {
        // What is not written follows by itself.
        let partner = partner.filter(|(name, _)| edit::written(text, key.0, name).is_some());
        let partner = partner.map(|(name, value)| (name, f64::from(value)));
        knobs.push(knob(key, shortest(present), steps, partner));
    };
    for (number, button) in profile.buttons.iter().enumerate() {
        button_forces(Table::Listed("button", number), button, &mut add);
    }
    if let Some(dpad) = &profile.dpad {
        directions(dpad, &mut add);
    }
    zones(profile, &mut add);
    for (number, button) in profile.buttons.iter().enumerate() {
        button_times(Table::Listed("button", number), button, &mut add);
    }
    let access = Table::Named("access");
    let tremor = profile.access.tremor.map(|tremor| shortest(tremor.cutoff_hz));
    knobs.push(knob_of((access, "tremor_hz"), tremor, TREMOR_HZ.to_vec()));
    for (key, us, steps) in
        [("slow_ms", profile.access.slow_us, SLOW), ("bounce_ms", profile.access.bounce_us, BOUNCE)]
    {
        knobs.push(knob((access, key), us as f64 * 1e-3, steps, None));
    }
    knobs.retain_mut(|knob| {
        let presses =
            knob.key.1 == "min_force_n" || knob.key.1 == "press_n" && is_normal(profile, knob.key.0);
        knob.values.retain(|value| !presses || *value == knob.present || value.is_some_and(|n| n >= TOUCH_N));
        knob.values.len() > 1
    });
    knobs
}

/// Whether it is a button of the normal force.
fn is_normal(profile: &Profile, table: Table) -> bool {
    let Table::Listed(_, number) = table else { return false };
    profile.buttons.get(number).is_some_and(|button| button.force == Force::Fz)
}

type Add<'a> = dyn FnMut(Key, f32, Steps, Option<(&'static str, f32)>) + 'a;

fn directions(dpad: &Dpad, add: &mut Add<'_>) {
    let table = Table::Named("dpad");
    add((table, "min_force_n"), dpad.min_force_n, FORCE, Some(("release_force_n", dpad.release_force_n)));
    add((table, "centre_radius_mm"), dpad.centre_radius_mm, RADIUS, None);
    add((table, "radius_hysteresis_mm"), dpad.radius_hysteresis_mm, SLACK, None);
    // There the diagonals are the hysteresis, and here there are none.
    if dpad.mode != DpadMode::FourWaySticky {
        add((table, "hysteresis_mm"), dpad.hysteresis_mm, ARC, None);
    }
    if dpad.mode != DpadMode::FourWay {
        add((table, "diagonal_deg"), dpad.diagonal_deg, DIAGONAL, None);
    }
}

fn button_forces(table: Table, button: &Button, add: &mut Add<'_>) {
    add((table, "press_n"), button.press_n, FORCE, Some(("release_n", button.release_n)));
    add((table, "release_n"), button.release_n, FORCE, None);
    if let Action::ByForce { hard_press_n, hard_release_n, .. } = button.action {
        add((table, "hard_press_n"), hard_press_n, FORCE, Some(("hard_release_n", hard_release_n)));
    }
}

fn button_times(table: Table, button: &Button, add: &mut Add<'_>) {
    let ms = |us: u64| us as f32 * 1e-3;
    if let Action::ByTime { double, hold, .. } = button.action {
        if let Some(hold) = hold {
            add((table, "long_press_ms"), ms(hold.us), TIME, None);
        }
        if let Some(double) = double {
            add((table, "double_press_ms"), ms(double.us), TIME, None);
        }
    }
    if let Some(dwell) = button.dwell {
        add((table, "dwell_ms"), ms(dwell.us), TIME, None);
        add((table, "dwell_mm"), dwell.radius_mm, Steps::Even(0.5, 15.0, 0.5), None);
    }
}

/// Rings that buttons ask for.
fn zones(profile: &Profile, add: &mut Add<'_>) {
    let is_used =
        |number: usize| profile.buttons.iter().any(|button| button.place == Some(ButtonPlace::Zone(number)));
    for (number, zone) in profile.zones.iter().enumerate().filter(|(number, _)| is_used(*number)) {
        let table = Table::Listed("zone", number);
        let edges = [("inner_radius_mm", zone.inner_radius_mm), ("outer_radius_mm", zone.outer_radius_mm)];
        // The middle and the rim are no edges.
        let edges: Vec<_> = edges.into_iter().filter(|(_, mm)| (1.0..30.0).contains(mm)).collect();
        for (key, radius_mm) in &edges {
            add((table, key), *radius_mm, RADIUS, None);
        }
        if !edges.is_empty() {
            add((table, "radius_hysteresis_mm"), zone.radius_hysteresis_mm, SLACK, None);
        }
    }
}

fn knob(key: Key, present: f64, steps: Steps, partner: Option<(&'static str, f64)>) -> Knob {
    let mut values = Vec::new();
    match steps {
        Steps::Even(low, high, step) => {
            // From the present value on, so that it is among them.
            let first = present - step * ((present - low) / step).floor().max(0.0);
            let count = ((high - first) / step).floor().max(0.0) as usize;
            values.extend((0..=count).map(|k| first + step * k as f64));
        }
        Steps::Growing(low, high, ratio) => {
            let [down, up] = [(1.0 / low).ln(), high.ln()].map(|way| (way / ratio.ln()).floor() as i32);
            values.extend((-down..=up).map(|k| present * ratio.powi(k)));
        }
    }
    Knob { partner, ..knob_of(key, Some(present), values) }
}

/// A number with these values, and its present one where it belongs.
fn knob_of(key: Key, present: Option<f64>, values: Vec<f64>) -> Knob {
    let mut values: Vec<f64> = values.into_iter().map(|value| rounded(key.1, value)).collect();
    let falls = matches!(values[..], [first, .., last] if first > last);
    if let Some(present) = present {
        // It stands for those that rounding brings near to it.
        values.retain(|value| (value - present).abs() > 1e-3 * present.abs());
        values.push(present);
    }
    values.sort_by(f64::total_cmp);
    values.dedup();
    if falls {
        values.reverse();
    }
    let absent = present.is_none().then_some(None);
    Knob {
        key,
        present,
        values: absent.into_iter().chain(values.into_iter().map(Some)).collect(),
        partner: None,
    }
}

/// The number as people wrote it: 0.3 and not what is nearest to it in single precision.
pub(super) fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| f64::from(value))
}
