//! What random effects make up together: whatever else looks like a mixture of them cannot be told from them.

use rayon::prelude::*;

use super::{Attribution, AttributionFit, Search, is_random_effect};
use crate::error::{InferenceError, Stage, factorised};
use crate::model::Signature;
use crate::policy::{MODEL_ERROR, SIGNATURE_ERROR, WITHIN_95};
use tactpad_numeric::dense::{Matrix, gram};
use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::mean;

/// A remainder of which the background's functions make up more than this part is smooth.
const SMOOTH: f64 = 0.5;
/// What makes a solution by the background's functions unique, as a share of their mean square.
const RIDGE: f64 = 1e-9;

/// The signatures of random effects, each channel in units of its root mean square and about its mean.
struct RandomEffectsSpan<'s, 'm, L> {
    search: &'s Search<'m, L>,
    fit: &'s AttributionFit,
    sizes: Vec<f64>,
    /// A.
    members: Vec<Vec<f64>>,
    /// Of each member, the share of its signature that may be wrong.
    errors: Vec<f64>,
    /// AᵀA.
    gram: Matrix,
    /// None where there is no member.
    factor: Option<LargeFactor>,
}

/// c = (AᵀA)⁻¹ Aᵀ s, and what is left of |s|².
struct Mixture {
    weights: Vec<f64>,
    whole: f64,
    left: f64,
}

impl<'s, 'm, L> RandomEffectsSpan<'s, 'm, L> {
    fn of(
        search: &'s Search<'m, L>,
        fit: &'s AttributionFit,
        random_effects: &[Vec<usize>],
    ) -> Result<Self, InferenceError> {
        let mut span = Self {
            search,
            fit,
            sizes: search.model.sizes(),
            members: Vec::new(),
            errors: Vec::new(),
            gram: Matrix::zeros(0, 0),
            factor: None,
        };
        for at in random_effects.iter().flatten() {
            let own: Vec<Vec<f64>> = span.asked(*at).map(|it| span.scaled(it)).collect();
            span.errors.resize(span.errors.len() + own.len(), search.model.hypotheses()[*at].signature_error);
            span.members.extend(own);
        }
        if !span.members.is_empty() {
            span.gram = gram(&span.members.iter().map(Vec::as_slice).collect::<Vec<_>>());
            span.factor = Some(factorised(&span.gram, Stage::Causes)?);
        }
        Ok(span)
    }

    fn asked(&self, hypothesis: usize) -> impl Iterator<Item = &'s Signature> + use<'s, L> {
        let numbers = self.search.columns.of_hypothesis[hypothesis].len();
        self.fit.linearised.signatures[hypothesis].iter().take(numbers)
    }

    fn scaled(&self, signature: &Signature) -> Vec<f64> {
        let channels = signature.iter().zip(&self.sizes).zip(&self.fit.linearised.readings);
        let scaled = channels.flat_map(|((values, size), readings)| match values {
            Some(values) => {
                let middle = mean(values.iter().copied());
                values.iter().map(|value| (value - middle) / size.max(f64::MIN_POSITIVE)).collect()
            }
            None => vec![0.0; readings.len()],
        });
        scaled.collect()
    }

    fn mixture(&self, column: &[f64]) -> Mixture {
        let whole = dot(column, column);
        let Some(factor) = &self.factor else { return Mixture { weights: Vec::new(), whole, left: whole } };
        let across: Vec<f64> = self.members.iter().map(|member| dot(member, column)).collect();
        let weights = factor.solve(&across);
        Mixture { left: whole - dot(&weights, &across), weights, whole }
    }

    /// Which hypotheses the members reproduce to within what signatures may be wrong by: by the little that is left of them nothing can be
    /// told, however well it is seen. Shares ε of signatures are wrong, of s and of the members a that make it up.
    ///
    /// ```text
    /// |s − A c|² < ε₀² |s|² + 1.96² (ε² |s|² + Σ εₖ² cₖ² |aₖ|²)
    /// ```
    fn reproduced(&self) -> Vec<bool> {
        let errors: Vec<f64> = self.search.model.hypotheses().iter().map(|it| it.signature_error).collect();
        let is_reproduced = |own: f64, column: &[f64]| {
            let Mixture { weights, whole, left } = self.mixture(column);
            let parts = weights.iter().zip(&self.errors).enumerate();
            let wrong = own.powi(2) * whole
                + parts.map(|(k, (c, error))| (c * error).powi(2) * self.gram.at(k, k)).sum::<f64>();
            left < SIGNATURE_ERROR.powi(2) * whole + WITHIN_95.powi(2) * wrong
        };
        if self.factor.is_none() {
            return vec![false; errors.len()];
        }
        let columns = (0..errors.len()).map(|at| self.asked(at).map(|it| self.scaled(it)).collect());
        let columns: Vec<Vec<Vec<f64>>> = columns.collect();
        let all = columns.par_iter().zip(&errors);
        all.map(|(columns, error)| columns.iter().all(|column| is_reproduced(*error, column))).collect()
    }
}

impl<L> Search<'_, L> {
    /// Which hypotheses random effects reproduce.
    pub(super) fn reproduced(
        &self,
        fit: &AttributionFit,
        random_effects: &[Vec<usize>],
    ) -> Result<Vec<bool>, InferenceError> {
        Ok(RandomEffectsSpan::of(self, fit, random_effects)?.reproduced())
    }

    /// Whether a fitted cause beside random effects changes no more, beyond what the members make up, than a model itself gets wrong, and in the same
    /// way, smoothly with the place and the load.
    ///
    /// ```text
    /// q = s ψ − A c,   |q|² < ε² n for the n readings that s changes,   |B (BᵀB)⁻¹ Bᵀ q|² > ½ |q|²
    /// ```
    pub fn is_within_model_error(&self, found: &Attribution, at: usize) -> Result<bool, InferenceError> {
        let Attribution { fit, random_effects, .. } = found;
        let (hypothesis, psi) = &fit.applied[at];
        if random_effects.is_empty() || is_random_effect(random_effects, *hypothesis) {
            return Ok(false);
        }
        let span = RandomEffectsSpan::of(self, fit, random_effects)?;
        let rows = self.observations.rows();
        let mut column = vec![0.0; rows * span.sizes.len()];
        let mut is_changed = vec![false; span.sizes.len()];
        for (signature, psi) in span.asked(*hypothesis).zip(psi) {
            column.iter_mut().zip(span.scaled(signature)).for_each(|(sum, value)| *sum += psi * value);
            is_changed.iter_mut().zip(signature).for_each(|(any, own)| *any |= own.is_some());
        }
        let Mixture { weights, left, .. } = span.mixture(&column);
        let changed = rows * is_changed.iter().filter(|it| **it).count();
        if left >= MODEL_ERROR.powi(2) * changed as f64 {
            return Ok(false);
        }
        for (member, weight) in span.members.iter().zip(weights) {
            column.iter_mut().zip(member).for_each(|(left, value)| *left -= weight * value);
        }
        let mut smooth = 0.0;
        for (channel, own) in column.chunks(rows).enumerate().filter(|(channel, _)| is_changed[*channel]) {
            let functions = fit.systems.background_at(channel, 1.0, self.observations);
            let mut inner = gram(&functions.iter().map(Vec::as_slice).collect::<Vec<_>>());
            let mean_square =
                (0..functions.len()).map(|k| inner.at(k, k)).sum::<f64>() / functions.len() as f64;
            (0..functions.len()).for_each(|k| inner.row_mut(k)[k] += RIDGE * mean_square);
            let across: Vec<f64> = functions.iter().map(|function| dot(function, own)).collect();
            smooth += dot(&factorised(&inner, Stage::Background)?.solve(&across), &across);
        }
        Ok(smooth > SMOOTH * left)
    }
}
