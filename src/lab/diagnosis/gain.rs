//! What the findings are worth on rows that had no part in finding them.

use super::attribution::Applied;
use super::model::{Hypothesis, Model, Told};
use super::noise::NoiseLevel;
use super::observations::{Observations, Sample};
use super::report::{Decoded, Gain, Without};
use crate::numeric::random::SplitMix64;
use crate::numeric::statistics::mean;
use crate::tables::measured::zero::UNLOADED_N;

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

    /// For each cluster, how far decoded contacts are from those that were written; rows without one have none. None where the
    /// model knows no contacts.
    fn errors(&self, applied: &Applied, told: &Told<'_>) -> Option<Vec<Errors>> {
        let contacts = self.model.contacts(applied, told)?;
        let clusters = self.observations.clusters();
        let mut errors = vec![Errors::default(); clusters.iter().max().map_or(0, |last| last + 1)];
        let rows = self.observations.samples.iter().zip(contacts).zip(clusters);
        for ((sample, contact), cluster) in rows.filter(|((sample, _), _)| is_loaded(sample)) {
            let Some([x, y, fx, fy, fz]) = contact else { continue };
            let off =
                |found: &[f64], written: &[f64]| mean(found.iter().zip(written).map(|(a, b)| (a - b).abs()));
            let Errors { rows, sums: [place, load] } = &mut errors[cluster];
            *rows += 1.0;
            *place += off(&[x, y], &sample.place_mm);
            *load += off(&[fx, fy, fz], &sample.load);
        }
        Some(errors)
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

/// Whether something presses: without that there is no place to decode.
fn is_loaded(sample: &Sample) -> bool {
    sample.load.iter().map(|n| n * n).sum::<f64>() > UNLOADED_N * UNLOADED_N
}

/// Errors of the decoded contacts of a cluster, added up.
#[derive(Clone, Copy, Default)]
struct Errors {
    /// How many contacts.
    rows: f64,
    /// Of each, the mean magnitude of the error along the axes: of its place, of its load.
    sums: [f64; 2],
}

/// Root mean square of residuals beside zeros.
pub(super) fn rmse(rows: &Rows<'_>, applied: &Applied, zeros: &[f64]) -> f64 {
    let count = rows.observations.is_told.iter().flatten().filter(|it| **it).count() as f64;
    (rows.squares(applied, zeros).iter().sum::<f64>() / count).sqrt()
}

/// The gain of `applied` on the locked rows, whose channels have this noise; none where nothing was found. Zeros are those of the
/// open ones.
pub(super) fn gain([open, locked]: [&Rows<'_>; 2], applied: &Applied, noise: &[NoiseLevel]) -> Option<Gain> {
    if applied.is_empty() || locked.observations.rows() == 0 {
        return None;
    }
    let squares = |applied: &Applied| locked.squares(applied, &open.zeros(applied));
    let (nominal, extended) = (squares(&Vec::new()), squares(applied));
    let hypotheses = open.model.hypotheses();
    let without = |at: usize| {
        let others: Applied =
            applied.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, it)| it.clone()).collect();
        let Hypothesis { effect, target, .. } = hypotheses[applied[at].0];
        Without { effect, target, rmse_ratio: ratio(&squares(&others), &nominal) }
    };
    let all: Vec<usize> = (0..nominal.len()).collect();
    let share = |drawn: &[usize]| {
        let sum = |squares: &[f64]| drawn.iter().map(|at| squares[*at]).sum::<f64>();
        (sum(&extended) / sum(&nominal)).sqrt()
    };
    let errors = |applied: &Applied| locked.errors(applied, &Told { zeros: &open.zeros(applied), noise });
    let decoded = errors(&Vec::new()).zip(errors(applied));
    let [position_mae, force_mae] =
        [0, 1].map(|at| decoded.as_ref().and_then(|(nominal, extended)| changed(nominal, extended, at)));
    Some(Gain {
        rows_locked: locked.observations.rows(),
        rmse_ratio: share(&all),
        rmse_ratio_interval95: interval95(nominal.len(), share),
        position_mae,
        force_mae,
        per_cause: (0..applied.len()).map(without).collect(),
    })
}

/// How the mean error of places (0) or loads (1) changes; none where there is no contact.
fn changed(nominal: &[Errors], extended: &[Errors], at: usize) -> Option<Decoded> {
    let of = |errors: &[Errors], drawn: &[usize]| {
        let sum = |it: fn(&Errors, usize) -> f64| drawn.iter().map(|k| it(&errors[*k], at)).sum::<f64>();
        sum(|errors, at| errors.sums[at]) / sum(|errors, _| errors.rows)
    };
    let all: Vec<usize> = (0..nominal.len()).collect();
    let change = |drawn: &[usize]| of(extended, drawn) - of(nominal, drawn);
    let (nominal_mean, extended_mean) = (of(nominal, &all), of(extended, &all));
    (nominal_mean.is_finite() && extended_mean.is_finite()).then(|| Decoded {
        nominal: nominal_mean,
        extended: extended_mean,
        change_interval95: interval95(nominal.len(), change),
    })
}

/// Ends of the 95 % interval of what is computed of clusters, by drawing as many of them as there are.
fn interval95(clusters: usize, of: impl Fn(&[usize]) -> f64) -> [f64; 2] {
    let mut random = SplitMix64::new(SEED);
    let mut drawn: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let draw = (0..clusters).map(|_| (random.next_bits() % clusters as u64) as usize);
            of(&draw.collect::<Vec<_>>())
        })
        .collect();
    drawn.sort_by(f64::total_cmp);
    [0.025, 0.975].map(|share| drawn[(share * DRAWS as f64) as usize])
}

fn ratio(extended: &[f64], nominal: &[f64]) -> f64 {
    (extended.iter().sum::<f64>() / nominal.iter().sum::<f64>()).sqrt()
}
