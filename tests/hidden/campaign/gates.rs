//! What the campaign must show, from its lines.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::limits::{Share, median};

/// One thing that must hold.
#[derive(Debug, Clone)]
pub(super) struct Gate {
    pub(super) what: String,
    pub(super) found: String,
    pub(super) held: bool,
}

fn gate(what: &str, found: impl ToString, held: bool) -> Gate {
    Gate { what: what.to_owned(), found: found.to_string(), held }
}

/// The lines of a part that came to a score.
fn part<'a>(lines: &'a [Value], part: &str) -> Vec<&'a Value> {
    lines.iter().filter(|line| line["part"] == part && line["score"].is_object()).collect()
}

fn with_times<'a>(lines: &[&'a Value], times: f64) -> Vec<&'a Value> {
    lines.iter().copied().filter(|line| line["times"].as_f64() == Some(times)).collect()
}

fn share(lines: &[&Value], hit: impl Fn(&Value) -> bool) -> Share {
    Share::of(lines.iter().map(|line| hit(line)))
}

/// The sizes of the sets that hold the truths: 1 for a name, 0 for what was missed.
fn set_sizes(line: &Value) -> Vec<u64> {
    line["score"]["set_sizes"].as_array().into_iter().flatten().filter_map(Value::as_u64).collect()
}

fn complete(line: &Value) -> bool {
    set_sizes(line).iter().all(|size| *size > 0)
}

fn named(line: &Value) -> bool {
    set_sizes(line).iter().all(|size| *size == 1)
}

fn wrong(line: &Value) -> bool {
    line["score"]["wrong"].as_array().is_some_and(|wrong| !wrong.is_empty())
}

fn alarm(line: &Value) -> bool {
    line["score"]["alarm"].as_bool().unwrap_or_default()
}

/// All gates for which there are lines.
pub(super) fn of(lines: &[Value]) -> Vec<Gate> {
    let mut gates = Vec::new();
    gates.extend(nulls(&part(lines, "nulls")));
    let sizes = part(lines, "sizes");
    let judged: Vec<&Value> = sizes.iter().copied().chain(part(lines, "nulls")).collect();
    if !judged.is_empty() {
        let found = share(&judged, wrong);
        gates.push(gate("wrong names in at most 2 % of runs", found, found.value() <= 0.02));
    }
    gates.extend(large(&with_times(&sizes, 3.0)));
    gates.extend(small(&with_times(&sizes, 1.0)));
    // A rival that does nearly the same is no wrong name for what the catalogue does not have.
    let differs = |line: &&Value| line["rival_share"].as_f64().is_none_or(|share| share < 0.9);
    let struck: Vec<&Value> = part(lines, "struck").into_iter().filter(differs).collect();
    if !struck.is_empty() {
        let found = share(&struck, wrong);
        gates.push(gate("a cause that is struck: at most 5 % wrong names", found, found.value() <= 0.05));
    }
    gates.extend(several(&part(lines, "several")));
    gates.extend(second(&part(lines, "second")));
    gates.extend(pads(&part(lines, "pads")));
    gates.extend(sharp(&part(lines, "sharp")));
    gates
}

fn nulls(nulls: &[&Value]) -> Vec<Gate> {
    if nulls.is_empty() {
        return Vec::new();
    }
    let found = share(nulls, alarm);
    vec![
        gate("nulls: at most 5 % alarms", found, found.value() <= 0.05),
        gate("nulls: one-sided upper limit at most 8 %", found, found.upper95() <= 0.08),
    ]
}

/// Two to five causes at once.
fn several(lines: &[&Value]) -> Vec<Gate> {
    if lines.is_empty() {
        return Vec::new();
    }
    let causes = |line: &Value| line["truths"].as_array().map_or(0, Vec::len);
    let number = |line: &Value, key: &str| line["score"][key].as_u64().unwrap_or_default() as usize;
    // One entry for each cause, of which the first so many count.
    let each = |key: &str| {
        Share::of(lines.iter().flat_map(|line| (0..causes(line)).map(|at| at < number(line, key))))
    };
    let [in_two, doubted] = ["in_two", "doubted"].map(each);
    let found = share(lines, wrong);
    let intervals = |at: usize| {
        lines.iter().filter_map(|line| line["score"]["intervals"][at].as_u64()).sum::<u64>() as usize
    };
    let held = Share::of((0..intervals(0)).map(|at| at < intervals(1)));
    vec![
        gate("several: named or in a set of two in at least 90 %", in_two, in_two.value() >= 0.9),
        gate("several: perhaps a part of something else in at most 10 %", doubted, doubted.value() <= 0.1),
        gate("several: wrong names in at most 2 % of tables", found, found.value() <= 0.02),
        gate("several: 90 to 99 % of intervals hold", held, (0.9..=0.99).contains(&held.value())),
    ]
}

/// At three times the minimum detectable effect.
fn large(lines: &[&Value]) -> Vec<Gate> {
    if lines.is_empty() {
        return Vec::new();
    }
    let found = share(lines, complete);
    let mut gates = vec![gate("3×: named or in the set in at least 95 %", found, found.value() >= 0.95)];
    let sets: Vec<f64> = lines
        .iter()
        .flat_map(|line| set_sizes(line))
        .filter(|size| *size > 1)
        .map(|size| size as f64)
        .collect();
    let middle = median(sets);
    gates.push(gate("3×: sets of at most 2 at the median", middle, middle.is_nan() || middle <= 2.0));
    // Where the program does not say how near the nearest rival comes, the case counts.
    let alone: Vec<&Value> = lines
        .iter()
        .copied()
        .filter(|line| line["rival_share"].as_f64().is_none_or(|share| share <= 0.8))
        .collect();
    let found = share(&alone, named);
    gates.push(gate("3×, no rival over 80 %: named alone in at least 85 %", found, found.value() >= 0.85));
    let right: Vec<&Value> = lines.iter().copied().filter(|line| named(line)).collect();
    let better =
        share(&right, |line| line["score"]["rmse_ratio_high95"].as_f64().is_some_and(|high| high < 1.0));
    gates.push(gate(
        "3×: a gain that is sure in at least 90 % of right names",
        better,
        better.value() >= 0.9,
    ));
    gates.push(coverage(&right));
    let widths = right.iter().flat_map(|line| line["relative_widths"].as_array().into_iter().flatten());
    let middle = median(widths.filter_map(Value::as_f64).collect());
    gates.push(gate(
        "3×, paper's plan: intervals at most 1.5 times as wide as they must be, at the median",
        format!("{middle:.2}"),
        middle <= 1.5,
    ));
    gates
}

/// Causes whose change comes from the program itself say nothing about intervals.
fn coverage(right: &[&Value]) -> Gate {
    let count =
        |line: &&Value, place: usize| line["score"]["intervals"][place].as_u64().unwrap_or_default() as usize;
    let own: Vec<&Value> =
        right.iter().copied().filter(|line| line["independent"].as_bool().unwrap_or_default()).collect();
    let held = Share {
        hits: own.iter().map(|line| count(line, 1)).sum(),
        all: own.iter().map(|line| count(line, 0)).sum(),
    };
    gate("3×: intervals hold the truth in 90 to 99 %", held, (0.9..=0.99).contains(&held.value()))
}

/// At the minimum detectable effect itself. What is detected is what alarms.
fn small(lines: &[&Value]) -> Vec<Gate> {
    let sized: Vec<&Value> = lines
        .iter()
        .copied()
        .filter(|line| line["truths"][0]["parameters"].as_object().is_some_and(|all| !all.is_empty()))
        .collect();
    if sized.is_empty() {
        return Vec::new();
    }
    let pooled = share(&sized, alarm);
    let mut causes: BTreeMap<String, Vec<&Value>> = BTreeMap::new();
    for line in &sized {
        causes.entry(line["effect"].to_string()).or_default().push(line);
    }
    let weak = |lines: &Vec<&Value>| share(lines, alarm).value() < 0.6;
    let weak: Vec<String> =
        causes.iter().filter(|(_, lines)| weak(lines)).map(|(cause, _)| cause.clone()).collect();
    vec![
        gate("1×: pooled power 0.8 to 0.97", pooled, (0.8..=0.97).contains(&pooled.value())),
        gate("1×: no cause below 6 of 10", weak.join(", "), weak.is_empty()),
        gate("1×: named or in the set (for orientation)", share(&sized, complete), true),
    ]
}

/// The stated ratio of errors on the other recording.
fn second(lines: &[&Value]) -> Vec<Gate> {
    let right: Vec<&Value> =
        lines.iter().copied().filter(|line| named(line) && line["error_ratio"].is_number()).collect();
    if right.is_empty() {
        return Vec::new();
    }
    let inside = |line: &Value| {
        let [low, high] = [1, 2].map(|place| line["ratio"][place].as_f64().unwrap_or(f64::NAN));
        line["error_ratio"].as_f64().is_some_and(|ratio| (low..=high).contains(&ratio))
    };
    let found = share(&right, inside);
    vec![gate(
        "another recording: the stated ratio within its interval in at least 90 %",
        found,
        found.value() >= 0.9,
    )]
}

fn pads(lines: &[&Value]) -> Vec<Gate> {
    if lines.is_empty() {
        return Vec::new();
    }
    let found = share(lines, |line| line["set_at_most_2"].as_bool().unwrap_or_default());
    let plates: Vec<&Value> =
        lines.iter().copied().filter(|line| line["truths"][0]["effect"] == "plate_stiffness").collect();
    let plate = share(&plates, |line| {
        line["value"].as_f64().is_some_and(|factor| (factor / 1.15_f64.powi(3) - 1.0).abs() <= 0.05)
    });
    vec![
        gate("the five changed pads: named, or in a set of at most 2", found, found.hits == found.all),
        gate("the thick plate within 5 %", plate, plate.hits == plate.all),
    ]
}

/// What the least sizes may be at most, at the median over seeds and targets: cause, parameter, size, targets.
const SHARP: [(&str, &str, f64); 7] = [
    ("channel_gain", "gain", 0.03),
    ("channel_crosstalk", "share", 0.02),
    ("module_displaced", "radial_mm", 0.3),
    ("module_displaced", "tangential_mm", 0.3),
    ("module_rotated", "deg", 0.8),
    ("stage_offset", "x_mm", 0.25),
    ("reference_tilt", "x_deg", 0.5),
];

fn sharp(lines: &[&Value]) -> Vec<Gate> {
    let stated = |effect: &str, parameter: &str| -> Vec<f64> {
        let entries = lines.iter().flat_map(|line| line["not_detected"].as_array().into_iter().flatten());
        let own = entries.filter(|entry| entry["effect"] == effect);
        own.filter_map(|entry| entry["minimum_detectable"][parameter].as_f64()).collect()
    };
    let one = |(effect, parameter, most): &(&str, &str, f64)| {
        let middle = median(stated(effect, parameter));
        gate(
            &format!("least {effect} at most {most} in {parameter}"),
            format!("{middle:.4}"),
            middle <= *most,
        )
    };
    if lines.is_empty() { Vec::new() } else { SHARP.iter().map(one).chain([near_leak(lines)]).collect() }
}

/// From z into x of one module, at most 0.4 %.
fn near_leak(lines: &[&Value]) -> Gate {
    let entries = lines.iter().flat_map(|line| line["not_detected"].as_array().into_iter().flatten());
    let near = |entry: &&Value| {
        let [target, source] = ["target", "with"].map(|key| entry[key].as_str().unwrap_or_default());
        entry["effect"] == "channel_crosstalk"
            && target.ends_with('x')
            && source.ends_with('z')
            && target.get(..2) == source.get(..2)
    };
    let sizes = entries.filter(near).filter_map(|entry| entry["minimum_detectable"]["share"].as_f64());
    let middle = median(sizes.collect());
    gate("least leak from z into x of a module at most 0.4 %", format!("{middle:.4}"), middle <= 0.004)
}
