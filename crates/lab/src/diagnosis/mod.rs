//! Diagnosis: what measured data show that a model gets wrong, and which causes explain it.
//!
//! The way of the data, folder by folder:
//!
//! | folder | stage |
//! |---|---|
//! | [`conventions`] | how labels are meant, before anything is held against them |
//! | [`data`] | rows of a table become observations |
//! | `gatekeepers` | the recording is checked before any physics |
//! | `model` | the chain from contact to reading |
//! | `causes` | the catalogue of hypotheses |
//! | `simulation` | the simulated pad as a model of nine channels, about its own field or those of changed pads (`atlas`); [`tactpad_inference`] says which hypotheses explain what it gets wrong |
//! | `naming` | which of them may be named: not those that look like parts of something else (`withdrawal`); models of further measurements (`experiments`) say which would tell the others apart (`separation`); causes that lack a column stay rivals (`untestable`) |
//! | `validation` | the worth of the findings on rows that had no part in it, in readings and in contacts that the model decodes backwards |
//!
//! [`against`] holds two recordings of one sensor against each other, without a simulator; [`prediction`] a recording of any sensor against what
//! anybody's model says of it; [`report`], [`extension`] and [`agreement`] are what
//! comes of a diagnosis.
//!
//! What is said of channels and places is in `naming`; how sure that is, in the inference, which knows no pad.

pub mod against;
pub mod agreement;
mod causes;
pub mod conventions;
pub mod data;
pub mod extension;
pub(crate) mod gatekeepers;
mod label;
pub(crate) mod model;
mod naming;
pub mod prediction;
pub mod report;
mod simulation;
mod validation;

use std::fmt;

use self::causes::catalogue::CATALOGUE;
use self::conventions::Conventions;
use self::data::observed::observed;
use self::data::target::Target;
use self::gatekeepers::checks::excess::{Excess, excess};
use self::gatekeepers::{Gate, guarded};
use self::label::{ModelOfRows, Search, no_solution};
use self::naming::proposal::{OpenFinding, proposal};
use self::naming::separation::Separation;
use self::naming::untestable::with_untestable;
use self::naming::withdrawal::{Candidate, NamingResult, doubted, in_common, named};
use self::naming::{not_detected, offsets};
use self::report::{Diagnosis, Finding, NotTestable, Notice, Proposal, Residuals, Verdict};
use self::simulation::atlas::{Atlas, attributed};
use self::simulation::simulated::Simulated;
use self::validation::ceiling::{ceiling_share, is_all_removed};
use self::validation::gain::{Rows, gain, rmse};
use self::validation::rounded::rounded;
use crate::effect::Effect;
use crate::tangent::SimulatedPad;
use tactpad_core::counted::counted;
use tactpad_core::quantity::CHANNEL_NAMES;
use tactpad_core::tables::measured::Table;
use tactpad_inference::covariance::Remainder;
use tactpad_inference::error::InferenceError;
use tactpad_inference::model::Model;
use tactpad_inference::observations::Observations;
use tactpad_inference::policy::REMAINDER_MAX;
use tactpad_inference::search::{Applied, Attribution, AttributionFit};
use tactpad_numeric::chi_square;
use tactpad_numeric::statistics::{mean, population_deviation, rms};

/// Fewest rows, and fewest locations among them, by which causes can be told.
const ROWS_MIN: usize = 60;
const LOCATIONS_MIN: usize = 12;

/// Why a table cannot be diagnosed.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// Too few rows.
    Rows(usize),
    /// Too few locations.
    Locations(usize),
    /// No forces.
    Unloaded,
    /// A label never changes while the contacts do.
    Stuck(&'static str),
    /// No channel goes with the contacts.
    Silent,
    /// The inference has no answer.
    Inference(InferenceError),
}

impl fmt::Display for DiagnosisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rows(rows) => write!(
                f,
                "{} with channels: to tell causes apart it takes {ROWS_MIN} at least; tactpad protocol paper makes a plan",
                counted(rows, "row")
            ),
            Self::Locations(locations) => write!(
                f,
                "contacts at {}: to tell causes apart it takes {LOCATIONS_MIN} at least, spread over the plate",
                counted(locations, "place")
            ),
            Self::Unloaded => f.write_str("all forces are zero: without written loads the channels cannot be held against the pad"),
            Self::Stuck(name) => write!(
                f,
                "{name} is the same in all rows, while the contacts that the channels tell are not: see why it was not written, and measure \
                 again; or say with --without label_stuck that it is so"
            ),
            Self::Silent => f.write_str(
                "no channel follows the contacts; measure again, and see that each row has the channels of its own contact",
            ),
            Self::Inference(error) => f.write_str(&no_solution(error, &CHANNEL_NAMES)),
        }
    }
}

impl std::error::Error for DiagnosisError {}

/// Holds a measured table against a pad: what differs, why, and what the findings gain on locked rows.
///
/// # Errors
/// The table has too little in it to tell causes apart.
pub fn diagnose(
    table: &Table,
    pad: &SimulatedPad<'_>,
    without: &[Effect],
) -> Result<Diagnosis, DiagnosisError> {
    diagnosed(table, pad, without, Scope::Full)
}

/// The same causes as those of [`diagnose`], in half of the time: what they gain on locked rows, the ceiling there and the measurements that
/// would tell them apart are absent.
///
/// # Errors
/// The table has too little in it to tell causes apart.
pub fn causes(table: &Table, pad: &SimulatedPad<'_>) -> Result<Diagnosis, DiagnosisError> {
    diagnosed(table, pad, &[], Scope::CausesOnly)
}

/// How much is asked of a table.
#[derive(Clone, Copy, PartialEq)]
enum Scope {
    /// Causes, their worth on rows in which they were not looked for, and the measurements that tell them apart.
    Full,
    CausesOnly,
}

fn diagnosed(
    table: &Table,
    pad: &SimulatedPad<'_>,
    without: &[Effect],
    scope: Scope,
) -> Result<Diagnosis, DiagnosisError> {
    let conventions = Conventions::of(table, pad);
    // Whoever leaves one of them out takes the labels as they are written.
    let are_asked_for = !conventions::EFFECTS.iter().any(|effect| without.contains(effect));
    let gate = if conventions.are_default() || !are_asked_for {
        check_meant(table)?;
        checked(&observed(table), pad, without)?
    } else {
        if let Some(stuck) = conventions.stuck.iter().find(|it| it.rows.len() == conventions.contacts()) {
            return Err(DiagnosisError::Stuck(stuck.name()));
        }
        let meant = conventions.applied(table);
        check_meant(&meant)?;
        let [written, meant] = [observed(table), observed(&meant)];
        let mut gate = checked(&meant, pad, without)?;
        let [before, after] = [&written, &meant].map(|it| residual_square(it, pad));
        let left = if before > 0.0 { (after / before).clamp(0.0, 1.0) } else { 1.0 };
        gate.left *= left;
        gate.findings.iter_mut().for_each(|finding| finding.share *= left);
        gate.findings.splice(..0, conventions.findings(table, pad, 1.0 - left));
        gate.notices.splice(..0, conventions.notice(table));
        gate
    };
    let all = gate.observations.clone();
    let [open, locked] = all.split().map(|rows| all.picked(&rows));
    let mut model = Atlas::new(pad, without, &all, &open);
    let found = attributed(&mut model).map_err(DiagnosisError::Inference)?;
    let missing = model.missing();
    concluded(gate, [&open, &locked], &model, &found, Question { missing, without, individual: &[], scope })
        .map_err(DiagnosisError::Inference)
}

/// What was asked, and what cannot be answered.
struct Question<'q> {
    missing: Vec<NotTestable>,
    without: &'q [Effect],
    /// What each target has of its own: several at once need no reason in common.
    individual: &'q [Effect],
    scope: Scope,
}

/// What is said of causes that were found at the open rows, after the checks of the recording.
fn concluded(
    mut gate: Gate,
    [open, locked]: [&Observations; 2],
    model: &dyn ModelOfRows,
    found: &Attribution,
    Question { missing, without, individual, scope }: Question<'_>,
) -> Result<Diagnosis, InferenceError> {
    let measured = gate.unrepaired.take();
    let all = &gate.observations;
    let at_locked = model.at(locked);
    let search = Search::new(model, all, open);
    let parts =
        measured.as_ref().map(|whole| [open, locked].map(|part| (whole, whole.picked(&part.numbers))));
    let models = parts
        .as_ref()
        .map(|parts| parts.each_ref().map(|(whole, part)| (model.at_measured(whole, part), part)));
    let unrepaired = models.as_ref().map(|models| {
        models.each_ref().map(|(model, observations)| Rows {
            model: model.as_ref(),
            observations,
            unrepaired: None,
        })
    });
    let as_measured = |at: usize| unrepaired.as_ref().map(|rows| &rows[at]);
    let rows = [
        Rows { model, observations: open, unrepaired: as_measured(0) },
        Rows { model: at_locked.as_ref(), observations: locked, unrepaired: as_measured(1) },
    ];
    // What each specimen has of its own comes in all sizes: whether more is left is asked of all of it together.
    let halves = open.halves().map(|rows| open.picked(&rows));
    let models = halves.each_ref().map(|half| model.at(half));
    let half = |at: usize| Rows { model: models[at].as_ref(), observations: &halves[at], unrepaired: None };
    let is_complete = !found.random_effects.is_empty()
        && is_all_removed([&half(0), &half(1)], &found.fit.applied, &found.fit.systems.noise);
    let diagnosis = summary(&search, found, &rows, &missing, Judgement { is_complete, scope })?;
    let excess = (!without.contains(&Effect::NoiseExcess))
        .then(|| excess(open, &found.fit.systems.noise, &found.fit.linearised.readings));
    let asks_for_steps = scope == Scope::Full && !without.contains(&Effect::LabelRounded);
    let rounded = if asks_for_steps { rounded(&rows[0], &found.fit) } else { Vec::new() };
    for (finding, notice) in rounded {
        gate.findings.push(finding);
        gate.notices.push(notice);
    }
    let mut individual = individual.to_vec();
    if has_own_gains(&diagnosis.findings, open) {
        let effect = |at: &usize| model.hypotheses()[*at].label.0;
        let own = found.random_effects.iter().flatten().map(effect);
        individual.extend(own.chain([Effect::ChannelOffset]));
    }
    let mut diagnosis = with_gatekeepers(diagnosis, gate, excess.unwrap_or_default());
    diagnosis.not_detected.retain(|it| !without.contains(&it.effect));
    let has_modules = model.hypotheses().iter().any(|it| matches!(it.label.1, Target::Module(_)));
    diagnosis.findings = in_common(diagnosis.findings, &individual, has_modules);
    diagnosis.findings = with_untestable(diagnosis.findings, &diagnosis.not_testable, open);
    Ok(diagnosis)
}

/// Whether most channels have a gain of their own, as those of a pad have that is as it was made. Modules that all stand otherwise beside
/// channels that are all alike have another reason.
fn has_own_gains(findings: &[Finding], observations: &Observations) -> bool {
    let gains = findings.iter().filter(|it| it.effect == Effect::ChannelGain).count();
    let alive = (0..observations.channels.len()).filter(|channel| observations.is_alive(*channel)).count();
    2 * gains > alive
}

/// The observations after the checks of the recording.
fn checked(
    observations: &Observations,
    pad: &SimulatedPad<'_>,
    without: &[Effect],
) -> Result<Gate, DiagnosisError> {
    let expected =
        Simulated::new(pad, without, pad.device, pad.field, observations, observations, observations)
            .readings(&[]);
    let gate = guarded(observations, Some(&expected), |effect| !without.contains(&effect));
    let is_alive = |channel| gate.observations.is_alive(channel);
    if (0..gate.observations.channels.len()).any(is_alive) { Ok(gate) } else { Err(DiagnosisError::Silent) }
}

/// The squared residual beside the model and a zero, each channel's in units of its reading's variance.
fn residual_square(observations: &Observations, pad: &SimulatedPad<'_>) -> f64 {
    let expected = Simulated::new(pad, &[], pad.device, pad.field, observations, observations, observations)
        .readings(&[]);
    let of_channel = |(read, expected): (&Vec<f64>, &Vec<f64>)| {
        let left: Vec<f64> = read.iter().zip(expected).map(|(y, f)| y - f).collect();
        (population_deviation(&left) / population_deviation(read)).powi(2)
    };
    let squares = observations.readings.iter().zip(&expected).map(of_channel);
    squares.filter(|square| square.is_finite()).sum()
}

/// What the checks of the recording found goes first.
fn with_gatekeepers(mut diagnosis: Diagnosis, gate: Gate, excess: Excess) -> Diagnosis {
    // Shares are of the residual before the repairs.
    diagnosis.findings.iter_mut().for_each(|finding| finding.share *= gate.left);
    let excess = excess.of_channels(|channel| diagnosis.unnamed_by_channel[channel] <= 0.0);
    let own = gate.findings.into_iter().chain(excess.findings);
    diagnosis.findings.splice(..0, own);
    diagnosis.verdict = verdict(&diagnosis.findings, diagnosis.unnamed_share);
    diagnosis.not_detected.extend(gate.not_detected.into_iter().chain(excess.not_detected));
    diagnosis.not_testable.extend(gate.not_testable);
    let own = gate.notices.into_iter().chain(excess.notices);
    diagnosis.gatekeepers.splice(..0, own);
    diagnosis
}

/// The names of all effects that can be found.
pub fn effects() -> impl Iterator<Item = Effect> {
    let of_recording = conventions::EFFECTS.into_iter().chain(gatekeepers::EFFECTS);
    CATALOGUE.iter().map(|cause| cause.effect).chain(of_recording).chain([Effect::LabelRounded])
}

/// Whether there is enough in a table; quick, where [`diagnose`] takes seconds.
///
/// # Errors
/// What is missing.
pub fn check(table: &Table, pad: &SimulatedPad<'_>) -> Result<(), DiagnosisError> {
    check_meant(table).or_else(|_| check_meant(&Conventions::of(table, pad).applied(table)))
}

/// The same of a table whose labels are meant as they stand.
fn check_meant(table: &Table) -> Result<(), DiagnosisError> {
    let all = observed(table);
    let locations = all.clusters().into_iter().max().map_or(0, |last| last + 1);
    match all {
        _ if all.rows() < ROWS_MIN => Err(DiagnosisError::Rows(all.rows())),
        _ if locations < LOCATIONS_MIN => Err(DiagnosisError::Locations(locations)),
        _ if all.load_rms() <= 0.0 => Err(DiagnosisError::Unloaded),
        _ => Ok(()),
    }
}

/// How findings are judged.
#[derive(Clone, Copy)]
struct Judgement {
    /// Nothing is left of which they may be a part.
    is_complete: bool,
    scope: Scope,
}

/// Everything that is said about what was found.
fn summary(
    search: &Search<'_>,
    found: &Attribution,
    [open, locked]: &[Rows<'_>; 2],
    missing: &[NotTestable],
    Judgement { is_complete, scope }: Judgement,
) -> Result<Diagnosis, InferenceError> {
    let (fit, rows) = (&found.fit, [open, locked]);
    let is_full = scope == Scope::Full;
    let remainders = unnamed_squares(found);
    let whole = search.removed(fit)? + remainders.iter().sum::<f64>();
    let NamingResult { candidates, unnamed_by_channel, doubted_by_channel } =
        named(search, found, whole, remainders, is_complete)?;
    let unnamed: f64 = unnamed_by_channel.iter().sum();
    let separation = is_full.then(|| Separation::new(search, found));
    let applied: Applied = candidates.iter().map(|it| fit.applied[it.place].clone()).collect();
    let is_open = |it: &&Candidate| !it.finding.confounded_with.is_empty();
    let open_findings: Vec<OpenFinding> =
        candidates.iter().filter(is_open).map(|it| (it.place, it.finding.confounded_with.clone())).collect();
    let told = |Candidate { place, finding, is_doubted }| {
        let separate_by = separation.as_ref().and_then(|it| it.told(place, &finding.confounded_with));
        let finding = Finding { separate_by, ..finding };
        if is_doubted { doubted(finding) } else { finding }
    };
    let mut findings: Vec<Finding> = candidates.into_iter().map(told).collect();
    findings.extend(offsets(search, found, whole + search.offsets_square(found)?, &doubted_by_channel)?);
    let unnamed_share = if unnamed > 0.0 { unnamed / whole } else { 0.0 };
    let nothing = Vec::new();
    Ok(Diagnosis {
        residuals: residuals(open, found, &applied),
        channels: open.observations.channels.clone(),
        full_scale: search.model.full_scale(),
        verdict: verdict(&findings, unnamed_share),
        noise_floor: noise_floor(open, fit),
        rmse_nominal: rmse(open.measured(), &nothing, &open.measured().zeros(&nothing)),
        rmse_extended: rmse(open, &applied, &open.zeros(&applied)),
        background_mm: fit.background.prior.length_mm,
        background_share: rms(fit.background.shares.iter().flatten().copied()),
        ceiling_share: is_full.then(|| ceiling_share(rows, &applied, &fit.systems.noise)).flatten(),
        gain: is_full.then(|| gain(search, fit, rows, &applied)).flatten(),
        not_detected: not_detected(search, found)?,
        not_testable: missing.to_vec(),
        unnamed_share,
        unnamed_by_channel,
        findings,
        gatekeepers: unsettled(fit).into_iter().collect(),
        next: separation.as_ref().map_or_else(Proposal::default, |it| proposal(it, &open_findings)),
    })
}

/// A fit that ran out of steps is told.
fn unsettled(fit: &AttributionFit) -> Option<Notice> {
    let detail = format!(
        "when the steps of the fit were used up, one more would have moved a number by {:.1} of its standard deviations; its 95 % \
         interval is too narrow by that on either side",
        fit.unsettled
    );
    (!fit.is_settled()).then_some(Notice { check: "fit", channel: None, detail })
}

/// Root mean square of the channels' noise.
fn noise_floor(open: &Rows<'_>, fit: &AttributionFit) -> f64 {
    let noise = fit.systems.noise.iter().zip(&fit.linearised.readings).enumerate();
    let alive = noise.filter(|(channel, _)| open.observations.is_alive(*channel));
    let in_series = open.observations.in_series();
    mean(alive.map(|(_, (noise, signal))| noise.mean_square(signal, &in_series))).sqrt()
}

/// Residuals of the model at the open rows, without and with the findings.
fn residuals(open: &Rows<'_>, found: &Attribution, applied: &Applied) -> Residuals {
    let noise = found.fit.systems.noise.iter().zip(&found.fit.linearised.readings);
    let in_series = open.observations.in_series();
    Residuals {
        samples: open.observations.samples.clone(),
        noise: noise.map(|(noise, signal)| noise.mean_square(signal, &in_series).sqrt()).collect(),
        nominal: open.centred(&Vec::new()),
        extended: open.centred(applied),
    }
}

/// What each channel's smooth remainder has beyond a background, where it is larger than a background may be and that is no
/// chance; else nothing.
fn unnamed_squares(found: &Attribution) -> Vec<f64> {
    let fit = &found.fit;
    let remainders = fit.systems.remainders(&fit.background, &fit.marginal, &fit.coordinates);
    let is_no_chance = |it: &Remainder| {
        let beyond = (it.mean_square - REMAINDER_MAX * REMAINDER_MAX) / it.deviation;
        beyond > 0.0 && chi_square::exceeded(beyond * beyond, 1) < found.critical
    };
    let square = |it: &Remainder| if is_no_chance(it) { (it.energy - it.freedom).max(0.0) } else { 0.0 };
    remainders.iter().map(square).collect()
}

/// A finding that may be a part of something else explains nothing.
fn verdict(findings: &[Finding], unnamed_share: f64) -> Verdict {
    let explains = findings.iter().any(|it| !it.is_doubted());
    match (explains, unnamed_share > 0.0) {
        (false, false) => Verdict::NoDiscrepancy,
        (true, false) => Verdict::Explained,
        (true, true) => Verdict::PartlyExplained,
        (false, true) => Verdict::Unexplained,
    }
}
