//! A contact's residual, and the inverse covariance of it: what the fit sums over.

use crate::calibration::data::contacts::Knowledge;
use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::products::dot;

/// A contact's residual r = y − f(θ).
#[derive(Clone, Debug)]
pub(crate) struct Residual {
    /// What is known of its label.
    pub(crate) knowledge: Knowledge,
    /// On the pad's clock.
    pub(crate) at_s: f64,
    /// The signals that relative noise is relative to.
    pub(crate) uv: [f64; CHANNELS],
    /// Its force.
    pub(crate) force_n: f64,
    /// r.
    pub(crate) residual_uv: [f64; CHANNELS],
    /// J: derivatives of each channel by x, y (µV/mm), Fx, Fy, Fz (µV/N).
    pub(crate) label_jacobian: [[f64; UNKNOWNS]; CHANNELS],
}

/// Inverse covariance of a residual with the label's error marginalised: V⁻¹ = W − Σᵢ tᵢ tᵢᵀ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MarginalPrecision {
    /// Diagonal of W: one over the variance of each channel's noise.
    pub(crate) weights: [f64; CHANNELS],
    /// The vectors tᵢ: columns of W J L⁻ᵀ, where M = L Lᵀ.
    pub(crate) downdates: [[f64; CHANNELS]; UNKNOWNS],
    /// ln det V.
    pub(crate) log_determinant: f64,
}

impl MarginalPrecision {
    /// V⁻¹.
    pub(crate) fn matrix(&self) -> [[f64; CHANNELS]; CHANNELS] {
        let entry = |i: usize, j: usize| {
            let own = if i == j { self.weights[i] } else { 0.0 };
            own - self.downdates.iter().map(|downdate| downdate[i] * downdate[j]).sum::<f64>()
        };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    /// rᵀ V⁻¹ r + ln det V, that is −2 ln of the normal density but for a constant.
    pub(crate) fn cost(&self, residual_uv: &[f64; CHANNELS]) -> f64 {
        self.square(residual_uv) + self.log_determinant
    }

    /// rᵀ V⁻¹ r.
    pub(crate) fn square(&self, residual_uv: &[f64; CHANNELS]) -> f64 {
        // Σₖ wₖ rₖ² − Σᵢ (tᵢᵀr)².
        let own: f64 = self.weights.iter().zip(residual_uv).map(|(weight, r)| weight * r * r).sum();
        let by_labels: f64 = self.downdates.iter().map(|downdate| dot(downdate, residual_uv).powi(2)).sum();
        own - by_labels
    }
}
