//! Which causes the residual calls for: forward selection with refits, backward removal.

mod bootstrap;
pub mod columns;
mod constancy;
pub mod estimates;
mod fitting;
mod held_out;
mod random_effects;
mod rivals;
pub mod score_test;
mod zeros;

use std::sync::Arc;

use rayon::prelude::*;

use self::bootstrap::{Bootstrap, Draw};
use self::columns::Columns;
use self::score_test::{Projected, Test};
use crate::covariance::{Background, Fitted, Marginal, Smooth, Systems};
use crate::error::{InferenceError, Stage, factorised};
use crate::hypothesis::Parameter;
use crate::model::{Linearised, Model};
use crate::observations::Observations;
use crate::policy::{LEVEL, SIGNATURE_ERROR};
use tactpad_numeric::dense::Matrix;
use tactpad_numeric::products::dot;

/// Draws of the bootstrap.
const DRAWS: usize = 1000;
/// By how much larger a candidate's p-value may be beside a background that takes its part than beside one that does not. Chosen on
/// tables of other seeds than those of the campaign (docs/diagnosis.md), for false alarms in a thirtieth of them.
const TAKEN: f64 = 5.0;
/// Candidates whose fit is looked at closely, by their score.
const SHORTLIST: usize = 6;
/// No more causes than this are looked for.
const CAUSES_MAX: usize = 12;
/// Steps of a fit that move no number that is asked for by more than this many standard deviations end.
const SETTLED: f64 = 0.1;

/// Hypotheses that hold, each with its coordinates.
pub type Applied = Vec<(usize, Vec<f64>)>;

/// What each specimen has of its own: hypotheses whose numbers are normal, effect by effect.
pub type RandomEffects = Vec<Vec<usize>>;

/// The measurement about a fitted point.
pub struct AttributionFit {
    /// Applied hypotheses, with the fitted coordinates.
    pub applied: Applied,
    /// By how many standard deviations the next covariance would move a number that is asked for at most.
    pub unsettled: f64,
    /// The channels' systems about the point.
    pub systems: Systems,
    /// Sizes of the smooth background.
    pub background: Background,
    /// The systems with that background.
    pub marginal: Marginal,
    /// The model about the point.
    pub linearised: Linearised,
    /// Coordinates of all columns beside the point: those of the nuisances.
    pub coordinates: Vec<f64>,
}

impl AttributionFit {
    /// Whether it stands; else it ran out of steps on the way.
    pub fn is_settled(&self) -> bool {
        self.unsettled < SETTLED
    }
}

/// Result of the search for causes.
pub struct Attribution {
    /// About the causes that hold.
    pub fit: AttributionFit,
    /// The p-value below which a cause is found: the family-wise level's quantile of the least of all.
    pub critical: f64,
    /// Hypotheses that are fitted together, whether they are significant or not, effect by effect: what each specimen has of its own.
    pub random_effects: RandomEffects,
    /// For each hypothesis, whether these reproduce it.
    pub reproduced: Vec<bool>,
}

/// Finds causes.
pub struct Search<'m, L> {
    /// The model that may be wrong.
    pub model: &'m dyn Model<L>,
    /// The rows by which causes are found.
    pub observations: &'m Observations,
    /// The background's functions at their rows.
    smooth: Arc<Smooth>,
    /// Which column means what.
    pub columns: Columns,
    clusters: Vec<usize>,
}

impl<'m, L> Search<'m, L> {
    /// `observations` are the open rows of `all`.
    pub fn new(model: &'m dyn Model<L>, all: &'m Observations, observations: &'m Observations) -> Self {
        let columns = Columns::of(model.hypotheses(), &model.common_errors(&[]), observations);
        let smooth = Arc::new(Smooth::of(all, observations));
        Self { model, observations, smooth, columns, clusters: observations.clusters() }
    }

    /// Forward selection from causes that are held to be there: whatever is not significant is taken out, but for `random_effects`, which
    /// are asked for together; while the best candidate is significant, it is fitted.
    pub fn run(&self, start: &Applied, random_effects: &[Vec<usize>]) -> Result<Attribution, InferenceError> {
        let mut fit = self.nearly_fitted(start, None)?;
        let mut critical = self.critical(&fit)?;
        fit = self.without_superfluous(fit, critical, random_effects, &mut Vec::new())?;
        // What was taken out or replaced stays out, so that the search ends.
        let mut barred: Vec<usize> = Vec::new();
        loop {
            while fit.applied.len() < CAUSES_MAX + random_effects.iter().flatten().count() {
                let Some(next) = self.next(&fit, critical, &barred, random_effects)? else { break };
                let mut applied = fit.applied.clone();
                applied.push((next, vec![0.0; self.model.hypotheses()[next].parameters.len()]));
                fit = self.within_range(self.nearly_fitted(&applied, Some(&fit))?, critical, &mut barred)?;
                critical = self.critical(&fit)?;
                fit = self.without_superfluous(fit, critical, random_effects, &mut barred)?;
            }
            while !fit.is_settled() {
                let causes = fit.applied.len();
                fit = self.fitted(&fit.applied, Some(&fit))?;
                critical = self.critical(&fit)?;
                fit = self.without_superfluous(fit, critical, random_effects, &mut barred)?;
                if fit.applied.len() == causes {
                    break;
                }
            }
            let gains = self.predictive_gains(&fit);
            let is_chosen = |at: &usize| !is_random_effect(random_effects, fit.applied[*at].0);
            let chosen = (0..fit.applied.len()).filter(is_chosen);
            let Some(least) = chosen.min_by(|one, other| gains[*one].total_cmp(&gains[*other])) else {
                break;
            };
            if gains[least] > 0.0 {
                break;
            }
            let mut applied = fit.applied.clone();
            barred.push(applied.remove(least).0);
            fit = self.nearly_fitted(&applied, Some(&fit))?;
            critical = self.critical(&fit)?;
        }
        let reproduced = self.reproduced(&fit, random_effects)?;
        Ok(Attribution { fit, critical, random_effects: random_effects.to_vec(), reproduced })
    }

    /// The fit without what is not significant, one after the other; what went is `barred`.
    fn without_superfluous(
        &self,
        mut fit: AttributionFit,
        critical: f64,
        random_effects: &[Vec<usize>],
        barred: &mut Vec<usize>,
    ) -> Result<AttributionFit, InferenceError> {
        while let Some(least) = self.superfluous(&fit, critical, random_effects)? {
            let mut applied = fit.applied.clone();
            barred.push(applied.remove(least).0);
            fit = self.nearly_fitted(&applied, Some(&fit))?;
        }
        Ok(fit)
    }

    /// The fit, or where its last cause ended at an end of its range, that with a rival in its place which explains the data as well
    /// and does not; if there is one that is not barred. Then the cause is.
    fn within_range(
        &self,
        fit: AttributionFit,
        critical: f64,
        barred: &mut Vec<usize>,
    ) -> Result<AttributionFit, InferenceError> {
        let Some(last) = fit.applied.len().checked_sub(1).filter(|last| self.is_at_an_end(&fit, *last))
        else {
            return Ok(fit);
        };
        let (projected, score) = self.without(&fit, last)?;
        let mut rivals = self.rivals(&fit, critical, last, &projected, &score);
        rivals.retain(|rival| !barred.contains(rival));
        for rival in rivals {
            let mut applied = fit.applied.clone();
            applied[last] = (rival, vec![0.0; self.model.hypotheses()[rival].parameters.len()]);
            let other = self.nearly_fitted(&applied, Some(&fit))?;
            if !self.is_at_an_end(&other, last) {
                barred.push(fit.applied[last].0);
                return Ok(other);
            }
        }
        Ok(fit)
    }

    /// Whether a hypothesis is a channel's zero.
    pub(crate) fn is_zero(&self, hypothesis: usize) -> bool {
        self.model.hypotheses()[hypothesis].zero_of.is_some()
    }

    /// The critical p-value where these causes hold.
    fn critical(&self, fit: &AttributionFit) -> Result<f64, InferenceError> {
        let projected = self.projected(fit)?;
        let mut bootstrap = Bootstrap::of(
            &fit.systems,
            &fit.marginal,
            &fit.background,
            &self.columns,
            &fit.systems.explained(&fit.marginal, &fit.linearised)?,
            &self.clusters,
        );
        let asked: Vec<usize> =
            (0..self.columns.of_hypothesis.len()).filter(|at| !self.is_zero(*at)).collect();
        let parts: Vec<Vec<f64>> = asked.iter().map(|at| self.parts(fit, *at)).collect();
        let draws: Vec<Draw> = (0..DRAWS).map(|_| bootstrap.draw()).collect();
        let mut least: Vec<f64> = draws
            .par_iter()
            .map(|draw| {
                let score = projected.projected(&draw.score);
                let p_value = |(at, parts): (&usize, &Vec<f64>)| {
                    let test = self.test(&projected, *at, &score);
                    Test { square: test.square / dot(parts, &draw.variances), ..test }.p_value()
                };
                asked.iter().zip(&parts).map(p_value).fold(1.0, f64::min)
            })
            .collect();
        least.sort_by(f64::total_cmp);
        Ok(least[(LEVEL * DRAWS as f64) as usize])
    }

    /// The channels' parts in what is known of a hypothesis: they add up to 1.
    pub fn parts(&self, fit: &AttributionFit, hypothesis: usize) -> Vec<f64> {
        let columns = &self.columns.of_hypothesis[hypothesis];
        let of_channel = |at: usize| {
            let own = fit.systems.channels[at]
                .equations
                .columns
                .iter()
                .enumerate()
                .filter(|(_, number)| columns.contains(number));
            own.map(|(row, _)| fit.marginal.channels[at].fisher.at(row, row)).sum::<f64>()
        };
        let parts: Vec<f64> = (0..fit.systems.channels.len()).map(of_channel).collect();
        let whole: f64 = parts.iter().sum();
        parts.iter().map(|part| if whole > 0.0 { part / whole } else { 1.0 / parts.len() as f64 }).collect()
    }

    /// Information and score beside what is fitted.
    pub(crate) fn projected(&self, fit: &AttributionFit) -> Result<Projected, InferenceError> {
        Projected::of(&fit.marginal, &self.columns.fitted(fit.applied.iter().map(|(at, _)| *at)))
    }

    /// The test of a hypothesis that is not fitted. One whose number cannot be negative is asked for positive ones only.
    pub fn test(&self, projected: &Projected, at: usize, score: &[f64]) -> Test {
        let columns = &self.columns.of_hypothesis[at];
        let is_one_sided = self.model.hypotheses()[at].asked().iter().all(Parameter::is_one_sided);
        if is_one_sided && columns.iter().all(|column| score[*column] <= 0.0) {
            return Test::NOTHING;
        }
        projected.test(columns, score)
    }

    /// The candidate with the best fit, if it is significant.
    fn next(
        &self,
        fit: &AttributionFit,
        critical: f64,
        barred: &[usize],
        random_effects: &[Vec<usize>],
    ) -> Result<Option<usize>, InferenceError> {
        let projected = self.projected(fit)?;
        let least = self.least_square(fit)?;
        let reproduced = self.reproduced(fit, random_effects)?;
        let holds = |at: usize| barred.contains(&at) || fit.applied.iter().any(|(held, _)| *held == at);
        let mut candidates: Vec<(Test, usize)> = (0..self.columns.of_hypothesis.len())
            .filter(|at| !holds(*at) && !self.is_zero(*at) && !reproduced[*at])
            .map(|at| (self.test(&projected, at, &projected.score), at))
            .collect();
        // The bootstrap knows how large candidates are by chance beside a background that has their part, too.
        candidates.retain(|(test, _)| test.p_value() < TAKEN * critical);
        candidates.sort_by(|(one, _), (other, _)| one.by_chance(other));
        candidates.truncate(SHORTLIST);
        // One that the held ones reproduce has no fit beside them.
        let closely = |(_, at): &(Test, usize)| Some((*at, self.criterion(fit, *at).ok()?));
        let looked_at: Vec<(usize, (f64, Test))> = candidates.par_iter().filter_map(closely).collect();
        let mut best: Option<(f64, usize)> = None;
        for (at, (criterion, test)) in looked_at {
            let is_found = test.p_value() < critical && test.square > least;
            if is_found && best.is_none_or(|(least, _)| criterion < least) {
                best = Some((criterion, at));
            }
        }
        Ok(best.map(|(_, at)| at))
    }

    /// Schwarz's criterion of the fit with a candidate beside the held causes, and the candidate's test. The covariance is found
    /// anew, so that the background does not take the candidate's part.
    fn criterion(&self, fit: &AttributionFit, at: usize) -> Result<(f64, Test), InferenceError> {
        let held = || fit.applied.iter().map(|(held, _)| *held);
        let both = self.columns.fitted(held().chain([at]));
        let background = fit.systems.resized(&both, &fit.background)?;
        let marginal = fit.systems.marginal_with(&both.columns, &background)?;
        let projected = Projected::of(&marginal, &self.columns.fitted(held()))?;
        let test = self.test(&projected, at, &projected.score);
        let deviance = marginal.square - both.solved(&marginal)?.removed + marginal.log_determinant();
        Ok((deviance + test.freedom as f64 * (self.observations.rows() as f64).ln(), test))
    }

    /// −2 ln of how probable a fit makes the readings, but for a constant, with 2 ln M for each cause that was chosen among M hypotheses.
    /// The numbers ψ of a cause are normal about none, and so are those of one effect among the random effects, with the deviation σ that they show:
    ///
    /// ```text
    /// rᵀ V⁻¹ r + ln det V + Σ ψ²/σ² + ln det(F + P) + Σ ln σ²,  σ² = mean of ψ²,  P = diag(1/σ²)
    /// ```
    ///
    /// Source: D. J. C. MacKay, Neural Computation 4 (1992) 415; of the choice J. Chen, Z. Chen, Biometrika 95 (2008) 759, γ = 1.
    pub fn criterion_of(&self, found: &Attribution) -> Result<f64, InferenceError> {
        let Attribution { fit, random_effects, .. } = found;
        let mut precisions = self.columns.precisions.clone();
        let mut criterion = fit.marginal.log_determinant();
        let (members, chosen): (Vec<_>, Vec<_>) = fit
            .applied
            .iter()
            .partition(|(held, _)| random_effects.iter().flatten().any(|member| member == held));
        let of_effect = |effect: &Vec<usize>| -> Vec<&(usize, Vec<f64>)> {
            members.iter().copied().filter(|(held, _)| effect.contains(held)).collect()
        };
        for group in random_effects.iter().map(of_effect).chain(chosen.iter().map(|cause| vec![*cause])) {
            let numbers: Vec<(usize, f64)> = group
                .iter()
                .flat_map(|(held, psi)| {
                    self.columns.of_hypothesis[*held].iter().copied().zip(psi.iter().copied())
                })
                .collect();
            let square = numbers.iter().map(|(_, psi)| psi * psi).sum::<f64>() / numbers.len() as f64;
            let square = square.max(f64::MIN_POSITIVE.sqrt());
            for (column, psi) in numbers {
                precisions[column] = square.recip();
                criterion += psi * psi / square + square.ln();
            }
        }
        let columns = self.columns.fitted(fit.applied.iter().map(|(held, _)| *held)).columns;
        let fitted = Fitted { columns, precisions: &precisions };
        let free = self.columns.fitted(fit.applied.iter().map(|(held, _)| *held));
        criterion += fit.marginal.square - free.solved(&fit.marginal)?.removed;
        criterion += fitted.factorised(&fit.marginal)?.log_determinant();
        Ok(criterion + 2.0 * chosen.len() as f64 * (self.columns.of_hypothesis.len() as f64).ln())
    }

    /// The place in the fit of a cause that is not significant beside the others; the least of them.
    fn superfluous(
        &self,
        fit: &AttributionFit,
        critical: f64,
        random_effects: &[Vec<usize>],
    ) -> Result<Option<usize>, InferenceError> {
        let mut worst: Option<(f64, usize)> = None;
        let least = self.least_square(fit)?;
        let is_chosen = |at: &usize| !is_random_effect(random_effects, fit.applied[*at].0);
        for at in (0..fit.applied.len()).filter(is_chosen) {
            let test = self.test_within(fit, at)?;
            let p_value = test.p_value();
            if (p_value > critical || test.square < least)
                && worst.is_none_or(|(greatest, _)| p_value > greatest)
            {
                worst = Some((p_value, at));
            }
        }
        Ok(worst.map(|(_, at)| at))
    }

    /// What a cause must take off the weighted squares to be more than the signatures of those with a course may be wrong by: where a
    /// signature goes with the load in proportion the background holds its error; where it has a course of its own, so much of what the
    /// cause explains may be that cause still, in another guise.
    fn least_square(&self, fit: &AttributionFit) -> Result<f64, InferenceError> {
        let has_course = |at: &usize| !self.columns.shapes[fit.applied[*at].0].is_empty();
        let mut squares =
            (0..fit.applied.len()).filter(has_course).map(|at| Ok(self.test_within(fit, at)?.square));
        let largest = squares.try_fold(0.0, |largest, square| Ok(f64::max(largest, square?)))?;
        Ok(SIGNATURE_ERROR * SIGNATURE_ERROR * largest)
    }

    /// The test of a fitted cause beside all others that are fitted.
    pub fn test_within(&self, fit: &AttributionFit, at: usize) -> Result<Test, InferenceError> {
        let (hypothesis, _) = fit.applied[at];
        let own = &self.columns.of_hypothesis[hypothesis];
        let (projected, score) = self.without(fit, at)?;
        Ok(projected.test(own, &score))
    }

    /// What all fitted causes together take off the weighted squares, beside the nuisances.
    pub fn removed(&self, fit: &AttributionFit) -> Result<f64, InferenceError> {
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
        Ok(projected.test(&columns, &score).square)
    }

    /// Everything but one fitted cause projected out, and the score of the residual without that cause.
    pub fn without(&self, fit: &AttributionFit, at: usize) -> Result<(Projected, Vec<f64>), InferenceError> {
        self.without_all(fit, &[at])
    }

    /// The same of several.
    fn without_all(
        &self,
        fit: &AttributionFit,
        places: &[usize],
    ) -> Result<(Projected, Vec<f64>), InferenceError> {
        let others =
            fit.applied.iter().enumerate().filter(|(at, _)| !places.contains(at)).map(|(_, (held, _))| *held);
        let projected = Projected::of(&fit.marginal, &self.columns.fitted(others))?;
        // r + J ψ̂: the residual about the point without the causes, to first order.
        let mut score = projected.score.clone();
        for (hypothesis, coordinates) in places.iter().map(|at| &fit.applied[*at]) {
            for (column, psi) in self.columns.of_hypothesis[*hypothesis].iter().zip(coordinates) {
                score
                    .iter_mut()
                    .zip(projected.fisher.row(*column))
                    .for_each(|(score, entry)| *score += psi * entry);
            }
        }
        Ok((projected, score))
    }

    /// What each fitted cause takes off the weighted squares: beside all others; of random effects all of one effect together, each by what
    /// it takes off alone. Beside random effects what several explain alike is shared by these parts, so that they add up to the whole.
    pub fn squares(&self, found: &Attribution) -> Result<Vec<f64>, InferenceError> {
        let Attribution { fit, random_effects, .. } = found;
        let mut squares = Vec::new();
        for at in 0..fit.applied.len() {
            squares.push(self.test_within(fit, at)?.square);
        }
        for effect in random_effects {
            let members: Vec<usize> =
                (0..fit.applied.len()).filter(|at| effect.contains(&fit.applied[*at].0)).collect();
            let (projected, score) = self.without_all(fit, &members)?;
            let columns = |at: &usize| self.columns.of_hypothesis[fit.applied[*at].0].clone();
            let whole = projected.test(&members.iter().flat_map(columns).collect::<Vec<_>>(), &score).square;
            let alone: Vec<f64> =
                members.iter().map(|at| projected.test(&columns(at), &score).square).collect();
            let sum: f64 = alone.iter().sum();
            for (at, alone) in members.into_iter().zip(alone) {
                squares[at] = if sum > 0.0 { whole * alone / sum } else { 0.0 };
            }
        }
        let sum: f64 = squares.iter().sum();
        if !random_effects.is_empty() && sum > 0.0 {
            let whole = self.removed(fit)?;
            squares.iter_mut().for_each(|square| *square *= whole / sum);
        }
        Ok(squares)
    }

    /// Covariance of a fitted cause's coordinates.
    pub fn covariance(&self, fit: &AttributionFit, at: usize) -> Result<Matrix, InferenceError> {
        let (projected, _) = self.without(fit, at)?;
        let own: Vec<usize> = self.columns.all_of(fit.applied[at].0).collect();
        let mut inner = projected.fisher.picked(&own, &own);
        for (row, column) in own.iter().enumerate() {
            inner.row_mut(row)[row] += self.columns.precisions[*column];
        }
        let factor = factorised(&inner, Stage::Causes)?;
        let unit = |at: usize| (0..own.len()).map(|k| f64::from(u8::from(k == at))).collect::<Vec<_>>();
        Ok(Matrix::from_rows(&(0..own.len()).map(|at| factor.solve(&unit(at))).collect::<Vec<_>>()))
    }
}

/// Whether a hypothesis is a random effect.
pub fn is_random_effect(random_effects: &[Vec<usize>], hypothesis: usize) -> bool {
    random_effects.iter().flatten().any(|member| *member == hypothesis)
}

#[cfg(test)]
mod tests;
