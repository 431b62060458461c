//! The channels' zeros beside the causes that hold.

use super::{Attribution, AttributionFit, Search};
use crate::error::InferenceError;
use tactpad_numeric::chi_square;

impl<L> Search<'_, L> {
    /// Each channel's zero and its variance.
    fn zeros(&self, found: &Attribution) -> Result<Vec<[f64; 2]>, InferenceError> {
        let fit = &found.fit;
        let covariance =
            self.columns.fitted(fit.applied.iter().map(|(at, _)| *at)).factorised(&fit.marginal)?;
        let diagonal = covariance.inverse_diagonal();
        Ok((0..fit.systems.channels.len())
            .map(|channel| [fit.coordinates[channel], diagonal[channel]])
            .collect())
    }

    /// Each channel's zero and its variance, with whatever of confounded causes leaves it nearest to none: which of them holds is not
    /// known, and a zero that only one of them needs is not either.
    pub fn least_zeros(&self, found: &Attribution) -> Result<Vec<[f64; 2]>, InferenceError> {
        let mut least = self.zeros(found)?;
        for at in 0..found.fit.applied.len() {
            let (projected, score) = self.without(&found.fit, at)?;
            for rival in self.rivals(&found.fit, found.critical, at, &projected, &score) {
                let zeros = self.zeros_with(&found.fit, at, rival).into_iter().flatten();
                let square = |[zero, variance]: [f64; 2]| zero * zero / variance;
                for (least, other) in
                    least.iter_mut().zip(zeros).filter(|(one, other)| square(*other) < square(**one))
                {
                    *least = other;
                }
            }
        }
        Ok(least)
    }

    /// The zeros with a rival in the place of a fitted cause; `None` where the other causes reproduce it.
    fn zeros_with(&self, fit: &AttributionFit, at: usize, rival: usize) -> Option<Vec<[f64; 2]>> {
        let others =
            fit.applied.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, (held, _))| *held);
        let fitted = self.columns.fitted(others.chain([rival]));
        // Aᵀ V⁻¹ (r + J ψ̂): about the point without the cause, to first order.
        let mut score = fit.marginal.score.clone();
        let (hypothesis, coordinates) = &fit.applied[at];
        for (column, psi) in self.columns.of_hypothesis[*hypothesis].iter().zip(coordinates) {
            let row = fit.marginal.fisher.row(*column);
            score.iter_mut().zip(row).for_each(|(score, entry)| *score += psi * entry);
        }
        let factor = fitted.factorised(&fit.marginal).ok()?;
        let score: Vec<f64> = fitted.columns.iter().map(|column| score[*column]).collect();
        let zeros = factor.solve(&score).into_iter().zip(factor.inverse_diagonal());
        Some(zeros.take(fit.systems.channels.len()).map(|(zero, variance)| [zero, variance]).collect())
    }

    /// What the zeros that are not zero take off the weighted squares.
    pub fn offsets_square(&self, found: &Attribution) -> Result<f64, InferenceError> {
        let squares = self.least_zeros(found)?.into_iter().map(|[zero, variance]| zero * zero / variance);
        Ok(squares.filter(|square| chi_square::exceeded(*square, 1) < found.critical).sum())
    }
}
