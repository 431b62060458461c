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

use super::lasting::{Smoothed, Wander};
use super::residual::{MarginalPrecision, Residual};
use super::{NoisePrior, SquaredResidual};
use crate::calibration::data::contacts::Knowledge;
use tactpad_core::pipeline::contact::uncertainty::{Noise, UNKNOWNS};
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::linear::Factor;
use tactpad_numeric::products::dot;

/// Contacts with the standard deviations below that the prior of the label errors counts as.
const PSEUDO_CONTACTS: f64 = 6.0;
const PLACE_MM: f64 = 0.1;
const FORCE_N: f64 = 0.02;
/// Least standard deviations of label errors: no reference is better.
const PLACE_MIN_MM: f64 = 2e-3;
const FORCE_MIN_N: f64 = 5e-4;
/// EM steps for each estimate; the states of lasting noise make each dear.
const ROUNDS: usize = 12;
const ROUNDS_LASTING: usize = 4;
/// A step that changes every deviation by a smaller part is the last.
const SETTLED: f64 = 1e-3;

/// Standard deviations of channel noise and label errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoiseModel {
    /// Channel noise.
    pub(crate) noise: Noise,
    /// Error of each written coordinate.
    place_mm: f64,
    /// Error of each written force component.
    force_n: f64,
    /// Time constant of the relative noise; zero: it is drawn anew for each contact.
    pub(crate) lasting_s: f64,
    /// Prior of the channel noise.
    prior: NoisePrior,
}

impl NoiseModel {
    /// The model before any measurement.
    pub(crate) const fn prior(prior: NoisePrior, lasting_s: f64) -> Self {
        Self { noise: prior.noise, place_mm: PLACE_MM, force_n: FORCE_N, lasting_s, prior }
    }

    /// How the gains wander, if relative noise lasts.
    pub(crate) fn wander(&self) -> Option<Wander> {
        let Self { lasting_s: time_s, noise, .. } = self;
        (*time_s > 0.0).then_some(Wander { time_s: *time_s, deviation: noise.share })
    }

    /// Diagonal of Λ: one over the variances of the label's errors; without a label nothing is known of it.
    fn label_precisions(&self, knowledge: Knowledge) -> [f64; UNKNOWNS] {
        let deviations = match knowledge {
            Knowledge::Written => [self.place_mm, self.place_mm, self.force_n, self.force_n, self.force_n],
            Knowledge::Placed(deviations) => deviations,
            Knowledge::Unlabelled => return [0.0; UNKNOWNS],
        };
        deviations.map(|deviation| 1.0 / (deviation * deviation))
    }

    /// Factor of M = Λ + Jᵀ W J, the inverse covariance of the label's error given the channels.
    fn label_information(&self, residual: &Residual, weights: &[f64; CHANNELS]) -> Option<Factor<UNKNOWNS>> {
        let mut information = [[0.0; UNKNOWNS]; UNKNOWNS];
        for (k, precision) in self.label_precisions(residual.knowledge).into_iter().enumerate() {
            information[k][k] = precision;
        }
        add_products(&mut information, &residual.label_jacobian, weights);
        Factor::of(&information)
    }

    /// Of each channel, what is drawn anew for each contact.
    fn variances(&self, residual: &Residual) -> [f64; CHANNELS] {
        let uv = if self.lasting_s > 0.0 { [0.0; CHANNELS] } else { residual.uv };
        self.noise.variances(&uv, residual.force_n).noise
    }

    /// The most likely error of the label, d̂ = M⁻¹ Jᵀ W r.
    pub(crate) fn label_error(&self, residual: &Residual) -> Option<[f64; UNKNOWNS]> {
        // Lasting noise is noise here: each contact is taken by itself.
        let variances = self.noise.variances(&residual.uv, residual.force_n).noise;
        let weights = variances.map(|variance| 1.0 / variance);
        Some(self.label_information(residual, &weights)?.solve(&projected(residual, &weights)))
    }

    /// A gradient by the force that the channels say as one by the channels: Kᵀ w = W J M⁻¹ (0, 0, w).
    pub(crate) fn through_force(
        &self,
        residual: &Residual,
        by_force_n: &[f64; 3],
    ) -> Option<[f64; CHANNELS]> {
        let variances = self.noise.variances(&residual.uv, residual.force_n).noise;
        let weights = variances.map(|variance| 1.0 / variance);
        let [fx, fy, fz] = *by_force_n;
        let by = self.label_information(residual, &weights)?.solve(&[0.0, 0.0, fx, fy, fz]);
        Some(std::array::from_fn(|k| weights[k] * dot(&residual.label_jacobian[k], &by)))
    }

    /// `None` where M is not positive definite or not finite.
    pub(crate) fn marginal_precision(&self, residual: &Residual) -> Option<MarginalPrecision> {
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
        let channels: f64 = variances.iter().map(|variance| variance.ln()).sum();
        Some(MarginalPrecision {
            weights,
            downdates,
            log_determinant: channels + label_information.log_determinant() - self.log_labels(residual)?,
        })
    }

    /// What ln det V = ln det W⁻¹ + ln det M − ln det Λ has of the label. Without one, the density is that of the four directions
    /// that no contact explains, which det JᵀJ in the place of det Λ gives: it does not depend on the contact's units.
    fn log_labels(&self, residual: &Residual) -> Option<f64> {
        if residual.knowledge == Knowledge::Unlabelled {
            let mut products = [[0.0; UNKNOWNS]; UNKNOWNS];
            add_products(&mut products, &residual.label_jacobian, &[1.0; CHANNELS]);
            return Some(Factor::of(&products)?.log_determinant());
        }
        Some(self.label_precisions(residual.knowledge).iter().map(|precision| precision.ln()).sum())
    }

    /// The maximum-likelihood estimate from these residuals, with the prior as pseudo-observations. `freedom_ratio` is the share
    /// of the readings that are residual degrees of freedom: squares of residuals are divided by it.
    pub(crate) fn reestimated(self, residuals: &[Residual], freedom_ratio: f64) -> Self {
        let rounds = if self.lasting_s > 0.0 { ROUNDS_LASTING } else { ROUNDS };
        let mut noise_model = self;
        for _ in 0..rounds {
            let previous = noise_model;
            noise_model = previous.em_step(residuals, freedom_ratio);
            if noise_model.is_near(&previous) {
                break;
            }
        }
        noise_model
    }

    /// Whether no standard deviation differs by more than a thousandth.
    fn is_near(&self, other: &Self) -> bool {
        self.deviations()
            .zip(other.deviations())
            .all(|(one, other)| (one - other).abs() <= SETTLED * other.abs())
    }

    fn deviations(&self) -> impl Iterator<Item = f64> {
        let Noise { additive_uv, share, force_uv_per_n, .. } = self.noise;
        [additive_uv, share, force_uv_per_n].into_iter().flatten().chain([self.place_mm, self.force_n])
    }

    /// E: expected squares of each label's error d and each channel's noise n, given the residual r.
    /// M: label variances are means of these squares, channel variances are fitted to them.
    fn em_step(&self, residuals: &[Residual], freedom_ratio: f64) -> Self {
        let smoothed = self.smoothed(residuals);
        let mut squares = Squares::default();
        for (at, residual) in residuals.iter().enumerate() {
            let state = smoothed.as_ref().map(|it| (&it.mean[at], &it.covariance[at]));
            self.add_squares(residual, state, freedom_ratio, &mut squares);
        }
        let mut noise = super::from_residuals(&squares.noise, &self.prior);
        if let Some(smoothed) = smoothed {
            noise.share = self.lasting_share(&smoothed.variance, residuals.len());
        }
        // σ² = (κ σ₀² + Σ E[d²])/(κ + n), with κ pseudo-contacts of the prior σ₀; two coordinates and three forces each.
        let count = squares.labels as f64 + PSEUDO_CONTACTS;
        let mean = |sum: f64, prior: f64, numbers: f64| {
            ((sum + numbers * PSEUDO_CONTACTS * prior * prior) / (numbers * count)).sqrt()
        };
        Self {
            noise,
            place_mm: mean(squares.place_mm2, PLACE_MM, 2.0).max(PLACE_MIN_MM),
            force_n: mean(squares.force_n2, FORCE_N, 3.0).max(FORCE_MIN_N),
            ..*self
        }
    }

    /// The states of lasting noise by all contacts; none where noise is drawn anew.
    fn smoothed(&self, residuals: &[Residual]) -> Option<Smoothed> {
        let wander = self.wander()?;
        let seen = residuals.iter().map(|residual| Some((self.marginal_precision(residual)?, residual)));
        wander.smoothed(&seen.collect::<Option<Vec<_>>>()?)
    }

    /// σ² = (κ σ₀² + n σ̂²)/(κ + n) of each channel's gain.
    fn lasting_share(&self, variance: &[f64; CHANNELS], count: usize) -> [f64; CHANNELS] {
        let (known, count) = (self.prior.pseudo_readings(), count as f64);
        std::array::from_fn(|k| {
            let prior = self.prior.noise.share[k];
            ((known * prior * prior + count * variance[k]) / (known + count)).sqrt().max(super::SHARE_MIN)
        })
    }

    /// Adds a contact's expected squares. `state` are mean m and covariance P of the lasting noise there.
    fn add_squares(
        &self,
        residual: &Residual,
        state: Option<(&[f64; CHANNELS], &[[f64; CHANNELS]; CHANNELS])>,
        freedom_ratio: f64,
        squares: &mut Squares,
    ) {
        let weights = self.variances(residual).map(|variance| 1.0 / variance);
        let Some(label_information) = self.label_information(residual, &weights) else { return };
        // What the lasting noise does not explain: r − D m.
        let mut residual = residual.clone();
        if let Some((mean, _)) = state {
            let own = residual.residual_uv.iter_mut().zip(residual.uv.iter().zip(mean));
            own.for_each(|(left_uv, (uv, mean))| *left_uv -= uv * mean);
        }
        // Cov d = M⁻¹, d̂ = M⁻¹ Jᵀ W (r − D m).
        let covariance = label_information.inverse();
        let errors = label_information.solve(&projected(&residual, &weights));
        if residual.knowledge == Knowledge::Written {
            squares.labels += 1;
            for (k, error) in errors.iter().enumerate() {
                // E[d²] = d̂² + (M⁻¹)ₖₖ.
                let sum = if k > 1 { &mut squares.force_n2 } else { &mut squares.place_mm2 };
                *sum += error * error / freedom_ratio + covariance[k][k];
            }
        }
        for (channel, row) in residual.label_jacobian.iter().enumerate() {
            // E[n²] = (r − D m − J d̂)² + J M⁻¹ Jᵀ + G P Gᵀ, with G = (I − J M⁻¹ Jᵀ W) D.
            let noise_uv = residual.residual_uv[channel] - dot(row, &errors);
            let covariance_row = covariance.map(|line| dot(&line, row));
            let mut square_uv2 = noise_uv * noise_uv / freedom_ratio + dot(row, &covariance_row);
            if let Some((_, state)) = state {
                let gain: [f64; CHANNELS] = std::array::from_fn(|other| {
                    let own = f64::from(u8::from(other == channel));
                    let through_label = dot(&residual.label_jacobian[other], &covariance_row);
                    (own - through_label * weights[other]) * residual.uv[other]
                });
                square_uv2 += dot(&gain, &state.map(|line| dot(&line, &gain)));
            }
            let uv = if state.is_some() { 0.0 } else { residual.uv[channel] };
            squares.noise[channel].push(SquaredResidual { uv, force_n: residual.force_n, square_uv2 });
        }
    }
}

/// Sums of expected squares over contacts.
#[derive(Default)]
struct Squares {
    /// Of each channel's noise.
    noise: [Vec<SquaredResidual>; CHANNELS],
    /// Of written places, both coordinates.
    place_mm2: f64,
    /// Of written forces, all three components.
    force_n2: f64,
    /// Contacts with a written label.
    labels: usize,
}

/// Adds Σₖ wₖ Jₖᵀ Jₖ.
fn add_products(
    to: &mut [[f64; UNKNOWNS]; UNKNOWNS],
    jacobian: &[[f64; UNKNOWNS]; CHANNELS],
    weights: &[f64; CHANNELS],
) {
    for (row, weight) in jacobian.iter().zip(weights) {
        for (line, left) in to.iter_mut().zip(row) {
            line.iter_mut().zip(row).for_each(|(entry, right)| *entry += weight * left * right);
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;

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
            Residual {
                knowledge: Knowledge::Written,
                at_s: 0.0,
                uv,
                force_n: 0.0,
                residual_uv,
                label_jacobian,
            }
        };
        (0..1500).map(|_| residual()).collect()
    }

    #[test]
    fn channel_noise_and_label_errors_are_told_apart() {
        for (place_mm, force_n) in [(0.1, 0.02), (0.6, 0.02), (0.02, 0.1)] {
            let found = (0..10).fold(NoiseModel::prior(NoisePrior::SIMULATED, 0.0), |it, _| {
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
        let noise_model = NoiseModel::prior(NoisePrior::SIMULATED, 0.0);
        let marginal_precision = noise_model.marginal_precision(residual).unwrap();
        let variances = noise_model.variances(residual);
        let label = noise_model.label_precisions(Knowledge::Written).map(|precision| 1.0 / precision);
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
