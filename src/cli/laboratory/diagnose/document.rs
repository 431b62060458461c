//! The JSON document. Numbers that are not finite are `null` there.

use std::collections::BTreeMap;

use serde::Serialize;

use super::numbers::word;
use tactpad::lab::diagnosis::data::target::Target;
use tactpad::lab::diagnosis::report::{self, Diagnosis};
use tactpad::lab::effect::{Effect, EffectFamily};
use tactpad::pad::device::Side;

/// Version of the document's form.
const SCHEMA: u32 = 1;

/// The whole answer.
#[derive(Serialize)]
pub(super) struct DiagnosisDocument<'d> {
    schema: u32,
    verdict: &'static str,
    noise_floor_uv: f64,
    rmse_uv: Rmse,
    background: Background,
    findings: Vec<Finding<'d>>,
    not_detected: Vec<NotDetected>,
    not_testable: Vec<NotTestable>,
    unnamed_share: f64,
    ceiling_share: Option<f64>,
    gain: Option<Gain>,
    gatekeepers: Vec<Notice<'d>>,
    /// Where causes are open.
    #[serde(skip_serializing_if = "Option::is_none")]
    next: Option<Next<'d>>,
}

/// Further measurements that tell what is open.
#[derive(Serialize)]
struct Next<'d> {
    rows: usize,
    minutes: f64,
    measurements: Vec<NextMeasurement<'d>>,
    others: &'d [String],
    inseparable: usize,
}

#[derive(Serialize)]
struct NextMeasurement<'d> {
    what: &'d str,
    why: &'d str,
    times: usize,
    minutes: f64,
}

#[derive(Serialize)]
struct Rmse {
    nominal: f64,
    extended: f64,
}

#[derive(Serialize)]
struct Background {
    share: f64,
    length_mm: f64,
}

/// A cause and where it is.
#[derive(Serialize)]
struct Cause {
    effect: Effect,
    target: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    with: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    side: Option<&'static str>,
}

/// A finding with its numbers.
#[derive(Serialize)]
pub(crate) struct Finding<'d> {
    status: &'static str,
    #[serde(flatten)]
    cause: Cause,
    /// Of the cause, and of all that it is confounded with.
    #[serde(skip_serializing_if = "Option::is_none")]
    family: Option<EffectFamily>,
    #[serde(skip_serializing_if = "Option::is_none")]
    part: Option<&'d str>,
    parameters: BTreeMap<&'static str, ParameterValue<'d>>,
    p_value: f64,
    share: f64,
    confounded_with: Vec<Cause>,
    separate_by: Option<&'d str>,
}

/// A number with its interval, or a text.
#[derive(Serialize)]
#[serde(untagged)]
enum ParameterValue<'d> {
    Number(Estimate),
    Text(&'d str),
}

#[derive(Serialize)]
struct Estimate {
    value: f64,
    low95: f64,
    high95: f64,
}

#[derive(Serialize)]
struct NotDetected {
    #[serde(flatten)]
    cause: Cause,
    minimum_detectable: BTreeMap<&'static str, f64>,
    rival_share: f64,
}

#[derive(Serialize)]
struct NotTestable {
    effect: Effect,
    needs: &'static str,
}

#[derive(Serialize)]
struct Gain {
    rows_locked: usize,
    rmse_ratio: f64,
    rmse_ratio_low95: f64,
    rmse_ratio_high95: f64,
    position_mae_mm: Option<Decoded>,
    force_mae_n: Option<Decoded>,
    per_cause: Vec<Without>,
}

/// Errors of decoded contacts.
#[derive(Serialize)]
struct Decoded {
    nominal: f64,
    extended: f64,
    change_low95: f64,
    change_high95: f64,
}

/// The result of a check of the recording, or of the fit; `channel` is `all` where it was in whole rows.
#[derive(Serialize)]
struct Notice<'d> {
    check: &'static str,
    channel: &'d str,
    detail: &'d str,
}

#[derive(Serialize)]
struct Without {
    #[serde(flatten)]
    cause: Cause,
    rmse_ratio_without: f64,
}

impl<'d> DiagnosisDocument<'d> {
    pub(super) fn of(diagnosis: &'d Diagnosis) -> Self {
        let cause = |effect, target: &Target| Cause::of(effect, target, &diagnosis.channels);
        let not_detected = diagnosis.not_detected.iter().map(|it| NotDetected {
            cause: cause(it.effect, &it.target),
            minimum_detectable: it.minimum_detectable.iter().copied().collect(),
            rival_share: it.rival_share,
        });
        let untested = diagnosis.not_testable.iter();
        Self {
            schema: SCHEMA,
            verdict: word(diagnosis.verdict),
            noise_floor_uv: diagnosis.noise_floor,
            rmse_uv: Rmse { nominal: diagnosis.rmse_nominal, extended: diagnosis.rmse_extended },
            background: Background { share: diagnosis.background_share, length_mm: diagnosis.background_mm },
            findings: diagnosis.findings.iter().map(|it| Finding::of(it, &diagnosis.channels)).collect(),
            not_detected: not_detected.collect(),
            not_testable: untested.map(|it| NotTestable { effect: it.effect, needs: it.needs }).collect(),
            unnamed_share: diagnosis.unnamed_share,
            ceiling_share: diagnosis.ceiling_share,
            gain: diagnosis.gain.as_ref().map(|gain| Gain::of(gain, &diagnosis.channels)),
            gatekeepers: diagnosis.gatekeepers.iter().map(|it| Notice::of(it, &diagnosis.channels)).collect(),
            next: Next::of(&diagnosis.next),
        }
    }
}

impl<'d> Next<'d> {
    fn of(proposal: &'d report::Proposal) -> Option<Self> {
        let report::Proposal { measurements, others, plan, inseparable } = proposal;
        let each = |it: &'d report::ProposedMeasurement| NextMeasurement {
            what: &it.what,
            why: it.why,
            times: it.repeats,
            minutes: it.minutes,
        };
        let is_open = !measurements.is_empty() || !others.is_empty() || *inseparable > 0;
        is_open.then(|| Self {
            rows: plan.rows.len(),
            minutes: measurements.iter().map(|it| it.minutes).sum(),
            measurements: measurements.iter().map(each).collect(),
            others,
            inseparable: *inseparable,
        })
    }
}

impl Cause {
    fn of(effect: Effect, target: &Target, channels: &[String]) -> Self {
        Self {
            effect,
            target: target.name(channels),
            with: target.with(channels),
            side: target.side().map(Side::name),
        }
    }
}

impl<'d> Finding<'d> {
    pub(crate) fn of(finding: &'d report::Finding, channels: &[String]) -> Self {
        let estimate = |it: &report::Estimate| {
            let [low95, high95] = it.interval95;
            (it.name, ParameterValue::Number(Estimate { value: it.value, low95, high95 }))
        };
        let labels = finding.labels.as_ref();
        let map = labels.and_then(|it| it.map.as_deref()).map(|map| ("map", ParameterValue::Text(map)));
        let others = finding.confounded_with.iter();
        Self {
            status: if finding.confounded_with.is_empty() { "NAMED" } else { "CONFOUNDED" },
            cause: Cause::of(finding.effect, &finding.target, channels),
            family: finding.family(),
            part: labels.and_then(|it| it.part.as_deref()),
            parameters: finding.parameters.iter().map(estimate).chain(map).collect(),
            p_value: finding.p_value,
            share: finding.share,
            confounded_with: others.map(|(effect, target)| Cause::of(*effect, target, channels)).collect(),
            separate_by: finding.separate_by.as_deref(),
        }
    }
}

impl<'d> Notice<'d> {
    fn of(notice: &'d report::Notice, channels: &'d [String]) -> Self {
        let channel = notice.channel.and_then(|channel| channels.get(channel));
        Self { check: notice.check, channel: channel.map_or("all", String::as_str), detail: &notice.detail }
    }
}

impl Decoded {
    const fn of(decoded: &report::Decoded) -> Self {
        let report::Decoded { nominal, extended, change_interval95: [change_low95, change_high95] } =
            *decoded;
        Self { nominal, extended, change_low95, change_high95 }
    }
}

impl Gain {
    fn of(gain: &report::Gain, channels: &[String]) -> Self {
        let [rmse_ratio_low95, rmse_ratio_high95] = gain.rmse_ratio_interval95;
        let without = |it: &report::WithoutFinding| Without {
            cause: Cause::of(it.effect, &it.target, channels),
            rmse_ratio_without: it.rmse_ratio,
        };
        Self {
            rows_locked: gain.rows_locked,
            rmse_ratio: gain.rmse_ratio,
            rmse_ratio_low95,
            rmse_ratio_high95,
            position_mae_mm: gain.position_mae.as_ref().map(Decoded::of),
            force_mae_n: gain.force_mae.as_ref().map(Decoded::of),
            per_cause: gain.per_cause.iter().map(without).collect(),
        }
    }
}
