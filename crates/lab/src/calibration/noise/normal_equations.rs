//! The normal equations H δ = g of a Gauss-Newton step δ around the parameters θ:
//!
//! ```text
//! H = P + Σ Aᵀ V⁻¹ A + Σ a aᵀ/σ²        g = P (m − θ) + Σ Aᵀ V⁻¹ r + Σ a r/σ²
//! ```
//!
//! P are the precisions of the prior and m its mean. The first sums are over contacts, with the residuals r of nine channels,
//! their covariance V and A = ∂f/∂θ; the second ones over single numbers with a variance σ² and derivatives a.

use crate::calibration::model::ReadingSlopes;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::linear::{LargeFactor, Reduced, Symmetric};
use tactpad_numeric::products::{combined, dot};

/// So many products are collected before they go into H, which is larger than a processor's cache.
const COLLECTED: usize = 72;

/// The sums H and g.
pub(crate) struct NormalEquations {
    curvature: Symmetric,
    gradient: Vec<f64>,
    /// Vectors l and r whose l rᵀ is still to be added to H.
    collected: Vec<(Vec<f64>, Vec<f64>)>,
}

/// A Gauss-Newton step δ, and the factor of the curvature H.
pub(crate) struct GaussNewtonStep {
    pub(crate) delta: Vec<f64>,
    pub(crate) factor: LargeFactor,
}

impl NormalEquations {
    /// Those of the prior alone: H = P, g = P (m − θ). All three have as many entries as there are parameters.
    pub(crate) fn of_prior(precisions: &[f64], mean: &[f64], values: &[f64]) -> Self {
        let mut curvature = Symmetric::zeros(values.len());
        let gradient =
            precisions.iter().zip(mean.iter().zip(values)).map(|(p, (m, v))| p * (m - v)).collect();
        precisions.iter().enumerate().for_each(|(at, precision)| curvature.add_diagonal(at, *precision));
        Self { curvature, gradient, collected: Vec::with_capacity(COLLECTED) }
    }

    /// Adds a contact by the channels' derivatives A = C S + R ([`ReadingSlopes`]) and the rows of V⁻¹ A, `weighted`:
    ///
    /// ```text
    /// Aᵀ V⁻¹ A = Sᵀ (Cᵀ V⁻¹ A) + Rᵀ (V⁻¹ A)        Aᵀ V⁻¹ r = (V⁻¹ A)ᵀ r
    /// ```
    ///
    /// The rows of S and R have few entries.
    pub(crate) fn add_contact(
        &mut self,
        slopes: ReadingSlopes,
        weighted: Vec<Vec<f64>>,
        residual_uv: &[f64; CHANNELS],
    ) {
        for (row, residual_uv) in weighted.iter().zip(residual_uv) {
            self.gradient.iter_mut().zip(row).for_each(|(sum, slope)| *sum += slope * residual_uv);
        }
        let ReadingSlopes { coupling, signals, rest } = slopes;
        let transposed: [[f64; CHANNELS]; CHANNELS] =
            std::array::from_fn(|from| std::array::from_fn(|into| coupling[into][from]));
        self.collected.extend(signals.into_iter().zip(combined(&transposed, &weighted)));
        self.collected.extend(rest.into_iter().zip(weighted));
        self.add_collected_if_many();
    }

    /// H ← H − v vᵀ, g ← g − v s.
    pub(crate) fn subtract(&mut self, vector: Vec<f64>, residual: f64) {
        self.gradient.iter_mut().zip(&vector).for_each(|(sum, entry)| *sum -= entry * residual);
        self.collected.push((vector.iter().map(|entry| -entry).collect(), vector));
        self.add_collected_if_many();
    }

    fn add_collected_if_many(&mut self) {
        if self.collected.len() >= COLLECTED {
            self.add_collected();
        }
    }

    fn add_collected(&mut self) {
        self.curvature.add_products(&self.collected);
        self.collected.clear();
    }

    /// Adds a single number with its residual r, variance σ² and derivatives a.
    pub(crate) fn add(&mut self, residual: f64, variance: f64, derivatives: &[f64]) {
        self.curvature.add_product(1.0 / variance, derivatives);
        let sums = self.gradient.iter_mut().zip(derivatives);
        sums.for_each(|(sum, slope)| *sum += slope * residual / variance);
    }

    /// g ← g + c v, where v has the first entries.
    pub(crate) fn pull(&mut self, by: f64, direction: &[f64]) {
        self.gradient.iter_mut().zip(direction).for_each(|(sum, entry)| *sum += by * entry);
    }

    /// δ = H⁻¹ g; `None` where H is not positive definite or not finite.
    pub(crate) fn solved(mut self) -> Option<GaussNewtonStep> {
        self.add_collected();
        let factor = self.curvature.factorised()?;
        Some(GaussNewtonStep { delta: factor.solve(&self.gradient), factor })
    }

    /// ½ (gᵀ H⁻¹ g − ln det H): what integrating over the unknowns adds to ln p at θ.
    pub(crate) fn log_evidence_gained(mut self) -> Option<f64> {
        self.add_collected();
        let factor = self.curvature.factorised()?;
        let half = factor.solve_lower(&self.gradient);
        Some(0.5 * (dot(&half, &half) - factor.log_determinant()))
    }

    /// How many unknowns there are.
    pub(crate) const fn size(&self) -> usize {
        self.gradient.len()
    }

    /// The equations of all but the first unknowns, when these are free; `None` where H of the first ones is not positive definite.
    pub(crate) fn reduced(mut self, first: usize) -> Option<Reduced> {
        self.add_collected();
        self.curvature.reduced(&self.gradient, first)
    }
}
