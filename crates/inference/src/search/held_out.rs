//! Whether a cause foretells rows that had no part in its numbers: cross-validation over the clusters.
//!
//! The clusters are dealt to K folds. With ψ₋ₖ fitted to all folds but k, and Q of the rows of fold k alone,
//!
//! ```text
//! D = Σₖ Qₖ(ψ₋ₖ) − Qₖ(ψ̂),   Qₖ(ψ̂ + d) − Qₖ(ψ̂) = dᵀ Fₖ d − 2 sₖᵀ d
//! ```
//!
//! to first order about the fit ψ̂, with the information F and the score s beside the nuisances. A cause foretells nothing if D is no larger
//! without it, all others fitted anew.
//!
//! Source: M. Stone, J. R. Statist. Soc. B 36 (1974) 111.

use super::score_test::Projected;
use super::{AttributionFit, Search};
use crate::error::{InferenceError, Stage, factorised};
use tactpad_numeric::products::dot;

/// K.
const FOLDS: usize = 5;

/// What one fold's rows tell of the numbers, and what all others do.
struct Fold {
    own: Projected,
    rest: Projected,
}

impl<L> Search<'_, L> {
    /// For each fitted cause, how much worse rows that had no part in the numbers are foretold without it: D without it, less D. Where a fold's rows are
    /// needed to know the numbers at all, nothing speaks against any.
    pub fn predictive_gains(&self, fit: &AttributionFit) -> Vec<f64> {
        let of = |folds: &[Fold]| -> Result<Vec<f64>, InferenceError> {
            let all = self.predictive_deviance(folds, fit, None)?;
            let without = |at| Ok(self.predictive_deviance(folds, fit, Some(at))? - all);
            (0..fit.applied.len()).map(without).collect()
        };
        self.folds(fit)
            .and_then(|folds| of(&folds))
            .unwrap_or_else(|_| vec![f64::INFINITY; fit.applied.len()])
    }

    fn folds(&self, fit: &AttributionFit) -> Result<Vec<Fold>, InferenceError> {
        let columns = self.columns.fitted(fit.applied.iter().map(|(at, _)| *at)).columns;
        let projected = |rows: &[usize], is_fitted: bool| {
            let mut marginal = fit.systems.marginal_at(rows, &columns, &fit.background)?;
            if is_fitted {
                self.columns.pull(&mut marginal, &fit.applied);
            }
            Projected::of(&marginal, &self.columns.nuisances())
        };
        let fold = |k: usize| {
            let (own, rest): (Vec<usize>, Vec<usize>) =
                (0..self.clusters.len()).partition(|row| self.clusters[*row] % FOLDS == k);
            Ok(Fold { own: projected(&own, false)?, rest: projected(&rest, true)? })
        };
        (0..FOLDS).map(fold).collect()
    }

    /// D, or what it is without the cause at this place of the fit.
    fn predictive_deviance(
        &self,
        folds: &[Fold],
        fit: &AttributionFit,
        without: Option<usize>,
    ) -> Result<f64, InferenceError> {
        let (mut free, mut held) = (Vec::new(), vec![0.0; self.columns.precisions.len()]);
        for (at, (hypothesis, coordinates)) in fit.applied.iter().enumerate() {
            let columns = self.columns.all_of(*hypothesis);
            if without == Some(at) {
                columns.zip(coordinates).for_each(|(column, psi)| held[column] = -psi);
            } else {
                free.extend(columns);
            }
        }
        let of_fold = |Fold { own, rest }: &Fold| {
            let mut inner = rest.fisher.picked(&free, &free);
            for (row, column) in free.iter().enumerate() {
                inner.row_mut(row)[row] += self.columns.precisions[*column];
            }
            let shift = rest.fisher.times(&held);
            let score: Vec<f64> = free.iter().map(|column| rest.score[*column] - shift[*column]).collect();
            let mut d = held.clone();
            let solved = factorised(&inner, Stage::Causes)?.solve(&score);
            free.iter().zip(solved).for_each(|(column, value)| d[*column] = value);
            Ok(dot(&d, &own.fisher.times(&d)) - 2.0 * dot(&own.score, &d))
        };
        folds.iter().map(of_fold).sum()
    }
}
