//! Causes that explain the data as well as a fitted one: the encompassing rule.
//!
//! A cause stands if it survives every rival: if something significant of it is left when the rival is fitted in its place. A
//! rival that leaves nothing of it explains the data as well, and the two are confounded. A rival of which something is left
//! beside the cause is another cause, and the search has it.
//!
//! Source: G. E. Mizon, J.-F. Richard, Econometrica 54 (1986) 657.

use super::score_test::{Projected, Test};
use super::{Attribution, AttributionFit, Search, is_member};
use crate::error::{InferenceError, Stage, factorised};
use crate::policy::LEVEL;
use tactpad_numeric::chi_square;
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::rms;

/// What has no more than this part in one member moves several.
const SEVERAL: f64 = 0.5;

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
                // Whatever has no direction of its own beside a rival is that rival.
                (beyond.freedom == 0 || beyond.p_value() > critical)
                    && self.is_possible(*rival, projected, score)
            })
            .collect()
    }

    /// Of these rivals of a family's member, those that are no more than another name of it: not those that move several members together,
    /// as a supply moves all gains, where the members have no more in common than chance gives such numbers. Of what is ordinary in any
    /// specimen so much is in each of the member's numbers, as a variance: (d σ)² of each such rival that was left out.
    ///
    /// ```text
    /// d = F⁻¹ F_r: the rival as a mixture of the members, each in units of the root mean square of its effect's numbers
    /// c = dᵀψ/dᵀd, s² = |ψ − c d|²/(n − 1), t = c |d|/s
    /// ```
    pub fn rivals_of_member(
        &self,
        found: &Attribution,
        at: usize,
        rivals: Vec<usize>,
    ) -> Result<(Vec<usize>, Vec<f64>), InferenceError> {
        let Attribution { fit, family, .. } = found;
        let others = fit.applied.iter().map(|(held, _)| *held).filter(|held| !is_member(family, *held));
        let projected = Projected::of(&fit.marginal, &self.columns.fitted(others))?;
        let (mut columns, mut psi, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
        for effect in family {
            let before = psi.len();
            for (held, own) in fit.applied.iter().filter(|(held, _)| effect.contains(held)) {
                columns.extend(&self.columns.of_hypothesis[*held]);
                psi.extend(&own[..self.columns.of_hypothesis[*held].len()]);
            }
            sizes.resize(psi.len(), rms(psi[before..].iter().copied()).max(f64::MIN_POSITIVE.sqrt()));
        }
        psi.iter_mut().zip(&sizes).for_each(|(psi, size)| *psi /= size);
        let factor = factorised(&projected.fisher.picked(&columns, &columns), Stage::Causes)?;
        let mixture = |column: usize| {
            factor.solve(&columns.iter().map(|at| projected.fisher.at(*at, column)).collect::<Vec<_>>())
        };
        let is_by_chance = |column: &usize| {
            let mixture: Vec<f64> = mixture(*column).iter().zip(&sizes).map(|(d, size)| d / size).collect();
            let square = dot(&mixture, &mixture);
            let largest = mixture.iter().fold(0.0, |largest: f64, d| largest.max(d * d));
            let common = dot(&mixture, &psi) / square;
            let left: f64 = psi.iter().zip(&mixture).map(|(psi, d)| (psi - common * d).powi(2)).sum();
            let freedom = (psi.len() - 1) as f64;
            let t_square = common * common * square / (left / freedom);
            largest < SEVERAL * square && t_exceeded(t_square, freedom) > LEVEL
        };
        let is_left = |rival: &usize| !self.columns.of_hypothesis[*rival].iter().all(is_by_chance);
        let (left, dismissed): (Vec<usize>, Vec<usize>) = rivals.into_iter().partition(is_left);
        let own = &self.columns.of_hypothesis[fit.applied[at].0];
        let mut doubt = vec![0.0; own.len()];
        for rival in dismissed {
            let mixture = mixture(self.columns.of_hypothesis[rival][0]);
            let ordinary = self.model.hypotheses()[rival].ordinary;
            for (doubt, column) in doubt.iter_mut().zip(own) {
                let place = columns.iter().position(|member| member == column);
                *doubt += place.map_or(0.0, |place| (mixture[place] * ordinary).powi(2));
            }
        }
        Ok((left, doubt))
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

/// Probability that Student's t of so many degrees of freedom is further from zero, by a normal number that is about as seldom.
///
/// Source: D. L. Wallace, Ann. Math. Statist. 30 (1959) 1124: z = (8ν + 1)/(8ν + 3) √(ν ln(1 + t²/ν)), to 0.02.
fn t_exceeded(t_square: f64, freedom: f64) -> f64 {
    let z = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) * (freedom * (t_square / freedom).ln_1p()).sqrt();
    chi_square::exceeded(z * z, 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t_is_students() {
        // Of tables: 95 % lie within 2.306 of 8 degrees of freedom, 99 % within 3.355; 95 % within 2.086 of 20.
        for (t, freedom, wanted) in [(2.306_f64, 8.0, 0.05), (3.355, 8.0, 0.01), (2.086, 20.0, 0.05)] {
            assert!((t_exceeded(t * t, freedom) / wanted - 1.0).abs() < 0.02, "{t} {freedom}");
        }
    }
}
