//! What came of a hidden case, from the program's JSON and the truth.

use serde_json::{Value, json};

use crate::truth::Truth;

/// What became of one hidden cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Found {
    /// NAMED, alone.
    Named,
    /// In a confounded set of this size.
    InSet(usize),
    Missed,
}

/// The score of one run.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    pub(crate) found: Vec<Found>,
    /// Names that are not in the truth.
    pub(crate) wrong: Vec<String>,
    /// Something was claimed, whatever it was.
    pub(crate) alarm: bool,
    pub(crate) verdict: String,
    pub(crate) unnamed_share: f64,
    /// Parameters of named causes, and how many of their intervals hold the truth.
    pub(crate) intervals: [usize; 2],
    pub(crate) rmse_ratio_high95: Option<f64>,
    /// How many hidden causes are named or in a set of at most two causes of the catalogue.
    pub(crate) in_two: usize,
    /// How many are found as what may be a part of something else.
    pub(crate) doubted: usize,
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

/// Whether an entry means this cause: its source counts where the entry names one.
fn means(entry: &Value, truth: &Truth) -> bool {
    let source = entry["with"].as_str();
    text(entry, "effect") == truth.effect
        && text(entry, "target") == truth.target
        && source.is_none_or(|source| truth.with.as_deref() == Some(source))
}

fn found(findings: &[Value], truth: &Truth) -> Found {
    let mut best = Found::Missed;
    for finding in findings {
        let rivals = list(finding, "confounded_with");
        let named = text(finding, "status") == "NAMED";
        if means(finding, truth) && named {
            return Found::Named;
        }
        if !named && (means(finding, truth) || rivals.iter().any(|rival| means(rival, truth))) {
            best = Found::InSet(1 + rivals.len());
        }
    }
    best
}

/// Whether a finding holds a cause, and the rivals in it: those of the catalogue, and whether that it is a part of something else is one.
fn rivals(finding: &Value, truth: &Truth) -> Option<(usize, bool)> {
    let all = list(finding, "confounded_with");
    let unlisted = all.iter().filter(|rival| text(rival, "effect") == "unlisted_cause").count();
    let is_held = means(finding, truth) || all.iter().any(|rival| means(rival, truth));
    is_held.then_some((all.len() - unlisted, unlisted > 0))
}

/// The parameters of a named cause, and how many of their intervals hold the truth.
fn intervals(findings: &[Value], truth: &Truth) -> [usize; 2] {
    let named = findings.iter().find(|finding| text(finding, "status") == "NAMED" && means(finding, truth));
    let held = |(name, value): &(String, f64)| {
        let stated = &named?["parameters"][name];
        Some((stated["low95"].as_f64()?..=stated["high95"].as_f64()?).contains(value))
    };
    let held: Vec<bool> = truth.parameters.iter().filter_map(held).collect();
    [held.len(), held.iter().filter(|held| **held).count()]
}

/// The widths of a named cause's intervals, in the order of its parameters.
pub(crate) fn widths(diagnosis: &Value, truth: &Truth) -> Option<Vec<f64>> {
    let findings = list(diagnosis, "findings");
    let named =
        findings.iter().find(|finding| text(finding, "status") == "NAMED" && means(finding, truth))?;
    let width = |(name, _): &(String, f64)| {
        let stated = &named["parameters"][name];
        Some(stated["high95"].as_f64()? - stated["low95"].as_f64()?)
    };
    truth.parameters.iter().map(width).collect()
}

impl Score {
    pub(crate) fn of(diagnosis: &Value, truths: &[Truth]) -> Self {
        let findings = list(diagnosis, "findings");
        let named = findings.iter().filter(|finding| text(finding, "status") == "NAMED");
        let wrong = named.filter(|finding| !truths.iter().any(|truth| means(finding, truth)));
        let verdict = text(diagnosis, "verdict").to_owned();
        let each = truths.iter().map(|truth| intervals(findings, truth));
        let held = truths.iter().map(|truth| {
            findings.iter().filter_map(|finding| rivals(finding, truth)).collect::<Vec<(usize, bool)>>()
        });
        Self {
            found: truths.iter().map(|truth| found(findings, truth)).collect(),
            wrong: wrong
                .map(|wrong| format!("{} {}", text(wrong, "effect"), text(wrong, "target")))
                .collect(),
            alarm: !findings.is_empty() || verdict != "no_discrepancy",
            verdict,
            unnamed_share: diagnosis["unnamed_share"].as_f64().unwrap_or_default(),
            intervals: each.fold([0, 0], |[all, held], [more, more_held]| [all + more, held + more_held]),
            rmse_ratio_high95: diagnosis["gain"]["rmse_ratio_high95"].as_f64(),
            in_two: held.clone().filter(|of| of.iter().any(|(rivals, _)| *rivals <= 1)).count(),
            doubted: held.filter(|of| !of.is_empty() && of.iter().all(|(_, is_doubted)| *is_doubted)).count(),
        }
    }

    /// All hidden causes are named or in a set.
    pub(crate) fn complete(&self) -> bool {
        !self.found.contains(&Found::Missed)
    }

    pub(crate) fn json(&self) -> Value {
        let found = |found: &Found| match found {
            Found::Named => json!(1),
            Found::InSet(size) => json!(size),
            Found::Missed => json!(0),
        };
        let named = self.found.iter().filter(|found| **found == Found::Named).count();
        json!({
            "set_sizes": self.found.iter().map(found).collect::<Vec<Value>>(),
            "named": named,
            "wrong": self.wrong,
            "alarm": self.alarm,
            "verdict": self.verdict,
            "unnamed_share": self.unnamed_share,
            "intervals": self.intervals,
            "in_two": self.in_two,
            "doubted": self.doubted,
            "rmse_ratio_high95": self.rmse_ratio_high95,
        })
    }
}

/// What the program states as the least it would see of a cause, per parameter: from a table without it, made by the same
/// plan and with the same noise. None where it says that the cause cannot be tested, or nothing.
pub(crate) fn minimum_detectable(diagnosis: &Value, truth: &Truth, parameter: &str) -> Option<f64> {
    let entry = list(diagnosis, "not_detected").iter().find(|entry| means(entry, truth))?;
    entry["minimum_detectable"][parameter].as_f64()
}

/// How much of a cause's signature its nearest rival reproduces in this plan, where the program says so.
pub(crate) fn rival_share(diagnosis: &Value, truth: &Truth) -> Option<f64> {
    let entry = list(diagnosis, "not_detected").iter().find(|entry| means(entry, truth))?;
    entry["rival_share"].as_f64()
}

#[test]
fn names_sets_and_wrong_names_are_told_apart() {
    let truth = [Truth::new("channel_gain", "m1z", &[("gain", 1.12)])];
    let finding = |status: &str, effect: &str, target: &str, rivals: Value| {
        let parameters = json!({"gain": {"value": 1.1, "low95": 1.11, "high95": 1.13}});
        json!({"status": status, "effect": effect, "target": target, "parameters": parameters,
               "confounded_with": rivals})
    };
    let scored = |findings: Vec<Value>| {
        Score::of(&json!({"verdict": "explained", "findings": findings, "unnamed_share": 0.1}), &truth)
    };
    let right = scored(vec![finding("NAMED", "channel_gain", "m1z", json!([]))]);
    assert!(right.complete() && right.wrong.is_empty() && right.alarm);
    assert_eq!((right.found[0], right.intervals), (Found::Named, [1, 1]));
    let rivals = json!([{"effect": "channel_gain", "target": "m1z"}, {"effect": "creep", "target": "pad"}]);
    let set = scored(vec![finding("CONFOUNDED", "hysteresis", "pad", rivals)]);
    assert_eq!((set.found[0], set.wrong.len()), (Found::InSet(3), 0));
    let wrong = scored(vec![finding("NAMED", "channel_gain", "m1y", json!([]))]);
    assert_eq!(
        (wrong.found[0], wrong.wrong.as_slice()),
        (Found::Missed, ["channel_gain m1y".to_owned()].as_slice())
    );
    let quiet = Score::of(&json!({"verdict": "no_discrepancy", "findings": []}), &[]);
    assert!(!quiet.alarm && quiet.complete());
}
