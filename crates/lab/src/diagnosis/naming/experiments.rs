//! The further measurements that may tell confounded causes apart.
//!
//! Each is a set of rows that nobody measured yet, what changes in how causes act on them, and what it costs. Or it is a dimension that
//! is measured by hand: that tells of a cause's numbers directly.

use crate::effect::Effect;
use tactpad_core::pad::weight::weight_n;
use tactpad_core::quantity::WEIGHT_N_PER_G;
use tactpad_inference::observations::{Observations, Sample};
use tactpad_numeric::statistics::rms;

/// Seconds that a contact takes, to reach and to hold; the rows to repeat are those of one location in so many, and no more than this.
const CONTACT_S: f64 = 6.0;
const ONE_IN: usize = 3;
const CONTACTS_MAX: usize = 216;
/// How many weights are placed, and what that takes for each.
const WEIGHTS: usize = 12;
const WEIGHT_MIN: f64 = 1.0;
/// Weights come in steps of so many grams.
const WEIGHT_STEP_G: f64 = 50.0;
/// Samples of the untouched pad, over so many minutes.
const UNTOUCHED: usize = 60;
const UNTOUCHED_MIN: f64 = 60.0;
/// What it takes to clamp a pad anew, to change a cap or an indenter and to measure it, to warm a pad and to let it cool.
const CLAMP_MIN: f64 = 15.0;
const CLAMPED_DEG: f64 = 120.0;
const CHANGE_MIN: f64 = 10.0;
const WARM_MIN: f64 = 60.0;
/// How long contacts are held where that is asked for.
const LONG_S: f64 = 20.0;
const SHORT_S: f64 = 2.0;
/// How far a pad is warmed and cooled about the mean temperature.
const WARMED_C: f64 = 8.0;
/// What it takes to measure a dimension by hand.
const BY_HAND_MIN: f64 = 20.0;

/// A further measurement.
pub(crate) struct Experiment {
    /// What to do.
    pub(crate) what: String,
    /// Why that tells causes apart.
    pub(crate) why: &'static str,
    /// What it takes, in minutes.
    pub(crate) minutes: f64,
    /// The rows that it gives.
    pub(crate) rows: Observations,
    /// Whether nothing touches the pad.
    pub(crate) is_untouched: bool,
    /// The cause that does not act on these rows.
    pub(crate) silent: Option<Effect>,
    /// Causes whose numbers it tells, and with which standard deviation.
    pub(crate) by_hand: Option<(Effect, f64)>,
}

impl Experiment {
    /// Whether it is rows of a plan that are measured together with others: not what a hand does, nor another cap or tip, of which no column
    /// tells, nor hours of an untouched pad, whose friction keeps another zero than loads come from.
    pub(crate) const fn is_in_a_plan(&self) -> bool {
        self.silent.is_none() && self.by_hand.is_none() && !self.is_untouched
    }
}

/// The catalogue for a measurement of `rows`, the cheapest first.
pub(crate) fn catalogue(rows: &Observations) -> Vec<Experiment> {
    let repeated = repeated(rows);
    let mut all = again(rows, &repeated);
    all.extend(without_reference(rows, &repeated));
    all.extend(BY_HAND.map(|(effect, deviation, what, why)| Experiment {
        by_hand: Some((effect, deviation)),
        ..plain(rows, what.to_owned(), why, BY_HAND_MIN, Vec::new())
    }));
    all.sort_by(|one, other| one.minutes.total_cmp(&other.minutes));
    all
}

/// Rows on which all causes act as they did.
fn plain(
    like: &Observations,
    what: String,
    why: &'static str,
    minutes: f64,
    samples: Vec<Sample>,
) -> Experiment {
    let rows = unread(like, samples);
    Experiment { what, why, minutes, rows, is_untouched: false, silent: None, by_hand: None }
}

/// The same contacts again, with something changed.
fn again(rows: &Observations, repeated: &[Sample]) -> Vec<Experiment> {
    let count = repeated.len();
    let minutes = count as f64 * CONTACT_S / 60.0;
    let of = |what: String, why, more_min: f64| plain(rows, what, why, more_min + minutes, repeated.to_vec());
    let clamped = format!(
        "clamp the pad turned by {CLAMPED_DEG} degrees, repeat {count} contacts and write so under turned_deg"
    );
    let why = "what is wrong with the rig stays with the rig, what is wrong with the pad turns with it";
    let turned = plain(rows, clamped, why, CLAMP_MIN + minutes, clamped_anew(repeated));
    let cap = of(
        format!("repeat {count} contacts with a cap of another height, which is measured"),
        "only the old cap's height is in doubt",
        CHANGE_MIN,
    );
    let indenter = of(
        format!("repeat {count} contacts with another indenter, whose tip is measured"),
        "only the old tip is in doubt",
        CHANGE_MIN,
    );
    let dwells = format!(
        "repeat {count} contacts and hold every second one for {LONG_S} s, and write so under dwell_s"
    );
    let above =
        format!("repeat {count} contacts, every second one from a higher load, and write so under approach");
    let random =
        format!("repeat {count} contacts while the pad is warmed and cools again, in a random order");
    let why = "time and cycles then no longer go with temperature";
    vec![
        of(format!("repeat {count} of the contacts"), "another draw of the noise is all that it takes", 0.0),
        turned,
        Experiment { silent: Some(Effect::ContactHeight), ..cap },
        Experiment { silent: Some(Effect::ContactSize), ..indenter },
        plain(
            rows,
            dwells,
            "a gain does not know how long",
            LONG_S / 120.0 * count as f64 + minutes,
            held(repeated),
        ),
        plain(rows, above, "only what keeps a load differs", minutes, from_above(repeated)),
        plain(rows, random, why, WARM_MIN + minutes, warmed(repeated)),
    ]
}

/// What needs no force sensor.
fn without_reference(rows: &Observations, repeated: &[Sample]) -> [Experiment; 2] {
    let weight_g = weight_g(repeated);
    let placed = plain(
        rows,
        format!(
            "place a known weight of {weight_g:.0} g at {WEIGHTS} of the places, and write so under weight_g"
        ),
        "it needs no force sensor, so what is wrong with the pad still shows, and what is wrong with the sensor does not",
        WEIGHT_MIN * WEIGHTS as f64,
        weights(repeated, weight_g),
    );
    let why = "no force sensor and no place has a part in that";
    let what = "record the untouched pad for an hour, with 0 under weight_g".to_owned();
    let rested = plain(rows, what, why, UNTOUCHED_MIN, untouched(repeated));
    [placed, Experiment { is_untouched: true, ..rested }]
}

/// Dimensions that are measured by hand, with the standard deviation of that: 0.1 mm at the modules' edges, half a degree along an edge
/// of 8 mm, a fifth of one along a mark over the plate, 0.1 mm over 40 mm of the stage's way, and a resistor of 0.1 % beside an arm of a
/// bridge that is known to 0.5 %.
const BY_HAND: [(Effect, f64, &str, &str); 5] = [
    (
        Effect::ModuleDisplaced,
        0.1,
        "measure the modules' places with a caliper",
        "the rig has no part in that",
    ),
    (Effect::ModuleRotated, 0.5, "measure how the modules are turned", "the rig has no part in that"),
    (
        Effect::StageRotation,
        0.2,
        "put a mark on pad and stage and take the angle between them",
        "the pad's channels have no part in that",
    ),
    (
        Effect::ExcitationGain,
        0.005,
        "shunt an arm of one bridge with a known resistor",
        "its step is that of supply and converter alone: neither strain nor force sensor has a part in it",
    ),
    (Effect::StageScale, 0.0025, "measure the stage's way with a caliper", "the pad has no part in that"),
];

/// The contacts to repeat: static ones of one location in three, else rows of series.
fn repeated(rows: &Observations) -> Vec<Sample> {
    let clusters = rows.clusters();
    let picked = |is_static: bool| -> Vec<Sample> {
        let own = rows.samples.iter().zip(&clusters);
        let own = own.filter(|(it, cluster)| **cluster % ONE_IN == 0 && it.trial.is_none() == is_static);
        own.filter(|(it, _)| it.load != [0.0; 3]).map(|(it, _)| Sample { trial: None, ..*it }).collect()
    };
    let mut samples = picked(true);
    if samples.is_empty() {
        samples = picked(false);
    }
    let step = samples.len().div_ceil(CONTACTS_MAX).max(1);
    let mut samples: Vec<Sample> = samples.into_iter().step_by(step).collect();
    // They come after all that was measured, in the circumstances of the end.
    let last = rows
        .samples
        .iter()
        .max_by(|one, other| one.t_s.unwrap_or_default().total_cmp(&other.t_s.unwrap_or_default()));
    let Some(last) = last.copied() else { return samples };
    let cycle = rows.samples.iter().filter_map(|it| it.cycle).reduce(f64::max);
    for (at, sample) in (1..).zip(&mut samples) {
        sample.t_s = sample.t_s.and(last.t_s).map(|t_s| t_s + CONTACT_S * f64::from(at));
        (sample.temp_c, sample.cycle) = (sample.temp_c.and(last.temp_c), sample.cycle.and(cycle));
    }
    samples
}

/// A weight as heavy as the usual load.
fn weight_g(samples: &[Sample]) -> f64 {
    let usual_n = rms(samples.iter().map(|it| it.load[2]));
    (usual_n / WEIGHT_N_PER_G / WEIGHT_STEP_G).round().max(1.0) * WEIGHT_STEP_G
}

fn weights(samples: &[Sample], weight_g: f64) -> Vec<Sample> {
    let step = (samples.len() / WEIGHTS).max(1);
    let placed = samples.iter().step_by(step).take(WEIGHTS);
    let load = [0.0, 0.0, weight_n(weight_g)];
    placed.map(|it| Sample { load, is_weight: true, is_unloading: false, ..*it }).collect()
}

fn untouched(samples: &[Sample]) -> Vec<Sample> {
    let Some(first) = samples.first() else { return Vec::new() };
    let after_s = |at: usize| 60.0 * UNTOUCHED_MIN * at as f64 / UNTOUCHED as f64;
    let at = |at: usize| {
        let t_s = first.t_s.map(|t_s| t_s + after_s(at));
        Sample { load: [0.0; 3], is_weight: true, is_unloading: false, place_mm: [0.0; 2], t_s, ..*first }
    };
    (0..UNTOUCHED).map(at).collect()
}

/// Every second one is held for longer.
fn held(samples: &[Sample]) -> Vec<Sample> {
    let at = |(at, it): (usize, &Sample)| {
        let dwell_s = if at % 2 == 0 { LONG_S } else { it.dwell_s.unwrap_or(SHORT_S).min(SHORT_S) };
        Sample { dwell_s: Some(dwell_s), ..*it }
    };
    samples.iter().enumerate().map(at).collect()
}

/// Every second one comes from above.
fn from_above(samples: &[Sample]) -> Vec<Sample> {
    samples.iter().enumerate().map(|(at, it)| Sample { is_unloading: at % 2 == 0, ..*it }).collect()
}

/// On a pad that is turned on the stage, against how it was.
fn clamped_anew(samples: &[Sample]) -> Vec<Sample> {
    samples.iter().map(|it| Sample { turned_deg: it.turned_deg + CLAMPED_DEG, ..*it }).collect()
}

/// Up, down and back again, which the order in time knows nothing of.
fn warmed(samples: &[Sample]) -> Vec<Sample> {
    let at = |(at, it): (usize, &Sample)| {
        // A golden sequence is spread evenly, and goes with nothing.
        let share = (at as f64 * 0.618_034).fract();
        let temp_c = it.temp_c.map(|temp_c| temp_c + WARMED_C * (2.0 * share - 1.0));
        Sample { temp_c, ..*it }
    };
    samples.iter().enumerate().map(at).collect()
}

/// Rows that nobody read.
fn unread(like: &Observations, samples: Vec<Sample>) -> Observations {
    let channels = like.channels.len();
    Observations {
        channels: like.channels.clone(),
        readings: vec![vec![0.0; samples.len()]; channels],
        is_told: vec![vec![true; samples.len()]; channels],
        numbers: (0..samples.len()).collect(),
        samples,
    }
}
