//! Which of the fitted causes may be named: the encompassing rule.
//!
//! A cause is named if it survives every rival: if something significant of it is left when the rival is fitted in its place. A
//! rival that leaves nothing of it explains the data as well, and the two are confounded. A rival of which something is left
//! beside the cause is another cause, and the search has it.
//!
//! Source: G. E. Mizon, J.-F. Richard, Econometrica 54 (1986) 657.

pub(crate) mod experiments;
pub(crate) mod separation;
pub(crate) mod specification;
pub(crate) mod withdrawal;

use self::withdrawal::{OVER_NEAR, doubted, is_over};
use super::attribution::{Attribution, AttributionFit, Search};
use super::report::{Estimate, Finding, NotDetected};
use crate::diagnosis::attribution::inference::{Projected, Test};
use crate::diagnosis::data::target::Target;
use crate::effect::Effect;
use tactpad_core::numeric::chi_square;
use tactpad_core::numeric::dense::Matrix;

/// How large coordinates are, in units of their own deviations: of several the root of the sum of squares.
fn norm(coordinates: &[f64], covariance: &Matrix) -> f64 {
    let square = |(k, psi): (usize, &f64)| psi * psi / covariance.at(k, k).max(f64::MIN_POSITIVE);
    coordinates.iter().enumerate().map(square).sum::<f64>().sqrt()
}

/// Quantile of a normal number: 95 % lie within.
const WITHIN_95: f64 = 1.959_964;
/// Share of measurements like this one in which a cause of the stated size is found.
pub(crate) const POWER: f64 = 0.9;

impl Search<'_> {
    /// The findings with their places in the fit, the largest first. `whole` is the weighted squared residual above noise and
    /// background.
    pub(crate) fn findings(&self, found: &Attribution, whole: f64) -> Option<Vec<(usize, Finding)>> {
        let mut findings = Vec::new();
        for at in 0..found.fit.applied.len() {
            let (hypothesis, _) = found.fit.applied[at];
            let (projected, score) = self.without(&found.fit, at)?;
            let test = projected.test(&self.columns.of_hypothesis[hypothesis], &score);
            let it = &self.model.hypotheses()[hypothesis];
            let named =
                |rival: usize| (self.model.hypotheses()[rival].effect, self.model.hypotheses()[rival].target);
            let finding = Finding {
                effect: it.effect,
                target: it.target,
                parameters: self.estimates(found, at)?,
                shapes: self.shapes(found, at),
                p_value: test.p_value(),
                share: (test.square / whole).clamp(0.0, 1.0),
                confounded_with: self
                    .rivals(&found.fit, found.critical, at, &projected, &score)
                    .into_iter()
                    .map(named)
                    .collect(),
                separate_by: None,
            };
            findings.push((at, finding));
        }
        findings.sort_by(|(_, one), (_, other)| other.share.total_cmp(&one.share));
        Some(findings)
    }

    /// A fitted cause's numbers with their intervals.
    fn estimates(&self, found: &Attribution, at: usize) -> Option<Vec<Estimate>> {
        let covariance = self.covariance(&found.fit, at)?;
        let (hypothesis, coordinates) = &found.fit.applied[at];
        let it = &self.model.hypotheses()[*hypothesis];
        let parameters = it.asked();
        let size = norm(&coordinates[..parameters.len()], &covariance);
        let estimate = |(k, parameter): (usize, &super::model::Parameter)| {
            let deviation = covariance.at(k, k).max(0.0).sqrt();
            // An error of the signature moves all numbers in proportion, and turns them by as much.
            let spread = WITHIN_95 * deviation * libm::hypot(1.0, it.signature_error * size);
            Estimate {
                name: parameter.name,
                value: parameter.value(coordinates[k]),
                interval95: [-spread, spread].map(|by| parameter.value(coordinates[k] + by)),
            }
        };
        Some(parameters.iter().enumerate().map(estimate).collect())
    }

    /// The numbers of a fitted cause's course.
    fn shapes(&self, found: &Attribution, at: usize) -> Vec<(&'static str, f64)> {
        let (hypothesis, coordinates) = &found.fit.applied[at];
        let it = &self.model.hypotheses()[*hypothesis];
        let numbers = it.parameters.iter().zip(coordinates).skip(it.asked().len());
        numbers.map(|(parameter, psi)| (parameter.name, parameter.value(*psi))).collect()
    }

    /// The rivals that explain the data as well as a fitted cause, `projected` and `score` being without it.
    pub(crate) fn rivals(
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

    /// What all fitted causes together take off the weighted squares, beside the nuisances.
    pub(crate) fn removed(&self, fit: &AttributionFit) -> Option<f64> {
        let projected = Projected::of(&fit.marginal, &self.columns.fitted([]))?;
        let mut score = projected.score.clone();
        let mut columns = Vec::new();
        for (hypothesis, coordinates) in &fit.applied {
            for (column, psi) in self.columns.of_hypothesis[*hypothesis].iter().zip(coordinates) {
                score
                    .iter_mut()
                    .zip(projected.fisher.row(*column))
                    .for_each(|(score, entry)| *score += psi * entry);
                columns.push(*column);
            }
        }
        Some(projected.test(&columns, &score).square)
    }

    /// Each channel's zero and its variance.
    fn zeros(&self, found: &Attribution) -> Option<Vec<[f64; 2]>> {
        let fit = &found.fit;
        let covariance =
            self.columns.fitted(fit.applied.iter().map(|(at, _)| *at)).factorised(&fit.marginal)?;
        let diagonal = covariance.inverse_diagonal();
        Some(
            (0..fit.systems.channels.len())
                .map(|channel| [fit.coordinates[channel], diagonal[channel]])
                .collect(),
        )
    }

    /// Each channel's zero and its variance, with whatever of confounded causes leaves it nearest to none: which of them holds is not
    /// known, and a zero that only one of them needs is not either.
    fn least_zeros(&self, found: &Attribution) -> Option<Vec<[f64; 2]>> {
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
        Some(least)
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
        let factor = fitted.factorised(&fit.marginal)?;
        let score: Vec<f64> = fitted.columns.iter().map(|column| score[*column]).collect();
        let zeros = factor.solve(&score).into_iter().zip(factor.inverse_diagonal());
        Some(zeros.take(fit.systems.channels.len()).map(|(zero, variance)| [zero, variance]).collect())
    }

    /// What the zeros that are not zero take off the weighted squares.
    pub(crate) fn offsets_square(&self, found: &Attribution) -> Option<f64> {
        let squares = self.least_zeros(found)?.into_iter().map(|[zero, variance]| zero * zero / variance);
        Some(squares.filter(|square| chi_square::exceeded(*square, 1) < found.critical).sum())
    }

    /// The zeros that are not zero. Beside what is `left_by_channel` without a name each is doubted, if it is far more than that; else it
    /// is none.
    pub(crate) fn offsets(
        &self,
        found: &Attribution,
        whole: f64,
        left_by_channel: &[f64],
    ) -> Option<Vec<Finding>> {
        let finding = |(channel, [zero, variance]): (usize, [f64; 2])| {
            let square = zero * zero / variance;
            let spread = WITHIN_95 * variance.sqrt();
            let p_value = chi_square::exceeded(square, 1);
            let is_clear = left_by_channel[channel] <= 0.0 && is_over(square, left_by_channel);
            let is_found = p_value < found.critical
                && square > OVER_NEAR * left_by_channel[channel]
                && self.zero_holds_throughout(&found.fit, channel, square).unwrap_or(false);
            let finding = Finding {
                effect: Effect::ChannelOffset,
                target: Target::Channel(channel),
                parameters: vec![Estimate {
                    name: "offset_uv",
                    value: zero,
                    interval95: [zero - spread, zero + spread],
                }],
                shapes: Vec::new(),
                p_value,
                share: square / whole,
                confounded_with: Vec::new(),
                separate_by: None,
            };
            is_found.then(|| if is_clear { finding } else { doubted(finding) })
        };
        Some(self.least_zeros(found)?.into_iter().enumerate().filter_map(finding).collect())
    }

    /// What was asked for and not found, with the size that would have been.
    pub(crate) fn not_detected(&self, found: &Attribution) -> Option<Vec<NotDetected>> {
        let projected = self.projected(&found.fit)?;
        let largest = self.columns.of_hypothesis.iter().map(Vec::len).max().unwrap_or(0);
        let noncentralities: Vec<f64> = (0..=largest)
            .map(|freedom| {
                chi_square::noncentrality(chi_square::quantile(found.critical, freedom), freedom, POWER)
            })
            .collect();
        let asked = (0..self.columns.of_hypothesis.len())
            .filter(|at| !self.is_zero(*at) && found.fit.applied.iter().all(|(held, _)| held != at));
        Some(asked.filter_map(|at| self.detectable(&projected, at, &noncentralities)).collect())
    }

    fn detectable(&self, projected: &Projected, at: usize, noncentralities: &[f64]) -> Option<NotDetected> {
        let it = &self.model.hypotheses()[at];
        let columns = &self.columns.of_hypothesis[at];
        let freedom = projected.test(columns, &projected.score).freedom;
        if freedom == 0 {
            return None;
        }
        let minimum_detectable =
            columns.iter().zip(it.asked()).filter(|(column, _)| !projected.is_empty(**column));
        let size = |(column, parameter): (&usize, &super::model::Parameter)| {
            // λ = ψ² I.
            let psi = (noncentralities[freedom] / projected.fisher.at(*column, *column)).sqrt();
            (parameter.name, (parameter.value(psi) - parameter.none).abs())
        };
        Some(NotDetected {
            effect: it.effect,
            target: it.target,
            minimum_detectable: minimum_detectable.map(size).collect(),
            rival_share: self.rival_share(projected, at),
        })
    }

    /// The largest part of a hypothesis' signature that another one reproduces.
    fn rival_share(&self, projected: &Projected, at: usize) -> f64 {
        let own = &self.columns.of_hypothesis[at];
        let rivals =
            (0..self.columns.of_hypothesis.len()).filter(|rival| *rival != at && !self.is_zero(*rival));
        rivals.map(|rival| projected.reproduced(own, &self.columns.of_hypothesis[rival])).fold(0.0, f64::max)
    }
}
