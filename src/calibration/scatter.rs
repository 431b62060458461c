//! How measured contacts scatter around the model: nine channels by their noise, and labels by what their reference did.
//!
//! A contact's rest is r = n + J d: the channels' noise n, and what the difference d between the true contact and the
//! written one does to the channels. Nine channels and five differences tell the two apart, so a bad reference is not
//! taken for a noisy pad, nor the other way round. Sizes are found by expectation and maximisation (A. P. Dempster, N. M.
//! Laird, D. B. Rubin, J. R. Statist. Soc. B 39 (1977) 1).

use super::noise::{self, Known, Rest};
use crate::contact::uncertainty::{Noise, UNKNOWNS};
use crate::linear::Factor;
use crate::quantity::CHANNELS;

/// What is known of labels before: as much as so many contacts with these differences.
const KNOWN: f64 = 6.0;
const PLACE_MM: f64 = 0.1;
const FORCE_N: f64 = 0.02;
/// No reference is better.
const PLACE_MIN_MM: f64 = 2e-3;
const FORCE_MIN_N: f64 = 5e-4;
/// Rounds each time that sizes are looked for.
const ROUNDS: usize = 12;

/// Sizes of what scatters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scatter {
    /// Of the channels.
    pub(super) noise: Noise,
    /// Of each written coordinate around the true one.
    place_mm: f64,
    /// Of each written force around the true one.
    force_n: f64,
    /// What was known of the channels.
    known: Known,
}

/// A contact beside the model.
#[derive(Clone, Debug)]
pub(super) struct Residual {
    /// Its channels.
    pub(super) uv: [f64; CHANNELS],
    /// Its force.
    pub(super) force_n: f64,
    /// What the model leaves over.
    pub(super) rest_uv: [f64; CHANNELS],
    /// How each channel changes with x, y, Fx, Fy, Fz.
    pub(super) slopes: [[f64; UNKNOWNS]; CHANNELS],
}

/// What a residual is worth: the inverse of its covariance is diag(weights) − Σ tᵢ tᵢ′.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worth {
    pub(super) weights: [f64; CHANNELS],
    /// The vectors t.
    pub(super) taken: [[f64; CHANNELS]; UNKNOWNS],
    /// ln of the covariance's determinant.
    log_determinant: f64,
}

impl Scatter {
    /// Before any measurement.
    pub(super) const fn before(known: Known) -> Self {
        Self { noise: known.noise, place_mm: PLACE_MM, force_n: FORCE_N, known }
    }

    /// One over the variances of the label.
    fn precisions(&self) -> [f64; UNKNOWNS] {
        let [place, force] = [self.place_mm, self.force_n].map(|deviation| 1.0 / (deviation * deviation));
        [place, place, force, force, force]
    }

    /// Inverse covariance of the label's differences once the channels are read: Λ⁻¹ + J′WJ.
    fn told(&self, residual: &Residual, weights: &[f64; CHANNELS]) -> Option<Factor<UNKNOWNS>> {
        let mut curvature = [[0.0; UNKNOWNS]; UNKNOWNS];
        for (k, precision) in self.precisions().into_iter().enumerate() {
            curvature[k][k] = precision;
        }
        for (row, weight) in residual.slopes.iter().zip(weights) {
            for (line, left) in curvature.iter_mut().zip(row) {
                line.iter_mut().zip(row).for_each(|(entry, right)| *entry += weight * left * right);
            }
        }
        Factor::of(&curvature)
    }

    fn variances(&self, residual: &Residual) -> [f64; CHANNELS] {
        self.noise.variances(&residual.uv, residual.force_n).noise
    }

    /// `None` where the numbers make no sense.
    pub(super) fn worth(&self, residual: &Residual) -> Option<Worth> {
        let variances = self.variances(residual);
        let weights = variances.map(|variance| 1.0 / variance);
        let told = self.told(residual, &weights)?;
        let mut taken = [[0.0; CHANNELS]; UNKNOWNS];
        for (k, row) in residual.slopes.iter().enumerate() {
            for (taken, value) in taken.iter_mut().zip(told.solve_lower(row)) {
                taken[k] = weights[k] * value;
            }
        }
        let labels: f64 = self.precisions().iter().map(|precision| precision.ln()).sum();
        let channels: f64 = variances.iter().map(|variance| variance.ln()).sum();
        Some(Worth { weights, taken, log_determinant: channels + told.log_determinant() - labels })
    }

    /// The sizes that these residuals have. `freedom` is the part of the readings that the fitted numbers did not take up.
    pub(super) fn seen(self, residuals: &[Residual], freedom: f64) -> Self {
        (0..ROUNDS).fold(self, |scatter, _| scatter.improved(residuals, freedom))
    }

    fn improved(&self, residuals: &[Residual], freedom: f64) -> Self {
        let mut rests: [Vec<Rest>; CHANNELS] = [const { Vec::new() }; CHANNELS];
        let mut squares = [2.0 * KNOWN * PLACE_MM * PLACE_MM, 3.0 * KNOWN * FORCE_N * FORCE_N];
        for residual in residuals {
            let weights = self.variances(residual).map(|variance| 1.0 / variance);
            let Some(told) = self.told(residual, &weights) else { continue };
            let hidden = told.inverse();
            let differences = told.solve(&weighted(residual, &weights));
            for (k, difference) in differences.iter().enumerate() {
                squares[usize::from(k > 1)] += difference * difference / freedom + hidden[k][k];
            }
            for (channel, row) in residual.slopes.iter().enumerate() {
                let rest = residual.rest_uv[channel] - dot(row, &differences);
                let lines = hidden.map(|line| dot(&line, row));
                let square_uv2 = rest * rest / freedom + dot(row, &lines);
                let Residual { uv, force_n, .. } = *residual;
                rests[channel].push(Rest { uv: uv[channel], force_n, square_uv2 });
            }
        }
        let count = residuals.len() as f64 + KNOWN;
        Self {
            noise: noise::of_rests(&rests, &self.known),
            known: self.known,
            place_mm: (squares[0] / (2.0 * count)).sqrt().max(PLACE_MIN_MM),
            force_n: (squares[1] / (3.0 * count)).sqrt().max(FORCE_MIN_N),
        }
    }
}

impl Worth {
    /// r′ V⁻¹ r + ln det V.
    pub(super) fn cost(&self, rest_uv: &[f64; CHANNELS]) -> f64 {
        let own: f64 = self.weights.iter().zip(rest_uv).map(|(weight, rest)| weight * rest * rest).sum();
        let taken: f64 = self.taken.iter().map(|taken| dot(taken, rest_uv).powi(2)).sum();
        own - taken + self.log_determinant
    }
}

/// J′W r.
fn weighted(residual: &Residual, weights: &[f64; CHANNELS]) -> [f64; UNKNOWNS] {
    let mut sums = [0.0; UNKNOWNS];
    for ((row, rest), weight) in residual.slopes.iter().zip(residual.rest_uv).zip(weights) {
        sums.iter_mut().zip(row).for_each(|(sum, slope)| *sum += weight * slope * rest);
    }
    sums
}

fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    /// Residuals of channels with noise, and of labels with differences.
    fn residuals(place_mm: f64, force_n: f64) -> Vec<Residual> {
        let mut random = SplitMix64::new(4);
        let mut normal = |size: f64| size * f64::from(random.normal());
        let mut residual = || {
            let slopes = [[0; UNKNOWNS]; CHANNELS].map(|row| row.map(|_| normal(200.0)));
            let differences = [place_mm, place_mm, force_n, force_n, force_n].map(&mut normal);
            let uv = [0; CHANNELS].map(|_| normal(1000.0));
            let noise = |uv: f64, normal: &mut dyn FnMut(f64) -> f64| normal(5.0) + uv * normal(0.02);
            let rest_uv = std::array::from_fn(|k| noise(uv[k], &mut normal) + dot(&slopes[k], &differences));
            Residual { uv, force_n: 0.0, rest_uv, slopes }
        };
        (0..1500).map(|_| residual()).collect()
    }

    #[test]
    fn noise_and_bad_labels_are_told_apart() {
        for (place_mm, force_n) in [(0.1, 0.02), (0.6, 0.02), (0.02, 0.1)] {
            let found = (0..10)
                .fold(Scatter::before(Known::SIMULATED), |it, _| it.seen(&residuals(place_mm, force_n), 1.0));
            assert!((found.place_mm / place_mm - 1.0).abs() < 0.3, "{place_mm}: {found:?}");
            assert!((found.force_n / force_n - 1.0).abs() < 0.3, "{force_n}: {found:?}");
            assert!(found.noise.additive_uv.iter().all(|uv| (uv / 5.0 - 1.0).abs() < 0.35), "{found:?}");
            assert!(found.noise.share.iter().all(|share| (share / 0.02 - 1.0).abs() < 0.15), "{found:?}");
        }
    }

    #[test]
    fn what_a_residual_is_worth_is_its_inverse_covariance() {
        let residual = &residuals(0.1, 0.02)[0];
        let scatter = Scatter::before(Known::SIMULATED);
        let worth = scatter.worth(residual).unwrap();
        let variances = scatter.variances(residual);
        let label = scatter.precisions().map(|precision| 1.0 / precision);
        let covariance: [[f64; CHANNELS]; CHANNELS] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let by_label: f64 =
                    (0..UNKNOWNS).map(|k| residual.slopes[i][k] * label[k] * residual.slopes[j][k]).sum();
                by_label + if i == j { variances[i] } else { 0.0 }
            })
        });
        let factor = Factor::of(&covariance).unwrap();
        let square = dot(&residual.rest_uv, &factor.solve(&residual.rest_uv));
        let wanted = square + factor.log_determinant();
        assert!((worth.cost(&residual.rest_uv) / wanted - 1.0).abs() < 1e-6, "{worth:?}");
    }
}
