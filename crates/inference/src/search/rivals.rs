//! Causes that explain the data as well as a fitted one: the encompassing rule.
//!
//! A cause stands if it survives every rival: if something significant of it is left when the rival is fitted in its place. A
//! rival that leaves nothing of it explains the data as well, and the two are confounded. A rival of which something is left
//! beside the cause is another cause, and the search has it.
//!
//! Source: G. E. Mizon, J.-F. Richard, Econometrica 54 (1986) 657.

use super::score_test::{Projected, Test};
use super::{AttributionFit, Search};

impl<L> Search<'_, L> {
    /// The rivals that explain the data as well as a fitted cause, `projected` and `score` being without it.
    pub fn rivals(
        &self,
        fit: &AttributionFit,
        critical: f64,
        at: usize,
        projected: &Projected,
        score: &[f64],
    ) -> Vec<usize> {
        let (own, _) = fit.applied[at];
        let columns = &self.columns.of_hypothesis[own];
        let held = |rival: &usize| fit.applied.iter().any(|(held, _)| held == rival);
        (0..self.columns.of_hypothesis.len())
            .filter(|rival| !held(rival) && !self.is_zero(*rival))
            .filter(|rival| {
                let others = &self.columns.of_hypothesis[*rival];
                let alone = projected.test(others, score);
                let both = projected.test(&[others.as_slice(), columns].concat(), score);
                let beyond = Test {
                    square: (both.square - alone.square).max(0.0),
                    freedom: both.freedom - alone.freedom,
                };
                beyond.p_value() > critical && self.is_possible(*rival, projected, score)
            })
            .collect()
    }

    /// Whether a rival would explain the data with numbers that are physically possible.
    fn is_possible(&self, rival: usize, projected: &Projected, score: &[f64]) -> bool {
        let columns = &self.columns.of_hypothesis[rival];
        let Some(factor) = projected.fisher.picked(columns, columns).factorised() else { return true };
        let of_columns: Vec<f64> = columns.iter().map(|column| score[*column]).collect();
        let parameters = self.model.hypotheses()[rival].asked();
        factor.solve(&of_columns).iter().zip(parameters).all(|(psi, parameter)| {
            let back = parameter.coordinate(parameter.value(*psi));
            (back - psi).abs() <= 1e-9 + 1e-6 * psi.abs()
        })
    }
}
