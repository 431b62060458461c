//! What may be hidden: the causes, and draws of their targets and sizes.

use crate::effects::mechanical::OPEN_SHARE;
use crate::plan::Plan;
use crate::random::Random;
use crate::truth::{CHANNELS, Truth};

/// All causes: those that static contacts show, those that need time, temperature or cycles, those of the electronics.
pub(crate) const CAUSES: [&str; 36] = [
    "channel_gain",
    "channel_offset",
    "noise_excess",
    "channel_dead",
    "channel_polarity",
    "channels_swapped",
    "channel_crosstalk",
    "gauge_nonlinearity",
    "adc_clipping",
    "channel_intermittent",
    "channel_skew",
    "mains_pickup",
    "module_displaced",
    "module_rotated",
    "module_tilted",
    "module_stiffness",
    "module_debonded",
    "module_frame_open",
    "module_crosstalk",
    "plate_stiffness",
    "excitation_gain",
    "thermal_zero",
    "thermal_gain",
    "zero_drift",
    "hysteresis",
    "creep",
    "ageing",
    "reference_tilt",
    "reference_gain",
    "reference_zero",
    "stage_offset",
    "stage_rotation",
    "stage_scale",
    "contact_height",
    "contact_size",
    "time_lag",
];

/// Whether a cause's change of the field comes from elsewhere than the program: see `effects/taken.rs`.
pub(crate) fn independent(effect: &str) -> bool {
    !["module_tilted", "module_debonded"].contains(&effect)
}

/// Which plan shows a cause best: a stream for what goes with seconds, two dwells and two ways for what goes with minutes.
pub(crate) fn best_plan(effect: &str) -> Plan {
    match effect {
        "channel_skew" | "mains_pickup" | "time_lag" => Plan::Stream,
        "hysteresis" | "creep" | "zero_drift" | "thermal_zero" | "thermal_gain" | "ageing" => {
            Plan::Recommended
        }
        _ => Plan::Paper,
    }
}

/// A cause with a drawn target and sign, `times` as large as its own plain size.
pub(crate) fn drawn(effect: &str, times: f64, random: &mut Random) -> Truth {
    let sign = random.sign();
    let size = |plain: f64| sign * times * plain;
    let [target, other] = channels(random);
    let [module, source] = modules(random);
    match effect {
        "channel_gain" => Truth::new(effect, target, &[("gain", 1.0 + size(0.1))]),
        "channel_offset" => Truth::new(effect, target, &[("offset_uv", size(60.0))]),
        "channel_crosstalk" => Truth::new(effect, target, &[("share", size(0.06))]).with(other),
        "gauge_nonlinearity" => Truth::new(effect, target, &[("second_order_percent_fs", size(8.0))]),
        "channel_dead" | "channel_polarity" => Truth::new(effect, target, &[]),
        "channels_swapped" => swapped(random),
        "noise_excess" => Truth::new(effect, target, &[("factor", 1.0 + times * 2.0)]),
        "adc_clipping" => {
            // About one press in twenty of the paper's plan is larger.
            let limit = if target.ends_with('x') {
                1000.0
            } else if target.ends_with('y') {
                2500.0
            } else {
                6400.0
            };
            Truth::new(effect, target, &[("limit_uv", limit / times)])
        }
        "channel_intermittent" => Truth::new(effect, target, &[("gain", 1.0 - (times * 0.15).min(0.9))]),
        "channel_skew" => Truth::new(effect, target, &[("skew_us", size(15_000.0))]),
        "mains_pickup" => mains(random, times),
        "module_displaced" => displaced(random, &module, times),
        "module_rotated" => Truth::new(effect, &module, &[("deg", size(2.5))]),
        "module_tilted" => tilted(random, &module, times),
        "module_stiffness" => Truth::new(effect, &module, &[("factor", size(0.35).exp())]),
        "module_debonded" => Truth::new(effect, &module, &[("area_share", times * 0.2)]).on(side(random)),
        "module_frame_open" => open(random, &module, times),
        "module_crosstalk" => Truth::new(effect, &module, &[("share", size(0.03))]).with(&source),
        _ => whole(effect, sign, times, random),
    }
}

/// Causes in the whole pad, in the contact or in the rig.
fn whole(effect: &str, sign: f64, times: f64, random: &mut Random) -> Truth {
    let size = |plain: f64| sign * times * plain;
    let pad = |name: &str, value: f64| Truth::new(effect, "pad", &[(name, value)]);
    let rig = |name: &str, value: f64| Truth::new(effect, "rig", &[(name, value)]);
    match effect {
        "plate_stiffness" => pad("factor", size(0.3).exp()),
        "excitation_gain" => pad("gain", 1.0 + size(0.06)),
        "thermal_zero" => pad("uv_per_c", size(12.0)),
        "thermal_gain" => pad("per_c", size(0.004)),
        "zero_drift" => pad("uv_per_h", size(60.0)),
        "hysteresis" => pad("share_of_full_scale", times * 0.04),
        "creep" => pad("share_at_20s", times * 0.03),
        "ageing" => pad("share_at_end", times * 0.06),
        "reference_gain" => rig("gain", 1.0 + size(0.06)),
        "reference_tilt" => direction(effect, ["x_deg", "y_deg"], times * 2.0, random),
        "reference_zero" => zero(times * 0.1, random),
        "stage_offset" => direction(effect, ["x_mm", "y_mm"], times * 0.8, random),
        "stage_rotation" => rig("deg", size(2.0)),
        "stage_scale" => rig("scale", 1.0 + size(0.03)),
        "contact_height" => rig("mm", size(0.8)),
        "contact_size" => rig("radius_mm", 1.0 + times * 1.2),
        _ => rig("ms", size(60.0)),
    }
}

/// Two different channels.
fn channels(random: &mut Random) -> [&'static str; 2] {
    let first = random.below(9);
    [CHANNELS[first], CHANNELS[(first + 1 + random.below(8)) % 9]]
}

/// Two different modules.
fn modules(random: &mut Random) -> [String; 2] {
    let first = random.below(3);
    [first, (first + 1 + random.below(2)) % 3].map(|index| format!("module{index}"))
}

fn swapped(random: &mut Random) -> Truth {
    let mut two = channels(random);
    two.sort_unstable();
    Truth::new("channels_swapped", two[0], &[]).with(two[1])
}

fn mains(random: &mut Random, times: f64) -> Truth {
    let grid = [50.0, 60.0][random.below(2)];
    let frequency = grid + random.between(-0.05, 0.05);
    let parameters = [("amplitude_uv", times * 60.0), ("frequency_hz", frequency)];
    Truth::new("mains_pickup", CHANNELS[random.below(9)], &parameters)
}

fn displaced(random: &mut Random, module: &str, times: f64) -> Truth {
    let (sin, cos) = random.between(0.0, 360.0).to_radians().sin_cos();
    let length = times * 0.8;
    Truth::new("module_displaced", module, &[("radial_mm", length * cos), ("tangential_mm", length * sin)])
}

fn tilted(random: &mut Random, module: &str, times: f64) -> Truth {
    let (sin, cos) = random.between(0.0, 360.0).to_radians().sin_cos();
    let angle = times * 2.0;
    Truth::new("module_tilted", module, &[("tangential_deg", angle * cos), ("radial_deg", angle * sin)])
}

fn side(random: &mut Random) -> &'static str {
    ["+x", "-x", "+y", "-y"][random.below(4)]
}

/// The tables have a frame that is open along its tangent.
fn open(random: &mut Random, module: &str, times: f64) -> Truth {
    let share = OPEN_SHARE * times.min(1.0);
    Truth::new("module_frame_open", module, &[("area_share", share)]).on(["+x", "-x"][random.below(2)])
}

fn direction(effect: &str, names: [&str; 2], length: f64, random: &mut Random) -> Truth {
    let (sin, cos) = random.between(0.0, 360.0).to_radians().sin_cos();
    Truth::new(effect, "rig", &[(names[0], length * cos), (names[1], length * sin)])
}

fn zero(length: f64, random: &mut Random) -> Truth {
    let along = [random.normal(), random.normal(), random.normal()];
    let norm = along.iter().map(|part| part * part).sum::<f64>().sqrt();
    let [x, y, z] = along.map(|part| length * part / norm);
    Truth::new("reference_zero", "rig", &[("fx_n", x), ("fy_n", y), ("fz_n", z)])
}

/// A parameter where nothing is wrong.
fn neutral(effect: &str, name: &str) -> f64 {
    match name {
        "gain" | "scale" | "factor" => 1.0,
        // The nominal contact's.
        "radius_mm" if effect == "contact_size" => 1.0,
        _ => 0.0,
    }
}

/// How far a size is from nothing, and back. Stiffnesses go by their logarithm.
fn deviation(effect: &str, name: &str, value: f64) -> f64 {
    if name == "factor" && effect != "noise_excess" { value.ln() } else { value - neutral(effect, name) }
}

fn from_deviation(effect: &str, name: &str, deviation: f64) -> f64 {
    if name == "factor" && effect != "noise_excess" {
        deviation.exp()
    } else {
        neutral(effect, name) + deviation
    }
}

/// What the generator can make at most, as a deviation: how far tables and formulas hold.
fn largest(effect: &str, name: &str) -> f64 {
    match (effect, name) {
        ("module_frame_open", "area_share") => OPEN_SHARE,
        ("module_debonded", "area_share") => 0.8,
        ("module_displaced", _) => 1.6,
        ("module_rotated", _) => 8.0,
        ("module_tilted", _) => 9.0,
        ("module_stiffness", _) => 0.9,
        ("plate_stiffness", _) => 0.45,
        ("contact_size", _) => 2.0,
        ("channel_gain" | "channel_intermittent" | "excitation_gain" | "reference_gain", _) => 0.9,
        (_, "share" | "share_of_full_scale" | "share_at_20s" | "share_at_end") => 0.5,
        ("stage_offset", _) => 1.5,
        ("stage_scale", _) => 0.05,
        ("channel_skew", _) => 50_000.0,
        _ => f64::INFINITY,
    }
}

/// The same cause with a size of so many minimum detectable effects; none, if it has no size or would be larger than the
/// generator can make it.
///
/// A minimum detectable effect is stated as a deviation from what is nominal, `0.03` for a gain of 1.03. Of several
/// parameters each has its own, and the size is the root of the sum of their squares.
pub(crate) fn scaled(truth: &Truth, times: f64, minimum: &dyn Fn(&str) -> Option<f64>) -> Option<Truth> {
    let effect = truth.effect.as_str();
    let mut squares = 0.0;
    for (name, value) in truth.parameters.iter().filter(|(name, _)| name != "frequency_hz") {
        let least = minimum(name).filter(|least| *least > 0.0)?;
        let least = deviation(effect, name, from_size(effect, name, least));
        squares += (deviation(effect, name, *value) / least).powi(2);
    }
    let share = times / squares.sqrt();
    let mut made = truth.clone();
    for (name, value) in made.parameters.iter_mut().filter(|(name, _)| name != "frequency_hz") {
        let deviation = share * deviation(effect, name, *value);
        if !deviation.is_finite() || deviation.abs() > largest(effect, name) {
            return None;
        }
        *value = from_deviation(effect, name, deviation);
    }
    Some(made)
}

/// A parameter that is this much too large.
fn from_size(effect: &str, name: &str, size: f64) -> f64 {
    neutral(effect, name) + size
}
