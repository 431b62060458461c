//! Changes of a sensor since an earlier recording of it: neither a simulator nor forces are needed.
//!
//! The way of the data: two tables have columns in common (`columns`), rows become observations (`recording`); a regression of the
//! earlier ones says what the later ones should read, and how far that may be off (`earlier`); changes of the sensor and of what
//! measured it (`change`) are hypotheses about that (`later`). Everything else is the inference's.

mod change;
pub(in crate::diagnosis) mod columns;
mod earlier;
mod later;
pub(in crate::diagnosis) mod recording;
mod standing;
mod unfit;

use self::change::{Circumstances, EFFECTS, missing};
pub use self::columns::ColumnSelection;
use self::columns::{Columns, extent};
use self::earlier::EarlierRecording;
use self::later::{LaterRecording, Setting, sizes};
use self::recording::Recording;
use self::standing::standing;
pub use self::unfit::ComparisonError;
use self::unfit::{BLOCKS_MIN, ROWS_MIN};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::gatekeepers::checks::excess::{excess, excess_over};
use crate::diagnosis::gatekeepers::{self, Gate, guarded};
use crate::diagnosis::label::{Label, Search};
use crate::diagnosis::report::{Diagnosis, Finding, Notice};
use crate::diagnosis::validation::gain::Rows;
use crate::diagnosis::{Judgement, Scope, summary, with_gatekeepers};
use crate::effect::Effect;
use tactpad_core::counted::counted;
use tactpad_core::tables::measured::sheet::Sheet;
use tactpad_inference::model::Model;
use tactpad_numeric::statistics::mean;

/// Fewest rows of a time series in which the labels' clock shows.
const SERIES_MIN: usize = 50;

/// Names of all effects that can be found against an earlier recording.
pub fn effects() -> impl Iterator<Item = Effect> {
    EFFECTS.into_iter().chain([Effect::ChannelOffset]).chain(gatekeepers::EFFECTS)
}

/// Columns whose texts are needed.
pub const TEXTS: [&str; 3] = ["trial", "session", "approach"];

/// Holds a table against an earlier one of the same sensor.
///
/// # Errors
/// The tables have too little in common, or too little in them.
pub fn compare(
    earlier: &Sheet,
    later: &Sheet,
    asked: &ColumnSelection<'_>,
) -> Result<Diagnosis, ComparisonError> {
    let columns = Columns::of(earlier, later, asked)?;
    let [before, after] = [earlier, later].map(|sheet| Recording::of(sheet, &columns));
    for (recording, which) in [(&before, "the earlier recording"), (&after, "the measured table")] {
        if recording.inputs.len() < ROWS_MIN {
            return Err(ComparisonError::Rows { rows: recording.inputs.len(), which });
        }
    }
    if let Some(at) = before.unused_label(&after) {
        let extents = [&before, &after].map(|it| extent(it.inputs.iter().map(|row| row[at])));
        return Err(ComparisonError::Narrow {
            name: columns.inputs[at].clone(),
            extents: extents.map(|it| it.map(short)),
        });
    }
    let has_temperature = [&before, &after].into_iter().all(varies_in_temperature);
    let sound = guarded(&before.observations, None, |_| true);
    let before = before.mended(&sound.observations);
    let known = EarlierRecording::of(&before, &columns, has_temperature)?;
    let reached: Vec<usize> =
        (0..after.inputs.len()).filter(|row| known.reaches(&after.inputs[*row])).collect();
    if reached.len() < ROWS_MIN {
        return Err(ComparisonError::Apart(reached.len()));
    }
    let lost = ExcludedRows { unlabelled: after.unlabelled, beyond: after.inputs.len() - reached.len() };
    let mut after = after.picked(&reached);
    after.placed(&columns, &known.extents);
    let (after, gate) = checked(&after, &known, asked)?;
    let mut diagnosis = told(&columns, &known, [&before, &after], asked, gate)?;
    diagnosis.gatekeepers.splice(..0, lost.notices());
    Ok(diagnosis)
}

/// The later recording after the checks: beside its channels' earlier zeros, and in clusters.
fn checked(
    after: &Recording,
    known: &EarlierRecording,
    asked: &ColumnSelection<'_>,
) -> Result<(Recording, Gate), ComparisonError> {
    let rows = after.inputs.iter().zip(&after.observations.samples);
    let signals: Vec<Vec<f64>> = rows.map(|(row, sample)| known.signals(row, sample.temp_c)).collect();
    let zeros: Vec<f64> = known.channels.iter().map(|it| it.as_ref().map_or(0.0, |it| it.zero())).collect();
    let expected: Vec<Vec<f64>> = zeros
        .iter()
        .enumerate()
        .map(|(channel, zero)| signals.iter().map(|row| row[channel] + zero).collect())
        .collect();
    let gate = guarded(&after.observations, Some(&expected), |effect| asked.asks_for(effect));
    let mut after = after.mended(&gate.observations);
    for (channel, zero) in zeros.iter().enumerate() {
        after.observations.readings[channel].iter_mut().for_each(|y| *y -= zero);
        if known.channels[channel].is_none() {
            after.observations.is_told[channel].iter_mut().for_each(|it| *it = false);
        }
    }
    let blocks = after.blocks.clone();
    after
        .observations
        .samples
        .iter_mut()
        .zip(&blocks)
        .for_each(|(sample, block)| sample.block = Some(*block));
    let mut distinct = blocks;
    distinct.sort_unstable();
    distinct.dedup();
    if distinct.len() < BLOCKS_MIN {
        return Err(ComparisonError::Blocks(distinct.len()));
    }
    let is_alive = (0..zeros.len()).any(|channel| after.observations.is_alive(channel));
    if is_alive { Ok((after, gate)) } else { Err(ComparisonError::Silent) }
}

/// What the inference finds.
fn told(
    columns: &Columns,
    known: &EarlierRecording,
    [before, after]: [&Recording; 2],
    asked: &ColumnSelection<'_>,
    gate: Gate,
) -> Result<Diagnosis, ComparisonError> {
    let all = &after.observations;
    let there = circumstances([before, after], known);
    let times_s = extent(all.samples.iter().filter_map(|sample| sample.t_s));
    let temp_c = mean(all.samples.iter().filter_map(|sample| sample.temp_c).collect::<Vec<_>>());
    let sizes = sizes(known, after);
    let setting = Setting { earlier: known, columns, asked, there, times_s, sizes: &sizes, temp_c, own: &[] };
    let own = LaterRecording::without_errors(setting, before).contradictions();
    let setting = Setting { own: &own, ..setting };
    let [open, locked] = all.split().map(|rows| {
        let mut part = after.picked(&rows);
        part.observations = all.picked(&rows);
        part
    });
    let (model, at_locked) = (LaterRecording::new(setting, &open), LaterRecording::new(setting, &locked));
    let search = Search::new(&model, all, &open.observations);
    let no_solution = |error| ComparisonError::of(&error, &all.channels);
    let found = search.run(&Vec::new(), &[]).map_err(no_solution)?;
    let rows = [(&model, &open), (&at_locked, &locked)].map(|(model, part)| Rows {
        model: model as &dyn Model<Label>,
        observations: &part.observations,
        unrepaired: None,
    });
    let mut diagnosis = summary(
        &search,
        &found,
        &rows,
        &missing(columns, there),
        Judgement { is_complete: false, scope: Scope::Full },
    )
    .map_err(no_solution)?;
    if there.is_repeated {
        standing(&mut diagnosis, &search, &rows, &found);
    } else {
        // No chance is known that a zero could be held against.
        diagnosis.findings.clear();
        diagnosis.unnamed_share = 0.0;
        diagnosis.unnamed_by_channel.fill(0.0);
    }
    let signals = &found.fit.linearised.readings;
    let expected: Vec<Option<[f64; 2]>> =
        signals.iter().enumerate().map(|(channel, signals)| known.noise(channel, signals)).collect();
    // Means of held loads have another noise than rows of a series.
    let has_series = |it: &Recording| it.observations.in_series().contains(&true);
    let noise = &found.fit.systems.noise;
    let excess = asked.asks_for(Effect::NoiseExcess).then(|| {
        if has_series(before) == has_series(after) {
            excess_over(&open.observations, noise, signals, &expected)
        } else {
            excess(&open.observations, noise, signals)
        }
    });
    let mut diagnosis = with_gatekeepers(diagnosis, gate, excess.unwrap_or_default());
    let own = diagnosis.findings.clone();
    // Readings at a limit that was not seen look like noise.
    let is_clipped =
        |target: Target| own.iter().any(|it| it.effect == Effect::AdcClipping && it.target == target);
    diagnosis.findings.retain(|it| it.effect != Effect::NoiseExcess || !is_clipped(it.target));
    diagnosis.findings.retain(|it| {
        asked.asks_for(it.effect) && (it.effect != Effect::ChannelOffset || is_known_zero(it, &own, columns))
    });
    diagnosis.not_detected.retain(|it| asked.asks_for(it.effect));
    unplaced(&mut diagnosis, columns);
    Ok(diagnosis)
}

/// Where no load is written nobody knows what a channel reads without any: what a gain changes then moves its zero, too, by as much as
/// nobody knows. A zero is told only beside a gain that stays.
fn is_known_zero(zero: &Finding, findings: &[Finding], columns: &Columns) -> bool {
    let acts_on = |it: &Finding| match (it.effect, it.target) {
        (Effect::ExcitationGain | Effect::ReferenceGain, _) => true,
        (Effect::ChannelGain | Effect::ChannelPolarity, target) => target == zero.target,
        (Effect::ChannelsSwapped, Target::Channels { into, from }) => {
            [into, from].iter().any(|channel| Target::Channel(*channel) == zero.target)
        }
        _ => false,
    };
    columns.has_loads() || !findings.iter().any(acts_on)
}

/// What stood for places and loads in the inference is none to be shown.
pub(in crate::diagnosis) fn unplaced(diagnosis: &mut Diagnosis, columns: &Columns) {
    let has_place = ["x_mm", "y_mm"].iter().any(|name| columns.input(name).is_some());
    for sample in &mut diagnosis.residuals.samples {
        sample.block = None;
        if !has_place {
            sample.place_mm = [0.0; 2];
        }
    }
}

fn circumstances([before, after]: [&Recording; 2], known: &EarlierRecording) -> Circumstances {
    let samples = &after.observations.samples;
    let [first, last] = extent(samples.iter().filter_map(|sample| sample.t_s));
    let in_series = samples.iter().filter(|sample| sample.trial.is_some() && sample.t_s.is_some());
    Circumstances {
        has_time: last > first && samples.iter().all(|sample| sample.t_s.is_some()),
        has_temperature: known.has_temperature(),
        has_series: in_series.count() >= SERIES_MIN,
        is_repeated: before.is_repeated && after.is_repeated,
    }
}

/// A number of four digits, as a sentence takes it.
fn short(number: f64) -> String {
    let digits = if number == 0.0 { 0 } else { (3 - number.abs().log10().floor() as i32).clamp(0, 9) };
    format!("{number:.0$}", digits as usize)
}

fn varies_in_temperature(recording: &Recording) -> bool {
    let samples = &recording.observations.samples;
    let [low, high] = extent(samples.iter().filter_map(|sample| sample.temp_c));
    high > low && samples.iter().all(|sample| sample.temp_c.is_some())
}

/// Rows that have no part in anything.
struct ExcludedRows {
    unlabelled: usize,
    beyond: usize,
}

impl ExcludedRows {
    fn notices(&self) -> Vec<Notice> {
        let notice = |detail: String| Notice { check: "missing", channel: None, detail };
        let unlabelled = format!(
            "{} with a label that is no number, or a code for none; left out; write down all labels of every row",
            counted(self.unlabelled, "row")
        );
        let beyond = format!(
            "{} with labels that the earlier recording has not; left out; what the channels should read there is not known",
            counted(self.beyond, "row")
        );
        let told = [(self.unlabelled, unlabelled), (self.beyond, beyond)];
        told.into_iter().filter(|(rows, _)| *rows > 0).map(|(_, detail)| notice(detail)).collect()
    }
}
