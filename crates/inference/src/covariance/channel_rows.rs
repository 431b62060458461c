//! The system of one channel, with the noise that its own residual tells.

use super::basis::Prior;
use super::system::ChannelSystem;
use super::whitening::Whitening;
use crate::error::{InferenceError, Stage, factorised};
use crate::model::Column;
use crate::noise::Noise;
use crate::observations::Observations;
use crate::policy::BACKGROUND_MAX;
use tactpad_numeric::statistics::{population_deviation, rms};

/// A column's prior while noise is estimated, as a share of the channel's root mean square.
const SIGNATURE_PRIOR: f64 = 0.1;
/// How often noise and what surrounds it are found in turn.
const NOISE_ROUNDS: usize = 3;
/// The same from a noise that is nearly right.
const NOISE_ROUNDS_AGAIN: usize = 1;
/// Least part of the rows that count as degrees of freedom.
const FREEDOM_RATIO_MIN: f64 = 0.1;

/// Rows, background and errors of which a channel's system is made.
pub(crate) struct ChannelRows<'r> {
    pub(crate) observations: &'r Observations,
    pub(crate) channel: usize,
    pub(crate) modelled: &'r [f64],
    pub(crate) doubts: &'r [f64],
    pub(crate) errors: &'r [Vec<f64>],
    pub(crate) background: Vec<Vec<f64>>,
    pub(crate) columns: &'r [Column<'r>],
    pub(crate) in_series: &'r [bool],
    pub(crate) follows: &'r [bool],
}

impl ChannelRows<'_> {
    /// The system, with the noise that its own residual tells.
    pub(crate) fn system(
        &self,
        wide: &Prior,
        before: Option<(Noise, f64)>,
    ) -> Result<(ChannelSystem, Noise), InferenceError> {
        let readings = &self.observations.readings[self.channel];
        let residual: Vec<f64> = readings.iter().zip(self.modelled).map(|(y, f)| y - f).collect();
        let rounds = if before.is_some() { NOISE_ROUNDS_AGAIN } else { NOISE_ROUNDS };
        let (mut level, mut memory) = before.unwrap_or_else(|| (Noise::first(self.modelled), 0.0));
        for _ in 0..if self.observations.is_alive(self.channel) { rounds } else { 0 } {
            let system = self.with(&residual, &level, memory)?;
            (level, memory) = self.estimated_noise(&system, &level, wide)?;
        }
        Ok((self.with(&residual, &level, memory)?, level))
    }

    /// The system with this noise.
    fn with(&self, residual: &[f64], level: &Noise, memory: f64) -> Result<ChannelSystem, InferenceError> {
        let is_told = &self.observations.is_told[self.channel];
        let variance = |(row, is_told): (usize, &bool)| {
            let doubt = self.doubts.get(row).copied().unwrap_or_default();
            if *is_told {
                level.variance(self.modelled[row], self.in_series[row]) + doubt * doubt
            } else {
                f64::INFINITY
            }
        };
        let variances: Vec<f64> = is_told.iter().enumerate().map(variance).collect();
        let own: Vec<(usize, &[f64])> = self
            .columns
            .iter()
            .enumerate()
            .filter_map(|(number, column)| Some((number, column[self.channel].as_deref()?)))
            .collect();
        let whitening = Whitening::of(&variances, self.follows, memory);
        ChannelSystem::of(&own, &self.background, self.errors, residual, whitening)
    }

    /// The noise and its memory, when all causes and a large background are fitted with wide priors: what nothing smooth explains.
    fn estimated_noise(
        &self,
        system: &ChannelSystem,
        level: &Noise,
        wide: &Prior,
    ) -> Result<(Noise, f64), InferenceError> {
        let shares = [2.0 * BACKGROUND_MAX; 3];
        let reduced = system.equations.reduced(wide, &shares)?;
        let mut inner = reduced.fisher.clone();
        let weights = &system.whitening.weights;
        let rows = system.whitening.told() as f64;
        let priors = wide_precisions(system, self.modelled);
        priors.iter().enumerate().for_each(|(at, precision)| inner.row_mut(at)[at] += precision);
        let factor = factorised(&inner, Stage::Noise)?;
        let coordinates = factor.solve(&reduced.score);
        let z = reduced.factor.solve(&system.equations.background_score(&coordinates));
        let left = system.left_over(&coordinates, &z);
        let told: Vec<usize> = (0..left.len()).filter(|row| weights[*row] > 0.0).collect();
        let modelled: Vec<f64> = told.iter().map(|row| self.modelled[*row]).collect();
        let in_series: Vec<bool> = told.iter().map(|row| self.in_series[*row]).collect();
        let deviation = |row: &usize| level.variance(self.modelled[*row], self.in_series[*row]).sqrt();
        let residual: Vec<f64> = told.iter().map(|row| left[*row] * deviation(row)).collect();
        // Σ (1 − P Var): what the rows, not the priors, tell.
        let told = |inverse: Vec<f64>, precisions: &mut dyn Iterator<Item = f64>| -> f64 {
            inverse
                .iter()
                .zip(precisions)
                .map(|(variance, precision)| (1.0 - variance * precision).max(0.0))
                .sum()
        };
        let effective = told(factor.inverse_diagonal(), &mut priors.iter().copied())
            + reduced.freedom(wide, &shares).iter().sum::<f64>()
            + system.stated.freedom();
        let freedom_ratio = (1.0 - effective / rows).max(FREEDOM_RATIO_MIN);
        let size = population_deviation(&self.observations.readings[self.channel]);
        Ok((
            Noise::of(&residual, &modelled, &in_series, freedom_ratio, size),
            system.whitening.memory_of(&left),
        ))
    }
}

/// Precisions of wide priors of a channel's columns: no column is more than a share of the channel's root mean square.
pub(crate) fn wide_precisions(system: &ChannelSystem, modelled: &[f64]) -> Vec<f64> {
    let size = rms(modelled.iter().copied());
    let precision = |column: &Vec<f64>| {
        let told = column.iter().zip(&system.whitening.weights).filter(|(_, weight)| **weight > 0.0);
        let own = rms(told.map(|(value, weight)| value / weight));
        // Of a column that is nothing in all rows that tell something, anything may be.
        if own > 0.0 { (own / (SIGNATURE_PRIOR * size)).powi(2) } else { 1.0 }
    };
    system.signatures.iter().map(precision).collect()
}
