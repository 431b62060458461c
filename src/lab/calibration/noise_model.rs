//! The noise model of measured contacts: the channels have noise, and the labels have errors of their reference.
//!
//! A contact's residual is r = n + J d, with the channels' noise n ~ N(0, W⁻¹), the error d ~ N(0, Λ⁻¹) of its label, and
//! J the channels' derivatives by x, y, Fx, Fy, Fz; W and Λ are diagonal. With d marginalised the covariance is
//!
//! ```text
//! V = W⁻¹ + J Λ⁻¹ Jᵀ        V⁻¹ = W − W J M⁻¹ Jᵀ W        M = Λ + Jᵀ W J
//! ```
//!
//! Nine channels tell noise from the five label errors, so a bad reference is not taken for a noisy pad, nor the other way
//! round. The variances are found by expectation and maximisation (A. P. Dempster, N. M. Laird, D. B. Rubin, J. R. Statist.
//! Soc. B 39 (1977) 1).

use super::noise::{self, NoisePrior, SquaredResidual};
use crate::numeric::linear::Factor;
use crate::pipeline::contact::uncertainty::{Noise, UNKNOWNS};
use crate::quantity::CHANNELS;

/// Contacts with the standard deviations below that the prior of the label errors counts as.
const PSEUDO_CONTACTS: f64 = 6.0;
const PLACE_MM: f64 = 0.1;
const FORCE_N: f64 = 0.02;
/// Least standard deviations of label errors: no reference is better.
const PLACE_MIN_MM: f64 = 2e-3;
const FORCE_MIN_N: f64 = 5e-4;
/// EM steps for each estimate.
const ROUNDS: usize = 12;

/// Standard deviations of channel noise and label errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoiseModel {
    /// Channel noise.
    pub(super) noise: Noise,
    /// Error of each written coordinate.
    place_mm: f64,
    /// Error of each written force component.
    force_n: f64,
    /// Prior of the channel noise.
    prior: NoisePrior,
}

/// A contact's residual r = y − f(θ).
#[derive(Clone, Debug)]
pub(super) struct Residual {
    /// Its channels.
    pub(super) uv: [f64; CHANNELS],
    /// Its force.
    pub(super) force_n: f64,
    /// r.
    pub(super) residual_uv: [f64; CHANNELS],
    /// J: derivatives of each channel by x, y (µV/mm), Fx, Fy, Fz (µV/N).
    pub(super) label_jacobian: [[f64; UNKNOWNS]; CHANNELS],
}

/// Inverse covariance of a residual with the label's error marginalised: V⁻¹ = W − Σᵢ tᵢ tᵢᵀ.
#[derive(Clone, Copy, Debug)]
pub(super) struct MarginalPrecision {
    /// Diagonal of W: one over the variance of each channel's noise.
    pub(super) weights: [f64; CHANNELS],
    /// The vectors tᵢ: columns of W J L⁻ᵀ, where M = L Lᵀ.
    pub(super) downdates: [[f64; CHANNELS]; UNKNOWNS],
    /// ln det V.
    log_determinant: f64,
}

impl NoiseModel {
    /// The model before any measurement.
    pub(super) const fn prior(prior: NoisePrior) -> Self {
        Self { noise: prior.noise, place_mm: PLACE_MM, force_n: FORCE_N, prior }
    }

    /// Diagonal of Λ: one over the variances of the label's errors.
    fn label_precisions(&self) -> [f64; UNKNOWNS] {
        let [place, force] = [self.place_mm, self.force_n].map(|deviation| 1.0 / (deviation * deviation));
        [place, place, force, force, force]
    }

    /// Factor of M = Λ + Jᵀ W J, the inverse covariance of the label's error given the channels.
    fn label_information(&self, residual: &Residual, weights: &[f64; CHANNELS]) -> Option<Factor<UNKNOWNS>> {
        let mut information = [[0.0; UNKNOWNS]; UNKNOWNS];
        for (k, precision) in self.label_precisions().into_iter().enumerate() {
            information[k][k] = precision;
        }
        // Σₖ wₖ Jₖᵀ Jₖ.
        for (row, weight) in residual.label_jacobian.iter().zip(weights) {
            for (line, left) in information.iter_mut().zip(row) {
                line.iter_mut().zip(row).for_each(|(entry, right)| *entry += weight * left * right);
            }
        }
        Factor::of(&information)
    }

    fn variances(&self, residual: &Residual) -> [f64; CHANNELS] {
        self.noise.variances(&residual.uv, residual.force_n).noise
    }

    /// `None` where M is not positive definite or not finite.
    pub(super) fn marginal_precision(&self, residual: &Residual) -> Option<MarginalPrecision> {
        let variances = self.variances(residual);
        let weights = variances.map(|variance| 1.0 / variance);
        let label_information = self.label_information(residual, &weights)?;
        // Row k of W J L⁻ᵀ is wₖ L⁻¹ Jₖᵀ.
        let mut downdates = [[0.0; CHANNELS]; UNKNOWNS];
        for (k, row) in residual.label_jacobian.iter().enumerate() {
            for (downdate, value) in downdates.iter_mut().zip(label_information.solve_lower(row)) {
                downdate[k] = weights[k] * value;
            }
        }
        // det V = det W⁻¹ det M / det Λ.
        let labels: f64 = self.label_precisions().iter().map(|precision| precision.ln()).sum();
        let channels: f64 = variances.iter().map(|variance| variance.ln()).sum();
        Some(MarginalPrecision {
            weights,
            downdates,
            log_determinant: channels + label_information.log_determinant() - labels,
        })
    }

    /// The maximum-likelihood estimate from these residuals, with the prior as pseudo-observations. `freedom_ratio` is the share
    /// of the readings that are residual degrees of freedom: squares of residuals are divided by it.
    pub(super) fn reestimated(self, residuals: &[Residual], freedom_ratio: f64) -> Self {
        (0..ROUNDS).fold(self, |noise_model, _| noise_model.em_step(residuals, freedom_ratio))
    }

    /// E: expected squares of each label's error d and each channel's noise n, given the residual r.
    /// M: label variances are means of these squares, channel variances are fitted to them.
    fn em_step(&self, residuals: &[Residual], freedom_ratio: f64) -> Self {
        let mut noise_squares: [Vec<SquaredResidual>; CHANNELS] = [const { Vec::new() }; CHANNELS];
        let mut label_squares =
            [2.0 * PSEUDO_CONTACTS * PLACE_MM * PLACE_MM, 3.0 * PSEUDO_CONTACTS * FORCE_N * FORCE_N];
        for residual in residuals {
            let weights = self.variances(residual).map(|variance| 1.0 / variance);
            let Some(label_information) = self.label_information(residual, &weights) else { continue };
            // Cov d = M⁻¹, d̂ = M⁻¹ Jᵀ W r.
            let covariance = label_information.inverse();
            let errors = label_information.solve(&projected(residual, &weights));
            for (k, error) in errors.iter().enumerate() {
                // E[d²] = d̂² + (M⁻¹)ₖₖ.
                label_squares[usize::from(k > 1)] += error * error / freedom_ratio + covariance[k][k];
            }
            for (channel, row) in residual.label_jacobian.iter().enumerate() {
                // E[n²] = (r − J d̂)² + J M⁻¹ Jᵀ.
                let noise_uv = residual.residual_uv[channel] - dot(row, &errors);
                let covariance_row = covariance.map(|line| dot(&line, row));
                let square_uv2 = noise_uv * noise_uv / freedom_ratio + dot(row, &covariance_row);
                let Residual { uv, force_n, .. } = *residual;
                noise_squares[channel].push(SquaredResidual { uv: uv[channel], force_n, square_uv2 });
            }
        }
        // σ² = (κ σ₀² + Σ E[d²])/(κ + n), with κ pseudo-contacts of the prior σ₀; two coordinates and three forces each.
        let count = residuals.len() as f64 + PSEUDO_CONTACTS;
        Self {
            noise: noise::from_residuals(&noise_squares, &self.prior),
            prior: self.prior,
            place_mm: (label_squares[0] / (2.0 * count)).sqrt().max(PLACE_MIN_MM),
            force_n: (label_squares[1] / (3.0 * count)).sqrt().max(FORCE_MIN_N),
        }
    }
}

impl MarginalPrecision {
    /// rᵀ V⁻¹ r + ln det V, that is −2 ln of the normal density but for a constant.
    pub(super) fn cost(&self, residual_uv: &[f64; CHANNELS]) -> f64 {
        // Σₖ wₖ rₖ² − Σᵢ (tᵢᵀr)².
        let own: f64 = self.weights.iter().zip(residual_uv).map(|(weight, r)| weight * r * r).sum();
        let by_labels: f64 = self.downdates.iter().map(|downdate| dot(downdate, residual_uv).powi(2)).sum();
        own - by_labels + self.log_determinant
    }
}

/// Jᵀ W r.
fn projected(residual: &Residual, weights: &[f64; CHANNELS]) -> [f64; UNKNOWNS] {
    let mut sums = [0.0; UNKNOWNS];
    for ((row, r), weight) in residual.label_jacobian.iter().zip(residual.residual_uv).zip(weights) {
        sums.iter_mut().zip(row).for_each(|(sum, slope)| *sum += weight * slope * r);
    }
    sums
}

fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;

    /// Residuals of channels with noise, and of labels with errors.
    fn residuals(place_mm: f64, force_n: f64) -> Vec<Residual> {
        let mut random = SplitMix64::new(4);
        let mut normal = |size: f64| size * f64::from(random.normal());
        let mut residual = || {
            let label_jacobian = [[0; UNKNOWNS]; CHANNELS].map(|row| row.map(|_| normal(200.0)));
            let errors = [place_mm, place_mm, force_n, force_n, force_n].map(&mut normal);
            let uv = [0; CHANNELS].map(|_| normal(1000.0));
            let noise = |uv: f64, normal: &mut dyn FnMut(f64) -> f64| normal(5.0) + uv * normal(0.02);
            let residual_uv =
                std::array::from_fn(|k| noise(uv[k], &mut normal) + dot(&label_jacobian[k], &errors));
            Residual { uv, force_n: 0.0, residual_uv, label_jacobian }
        };
        (0..1500).map(|_| residual()).collect()
    }

    #[test]
    fn channel_noise_and_label_errors_are_told_apart() {
        for (place_mm, force_n) in [(0.1, 0.02), (0.6, 0.02), (0.02, 0.1)] {
            let found = (0..10).fold(NoiseModel::prior(NoisePrior::SIMULATED), |it, _| {
                it.reestimated(&residuals(place_mm, force_n), 1.0)
            });
            assert!((found.place_mm / place_mm - 1.0).abs() < 0.3, "{place_mm}: {found:?}");
            assert!((found.force_n / force_n - 1.0).abs() < 0.3, "{force_n}: {found:?}");
            assert!(found.noise.additive_uv.iter().all(|uv| (uv / 5.0 - 1.0).abs() < 0.35), "{found:?}");
            assert!(found.noise.share.iter().all(|share| (share / 0.02 - 1.0).abs() < 0.15), "{found:?}");
        }
    }

    #[test]
    fn the_marginal_precision_is_the_inverse_covariance() {
        let residual = &residuals(0.1, 0.02)[0];
        let noise_model = NoiseModel::prior(NoisePrior::SIMULATED);
        let marginal_precision = noise_model.marginal_precision(residual).unwrap();
        let variances = noise_model.variances(residual);
        let label = noise_model.label_precisions().map(|precision| 1.0 / precision);
        let covariance: [[f64; CHANNELS]; CHANNELS] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let by_label: f64 = (0..UNKNOWNS)
                    .map(|k| residual.label_jacobian[i][k] * label[k] * residual.label_jacobian[j][k])
                    .sum();
                by_label + if i == j { variances[i] } else { 0.0 }
            })
        });
        let factor = Factor::of(&covariance).unwrap();
        let square = dot(&residual.residual_uv, &factor.solve(&residual.residual_uv));
        let wanted = square + factor.log_determinant();
        assert!(
            (marginal_precision.cost(&residual.residual_uv) / wanted - 1.0).abs() < 1e-6,
            "{marginal_precision:?}"
        );
    }
}
