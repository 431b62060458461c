//! The fit of hypotheses that hold: Gauss and Newton's steps with a covariance that is held, then the covariance of where they lead.
//!
//! What is least is
//!
//! ```text
//! Q(ψ) = min over ν of (r(ψ) − N ν)ᵀ V⁻¹ (r(ψ) − N ν) + νᵀ P ν, and Σ P ψ² of the courses
//! ```
//!
//! with the nuisances N (zeros, the model's own errors) and their priors P. V follows from Q's residual, so both are found in turn.

use super::{Applied, AttributionFit, SETTLED, Search};
use crate::covariance::{Background, Marginal, Systems};
use crate::error::InferenceError;
use crate::model::{Column, CommonError, Linearised};

/// How often a covariance is found, and steps with each of them: where causes are told, and where they are only looked for.
const STEPS: usize = 12;
const STEPS_OF_SEARCH: usize = 3;
/// How often a step is halved.
const HALVINGS: i32 = 5;

/// A covariance that is held, and the point about which it was found.
struct Held<'h> {
    systems: &'h Systems,
    marginal: &'h Marginal,
    errors: &'h [CommonError],
}

impl<L> Search<'_, L> {
    /// The fit of these hypotheses, with the covariance that goes with it. With `start`, a fit of nearly the same ones, that is not sought
    /// from the beginning.
    pub fn fitted(
        &self,
        applied: &Applied,
        start: Option<&AttributionFit>,
    ) -> Result<AttributionFit, InferenceError> {
        self.alternated(applied, start, STEPS)
    }

    /// The same with a covariance that may be a little off: enough to see which cause is the next.
    pub(super) fn nearly_fitted(
        &self,
        applied: &Applied,
        start: Option<&AttributionFit>,
    ) -> Result<AttributionFit, InferenceError> {
        self.alternated(applied, start, STEPS_OF_SEARCH)
    }

    fn alternated(
        &self,
        applied: &Applied,
        start: Option<&AttributionFit>,
        most: usize,
    ) -> Result<AttributionFit, InferenceError> {
        let mut applied = applied.clone();
        let mut before: Option<(Systems, Background)> = None;
        let mut covariances = 0;
        loop {
            let linearised = self.model.linearised(&applied);
            let errors = self.model.common_errors(&applied);
            let systems = Systems::of(
                self.observations,
                &self.smooth,
                self.model,
                &linearised,
                &self.columns.signatures(&linearised, &errors),
                before.as_ref().map(|(systems, _)| systems).or(start.map(|fit| &fit.systems)),
            )?;
            let fitted = self.columns.fitted(applied.iter().map(|(at, _)| *at));
            let background = match &before {
                Some((_, background)) => systems.resized(&fitted, background)?,
                None => systems.background(&fitted, start.map(|fit| &fit.background))?,
            };
            let mut marginal = systems.marginal(&background)?;
            self.columns.pull(&mut marginal, &applied);
            covariances += 1;
            let held = Held { systems: &systems, marginal: &marginal, errors: &errors };
            let next = self.least(&applied, &held, most)?;
            let unsettled = self.moved(&applied, &next, &marginal);
            if covariances == most || unsettled < SETTLED {
                let coordinates = self.columns.nuisances().solved(&marginal)?.coordinates;
                return Ok(AttributionFit {
                    unsettled,
                    applied,
                    systems,
                    background,
                    marginal,
                    linearised,
                    coordinates,
                });
            }
            applied = next;
            before = Some((systems, background));
        }
    }

    /// The coordinates at which Q is least, from those of the covariance.
    fn least(&self, from: &Applied, held: &Held<'_>, most: usize) -> Result<Applied, InferenceError> {
        let fitted = self.columns.fitted(from.iter().map(|(at, _)| *at));
        let mut step = fitted.solved(held.marginal)?.coordinates;
        let mut square = self.square(from, held.marginal)?;
        let mut point = from.clone();
        for _ in 0..most {
            let Some((next, own)) = self.shortened(&point, &step, square, held)? else { break };
            let moved = self.moved(&point, &next, held.marginal);
            (point, square) = (next, own);
            if moved < SETTLED {
                break;
            }
            let Linearised { readings, signatures, .. } = self.model.linearised_by_applied(&point);
            let of = |at: usize| self.columns.all_of(at).zip(&signatures[at]);
            let columns: Vec<_> = point
                .iter()
                .flat_map(|(at, _)| of(*at))
                .map(|(number, it)| (number, it.as_slice()))
                .collect();
            let mut marginal = self.about(held, &columns, &readings);
            self.columns.pull(&mut marginal, &point);
            step = fitted.solved(&marginal)?.coordinates;
        }
        Ok(point)
    }

    /// After as much of a step as makes Q less than this, and what it is there; none where no part of it does. Where a threshold of friction
    /// bends Q a whole step may lead up.
    fn shortened(
        &self,
        from: &Applied,
        step: &[f64],
        square: f64,
        held: &Held<'_>,
    ) -> Result<Option<(Applied, f64)>, InferenceError> {
        for halvings in 0..=HALVINGS {
            let next = self.stepped(from, step, 0.5_f64.powi(halvings));
            let own = self.square(&next, &self.about(held, &[], &self.model.readings(&next)))?;
            if own < square {
                return Ok(Some((next, own)));
            }
        }
        Ok(None)
    }

    /// The held covariance about other readings, with the nuisances and these columns.
    fn about(&self, held: &Held<'_>, columns: &[(usize, Column<'_>)], readings: &[Vec<f64>]) -> Marginal {
        let residual = |(read, modelled): (&Vec<f64>, &Vec<f64>)| {
            read.iter().zip(modelled).map(|(y, f)| y - f).collect::<Vec<f64>>()
        };
        let residuals: Vec<Vec<f64>> =
            self.observations.readings.iter().zip(readings).map(residual).collect();
        let nuisances = self.columns.nuisance_signatures(held.errors).enumerate();
        let all: Vec<(usize, Column<'_>)> = nuisances.chain(columns.iter().copied()).collect();
        held.systems.about(held.marginal, &all, &residuals)
    }

    /// Q.
    fn square(&self, applied: &Applied, marginal: &Marginal) -> Result<f64, InferenceError> {
        let removed = self.columns.nuisances().solved(marginal)?.removed;
        Ok(marginal.square - removed + self.columns.prior_square(applied))
    }

    /// By how many standard deviations a number that is asked for is moved at most.
    fn moved(&self, from: &Applied, to: &Applied, marginal: &Marginal) -> f64 {
        let mut most = 0.0_f64;
        for ((at, before), (_, after)) in from.iter().zip(to) {
            for (column, (before, after)) in
                self.columns.of_hypothesis[*at].iter().zip(before.iter().zip(after))
            {
                most = most.max((after - before).abs() * marginal.fisher.at(*column, *column).sqrt());
            }
        }
        most
    }

    /// After a part of a step, as far as the ranges let it.
    fn stepped(&self, from: &Applied, step: &[f64], part: f64) -> Applied {
        let of = |(at, coordinates): &(usize, Vec<f64>)| {
            let parameters = &self.model.hypotheses()[*at].parameters;
            let numbers = coordinates.iter().zip(self.columns.all_of(*at)).zip(parameters);
            let stepped = numbers.map(|((psi, column), parameter)| {
                parameter.coordinate(parameter.value(psi + part * step[column]))
            });
            (*at, stepped.collect())
        };
        from.iter().map(of).collect()
    }
}
