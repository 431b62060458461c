//! Regression of channels on their labels: Gaussian-process regression in low-rank form.
//!
//! With loads l and places p, both in units of their extent, a reading is a + bᵀ c + φ(x)ᵀ w + n. The functions φ stand for a process
//! with the covariance
//!
//! ```text
//! k(x, x′) = (1 − β) lᵀl′ exp(−½ Σ |p − p′|²/λₚ²) + β exp(−½ Σ |x − x′|²/λₓ²)
//! ```
//!
//! which is linear in the loads and smooth in the place, beside a part that is only smooth. φ = L⁻¹ k(pivots, x) with L Lᵀ the
//! pivots' covariance, and the pivots are those rows that pivoted factorisation takes first. So the cost is linear in the rows. β and
//! the lengths λ have the greatest evidence over all channels together; each channel has its own size, noise and memory.
//!
//! Sources: C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning (2006), 2.7 and 5.4; S. Fine, K. Scheinberg,
//! J. Machine Learning Research 2 (2001) 243 (pivots); D. J. C. MacKay, Neural Computation 4 (1992) 415 (evidence).

mod choice;
mod kernel;
mod system;

use self::choice::{KernelSelection, RATIOS};
pub use self::kernel::{Group, Labels};
use self::kernel::{Kernel, pivots, scale, scaled};
use self::system::{Solution, System};
use crate::covariance::whitening::Whitening;
use crate::error::{InferenceError, Stage};
use crate::noise::NoiseLevel;

use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::{population_deviation, rms};

/// Pivots at most.
const PIVOTS_MAX: usize = 220;
/// Steps of the search for a channel's ratio, by the golden section over its logarithm.
const SECTIONS: usize = 12;
const GOLDEN: f64 = 0.618_034;
/// How often noise and regression are found in turn.
const NOISE_ROUNDS: usize = 2;

/// The functions of a regression.
#[derive(Clone, Debug)]
pub struct Regression {
    groups: Vec<Group>,
    /// For each group, its inputs' middles and their extent.
    scales: Vec<(Vec<f64>, f64)>,
    kernel: Kernel,
    pivots: Vec<Vec<f64>>,
    factor: LargeFactor,
    others: usize,
}

/// A channel's regression.
#[derive(Clone, Debug)]
pub struct RegressionFit {
    weights: Vec<f64>,
    /// Of the weights' precision.
    factor: LargeFactor,
    /// Standard deviation of what the precision's unit is.
    deviation: f64,
    /// Of a row.
    pub noise: NoiseLevel,
    /// Of the noise, from row to row of a series.
    pub memory: f64,
    /// Effective degrees of freedom of the weights.
    pub freedom: f64,
}

impl Regression {
    /// Chooses the kernel by the `readings` of all channels.
    ///
    /// # Errors
    /// These rows have no unique solution.
    pub fn of(labels: &Labels, readings: &[Vec<f64>]) -> Result<Self, InferenceError> {
        Self::chosen(labels, readings).ok_or_else(|| no_solution(readings.iter().flatten()))
    }

    fn chosen(labels: &Labels, readings: &[Vec<f64>]) -> Option<Self> {
        let scales: Vec<(Vec<f64>, f64)> =
            labels.groups.iter().map(|group| scale(group, &labels.rows)).collect();
        let rows: Vec<Vec<f64>> =
            labels.rows.iter().map(|row| scaled(&labels.groups, &scales, row)).collect();
        let kernel = KernelSelection::of(labels, &rows, readings).chosen(labels)?;
        let others = labels.others.first().map_or(0, Vec::len);
        let (pivots, factor) = pivots(&labels.groups, &kernel, &rows, PIVOTS_MAX)?;
        let pivots = pivots.into_iter().map(|at| rows[at].clone()).collect();
        Some(Self { groups: labels.groups.clone(), scales, kernel, pivots, factor, others })
    }

    /// The functions at a row: 1, the linear ones, φ.
    pub fn functions(&self, row: &[f64], others: &[f64]) -> Vec<f64> {
        let mut functions = vec![1.0];
        functions.extend((0..self.others).map(|at| others.get(at).copied().unwrap_or(0.0)));
        functions.extend(self.smooth(row).0);
        functions
    }

    /// The functions at each row of these labels.
    pub fn functions_at(&self, labels: &Labels) -> Vec<Vec<f64>> {
        labels.rows.iter().zip(&labels.others).map(|(row, others)| self.functions(row, others)).collect()
    }

    /// The part of the process' variance of which the functions know nothing at a row: how far that is from all that were seen.
    pub fn unknown(&self, row: &[f64]) -> f64 {
        let (functions, whole) = self.smooth(row);
        // Under a small load nothing much can be unknown: loads have a mean square of 1.
        (whole - dot(&functions, &functions)).max(0.0) / whole.max(1.0)
    }

    fn smooth(&self, row: &[f64]) -> (Vec<f64>, f64) {
        let functions = self.factor.solve_lower(&self.covariances(row));
        let row = scaled(&self.groups, &self.scales, row);
        (functions, self.kernel.of(&self.groups, &row, &row))
    }

    /// The covariances of a row with the pivots.
    pub fn covariances(&self, row: &[f64]) -> Vec<f64> {
        let row = scaled(&self.groups, &self.scales, row);
        self.pivots.iter().map(|pivot| self.kernel.of(&self.groups, pivot, &row)).collect()
    }

    /// What a fit's smooth part is of these covariances: φᵀ w = kᵀ (L⁻ᵀ w), which costs no solution for each row.
    pub fn spread(&self, fit: &RegressionFit) -> Vec<f64> {
        self.factor.solve_upper(&fit.weights[1 + self.others..])
    }

    /// The regression of a channel by the functions at its rows, row by row. `is_told` says which readings count, `follows` which rows
    /// go on with the row before.
    ///
    /// # Errors
    /// These rows have no unique solution.
    pub fn fitted(
        &self,
        functions: &[Vec<f64>],
        readings: &[f64],
        is_told: &[bool],
        follows: &[bool],
    ) -> Result<RegressionFit, InferenceError> {
        let fit = self.fitted_in_turn(functions, readings, is_told, follows);
        fit.ok_or_else(|| no_solution(readings.iter()))
    }

    /// Weights and noise, which follow from each other.
    fn fitted_in_turn(
        &self,
        functions: &[Vec<f64>],
        readings: &[f64],
        is_told: &[bool],
        follows: &[bool],
    ) -> Option<RegressionFit> {
        let count = functions.first()?.len();
        let columns: Vec<Vec<f64>> =
            (0..count).map(|at| functions.iter().map(|row| row[at]).collect()).collect();
        let told: Vec<f64> =
            readings.iter().zip(is_told).filter(|(_, told)| **told).map(|(y, _)| *y).collect();
        let size = population_deviation(&told);
        let mut level = NoiseLevel::first(&[size.max(f64::MIN_POSITIVE.sqrt())]);
        let (mut variances, mut memory) = (vec![level.variance(0.0); readings.len()], 0.0);
        let mut fit = None;
        for round in 0..=NOISE_ROUNDS {
            for (variance, is_told) in variances.iter_mut().zip(is_told) {
                *variance = if *is_told { *variance } else { f64::INFINITY };
            }
            let whitening = Whitening::of(&variances, follows, memory);
            let (mut found, left) = self.solved(&columns, readings, &whitening)?;
            if round < NOISE_ROUNDS {
                // The signal that noise grows with is what goes with the labels.
                let signal: Vec<f64> = functions.iter().map(|row| found.signal(row)).collect();
                let plain: Vec<f64> =
                    functions.iter().zip(readings).map(|(row, y)| y - found.value(row)).collect();
                let kept = |of: &[f64]| -> Vec<f64> {
                    of.iter().zip(is_told).filter(|(_, told)| **told).map(|(value, _)| *value).collect()
                };
                let ratio = (1.0 - found.freedom / told.len() as f64).max(0.1);
                let squares: Vec<f64> = kept(&plain).iter().map(|left| left * left / ratio).collect();
                let signal_told = kept(&signal);
                level = NoiseLevel::of(&squares, &signal_told, rms(signal_told.iter().copied()));
                variances = signal.iter().map(|signal| level.variance(*signal)).collect();
                memory = whitening.memory_of(&left);
            }
            (found.noise, found.memory) = (level, memory);
            fit = Some(found);
        }
        fit
    }

    /// The weights at the ratio of noise to signal with the greatest evidence, and what they leave, whitened.
    fn solved(
        &self,
        columns: &[Vec<f64>],
        readings: &[f64],
        whitening: &Whitening,
    ) -> Option<(RegressionFit, Vec<f64>)> {
        let columns: Vec<Vec<f64>> = columns.iter().map(|column| whitening.whitened(column)).collect();
        let readings = whitening.whitened(readings);
        let system = System::of(&columns, &readings, 1 + self.others, whitening.told());
        let (mut low, mut high) = (RATIOS[0].ln() - 6.0, RATIOS[RATIOS.len() - 1].ln() + 4.0);
        // Whitened columns are as large as one over the noise.
        let unit = whitening.weights.iter().fold(0.0, |most: f64, weight| most.max(weight * weight)).ln();
        (low, high) = (low + unit, high + unit);
        let at = |log: f64| system.at(log.exp()).map(|it| it.evidence);
        let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let mut evidence = [at(inner[0])?, at(inner[1])?];
        for _ in 0..SECTIONS {
            if evidence[0] > evidence[1] {
                high = inner[1];
                inner = [high - GOLDEN * (high - low), inner[0]];
                evidence = [at(inner[0])?, evidence[0]];
            } else {
                low = inner[0];
                inner = [inner[1], low + GOLDEN * (high - low)];
                evidence = [evidence[1], at(inner[1])?];
            }
        }
        let ratio = f64::midpoint(low, high).exp();
        let Solution { factor, weights, variance, .. } = system.at(ratio)?;
        let mut left = readings;
        for (weight, column) in weights.iter().zip(&columns) {
            left.iter_mut().zip(column).for_each(|(left, value)| *left -= weight * value);
        }
        // tr((XᵀX + P)⁻¹ XᵀX) = K − Σ P (XᵀX + P)⁻¹.
        let inverse = factor.inverse_diagonal();
        let untold: f64 = inverse.iter().enumerate().map(|(at, own)| own * system.precision(at, ratio)).sum();
        let freedom = weights.len() as f64 - untold;
        let noise = NoiseLevel::first(&[1.0]);
        Some((
            RegressionFit { weights, factor, deviation: variance.sqrt(), noise, memory: 0.0, freedom },
            left,
        ))
    }
}

/// No unique solution of these readings.
fn no_solution<'r>(mut readings: impl Iterator<Item = &'r f64>) -> InferenceError {
    let is_finite = readings.all(|reading| reading.is_finite());
    InferenceError { stage: Stage::Regression, channel: None, is_finite }
}

impl RegressionFit {
    /// The reading that these functions let expect.
    pub fn value(&self, functions: &[f64]) -> f64 {
        dot(&self.weights, functions)
    }

    /// The same without the constant.
    pub fn signal(&self, functions: &[f64]) -> f64 {
        self.value(functions) - self.zero()
    }

    /// The constant.
    pub fn zero(&self) -> f64 {
        self.weights.first().copied().unwrap_or(0.0)
    }

    /// One of the linear weights, and its standard deviation.
    pub fn slope(&self, at: usize) -> [f64; 2] {
        let unit: Vec<f64> = (0..self.weights.len()).map(|k| f64::from(u8::from(k == 1 + at))).collect();
        [self.weights[1 + at], self.variance(&unit).sqrt()]
    }

    /// The error of [`Self::value`], as a sum of independent ones of deviation 1: the same ones for all rows.
    pub fn errors(&self, functions: &[f64]) -> Vec<f64> {
        self.factor.solve_lower(functions).into_iter().map(|value| self.deviation * value).collect()
    }

    /// The variance of [`Self::value`].
    pub fn variance(&self, functions: &[f64]) -> f64 {
        let errors = self.errors(functions);
        dot(&errors, &errors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;
    use tactpad_numeric::statistics::rms;

    fn groups() -> Vec<Group> {
        vec![Group { inputs: vec![0, 1], is_load: false }, Group { inputs: vec![2, 3], is_load: true }]
    }

    /// Two channels that are linear in two loads and smooth in the place, with noise of 0.5 % and a drift.
    fn measured(seed: u64, rows: usize) -> (Labels, Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let mut random = SplitMix64::new(seed);
        let mut labels = Labels { groups: groups(), ..Labels::default() };
        let (mut readings, mut truths) = (vec![Vec::new(); 2], vec![Vec::new(); 2]);
        for row in 0..rows {
            let [x, y, fx, fy] =
                [29.0, 29.0, 2.0, 5.0].map(|size| size * (2.0 * f64::from(random.fraction()) - 1.0));
            let t = row as f64 / rows as f64;
            for channel in 0..2 {
                let phase = channel as f64;
                let truth = 30.0
                    + 4.0 * t
                    + fx * 90.0 * libm::sin(x / 15.0 + phase)
                    + fy * 120.0 * libm::cos(y / 20.0);
                truths[channel].push(truth);
                readings[channel].push(truth + 1.5 * f64::from(random.normal()));
            }
            labels.rows.push(vec![x, y, fx, fy]);
            labels.others.push(vec![t]);
        }
        (labels, readings, truths)
    }

    #[test]
    fn predictions_miss_by_as_much_as_they_say() {
        let (labels, readings, _) = measured(3, 300);
        let regression = Regression::of(&labels, &readings).unwrap();
        let (new, _, truths) = measured(4, 300);
        for channel in 0..2 {
            let fit = regression
                .fitted(&regression.functions_at(&labels), &readings[channel], &[true; 300], &[false; 300])
                .unwrap();
            let at = regression.functions_at(&new);
            let scores = truths[channel]
                .iter()
                .zip(&at)
                .map(|(y, row)| (y - fit.value(row)) / fit.variance(row).sqrt());
            let score = rms(scores.collect::<Vec<_>>().iter().copied());
            let missed =
                rms(truths[channel].iter().zip(&at).map(|(y, row)| y - fit.value(row)).collect::<Vec<_>>());
            assert!(score > 0.6 && score < 1.5, "{score}");
            assert!(missed < 1.5, "{missed}");
            let [slope, deviation] = fit.slope(0);
            assert!((slope - 4.0).abs() < 4.0 * deviation && deviation < 2.0, "{slope} {deviation}");
            assert!((fit.noise.variance(0.0).sqrt() - 1.5).abs() < 0.4, "{:?}", fit.noise);
        }
    }

    #[test]
    fn rows_far_from_all_others_are_unknown() {
        let (labels, readings, _) = measured(5, 200);
        let regression = Regression::of(&labels, &readings).unwrap();
        let known = regression.unknown(&labels.rows[7]);
        assert!(known < 1e-3, "{known}");
        let far = regression.unknown(&[90.0, 90.0, 8.0, 8.0]);
        assert!(far > 0.5, "{far}");
    }
}
