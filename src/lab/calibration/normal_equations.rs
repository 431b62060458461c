//! The normal equations H δ = g of a Gauss-Newton step δ around the parameters θ:
//!
//! ```text
//! H = P + Σ Aᵀ V⁻¹ A + Σ a aᵀ/σ²        g = P (m − θ) + Σ Aᵀ V⁻¹ r + Σ a r/σ²
//! ```
//!
//! P are the precisions of the prior and m its mean. The first sums are over contacts, with the residuals r of nine channels,
//! their covariance V and A = ∂f/∂θ; the second ones over single numbers with a variance σ² and derivatives a.

use super::noise_model::MarginalPrecision;
use crate::numeric::linear::{LargeFactor, Symmetric};
use crate::pipeline::contact::uncertainty::UNKNOWNS;
use crate::quantity::CHANNELS;

/// The sums H and g.
pub(super) struct NormalEquations {
    curvature: Symmetric,
    gradient: Vec<f64>,
}

/// A Gauss-Newton step δ, and the factor of the curvature H.
pub(super) struct Step {
    pub(super) delta: Vec<f64>,
    pub(super) factor: LargeFactor,
}

impl NormalEquations {
    /// Those of the prior alone: H = P, g = P (m − θ). All three have as many entries as there are parameters.
    pub(super) fn of_prior(precisions: &[f64], mean: &[f64], values: &[f64]) -> Self {
        let mut curvature = Symmetric::zeros(values.len());
        let gradient =
            precisions.iter().zip(mean.iter().zip(values)).map(|(p, (m, v))| p * (m - v)).collect();
        precisions.iter().enumerate().for_each(|(at, precision)| curvature.add_diagonal(at, *precision));
        Self { curvature, gradient }
    }

    /// Adds a contact. `each_row` calls with each channel k and its derivatives, the row aₖ of A.
    ///
    /// The label's errors are marginalised: V⁻¹ = W − Σ tᵢ tᵢᵀ, with the weights W and the downdates tᵢ, hence
    ///
    /// ```text
    /// Aᵀ V⁻¹ A = Σₖ wₖ aₖ aₖᵀ − Σᵢ (Aᵀtᵢ)(Aᵀtᵢ)ᵀ        Aᵀ V⁻¹ r = Σₖ wₖ rₖ aₖ − Σᵢ (Aᵀtᵢ)(tᵢᵀr)
    /// ```
    pub(super) fn add_contact(
        &mut self,
        MarginalPrecision { weights, downdates, .. }: &MarginalPrecision,
        residual_uv: &[f64; CHANNELS],
        each_row: impl FnOnce(&mut dyn FnMut(usize, &[f64])),
    ) {
        let Self { curvature, gradient } = self;
        // Row i is Aᵀtᵢ.
        let mut projected = vec![vec![0.0; gradient.len()]; UNKNOWNS];
        each_row(&mut |channel, derivatives| {
            let weight = weights[channel];
            curvature.add_product(weight, derivatives);
            let weighted = weight * residual_uv[channel];
            gradient.iter_mut().zip(derivatives).for_each(|(sum, slope)| *sum += weighted * slope);
            for (row, downdate) in projected.iter_mut().zip(downdates) {
                row.iter_mut().zip(derivatives).for_each(|(sum, slope)| *sum += downdate[channel] * slope);
            }
        });
        for (row, downdate) in projected.iter().zip(downdates) {
            let product: f64 = downdate.iter().zip(residual_uv).map(|(t, r)| t * r).sum();
            gradient.iter_mut().zip(row).for_each(|(sum, entry)| *sum -= entry * product);
        }
        curvature.subtract_squares(&projected);
    }

    /// Adds a single number with its residual r, variance σ² and derivatives a.
    pub(super) fn add(&mut self, residual: f64, variance: f64, derivatives: &[f64]) {
        self.curvature.add_product(1.0 / variance, derivatives);
        let sums = self.gradient.iter_mut().zip(derivatives);
        sums.for_each(|(sum, slope)| *sum += slope * residual / variance);
    }

    /// δ = H⁻¹ g; `None` where H is not positive definite or not finite.
    pub(super) fn solved(self) -> Option<Step> {
        let factor = self.curvature.factorised()?;
        Some(Step { delta: factor.solve(&self.gradient), factor })
    }
}
