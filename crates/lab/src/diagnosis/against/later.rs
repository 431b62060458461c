//! A later recording of a sensor that an earlier one knows, as a model of its channels.

use super::change::{ChangeKind, Changes, Circumstances, hypotheses};
use super::columns::{ColumnSelection, Columns};
use super::earlier::{EarlierRecording, PARTS, counted};
use super::recording::Recording;
use crate::diagnosis::label::{Hypothesis, Label};
use tactpad_inference::model::{CommonError, Linearised, Model, Signature};
use tactpad_inference::observations::Sample;
use tactpad_numeric::statistics::rms;

/// Readings that change by less than this part of the largest reading do not change.
const NOTHING: f64 = 1e-9;

/// What all of the later recording has: any rows of it are held against the same.
#[derive(Clone, Copy)]
pub(super) struct Setting<'r> {
    pub(super) earlier: &'r EarlierRecording,
    pub(super) columns: &'r Columns,
    pub(super) asked: &'r ColumnSelection<'r>,
    pub(super) there: Circumstances,
    /// First and last time, and each channel's root mean square.
    pub(super) times_s: [f64; 2],
    pub(super) sizes: &'r [f64],
    /// Mean temperature.
    pub(super) temp_c: f64,
    /// What the earlier recording shows in itself of changes of all channels: their acts, which of their numbers, and how much.
    pub(super) own: &'r [(ChangeKind, usize, f64)],
}

/// The channels of some rows.
pub(super) struct LaterRecording<'r> {
    setting: Setting<'r>,
    recording: &'r Recording,
    hypotheses: Vec<Hypothesis>,
    acts: Vec<ChangeKind>,
    /// For each row, what each channel reads beside its zero if nothing has changed.
    unchanged: Vec<Vec<f64>>,
    errors: Vec<Vec<Vec<f64>>>,
}

impl<'r> LaterRecording<'r> {
    pub(super) fn new(setting: Setting<'r>, recording: &'r Recording) -> Self {
        let mut later = Self::without_errors(setting, recording);
        later.errors = (0..setting.columns.channels.len()).map(|channel| later.errors_of(channel)).collect();
        later
    }

    /// The same without what predictions may be off by.
    pub(super) fn without_errors(setting: Setting<'r>, recording: &'r Recording) -> Self {
        let Setting { earlier, columns, asked, there, .. } = setting;
        let (hypotheses, acts) =
            hypotheses(columns, &earlier.extents, there, |effect| asked.asks_for(effect)).into_iter().unzip();
        let temps = recording.observations.samples.iter().map(|sample| sample.temp_c);
        let unchanged: Vec<Vec<f64>> =
            recording.inputs.iter().zip(temps).map(|(row, temp_c)| earlier.signals(row, temp_c)).collect();
        let errors = vec![Vec::new(); columns.channels.len()];
        Self { setting, recording, hypotheses, acts, unchanged, errors }
    }

    /// How far the prediction of a channel may be off: by the regression's own error, and by what a recording does by itself.
    fn errors_of(&self, channel: usize) -> Vec<Vec<f64>> {
        let Setting { earlier, times_s: [first, last], .. } = self.setting;
        let Some(known) = &earlier.channels[channel] else { return Vec::new() };
        let samples = &self.recording.observations.samples;
        let rows: Vec<(&[f64], Option<f64>)> = self
            .recording
            .inputs
            .iter()
            .zip(samples)
            .map(|(row, sample)| (row.as_slice(), sample.temp_c))
            .collect();
        let mut errors = earlier.errors(channel, &rows);
        let count = rows.len();
        let part = |at: usize| -> f64 {
            let share = samples[at].t_s.filter(|_| last > first).map(|t_s| (t_s - first) / (last - first));
            share.unwrap_or(at as f64 / count as f64)
        };
        let mut push = |deviation: f64, of: &dyn Fn(usize) -> f64| {
            if deviation > 0.0 {
                errors.push((0..count).map(|row| deviation * of(row)).collect());
            }
        };
        push(known.zero_deviation(), &|_| 1.0);
        push(known.gain, &|row| self.unchanged[row][channel]);
        push(known.drift, &|row| part(row) - 0.5);
        for own in 0..PARTS {
            let is_own = |row: usize| ((part(row) * PARTS as f64) as usize).min(PARTS - 1) == own;
            push(known.wander, &|row| f64::from(u8::from(is_own(row))));
        }
        errors
    }

    /// What the earlier recording, of which these are the rows, shows in itself of changes that all channels share.
    pub(super) fn contradictions(&self) -> Vec<(ChangeKind, usize, f64)> {
        let samples = &self.recording.observations.samples;
        let count = samples.len();
        let counted = counted(samples, (0..count).collect());
        let mut by_row = vec![None; count];
        counted.iter().enumerate().for_each(|(at, row)| by_row[*row] = Some(at * PARTS / counted.len()));
        // Labels can only be late in a series: each is a part.
        let trials = samples.iter().filter_map(|it| it.trial).max().map_or(0, |last| last + 1);
        let by_trial: Vec<Option<usize>> = samples.iter().map(|it| it.trial).collect();
        let mut own = Vec::new();
        for (at, act) in self.acts.iter().enumerate() {
            if matches!(act, ChangeKind::Gain(Some(_)) | ChangeKind::Drift(_) | ChangeKind::Thermal(_)) {
                continue;
            }
            let parts = if *act == ChangeKind::Lag && trials > 1 { &by_trial } else { &by_row };
            for parameter in 0..self.hypotheses[at].parameters.len() {
                let deviation = self.setting.earlier.contradiction(&self.of(at, parameter), parts);
                own.push((act.clone(), parameter, deviation));
            }
        }
        own
    }

    /// ∂readings/∂ψ where nothing has changed.
    fn of(&self, at: usize, parameter: usize) -> Signature {
        if self.acts[at].is_of_channels() {
            let nothing = Changes::none(self.setting.columns.channels.len());
            return self.of_channels(&self.acts[at], &self.unchanged, &nothing);
        }
        self.of_labels(&[], [at, parameter])
    }

    fn changes(&self, applied: &[(usize, Vec<f64>)]) -> Changes {
        let mut changes = Changes::none(self.setting.columns.channels.len());
        for (at, coordinates) in applied {
            let parameters = &self.hypotheses[*at].parameters;
            let values: Vec<f64> =
                parameters.iter().zip(coordinates).map(|(it, psi)| it.value(*psi)).collect();
            changes.apply(&self.acts[*at], &values);
        }
        changes
    }

    /// For each row, what each channel reads beside its zero, before what happens in the channels.
    fn signals(&self, changes: &Changes) -> Vec<Vec<f64>> {
        let earlier = self.setting.earlier;
        if !changes.moves_labels() {
            return self.unchanged.clone();
        }
        let samples = &self.recording.observations.samples;
        let signal =
            |(row, sample): (usize, &Sample)| earlier.signals(&self.moved(row, changes), sample.temp_c);
        samples.iter().enumerate().map(signal).collect()
    }

    /// The true labels of a row.
    fn moved(&self, row: usize, changes: &Changes) -> Vec<f64> {
        let columns = self.setting.columns;
        let mut labels = self.lagged(row, changes.lag_ms);
        let [x, y, z] = ["x_mm", "y_mm", "z_mm"].map(|name| columns.input(name));
        if let (Some(x), Some(y)) = (x, y) {
            let turn = changes.rotation_deg.to_radians();
            let (sin, cos) = (libm::sin(turn), libm::cos(turn));
            (labels[x], labels[y]) = (cos * labels[x] - sin * labels[y], sin * labels[x] + cos * labels[y]);
        }
        for (at, by_mm) in [x, y, z].into_iter().zip(changes.offset_mm) {
            at.into_iter().for_each(|at| labels[at] += by_mm);
        }
        labels
    }

    /// What is written as much later as the labels are late; what is written last goes on.
    fn lagged(&self, row: usize, lag_ms: f64) -> Vec<f64> {
        let Recording { observations, inputs, .. } = self.recording;
        let samples = &observations.samples;
        let sample = &samples[row];
        let (Some(t_s), Some(_), true) = (sample.t_s, sample.trial, lag_ms != 0.0) else {
            return inputs[row].clone();
        };
        let wanted = t_s + 1e-3 * lag_ms;
        let is_of_series =
            |at: &usize| samples.get(*at).is_some_and(|it| it.trial == sample.trial && it.t_s.is_some());
        let time = |at: usize| samples[at].t_s.unwrap_or(0.0);
        // The rows around the wanted time.
        let mut low = row;
        while time(low) > wanted && low > 0 && is_of_series(&(low - 1)) {
            low -= 1;
        }
        while is_of_series(&(low + 1)) && time(low + 1) <= wanted {
            low += 1;
        }
        // Where there is no row after it, or none before, the nearest two go on.
        let high = if is_of_series(&(low + 1)) { low + 1 } else { low };
        let width = time(high) - time(low);
        if width <= 0.0 {
            return inputs[low].clone();
        }
        let share = ((wanted - time(low)) / width).clamp(0.0, 1.0);
        inputs[low].iter().zip(&inputs[high]).map(|(a, b)| a + share * (b - a)).collect()
    }

    /// Readings of the channels by their signals, channel by channel.
    fn read(&self, signals: &[Vec<f64>], changes: &Changes) -> Vec<Vec<f64>> {
        let rows = || signals.iter().enumerate();
        let channel = |k: usize| {
            let Changes { gains, drifts_per_h, zeros_per_c, .. } = changes;
            let read = |(row, signal): (usize, &Vec<f64>)| {
                gains[k] / changes.load * signal[k]
                    + drifts_per_h[k] * self.hours(row)
                    + zeros_per_c[k] * self.above_c(row)
            };
            rows().map(read).collect()
        };
        (0..self.setting.columns.channels.len()).map(channel).collect()
    }

    fn hours(&self, row: usize) -> f64 {
        let t_s = self.recording.observations.samples[row].t_s;
        t_s.map_or(0.0, |t_s| (t_s - self.setting.times_s[0]) / 3600.0)
    }

    fn above_c(&self, row: usize) -> f64 {
        self.recording.observations.samples[row].temp_c.map_or(0.0, |temp_c| temp_c - self.setting.temp_c)
    }

    /// ∂readings/∂ψ of what happens in the channels, in closed form.
    fn of_channels(&self, act: &ChangeKind, signals: &[Vec<f64>], changes: &Changes) -> Signature {
        let rows = || 0..signals.len();
        let slope = |k: usize| -> Vec<f64> {
            match act {
                ChangeKind::Gain(_) => {
                    rows().map(|row| changes.gains[k] / changes.load * signals[row][k]).collect()
                }
                ChangeKind::Load => {
                    rows().map(|row| -changes.gains[k] / changes.load * signals[row][k]).collect()
                }
                ChangeKind::Thermal(_) => rows().map(|row| self.above_c(row)).collect(),
                _ => rows().map(|row| self.hours(row)).collect(),
            }
        };
        let of = match act {
            ChangeKind::Gain(of) | ChangeKind::Drift(of) | ChangeKind::Thermal(of) => *of,
            _ => None,
        };
        let is_known = |k: &usize| self.setting.earlier.channels[*k].is_some();
        let of_channel = |k: usize| (of.is_none_or(|of| of == k) && is_known(&k)).then(|| slope(k));
        (0..self.setting.columns.channels.len()).map(of_channel).collect()
    }

    /// The same of what happens to the labels: a central difference.
    fn of_labels(&self, applied: &[(usize, Vec<f64>)], [at, parameter]: [usize; 2]) -> Signature {
        let step = self.hypotheses[at].parameters[parameter].step;
        let moved = |by: f64| {
            let mut applied = applied.to_vec();
            let own = applied.iter().position(|(index, _)| *index == at).unwrap_or(applied.len());
            if own == applied.len() {
                applied.push((at, vec![0.0; self.hypotheses[at].parameters.len()]));
            }
            applied[own].1[parameter] += by;
            self.readings(&applied)
        };
        let channels = moved(step).into_iter().zip(moved(-step)).zip(self.setting.sizes);
        channels
            .map(|((above, below), size)| {
                let slopes: Vec<f64> =
                    above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * step)).collect();
                slopes.iter().any(|slope| (slope * step).abs() > NOTHING * size).then_some(slopes)
            })
            .collect()
    }
}

impl Model<Label> for LaterRecording<'_> {
    fn hypotheses(&self) -> &[Hypothesis] {
        &self.hypotheses
    }

    fn readings(&self, applied: &[(usize, Vec<f64>)]) -> Vec<Vec<f64>> {
        let changes = self.changes(applied);
        self.read(&self.signals(&changes), &changes)
    }

    fn sizes(&self) -> Vec<f64> {
        self.setting.sizes.to_vec()
    }

    fn linearised(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        let changes = self.changes(applied);
        let signals = self.signals(&changes);
        let of = |(at, act): (usize, &ChangeKind)| {
            if act.is_of_channels() {
                return vec![self.of_channels(act, &signals, &changes)];
            }
            (0..self.hypotheses[at].parameters.len())
                .map(|parameter| self.of_labels(applied, [at, parameter]))
                .collect()
        };
        Linearised {
            readings: self.read(&signals, &changes),
            loads: self.recording.observations.samples.iter().map(|sample| sample.load).collect(),
            doubts: vec![Vec::new(); self.setting.columns.channels.len()],
            signatures: self.acts.iter().enumerate().map(of).collect(),
        }
    }

    fn common_errors(&self, _applied: &[(usize, Vec<f64>)]) -> Vec<CommonError> {
        let own = self.setting.own.iter().filter(|(.., deviation)| *deviation > 0.0);
        let signature = |act: &ChangeKind, parameter: usize| {
            let at = self.acts.iter().position(|other| other == act)?;
            Some(self.of(at, parameter))
        };
        let errors = own.filter_map(|(act, parameter, deviation)| {
            Some(CommonError { deviation: *deviation, signature: signature(act, *parameter)? })
        });
        errors.collect()
    }

    fn stated_errors(&self, channel: usize) -> &[Vec<f64>] {
        &self.errors[channel]
    }
}

/// Each channel's root mean square at rows, beside its zero.
pub(super) fn sizes(earlier: &EarlierRecording, recording: &Recording) -> Vec<f64> {
    let temps = recording.observations.samples.iter().map(|sample| sample.temp_c);
    let signals: Vec<Vec<f64>> =
        recording.inputs.iter().zip(temps).map(|(row, temp_c)| earlier.signals(row, temp_c)).collect();
    let size = |channel: usize| rms(signals.iter().map(|row| row[channel]).collect::<Vec<_>>());
    (0..earlier.channels.len()).map(|channel| size(channel).max(f64::MIN_POSITIVE.sqrt())).collect()
}
