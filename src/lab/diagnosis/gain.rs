//! What the findings are worth on rows that had no part in finding them.

use super::attribution::Applied;
use super::model::{Hypothesis, Model};
use super::observations::Observations;
use super::report::{Gain, Without};
use crate::numeric::random::SplitMix64;
use crate::numeric::statistics::mean;

/// Draws of the bootstrap over clusters.
const DRAWS: usize = 1000;
/// The same draws for the same data.
const SEED: u64 = 0x6a19;

/// A model at rows, and what the rows read.
pub(super) struct Rows<'r> {
    pub(super) model: &'r dyn Model,
    pub(super) observations: &'r Observations,
}

impl Rows<'_> {
    /// Each channel's residuals with these hypotheses; NaN where a reading tells nothing.
    pub(super) fn residuals(&self, applied: &Applied) -> Vec<Vec<f64>> {
        let readings = self.model.readings(applied);
        let Observations { readings: measured, is_told, .. } = self.observations;
        let left = |((y, f), is_told): ((&f64, f64), &bool)| if *is_told { y - f } else { f64::NAN };
        let channels = measured.iter().zip(readings).zip(is_told);
        channels
            .map(|((measured, modelled), is_told)| {
                measured.iter().zip(modelled).zip(is_told).map(left).collect()
            })
            .collect()
    }

    /// The means of the residuals: each channel's zero.
    pub(super) fn zeros(&self, applied: &Applied) -> Vec<f64> {
        let told = |of: &Vec<f64>| mean(of.iter().copied().filter(|residual| !residual.is_nan()));
        self.residuals(applied).iter().map(told).collect()
    }

    /// The residuals beside each channel's zero.
    pub(super) fn centred(&self, applied: &Applied) -> Vec<Vec<f64>> {
        let mut residuals = self.residuals(applied);
        for (channel, zero) in residuals.iter_mut().zip(self.zeros(applied)) {
            channel.iter_mut().for_each(|residual| *residual -= zero);
        }
        residuals
    }

    /// For each cluster, the sum of squares beside these zeros.
    fn squares(&self, applied: &Applied, zeros: &[f64]) -> Vec<f64> {
        let clusters = self.observations.clusters();
        let mut squares = vec![0.0; clusters.iter().max().map_or(0, |last| last + 1)];
        for (residuals, zero) in self.residuals(applied).iter().zip(zeros) {
            for (residual, cluster) in residuals.iter().zip(&clusters).filter(|(it, _)| !it.is_nan()) {
                squares[*cluster] += (residual - zero).powi(2);
            }
        }
        squares
    }
}

/// Root mean square of residuals beside zeros.
pub(super) fn rmse(rows: &Rows<'_>, applied: &Applied, zeros: &[f64]) -> f64 {
    let count = rows.observations.is_told.iter().flatten().filter(|it| **it).count() as f64;
    (rows.squares(applied, zeros).iter().sum::<f64>() / count).sqrt()
}

/// The gain of `applied` on the locked rows. Zeros are those of the open ones.
pub(super) fn gain(open: &Rows<'_>, locked: &Rows<'_>, applied: &Applied) -> Gain {
    let squares = |applied: &Applied| locked.squares(applied, &open.zeros(applied));
    let (nominal, extended) = (squares(&Vec::new()), squares(applied));
    let hypotheses = open.model.hypotheses();
    let without = |at: usize| {
        let others: Applied =
            applied.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, it)| it.clone()).collect();
        let Hypothesis { effect, target, .. } = hypotheses[applied[at].0];
        Without { effect, target, rmse_ratio: ratio(&squares(&others), &nominal) }
    };
    let mut random = SplitMix64::new(SEED);
    let mut drawn: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let mut sums = [0.0; 2];
            for _ in 0..nominal.len() {
                let at = (random.next_bits() % nominal.len() as u64) as usize;
                sums = [sums[0] + extended[at], sums[1] + nominal[at]];
            }
            (sums[0] / sums[1]).sqrt()
        })
        .collect();
    drawn.sort_by(f64::total_cmp);
    let quantile = |share: f64| drawn[(share * DRAWS as f64) as usize];
    Gain {
        rows_locked: locked.observations.rows(),
        rmse_ratio: ratio(&extended, &nominal),
        rmse_ratio_interval95: [quantile(0.025), quantile(0.975)],
        per_cause: (0..applied.len()).map(without).collect(),
    }
}

fn ratio(extended: &[f64], nominal: &[f64]) -> f64 {
    (extended.iter().sum::<f64>() / nominal.iter().sum::<f64>()).sqrt()
}
