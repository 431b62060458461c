//! The terms of a fit's log evidence.

use crate::calibration::noise::lasting::Filter;
use crate::calibration::noise::model::NoiseModel;
use crate::calibration::noise::residual::Residual;

/// ln p(contacts | θ) = −½ Σ (rᵀ V⁻¹ r + ln det V), with lasting noise integrated over, but for a constant.
pub(crate) fn log_likelihood_of_contacts(residuals: &[Residual], noise_model: &NoiseModel) -> Option<f64> {
    let wander = noise_model.wander();
    let mut filter = wander.as_ref().map(|wander| Filter::new(wander, 0));
    let mut previous_s = None;
    let mut cost = 0.0;
    for residual in residuals {
        let precision = noise_model.marginal_precision(residual)?;
        cost += precision.cost(&residual.residual_uv);
        if let Some(filter) = &mut filter {
            if let Some(previous_s) = previous_s.replace(residual.at_s) {
                filter.pass(residual.at_s - previous_s, None)?;
            }
            filter.see(&precision.matrix(), residual, &[]);
        }
    }
    cost += filter.map_or(Some(0.0), |filter| filter.end(None))?;
    Some(-0.5 * cost)
}

/// ln p(θ) = ½ Σᵢ (ln Pᵢ − Pᵢ (mᵢ − θᵢ)²), but for a constant.
pub(crate) fn log_prior(values: &[f64], mean: &[f64], precisions: &[f64]) -> f64 {
    let term = |(precision, (mean, value)): (&f64, (&f64, &f64))| {
        precision.ln() - precision * (mean - value).powi(2)
    };
    0.5 * precisions.iter().zip(mean.iter().zip(values)).map(term).sum::<f64>()
}
