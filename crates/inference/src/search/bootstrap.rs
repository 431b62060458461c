//! The distribution of scores under the hypothesis that nothing else is wrong: a cluster bootstrap.
//!
//! A draw is r* = B z* + w ∘ n̂ + Σ e* E: the background from its process, the rows' own errors n̂ = r − A ψ̂ − B ẑ with one random
//! sign w for each cluster, so that whatever rows of a location share stays together, and the model's own and stated errors. Scores are
//! linear in r*, so a draw costs no look at the rows.
//!
//! Source: A. C. Cameron, J. B. Gelbach, D. L. Miller, Review of Economics and Statistics 90 (2008) 414 (wild cluster bootstrap);
//! P. H. Westfall, S. S. Young, Resampling-Based Multiple Testing (1993) (the smallest p-value's distribution).

use super::columns::Columns;
use crate::covariance::{Background, Marginal, Systems};
use tactpad_numeric::dense::Matrix;
use tactpad_numeric::products::dot;
use tactpad_numeric::random::SplitMix64;

/// A cause acts on some of the functions and loads by which a channel's background is known: half, say.
const SIZED_BY: f64 = 0.5;
/// Least degrees of freedom by which a covariance counts as known, and the least cube root of a drawn ratio.
const FREEDOM_MIN: f64 = 8.0;
const VARIANCE_RATIO_MIN: f64 = 0.5;
/// The same draws for the same data.
const SEED: u64 = 0x7ac7;

/// From random numbers to scores.
pub(crate) struct Bootstrap {
    /// For each cluster, Aᵀ V⁻¹ of its rows' errors.
    clusters: Matrix,
    /// For each channel: (its columns, L⁻¹ Bᵀ D⁻¹ A … as a factor of the background's part).
    backgrounds: Vec<(Vec<usize>, Matrix)>,
    /// For each of the model's own errors, Aᵀ V⁻¹ E times its standard deviation.
    errors: Vec<Vec<f64>>,
    /// For each channel, the degrees of freedom that its covariance is known by.
    freedom: Vec<f64>,
    columns: usize,
    random: SplitMix64,
}

/// One bootstrap draw.
pub(crate) struct Draw {
    /// Aᵀ V⁻¹ r*.
    pub(crate) score: Vec<f64>,
    /// For each channel: true over believed variance.
    pub(crate) variances: Vec<f64>,
}

impl Bootstrap {
    /// `coordinates` is the fit about which to draw; `clusters` are the rows' clusters.
    pub(crate) fn of(
        systems: &Systems,
        marginal: &Marginal,
        background: &Background,
        columns: &Columns,
        coordinates: &[f64],
        clusters: &[usize],
    ) -> Self {
        let count = clusters.iter().max().map_or(0, |last| last + 1);
        let mut of_clusters = Matrix::zeros(count, systems.columns);
        let mut backgrounds = Vec::new();
        for (channel, (system, reduced)) in systems.channels.iter().zip(&marginal.channels).enumerate() {
            let own: Vec<f64> = system.equations.columns.iter().map(|number| coordinates[*number]).collect();
            let z = reduced.factor.solve(&system.equations.background_score(&own));
            let left = system.left_over(&own, &z);
            let inflation = inflation(&left, system.whitening.told());
            let smooth: Vec<Vec<f64>> =
                reduced.whitened_mixed.iter().map(|whitened| reduced.factor.solve_upper(whitened)).collect();
            let mut stated: Vec<Vec<f64>> = Vec::new();
            for ((at, number), smooth) in system.equations.columns.iter().enumerate().zip(&smooth) {
                // D½ V⁻¹ A = D⁻½ (A − B H⁻¹ Bᵀ D⁻¹ A), row by row, times D⁻½ n̂.
                let own = system.weighted(at, smooth);
                for ((own, left), cluster) in own.iter().zip(&left).zip(clusters) {
                    of_clusters.row_mut(*cluster)[*number] += inflation * own * left;
                }
                // Aᵀ V⁻¹ E.
                stated.push(system.stated.columns.iter().map(|error| dot(error, &own)).collect());
            }
            if !system.stated.columns.is_empty() {
                backgrounds.push((system.equations.columns.clone(), Matrix::from_rows(&stated)));
            }
            // Aᵀ V⁻¹ B T½: Bᵀ V⁻¹ A = T⁻¹ H⁻¹ Bᵀ D⁻¹ A, and T½ T⁻¹ is L⁻¹/τ of each load.
            let shares = background.shares[channel];
            let whitened = |smooth: &Vec<f64>| -> Vec<f64> {
                let loads = smooth.chunks(smooth.len() / shares.len()).zip(shares);
                loads
                    .flat_map(|(of_load, share)| {
                        background.prior.whitened(of_load).into_iter().map(move |value| value / share)
                    })
                    .collect()
            };
            let rows: Vec<Vec<f64>> = smooth.iter().map(whitened).collect();
            backgrounds.push((system.equations.columns.clone(), Matrix::from_rows(&rows)));
        }
        let errors = columns.precisions.iter().enumerate().filter(|(_, precision)| **precision > 0.0);
        let errors = errors
            .map(|(at, precision)| {
                marginal.fisher.row(at).iter().map(|value| value / precision.sqrt()).collect()
            })
            .collect();
        Self {
            clusters: of_clusters,
            backgrounds,
            errors,
            freedom: background.freedom.iter().map(|freedom| (SIZED_BY * freedom).max(FREEDOM_MIN)).collect(),
            columns: systems.columns,
            random: SplitMix64::named(SEED, "bootstrap"),
        }
    }

    /// A residual in which nothing is wrong.
    pub(crate) fn draw(&mut self) -> Draw {
        let Self { clusters, backgrounds, errors, random, .. } = self;
        let signs: Vec<f64> =
            (0..clusters.rows()).map(|_| if random.next_bits() % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let mut score =
            if clusters.rows() > 0 { clusters.transposed_times(&signs) } else { vec![0.0; self.columns] };
        for (columns, factors) in &*backgrounds {
            let z: Vec<f64> = (0..factors.columns()).map(|_| f64::from(random.normal())).collect();
            columns.iter().zip(factors.times(&z)).for_each(|(column, value)| score[*column] += value);
        }
        for error in &*errors {
            let size = f64::from(random.normal());
            score.iter_mut().zip(error).for_each(|(score, value)| *score += size * value);
        }
        // χ²/ν by Wilson and Hilferty (1931): (1 − 2/9ν + n √(2/9ν))³.
        let cube = |freedom: &f64| {
            let spread = 2.0 / (9.0 * freedom);
            (1.0 - spread + f64::from(random.normal()) * spread.sqrt()).max(VARIANCE_RATIO_MIN).powi(3)
        };
        Draw { variances: self.freedom.iter().map(cube).collect(), score }
    }
}

/// What is left over is smaller than the errors, as it was fitted; in standard deviations its mean square should be 1.
fn inflation(left: &[f64], told: usize) -> f64 {
    let square = dot(left, left) / told.max(1) as f64;
    if square > 0.0 { 1.0 / square.sqrt() } else { 1.0 }
}
