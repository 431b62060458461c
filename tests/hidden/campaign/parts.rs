//! The parts of the campaign, each a list of runs.

use std::fs;
use std::ops::RangeInclusive;
use std::time::Instant;

use serde_json::{Value, json};

use super::Length;
use super::lines::Lines;
use crate::case::Case;
use crate::measured::{Columns, Quality};
use crate::plan::Plan;
use crate::precision::least_widths;
use crate::program::{diagnosed, folder};
use crate::random::Random;
use crate::score::{Found, Score, minimum_detectable, rival_share, widths};
use crate::sizes::{CAUSES, drawn, independent, scaled};
use crate::truth::{CHANNELS, Truth};

/// One run.
pub(super) struct Job {
    pub(super) key: String,
    pub(super) part: &'static str,
    pub(super) plan: Plan,
    pub(super) effect: &'static str,
    pub(super) run: Box<dyn Fn(&Lines) -> Value + Send + Sync>,
}

/// A part, and its runs.
pub(super) struct Part {
    pub(super) name: &'static str,
    pub(super) jobs: fn(Length) -> Vec<Job>,
}

pub(super) const ALL: [Part; 8] = [
    Part { name: "least", jobs: least },
    Part { name: "nulls", jobs: nulls },
    Part { name: "sizes", jobs: sizes },
    Part { name: "struck", jobs: struck },
    Part { name: "several", jobs: several },
    Part { name: "second", jobs: second },
    Part { name: "pads", jobs: pads },
    Part { name: "sharp", jobs: sharp },
];

const COLUMNS: [Columns; 3] = [
    Columns { temp_c: false, cycle: false },
    Columns { temp_c: true, cycle: false },
    Columns { temp_c: false, cycle: true },
];

/// The seeds of plan, background and noise that a table and the one without its fault have in common.
fn quiet(plan: Plan, seed: u64, columns: Columns) -> Case {
    let kind = COLUMNS.iter().position(|known| *known == columns).unwrap_or_default();
    let key = format!("least-{}-{seed}-{kind}", plan.name());
    Case { columns, ..Case::new(&key, seed, plan, Vec::new()) }
}

/// A run's line: what was hidden, what was found, and how long it took.
fn line(case: &Case, more: &[&str]) -> Value {
    #[expect(clippy::disallowed_methods, reason = "how long a diagnosis takes is one of the gates")]
    let start = Instant::now();
    let result = case.diagnosed(more);
    let mut line = case.truth();
    line["seconds"] = json!(start.elapsed().as_secs_f64());
    line["independent"] = json!(case.truths.iter().all(|truth| independent(&truth.effect)));
    match result {
        Ok(diagnosis) => {
            line["score"] = Score::of(&diagnosis, &case.truths).json();
            line["not_testable"] = diagnosis["not_testable"].clone();
            line["ceiling_share"] = diagnosis["ceiling_share"].clone();
            line["ratio"] = json!(
                ["rmse_ratio", "rmse_ratio_low95", "rmse_ratio_high95"]
                    .map(|key| diagnosis["gain"][key].clone())
            );
            line["relative_widths"] = json!(relative_widths(case, &diagnosis));
            if case.truths.is_empty() {
                line["not_detected"] = diagnosis["not_detected"].clone();
            }
        }
        Err(said) => line["refused"] = json!(said),
    }
    line
}

/// The widths of a named cause's intervals over the least that they can be; on the paper's plan, whose noise has no memory.
fn relative_widths(case: &Case, diagnosis: &Value) -> Option<Vec<f64>> {
    let [truth] = case.truths.as_slice() else { return None };
    let stated = widths(diagnosis, truth).filter(|_| case.plan == Plan::Paper)?;
    // Where a row has no slope, as at a converter's end, there is no such limit.
    let known = stated.into_iter().zip(least_widths(case)).filter(|(_, least)| least.is_normal());
    Some(known.map(|(stated, least)| stated / least).collect())
}

/// Tables without a fault, for the sizes of the others.
fn least(length: Length) -> Vec<Job> {
    let mut jobs = Vec::new();
    for seed in length.seeds(length.seeds) {
        for (plan, columns) in Plan::BOTH.into_iter().flat_map(|plan| COLUMNS.map(|columns| (plan, columns)))
        {
            let case = quiet(plan, seed, columns);
            let key = case.key.clone();
            jobs.push(Job { key, part: "least", plan, effect: "", run: Box::new(move |_| line(&case, &[])) });
        }
    }
    jobs
}

fn nulls(length: Length) -> Vec<Job> {
    let job = |seed: u64| {
        let plan = Plan::BOTH[seed as usize % 2];
        let key = format!("null-{seed}");
        let case = Case::new(&key, 10_000 * length.first + seed, plan, Vec::new());
        Job { key, part: "nulls", plan, effect: "", run: Box::new(move |_| line(&case, &[])) }
    };
    (1..=length.nulls).map(job).collect()
}

/// A cause of so many minimum detectable effects: its case, and how much of it its nearest rival reproduces. None where it
/// has no size in this plan.
fn sized(effect: &str, times: f64, plan: Plan, seed: u64, lines: &Lines) -> Option<(Case, Value)> {
    let truth = drawn(effect, 1.0, &mut Random::new(seed, &format!("{effect} {}", plan.name())));
    let columns = Columns::of(std::slice::from_ref(&truth));
    let without = quiet(plan, seed, columns);
    let known = lines.get(&without.key)?;
    let rival = rival_share(&known, &truth);
    let made = scaled(&truth, times, &|name| minimum_detectable(&known, &truth, name));
    // What a channel either has or has not got has no size.
    let made = if truth.parameters.is_empty() { Some(truth) } else { made };
    let key = format!("{}-{effect}-{seed}-{times}", plan.name());
    Some((Case { quality: without.quality, ..Case::new(&key, seed, plan, vec![made?]) }, json!(rival)))
}

fn all_causes(
    part: &'static str,
    seeds: RangeInclusive<u64>,
    times: &[f64],
    run: fn(Case, &'static str) -> Value,
) -> Vec<Job> {
    let mut jobs = Vec::new();
    for seed in seeds {
        for plan in Plan::BOTH {
            for (effect, times) in
                CAUSES.iter().flat_map(|effect| times.iter().map(move |times| (*effect, *times)))
            {
                let key = format!("{part}-{}-{effect}-{seed}-{times}", plan.name());
                let one = move |lines: &Lines| {
                    let Some((case, rival)) = sized(effect, times, plan, seed, lines) else {
                        return json!({"no_size": true, "times": times});
                    };
                    let mut line = run(case, effect);
                    line["times"] = json!(times);
                    line["rival_share"] = rival;
                    line
                };
                jobs.push(Job { key, part, plan, effect, run: Box::new(one) });
            }
        }
    }
    jobs
}

fn sizes(length: Length) -> Vec<Job> {
    all_causes("sizes", length.seeds(length.seeds), &[1.0, 3.0], |case, _| line(&case, &[]))
}

/// With the hidden cause struck from the catalogue: the program must not name another in its place.
fn struck(length: Length) -> Vec<Job> {
    all_causes("struck", length.seeds(length.seeds.min(2)), &[3.0], |case, effect| {
        line(&case, &["--without", effect])
    })
}

/// So many tables of a seed have several causes at once.
const TABLES_OF_SEVERAL: u64 = 20;
/// Causes of the catalogue that any plan shows by contacts alone, that come in sizes, and whose change of the field does not come from the
/// program.
const OF_CONTACTS: [&str; 20] = [
    "channel_gain",
    "channel_offset",
    "channel_crosstalk",
    "gauge_nonlinearity",
    "module_displaced",
    "module_rotated",
    "module_stiffness",
    "module_frame_open",
    "module_crosstalk",
    "plate_stiffness",
    "excitation_gain",
    "zero_drift",
    "hysteresis",
    "creep",
    "reference_tilt",
    "reference_gain",
    "reference_zero",
    "stage_offset",
    "stage_rotation",
    "stage_scale",
];

/// Two to five different causes at once, each of three minimum detectable effects.
fn several(length: Length) -> Vec<Job> {
    let job = |seed: u64, number: u64| {
        let plan = Plan::BOTH[number as usize % 2];
        let key = format!("several-{}-{seed}-{number}", plan.name());
        let name = key.clone();
        let run = move |lines: &Lines| {
            let random = &mut Random::new(seed, &name);
            let count = 2 + random.below(4);
            let mut effects = OF_CONTACTS.to_vec();
            let mut truths = Vec::new();
            let without = quiet(plan, seed, Columns::default());
            let Some(known) = lines.get(&without.key) else { return json!({"no_size": true}) };
            while truths.len() < count && !effects.is_empty() {
                let effect = effects.swap_remove(random.below(effects.len()));
                let truth = drawn(effect, 1.0, random);
                truths.extend(scaled(&truth, 3.0, &|name| minimum_detectable(&known, &truth, name)));
            }
            line(&Case { quality: without.quality, ..Case::new(&name, seed, plan, truths) }, &[])
        };
        Job { key, part: "several", plan, effect: "", run: Box::new(run) }
    };
    let tables = |seed: u64| (0..TABLES_OF_SEVERAL).map(move |number| job(seed, number));
    length.seeds(length.seeds).flat_map(tables).collect()
}

/// The extended pad on another recording, by the other plan.
fn second(length: Length) -> Vec<Job> {
    all_causes("second", length.seeds(length.seeds.min(2)), &[3.0], |case, effect| {
        let saved = folder("saved").join(format!("{}.toml", case.key));
        let mut line = line(&case, &["--save-device", saved.to_str().unwrap_or_default()]);
        if !NOT_IN_DEVICE.contains(&effect) {
            line["error_ratio"] = json!(error_ratio(&case, &saved));
        }
        line
    })
}

/// What a device file does not hold, as the program says when it saves one.
const NOT_IN_DEVICE: [&str; 8] = [
    "channel_dead",
    "channel_polarity",
    "channels_swapped",
    "gauge_nonlinearity",
    "adc_clipping",
    "mains_pickup",
    "noise_excess",
    "contact_height",
];

/// The channels' error with the saved device, over that with the nominal one.
fn error_ratio(case: &Case, saved: &std::path::Path) -> Option<f64> {
    let plan = if case.plan == Plan::Paper { Plan::Recommended } else { Plan::Paper };
    let file = Case { plan, ..case.clone() }.written(1);
    let error = |more: &[&str]| diagnosed(&file, more).ok()?["rmse_uv"]["nominal"].as_f64();
    let ratio = error(&["--device", saved.to_str()?]).zip(error(&[])).map(|(saved, nominal)| saved / nominal);
    fs::remove_file(file).unwrap();
    ratio
}

/// The five changed pads of the tables as they are, with gains on top.
fn pads(_: Length) -> Vec<Job> {
    let moved = [("radial_mm", -0.7), ("tangential_mm", 0.9)];
    let pads = [
        Truth::new("module_displaced", "module0", &moved),
        Truth::new("module_rotated", "module1", &[("deg", -5.0)]),
        Truth::new("module_stiffness", "module2", &[("factor", 0.6)]),
        Truth::new("module_frame_open", "module0", &[("area_share", crate::effects::mechanical::OPEN_SHARE)])
            .on("-x"),
        Truth::new("plate_stiffness", "pad", &[("factor", 1.15_f64.powi(3))]),
    ];
    let mut jobs = Vec::new();
    for (index, truth) in pads.into_iter().enumerate() {
        for plan in Plan::BOTH {
            let random = &mut Random::new(index as u64, "gains");
            let first = random.below(9);
            let mut gain = |channel: usize| {
                let value = 1.0 + random.sign() * random.between(0.06, 0.12);
                Truth::new("channel_gain", CHANNELS[channel % 9], &[("gain", value)])
            };
            let truths = vec![truth.clone(), gain(first), gain(first + 4)];
            let key = format!("pads-{}-{}", truth.effect, plan.name());
            let case = Case::new(&key, 20_000 + index as u64, plan, truths);
            let run = move |_: &Lines| {
                let diagnosed = case.diagnosed(&[]);
                let mut line = case.truth();
                let Ok(diagnosis) = diagnosed else { return json!({"refused": true}) };
                let score = Score::of(&diagnosis, &case.truths);
                line["set_at_most_2"] = json!(match score.found[0] {
                    Found::Named => true,
                    Found::InSet(size) => size <= 2,
                    Found::Missed => false,
                });
                line["value"] = stated(&diagnosis, &case.truths[0]);
                line["score"] = score.json();
                line
            };
            jobs.push(Job { key, part: "pads", plan, effect: "", run: Box::new(run) });
        }
    }
    jobs
}

/// What the program states for the first parameter of a cause.
fn stated(diagnosis: &Value, truth: &Truth) -> Value {
    let findings = diagnosis["findings"].as_array().map_or(&[][..], Vec::as_slice);
    let own = findings.iter().find(|finding| finding["effect"] == truth.effect.as_str());
    own.map_or(Value::Null, |own| own["parameters"][&truth.parameters[0].0]["value"].clone())
}

/// The least sizes on the paper's plan, with the background and the noise for which they are asked for.
fn sharp(_: Length) -> Vec<Job> {
    let job = |seed: u64| {
        let key = format!("sharp-{seed}");
        let case =
            Case { quality: Quality::STATED, ..Case::new(&key, 30_000 + seed, Plan::Paper, Vec::new()) };
        Job { key, part: "sharp", plan: Plan::Paper, effect: "", run: Box::new(move |_| line(&case, &[])) }
    };
    (1..=3).map(job).collect()
}
