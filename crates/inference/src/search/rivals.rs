//! Causes that explain the data as well as a fitted one: the encompassing rule.
//!
//! A cause stands if it survives every rival: if something significant of it is left when the rival is fitted in its place. A
//! rival that leaves nothing of it explains the data as well, and the two are confounded. A rival of which something is left
//! beside the cause is another cause, and the search has it. What is left may be no more than an error of the two signatures, however well
//! it is seen:
//!
//! ```text
//! q(cause | rival) < 1.96² (ε² + εᵣ²) q(both),  q what is taken off the weighted squares
//! ```
//!
//! Source: G. E. Mizon, J.-F. Richard, Econometrica 54 (1986) 657.

use std::ops::Range;

use super::score_test::{Projected, Test};
use super::{Attribution, AttributionFit, Search, is_random_effect};
use crate::error::{InferenceError, Stage, factorised};
use crate::policy::{LEVEL, WITHIN_95};
use tactpad_numeric::chi_square;
use tactpad_numeric::dense::gram;
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::{population_deviation, rms};

/// What has no more than this part in one member moves several.
const SEVERAL: f64 = 0.5;
/// A rival that leaves no more than this part of what both explain is fitted in the cause's place.
const NEAR: f64 = 0.25;
/// An effect or a member with more than this part in a mixture is moved by it.
const MOVED: f64 = 0.05;

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
                let is_rival = beyond.freedom == 0
                    || beyond.p_value() > critical
                    || beyond.square < self.wrong_share(own, *rival) * both.square;
                is_rival && self.is_possible(*rival, projected, score)
            })
            .collect()
    }

    /// The rivals of a cause beside which little of it is left, and that explain the data as well where they are fitted in its place: far from
    /// none signatures bend, and what is left of the cause may be that.
    ///
    /// ```text
    /// q(cause | rival) < NEAR q(both),   Dᵣ < D + χ²(critical),   D = n ln(squares that a fit leaves)
    /// ```
    pub fn rivals_in_place(
        &self,
        found: &Attribution,
        at: usize,
        projected: &Projected,
        score: &[f64],
    ) -> Result<Vec<usize>, InferenceError> {
        let (fit, critical) = (&found.fit, found.critical);
        let (own, _) = fit.applied[at];
        let columns = &self.columns.of_hypothesis[own];
        let mut rivals = self.rivals(fit, critical, at, projected, score);
        let held = |rival: usize| fit.applied.iter().any(|(held, _)| *held == rival);
        let bends = |rival: usize| self.wrong_share(own, rival) > 0.0;
        let others: Vec<usize> = (0..self.columns.of_hypothesis.len())
            .filter(|rival| {
                !held(*rival) && !rivals.contains(rival) && !self.is_zero(*rival) && bends(*rival)
            })
            .collect();
        let least = self.deviance(fit) + chi_square::quantile(critical, 1);
        for rival in others {
            let alone = projected.test(&self.columns.of_hypothesis[rival], score);
            let both =
                projected.test(&[self.columns.of_hypothesis[rival].as_slice(), columns].concat(), score);
            if both.square - alone.square > NEAR * both.square {
                continue;
            }
            let mut applied = fit.applied.clone();
            applied[at] = (rival, vec![0.0; self.model.hypotheses()[rival].parameters.len()]);
            // One that cannot be fitted explains nothing.
            let Ok(other) = self.nearly_fitted(&applied, Some(fit)) else { continue };
            if !self.is_at_an_end(&other, at) && self.deviance(&other) < least {
                rivals.push(rival);
            }
        }
        Ok(rivals)
    }

    /// n ln of the mean square that a fit leaves, each channel about its mean and in units of its root mean square: −2 ln of how probable it
    /// makes the readings by a noise that is known by nothing else, but for a constant. Doubts of labels that are moved have no part.
    fn deviance(&self, fit: &AttributionFit) -> f64 {
        let (mut square, mut count) = (0.0, 0.0);
        let sizes = self.model.sizes();
        for (channel, modelled) in self.model.readings(&fit.applied).iter().enumerate() {
            let read = self.observations.readings[channel].iter().zip(modelled);
            let told = read.zip(&self.observations.is_told[channel]).filter(|(_, is_told)| **is_told);
            let left: Vec<f64> =
                told.map(|((read, modelled), _)| (read - modelled) / sizes[channel]).collect();
            count += left.len() as f64;
            square += left.len() as f64 * population_deviation(&left).powi(2);
        }
        count * (square / count).ln()
    }

    /// The rivals of a random effect: those that explain the data as well, and those that the random effects reproduce, as what is left of
    /// the member beside these may be an error of the signatures. Not those that move several members together, as a supply moves all
    /// gains, where the members have no more in common than chance gives such numbers (`in_common`). Of what any specimen has so much is in
    /// each of the member's numbers, as a variance: (d σ)² of each such rival that was left out.
    ///
    /// ```text
    /// d = F⁻¹ F_r: the rival as a mixture of the members, each in units of the root mean square of its effect's numbers,
    ///     of the effects that it moves
    /// ```
    pub fn rivals_of_random_effect(
        &self,
        found: &Attribution,
        at: usize,
        projected: &Projected,
        score: &[f64],
    ) -> Result<(Vec<usize>, Vec<f64>), InferenceError> {
        let Attribution { fit, random_effects, reproduced, .. } = found;
        let mut rivals = self.rivals(fit, found.critical, at, projected, score);
        let held =
            |rival: usize| fit.applied.iter().any(|(held, _)| *held == rival) || rivals.contains(&rival);
        let others: Vec<usize> = (0..reproduced.len())
            .filter(|rival| reproduced[*rival] && !held(*rival) && !self.is_zero(*rival))
            .collect();
        let chosen =
            fit.applied.iter().map(|(held, _)| *held).filter(|held| !is_random_effect(random_effects, *held));
        let projected = Projected::of(&fit.marginal, &self.columns.fitted(chosen))?;
        let (mut columns, mut psi, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
        // Where each effect's numbers end.
        let mut ends = Vec::new();
        for effect in random_effects {
            let before = psi.len();
            for (held, own) in fit.applied.iter().filter(|(held, _)| effect.contains(held)) {
                columns.extend(&self.columns.of_hypothesis[*held]);
                psi.extend(&own[..self.columns.of_hypothesis[*held].len()]);
            }
            sizes.resize(psi.len(), rms(psi[before..].iter().copied()).max(f64::MIN_POSITIVE.sqrt()));
            ends.push(psi.len());
        }
        psi.iter_mut().zip(&sizes).for_each(|(psi, size)| *psi /= size);
        let factor = factorised(&projected.fisher.picked(&columns, &columns), Stage::Causes)?;
        let mixture = |column: usize| {
            factor.solve(&columns.iter().map(|at| projected.fisher.at(*at, column)).collect::<Vec<_>>())
        };
        let own = &self.columns.of_hypothesis[fit.applied[at].0];
        let scaled = |column: &usize| -> Vec<f64> {
            mixture(*column).iter().zip(&sizes).map(|(d, size)| d / size).collect()
        };
        let moves = |rival: &usize| {
            self.columns.of_hypothesis[*rival].iter().any(|column| {
                let mixture = scaled(column);
                let of_own = columns.iter().zip(&mixture).filter(|(member, _)| own.contains(member));
                of_own.map(|(_, d)| d * d).sum::<f64>() > MOVED * dot(&mixture, &mixture)
            })
        };
        rivals.extend(others.into_iter().filter(moves));
        // Whether the members have no more of a rival than chance gives such numbers.
        let is_by_chance = |rival: &usize| {
            let mixtures: Vec<Vec<f64>> = self.columns.of_hypothesis[*rival].iter().map(scaled).collect();
            let part = |mixture: &[f64], of: Range<usize>| {
                mixture[of].iter().map(|d| d * d).sum::<f64>() / dot(mixture, mixture)
            };
            let is_of_several =
                |mixture: &Vec<f64>| (0..psi.len()).all(|at| part(mixture, at..at + 1) < SEVERAL);
            let effects =
                std::iter::once(0).chain(ends.iter().copied()).zip(&ends).map(|(from, to)| from..*to);
            let is_moved =
                |of: &Range<usize>| mixtures.iter().any(|mixture| part(mixture, of.clone()) > MOVED);
            let moved: Vec<usize> = effects.filter(is_moved).flatten().collect();
            let picked = |of: &[f64]| moved.iter().map(|at| of[*at]).collect::<Vec<f64>>();
            let mixtures_moved: Vec<Vec<f64>> = mixtures.iter().map(|mixture| picked(mixture)).collect();
            mixtures.iter().all(is_of_several) && in_common(&mixtures_moved, &picked(&psi)) > LEVEL
        };
        let (dismissed, left): (Vec<usize>, Vec<usize>) = rivals.into_iter().partition(is_by_chance);
        let mut doubt = vec![0.0; own.len()];
        for rival in dismissed {
            let mixture = mixture(self.columns.of_hypothesis[rival][0]);
            let prior_deviation = self.model.hypotheses()[rival].prior_deviation;
            for (doubt, column) in doubt.iter_mut().zip(own) {
                let place = columns.iter().position(|member| member == column);
                *doubt += place.map_or(0.0, |place| (mixture[place] * prior_deviation).powi(2));
            }
        }
        Ok((left, doubt))
    }

    /// The part of what two hypotheses explain that may be an error of their signatures.
    fn wrong_share(&self, one: usize, other: usize) -> f64 {
        let errors = [one, other].map(|at| self.model.hypotheses()[at].signature_error);
        WITHIN_95.powi(2) * dot(&errors, &errors)
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

/// Probability that n normal numbers ψ with mean 0 have more in common with q mixtures D than these:
///
/// ```text
/// (ν + q/2 − 1) ln(|ψ|²/|ψ − D c|²) ~ χ² of q,  ν = n − q,  c by least squares
/// ```
///
/// Source: M. S. Bartlett, Proc. R. Soc. A 160 (1937) 268; exact for q = 2, and to 3 % for q = 1 and 8 numbers. 0 where nothing is left of ψ,
/// or there are too few.
fn in_common(mixtures: &[Vec<f64>], psi: &[f64]) -> f64 {
    let (count, freedom) = (mixtures.len(), psi.len() as f64 - mixtures.len() as f64);
    let Some(factor) = gram(&mixtures.iter().map(Vec::as_slice).collect::<Vec<_>>()).factorised() else {
        return 0.0;
    };
    let across: Vec<f64> = mixtures.iter().map(|mixture| dot(mixture, psi)).collect();
    let whole = dot(psi, psi);
    let left = whole - dot(&factor.solve(&across), &across);
    if freedom < 1.0 || left <= 0.0 {
        return 0.0;
    }
    chi_square::exceeded((freedom + count as f64 / 2.0 - 1.0) * (whole / left).ln(), count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_have_something_in_common_are_known_by_f() {
        // Of tables: 95 % of Student's t lie within 2.306 of 8 degrees of freedom; of F with 2 and 4 below 6.944.
        let alone = |t: f64| in_common(&[vec![1.0; 9]], &numbers(9, t / 3.0 / 8.0_f64.sqrt()));
        assert!((alone(2.306) / 0.05 - 1.0).abs() < 0.03);
        let [one, other] = [[1.0, 0.0], [0.0, 1.0]].map(|on| on.repeat(3));
        let psi = [1.0, 0.5, -1.0, -0.5, 0.0, 0.0];
        let c = (6.944_f64 * 2.0 / 4.0 * 2.5 / 6.0).sqrt();
        let psi: Vec<f64> = psi.iter().map(|left| left + c).collect();
        assert!((in_common(&[one, other], &psi) / 0.05 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn numbers_that_are_nothing_else_and_too_few_are_in_common() {
        assert_eq!(in_common(&[vec![1.0, 2.0, 3.0]], &[2.0, 4.0, 6.0]), 0.0);
        assert_eq!(in_common(&[vec![1.0], vec![2.0]], &[1.0]), 0.0);
    }

    /// So many numbers with this mean and Σ of squares about it 1.
    fn numbers(count: usize, mean: f64) -> Vec<f64> {
        let away = (0..count).map(|at| [1.0, -1.0, 0.0][at % 3]);
        let norm = (2.0 * (count / 3) as f64).sqrt();
        away.map(|it| mean + it / norm).collect()
    }
}
