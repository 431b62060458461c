//! Prediction of a sensor by an earlier recording, how far that may be off, and how far the recording contradicts itself.
//!
//! A recording is cut into parts. What zero and gain of a channel differ by from part to part, beyond chance, is what a sensor does by
//! itself; and so is a zero's drift over the recording. No more than that is expected of a later one, either.

use super::columns::{Columns, extent};
use super::recording::Recording;
use super::unfit::{ComparisonError, ROWS_MIN};
use tactpad_inference::error::InferenceError;
use tactpad_inference::model::Signature;
use tactpad_inference::observations::Sample;
use tactpad_inference::regression::{Labels, Regression, RegressionFit};
use tactpad_numeric::statistics::{mean, population_deviation, rms};

/// Parts that a recording is held against itself in.
pub(super) const PARTS: usize = 6;
/// A row of which the regression knows less than this is beyond what was recorded.
const UNKNOWN_MAX: f64 = 0.02;
/// How far a label may lie beyond the earlier ones, as a share of their range.
const BEYOND: f64 = 0.1;
/// Directions of the prediction's error at most; those that are left out have less than this part of the noise in any row.
const ERRORS_MAX: usize = 160;
const ERROR_MIN: f64 = 0.01;
/// A channel goes with the labels whose gain is known better than to this.
const GAIN_ERROR_MAX: f64 = 0.1;
/// Fewer degrees of freedom than this say nothing of a deviation.
const FREEDOM_MIN: f64 = 0.5;
/// Static samples are enough from so many on.
const STATIC_MIN: usize = 2 * ROWS_MIN;

/// A sensor as an earlier recording knows it.
#[derive(Clone, Debug)]
pub(super) struct EarlierRecording {
    regression: Regression,
    /// None: too little is told of the channel.
    pub(super) channels: Vec<Option<Channel>>,
    /// Each input's least and greatest value.
    pub(super) extents: Vec<[f64; 2]>,
    /// Mean temperature, where it varies.
    temp_c: Option<f64>,
    has_time: bool,
}

/// A channel as the earlier recording knows it.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) fit: RegressionFit,
    /// Weights of the covariances with the pivots.
    spread: Vec<f64>,
    /// By how much the zero differs from part to part, as a standard deviation, and drifts over the recording.
    pub(super) wander: f64,
    pub(super) drift: f64,
    /// By how much the gain differs from part to part.
    pub(super) gain: f64,
    /// Standard deviation of its gain over the recording.
    gain_error: f64,
    /// Residual of each row, and one over its variance; 0 where nothing is told.
    left: Vec<[f64; 2]>,
}

/// Zero and gain of a part, and their variances.
#[derive(Clone, Copy)]
struct PartZeroGain {
    zero: [f64; 2],
    gain: [f64; 2],
}

impl EarlierRecording {
    pub(super) fn of(
        recording: &Recording,
        columns: &Columns,
        has_temperature: bool,
    ) -> Result<Self, ComparisonError> {
        let samples = &recording.observations.samples;
        let has_time = samples.iter().all(|sample| sample.t_s.is_some());
        let temp_c = has_temperature
            .then(|| mean(samples.iter().filter_map(|sample| sample.temp_c).collect::<Vec<_>>()));
        let labels = Labels {
            groups: columns.groups.clone(),
            rows: recording.inputs.clone(),
            others: others(recording, has_time, temp_c),
        };
        let observations = &recording.observations;
        let alive: Vec<usize> = (0..observations.channels.len())
            .filter(|channel| observations.is_told[*channel].iter().filter(|it| **it).count() >= ROWS_MIN)
            .collect();
        let readings: Vec<Vec<f64>> = alive.iter().map(|channel| centred(recording, *channel)).collect();
        let no_solution = |error| ComparisonError::of(&error, &observations.channels);
        let regression = Regression::of(&labels, &readings).map_err(no_solution)?;
        let functions = regression.functions_at(&labels);
        let mut channels = vec![None; observations.channels.len()];
        for channel in alive {
            let known = EarlierChannel { recording, functions: &functions, channel };
            let fit = known.fitted(&regression).map_err(|error| no_solution(error.in_channel(channel)))?;
            let own = known.parts(&fit);
            channels[channel] = Some(Channel {
                wander: between(own.iter().map(|part| part.zero)),
                gain: between(own.iter().map(|part| part.gain)),
                gain_error: own.iter().map(|part| part.gain[1].recip()).sum::<f64>().sqrt().recip(),
                drift: if has_time { beyond_chance(fit.slope(0)) } else { 0.0 },
                spread: regression.spread(&fit),
                left: known.left(&fit),
                fit,
            });
        }
        pool(&mut channels, &functions);
        let extents = (0..columns.inputs.len()).map(|at| extent(recording.inputs.iter().map(|row| row[at])));
        Ok(Self { regression, channels, extents: extents.collect(), temp_c, has_time })
    }

    /// Whether what is expected at a row is known: its labels are within those of the earlier recording, and near some of them.
    pub(super) fn reaches(&self, row: &[f64]) -> bool {
        let is_within = |(value, [low, high]): (&f64, &[f64; 2])| {
            let beyond = BEYOND * (high - low);
            (low - beyond..=high + beyond).contains(value)
        };
        row.iter().zip(&self.extents).all(is_within) && self.regression.unknown(row) < UNKNOWN_MAX
    }

    /// Signal of each channel beside its zero under these labels; nothing for one that is not known.
    pub(super) fn signals(&self, row: &[f64], temp_c: Option<f64>) -> Vec<f64> {
        let with = self.regression.covariances(row);
        let above_c = self.above_c(temp_c);
        let signal = |channel: &Option<Channel>| {
            channel.as_ref().map_or(0.0, |it| {
                let warm = if self.temp_c.is_some() {
                    above_c * it.fit.slope(usize::from(self.has_time))[0]
                } else {
                    0.0
                };
                tactpad_numeric::products::dot(&it.spread, &with) + warm
            })
        };
        self.channels.iter().map(signal).collect()
    }

    /// The mean square of a channel's noise that is expected at these signals, and its relative variance.
    pub(super) fn noise(&self, channel: usize, signals: &[f64]) -> Option<[f64; 2]> {
        let Channel { fit, left, .. } = self.channels[channel].as_ref()?;
        let told = left.iter().filter(|[_, weight]| *weight > 0.0).count();
        let square = mean(signals.iter().map(|signal| fit.noise.variance(*signal)).collect::<Vec<_>>());
        Some([square, 2.0 * correlated(fit) / told as f64])
    }

    /// Whether zeros are known by temperature.
    pub(super) const fn has_temperature(&self) -> bool {
        self.temp_c.is_some()
    }

    fn above_c(&self, temp_c: Option<f64>) -> f64 {
        self.temp_c.zip(temp_c).map_or(0.0, |(middle, now)| now - middle)
    }

    /// How large a change of this signature the earlier recording shows in itself, as a standard deviation: what it differs by from part
    /// to part, and what all parts have of it. `parts` has the part of each row.
    pub(super) fn contradiction(&self, signature: &Signature, parts: &[Option<usize>]) -> f64 {
        let count = parts.iter().flatten().max().map_or(0, |last| last + 1);
        let mut sums = vec![[0.0; 2]; count];
        for (channel, signature) in self.channels.iter().zip(signature) {
            let (Some(Channel { left, .. }), Some(signature)) = (channel, signature) else { continue };
            let whole: f64 = left.iter().map(|it| it[1]).sum();
            let middle = left.iter().zip(signature).map(|(it, slope)| it[1] * slope).sum::<f64>() / whole;
            for (([left, weight], slope), part) in left.iter().zip(signature).zip(parts) {
                let (slope, Some(part)) = (slope - middle, part) else { continue };
                sums[*part][0] += weight * slope * left;
                sums[*part][1] += weight * slope * slope;
            }
        }
        let all = sums.iter().fold([0.0; 2], |all, it| [all[0] + it[0], all[1] + it[1]]);
        let own = between(sums.iter().map(|[product, square]| [product / square, 1.0 / square]));
        let common = if all[1] > 0.0 { beyond_chance([all[0] / all[1], all[1].sqrt().recip()]) } else { 0.0 };
        libm::hypot(own, common)
    }

    /// The errors of a channel's prediction at rows, as independent columns of deviation 1.
    pub(super) fn errors(&self, channel: usize, rows: &[(&[f64], Option<f64>)]) -> Vec<Vec<f64>> {
        let Some(Channel { fit, .. }) = &self.channels[channel] else { return Vec::new() };
        let errors = rows.iter().map(|(row, temp_c)| {
            let mut others = vec![0.0; usize::from(self.has_time)];
            others.extend(self.temp_c.map(|_| self.above_c(*temp_c)));
            fit.errors(&self.regression.functions(row, &others))
        });
        leading(&errors.collect::<Vec<_>>(), ERROR_MIN * fit.noise.variance(0.0))
    }
}

impl Channel {
    /// Zero of the channel under no load, or whatever else makes its signal none.
    pub(super) fn zero(&self) -> f64 {
        self.fit.zero()
    }

    /// How far its zero may be off in another recording.
    pub(super) fn zero_deviation(&self) -> f64 {
        libm::hypot(self.wander, self.drift)
    }
}

/// A channel of a recording.
struct EarlierChannel<'r> {
    recording: &'r Recording,
    functions: &'r [Vec<f64>],
    channel: usize,
}

impl EarlierChannel<'_> {
    fn fitted(&self, regression: &Regression) -> Result<RegressionFit, InferenceError> {
        let observations = &self.recording.observations;
        let (readings, is_told) = (&observations.readings[self.channel], &observations.is_told[self.channel]);
        regression.fitted(self.functions, readings, is_told, &observations.follows())
    }

    /// Residuals of the fit, and their weights.
    fn left(&self, fit: &RegressionFit) -> Vec<[f64; 2]> {
        let observations = &self.recording.observations;
        let correlated = correlated(fit);
        let rows = observations.readings[self.channel].iter().zip(&observations.is_told[self.channel]);
        let left = |((y, is_told), functions): ((&f64, &bool), &Vec<f64>)| {
            let variance = correlated * fit.noise.variance(fit.signal(functions));
            if *is_told { [y - fit.value(functions), 1.0 / variance] } else { [0.0; 2] }
        };
        rows.zip(self.functions).map(left).collect()
    }

    /// Zero and gain of what the fit leaves, part by part.
    fn parts(&self, fit: &RegressionFit) -> Vec<PartZeroGain> {
        let observations = &self.recording.observations;
        let (readings, is_told) = (&observations.readings[self.channel], &observations.is_told[self.channel]);
        let told: Vec<usize> = (0..readings.len()).filter(|row| is_told[*row]).collect();
        let shrunk = (1.0 - fit.freedom / told.len() as f64).max(0.1).sqrt();
        let rows = counted(&observations.samples, told);
        let correlated = correlated(fit);
        let part = |at: usize| {
            let own = &rows[at * rows.len() / PARTS..(at + 1) * rows.len() / PARTS];
            let told: Vec<[f64; 3]> = own
                .iter()
                .map(|row| {
                    let functions = &self.functions[*row];
                    let signal = fit.signal(functions);
                    [
                        signal,
                        (readings[*row] - fit.value(functions)) / shrunk,
                        1.0 / fit.noise.variance(signal),
                    ]
                })
                .collect();
            PartZeroGain::of(&told, correlated)
        };
        (0..PARTS).map(part).collect()
    }
}

impl PartZeroGain {
    /// By weighted least squares of what is left on 1 and the signal; rows are signal, what is left, weight.
    fn of(rows: &[[f64; 3]], correlated: f64) -> Self {
        let whole: f64 = rows.iter().map(|[.., weight]| weight).sum();
        let mean = |of: usize| rows.iter().map(|row| row[2] * row[of]).sum::<f64>() / whole;
        let [signal, zero] = [mean(0), mean(1)];
        let square: f64 = rows.iter().map(|[s, _, weight]| weight * (s - signal).powi(2)).sum();
        let product: f64 = rows.iter().map(|[s, left, weight]| weight * (s - signal) * left).sum();
        Self { zero: [zero, correlated / whole], gain: [product / square, correlated / square] }
    }
}

/// The rows by which a recording is held against itself: static samples where there are enough, as the rows of a time series have their
/// errors together.
pub(super) fn counted(samples: &[Sample], rows: Vec<usize>) -> Vec<usize> {
    let is_static = |row: &&usize| samples[**row].trial.is_none();
    let samples: Vec<usize> = rows.iter().filter(is_static).copied().collect();
    if samples.len() < STATIC_MIN { rows } else { samples }
}

/// How many rows say as much as one that the row before does not foretell.
fn correlated(fit: &RegressionFit) -> f64 {
    (1.0 + fit.memory) / (1.0 - fit.memory)
}

/// The standard deviation τ of values vᵢ beyond their variances σᵢ², by moments (DerSimonian and Laird, Controlled Clinical Trials 7 (1986)
/// 177), each counting by what it tells, as large as few values leave it open:
///
/// ```text
/// wᵢ = 1/σᵢ²,   W = Σ wᵢ,   v̄ = Σ wᵢ vᵢ/W
/// τ² = (Σ wᵢ (vᵢ − v̄)² − (B − 1))/(W − Σ wᵢ²/W)
/// ν = W²/Σ wᵢ² − 1,   times (t/z)² of ν degrees of freedom, at 95 %
/// ```
fn between(parts: impl Iterator<Item = [f64; 2]>) -> f64 {
    let parts = parts.map(|[value, variance]| [value, variance.recip()]);
    let parts: Vec<[f64; 2]> =
        parts.filter(|[value, weight]| value.is_finite() && weight.is_normal()).collect();
    let whole: f64 = parts.iter().map(|[_, weight]| weight).sum();
    let squared: f64 = parts.iter().map(|[_, weight]| weight * weight).sum();
    let middle = parts.iter().map(|[value, weight]| weight * value).sum::<f64>() / whole;
    let square: f64 = parts.iter().map(|[value, weight]| weight * (value - middle).powi(2)).sum();
    if parts.len() < 2 {
        return 0.0;
    }
    let beyond = (square - (parts.len() as f64 - 1.0)).max(0.0) / (whole - squared / whole);
    beyond.sqrt() * widened(whole * whole / squared - 1.0)
}

/// The quantile of Student's t at 95 %, both ways, over the normal one. Source: D. L. Wallace, Ann. Math. Stat. 30 (1959) 1124; to 1 %
/// from 4 degrees of freedom on, and never too small.
fn widened(freedom: f64) -> f64 {
    let normal = 1.96;
    let freedom = freedom.max(FREEDOM_MIN);
    let z: f64 = normal * (8.0 * freedom + 3.0) / (8.0 * freedom + 1.0);
    (freedom * libm::expm1(z * z / freedom)).sqrt() / normal
}

/// Few parts tell little of what a channel does by itself: half of it is what all channels do, relative to their signals. One that hardly
/// goes with the labels has no part in that.
fn pool(channels: &mut [Option<Channel>], functions: &[Vec<f64>]) {
    let size = |it: &Channel| {
        let signals: Vec<f64> = functions.iter().map(|row| it.fit.signal(row)).collect();
        population_deviation(&signals).max(f64::MIN_POSITIVE.sqrt())
    };
    let sizes: Vec<f64> = channels.iter().flatten().map(size).collect();
    let sure = channels.iter().flatten().zip(&sizes).filter(|(it, _)| it.gain_error < GAIN_ERROR_MAX);
    let shares: Vec<[f64; 3]> = sure.map(|(it, size)| [it.wander / size, it.drift / size, it.gain]).collect();
    let pooled = [0, 1, 2].map(|at| rms(shares.iter().map(|it| it[at])));
    for (channel, size) in channels.iter_mut().flatten().zip(sizes) {
        let half = |own: f64, pooled: f64| rms([own, pooled]);
        channel.wander = half(channel.wander, pooled[0] * size);
        channel.drift = half(channel.drift, pooled[1] * size);
        channel.gain = half(channel.gain, pooled[2]);
    }
}

/// A number beyond what its standard deviation makes of none.
fn beyond_chance([value, deviation]: [f64; 2]) -> f64 {
    (value * value - deviation * deviation).max(0.0).sqrt()
}

/// What acts linearly: time, in units of the recording about its middle, and temperature about its mean.
fn others(recording: &Recording, has_time: bool, temp_c: Option<f64>) -> Vec<Vec<f64>> {
    let samples = &recording.observations.samples;
    let [first, last] = extent(samples.iter().filter_map(|sample| sample.t_s));
    let time =
        |t_s: f64| if last > first { (t_s - f64::midpoint(first, last)) / (last - first) } else { 0.0 };
    let of_row = |sample: &Sample| {
        let mut others: Vec<f64> = sample.t_s.filter(|_| has_time).map(time).into_iter().collect();
        others.extend(temp_c.map(|middle| sample.temp_c.map_or(0.0, |now| now - middle)));
        others
    };
    samples.iter().map(of_row).collect()
}

/// A channel's readings about their mean, with that in the place of readings that tell nothing.
fn centred(recording: &Recording, channel: usize) -> Vec<f64> {
    let observations = &recording.observations;
    let all = observations.readings[channel].iter().zip(&observations.is_told[channel]);
    let middle = mean(all.clone().filter(|(_, told)| **told).map(|(y, _)| *y).collect::<Vec<_>>());
    all.map(|(y, told)| if *told { y - middle } else { 0.0 }).collect()
}

/// Fewer columns with the same products between rows, but for less than `least` in any row: pivoted factorisation.
fn leading(rows: &[Vec<f64>], least: f64) -> Vec<Vec<f64>> {
    use tactpad_numeric::products::dot;
    let mut left: Vec<f64> = rows.iter().map(|row| dot(row, row)).collect();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    while columns.len() < ERRORS_MAX {
        let (next, largest) = left
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (at, left)| if *left > best.1 { (at, *left) } else { best });
        if largest <= least {
            break;
        }
        let mut column: Vec<f64> = rows.iter().map(|row| dot(row, &rows[next])).collect();
        for before in &columns {
            let factor = before[next];
            column.iter_mut().zip(before).for_each(|(value, before)| *value -= factor * before);
        }
        column.iter_mut().for_each(|value| *value /= largest.sqrt());
        left.iter_mut().zip(&column).for_each(|(left, value)| *left = (*left - value * value).max(0.0));
        left[next] = 0.0;
        columns.push(column);
    }
    columns
}
