//! Which causes the residual calls for: forward selection with refits, backward removal.

pub(crate) mod atlas;
pub(crate) mod bootstrap;
pub(crate) mod columns;
pub(crate) mod inference;

use std::sync::Arc;

use rayon::prelude::*;

use self::bootstrap::{Bootstrap, Draw};
use self::columns::Columns;
use self::inference::{Projected, Test};
use super::model::{Linearised, Model, Parameter, SIGNATURE_ERROR};
use crate::diagnosis::data::observations::Observations;
use crate::diagnosis::statistics::covariance::{Background, Marginal, Smooth, Systems};
use crate::effect::Effect;
use tactpad_core::numeric::dense::Matrix;
use tactpad_core::numeric::products::dot;

/// How often anything may be found where nothing is wrong: the family-wise level.
pub(crate) const LEVEL: f64 = 0.03;
/// Draws of the bootstrap.
const DRAWS: usize = 1000;
/// By how much larger a candidate's p-value may be beside a background that takes its part than beside one that does not. Chosen on
/// tables of other seeds than the campaign's, for false alarms in a thirtieth of them.
const TAKEN: f64 = 5.0;
/// Candidates whose fit is looked at closely, by their score.
const SHORTLIST: usize = 6;
/// No more causes than this are looked for.
const CAUSES_MAX: usize = 12;
/// Gauss-Newton steps of a refit.
const REFITS: usize = 12;
/// A refit that moves no number that is asked for by more than this many standard deviations stands.
const STANDS: f64 = 0.1;

/// Hypotheses that hold, each with its coordinates.
pub(crate) type Applied = Vec<(usize, Vec<f64>)>;

/// The measurement about a fitted point.
pub(crate) struct AttributionFit {
    /// Applied hypotheses, with the fitted coordinates.
    pub(crate) applied: Applied,
    pub(crate) systems: Systems,
    pub(crate) background: Background,
    pub(crate) marginal: Marginal,
    pub(crate) linearised: Linearised,
    /// Coordinates of all columns beside the point: the nuisances, and what a last step would change.
    pub(crate) coordinates: Vec<f64>,
}

/// A Gauss-Newton step in all columns, and how much of it is taken.
struct GaussNewtonStep {
    coordinates: Vec<f64>,
    fraction: f64,
}

/// Result of the search for causes.
pub(crate) struct Attribution {
    /// About the causes that hold.
    pub(crate) fit: AttributionFit,
    /// The p-value below which a cause is found: the family-wise level's quantile of the least of all.
    pub(crate) critical: f64,
}

/// Finds causes.
pub(crate) struct Search<'m> {
    pub(crate) model: &'m dyn Model,
    pub(crate) observations: &'m Observations,
    /// The background's functions at their rows.
    smooth: Arc<Smooth>,
    pub(crate) columns: Columns,
    pub(crate) clusters: Vec<usize>,
}

impl<'m> Search<'m> {
    /// `observations` are the open rows of `all`.
    pub(crate) fn new(model: &'m dyn Model, all: &'m Observations, observations: &'m Observations) -> Self {
        let columns = Columns::of(model.hypotheses(), &model.common_errors(), observations);
        let smooth = Arc::new(Smooth::of(all, observations));
        Self { model, observations, smooth, columns, clusters: observations.clusters() }
    }

    /// Forward selection from causes that are held to be there: whatever is not significant is taken out; while the best
    /// candidate is, it is fitted.
    pub(crate) fn run(&self, start: &Applied) -> Option<Attribution> {
        let mut fit = self.fitted(start, None)?;
        let mut critical = self.critical(&fit)?;
        while let Some(least) = self.superfluous(&fit, critical)? {
            let mut applied = fit.applied.clone();
            applied.remove(least);
            fit = self.fitted(&applied, Some(&fit))?;
        }
        // What was taken out or replaced stays out, so that the search ends.
        let mut barred: Vec<usize> = Vec::new();
        while fit.applied.len() < CAUSES_MAX {
            let Some(next) = self.next(&fit, critical, &barred)? else { break };
            let mut applied = fit.applied.clone();
            applied.push((next, vec![0.0; self.model.hypotheses()[next].parameters.len()]));
            fit = self.within_range(self.fitted(&applied, Some(&fit))?, critical, &mut barred)?;
            critical = self.critical(&fit)?;
            while let Some(least) = self.superfluous(&fit, critical)? {
                let mut applied = fit.applied.clone();
                barred.push(applied.remove(least).0);
                fit = self.fitted(&applied, Some(&fit))?;
            }
        }
        Some(Attribution { fit, critical })
    }

    /// The fit, or where its last cause ended at an end of its range, that with a rival in its place which explains the data as well
    /// and does not; if there is one that is not barred. Then the cause is.
    fn within_range(
        &self,
        fit: AttributionFit,
        critical: f64,
        barred: &mut Vec<usize>,
    ) -> Option<AttributionFit> {
        let Some(last) = fit.applied.len().checked_sub(1).filter(|last| self.is_at_an_end(&fit, *last))
        else {
            return Some(fit);
        };
        let (projected, score) = self.without(&fit, last)?;
        let mut rivals = self.rivals(&fit, critical, last, &projected, &score);
        rivals.retain(|rival| !barred.contains(rival));
        for rival in rivals {
            let mut applied = fit.applied.clone();
            applied[last] = (rival, vec![0.0; self.model.hypotheses()[rival].parameters.len()]);
            let other = self.fitted(&applied, Some(&fit))?;
            if !self.is_at_an_end(&other, last) {
                barred.push(fit.applied[last].0);
                return Some(other);
            }
        }
        Some(fit)
    }

    pub(crate) fn is_zero(&self, hypothesis: usize) -> bool {
        self.model.hypotheses()[hypothesis].effect == Effect::ChannelOffset
    }

    /// The fit of these hypotheses by Gauss and Newton's method, with the covariance that goes with it. With `start`, a fit of nearly the
    /// same ones, that is not sought from the beginning.
    pub(crate) fn fitted(&self, applied: &Applied, start: Option<&AttributionFit>) -> Option<AttributionFit> {
        let mut applied = applied.clone();
        let mut before: Option<(Systems, Background)> = None;
        let mut last: Option<GaussNewtonStep> = None;
        for step in 0..=REFITS {
            let linearised = self.model.linearised(&applied);
            let systems = Systems::of(
                self.observations,
                &self.smooth,
                self.model,
                &linearised,
                &self.columns.signatures(&linearised),
                before.as_ref().map(|(systems, _)| systems).or(start.map(|fit| &fit.systems)),
            )?;
            let fitted = self.columns.fitted(applied.iter().map(|(at, _)| *at));
            let found = match &before {
                Some((_, background)) => systems.resized(&fitted, background)?,
                None => systems.background(&fitted, start.map(|fit| &fit.background))?,
            };
            let mut marginal = systems.marginal(&found)?;
            self.columns.pull(&mut marginal, &applied);
            let solved = fitted.solved(&marginal)?;
            let moves = self.moves(&applied, &solved.coordinates, &marginal);
            if step == REFITS || moves < STANDS {
                return Some(AttributionFit {
                    applied,
                    systems,
                    background: found,
                    marginal,
                    linearised,
                    coordinates: solved.coordinates,
                });
            }
            let next = self.next_step(&applied, solved.coordinates, &marginal, last.as_ref());
            self.step(&mut applied, &next);
            (before, last) = (Some((systems, found)), Some(next));
        }
        None
    }

    /// By how many standard deviations a step moves the numbers that are asked for at most; a course has none.
    fn moves(&self, applied: &Applied, step: &[f64], marginal: &Marginal) -> f64 {
        let columns = applied.iter().flat_map(|(at, _)| &self.columns.of_hypothesis[*at]);
        columns
            .map(|column| step[*column].abs() * marginal.fisher.at(*column, *column).sqrt())
            .fold(0.0, f64::max)
    }

    /// A Gauss-Newton step s after a last one s₀, and how much of it is taken: by how far it turns back, ρ = sᵀ F s₀/(s₀ᵀ F s₀), with
    /// the Fisher information F. The shapes of a course need it: there whole steps may jump to and fro for ever.
    fn next_step(
        &self,
        applied: &Applied,
        coordinates: Vec<f64>,
        marginal: &Marginal,
        last: Option<&GaussNewtonStep>,
    ) -> GaussNewtonStep {
        let columns: Vec<usize> = applied.iter().flat_map(|(at, _)| self.columns.all_of(*at)).collect();
        let of = |step: &[f64]| columns.iter().map(|column| step[*column]).collect::<Vec<f64>>();
        let by_secant = |last: &GaussNewtonStep| {
            let before = of(&last.coordinates);
            let weighted = marginal.fisher.picked(&columns, &columns).times(&before);
            fraction(last.fraction, dot(&weighted, &of(&coordinates)) / dot(&weighted, &before))
        };
        GaussNewtonStep { fraction: last.map_or(1.0, by_secant), coordinates }
    }

    fn step(&self, applied: &mut Applied, GaussNewtonStep { coordinates: step, fraction }: &GaussNewtonStep) {
        for (at, coordinates) in applied {
            let hypothesis = &self.model.hypotheses()[*at];
            let columns = self.columns.all_of(*at);
            for ((coordinate, column), parameter) in
                coordinates.iter_mut().zip(columns).zip(&hypothesis.parameters)
            {
                *coordinate = parameter.coordinate(parameter.value(*coordinate + fraction * step[column]));
            }
        }
    }

    /// The critical p-value where these causes hold.
    fn critical(&self, fit: &AttributionFit) -> Option<f64> {
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
        Some(least[(LEVEL * DRAWS as f64) as usize])
    }

    /// The channels' parts in what is known of a hypothesis: they add up to 1.
    pub(crate) fn parts(&self, fit: &AttributionFit, hypothesis: usize) -> Vec<f64> {
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

    pub(crate) fn projected(&self, fit: &AttributionFit) -> Option<Projected> {
        Projected::of(&fit.marginal, &self.columns.fitted(fit.applied.iter().map(|(at, _)| *at)))
    }

    /// The test of a hypothesis that is not fitted. One whose number cannot be negative is asked for positive ones only.
    pub(crate) fn test(&self, projected: &Projected, at: usize, score: &[f64]) -> Test {
        let columns = &self.columns.of_hypothesis[at];
        let is_one_sided = self.model.hypotheses()[at].asked().iter().all(Parameter::is_one_sided);
        if is_one_sided && columns.iter().all(|column| score[*column] <= 0.0) {
            return Test::NOTHING;
        }
        projected.test(columns, score)
    }

    /// The candidate with the best fit, if it is significant.
    fn next(&self, fit: &AttributionFit, critical: f64, barred: &[usize]) -> Option<Option<usize>> {
        let projected = self.projected(fit)?;
        let least = self.least_square(fit)?;
        let holds = |at: usize| barred.contains(&at) || fit.applied.iter().any(|(held, _)| *held == at);
        let mut candidates: Vec<(Test, usize)> = (0..self.columns.of_hypothesis.len())
            .filter(|at| !holds(*at) && !self.is_zero(*at))
            .map(|at| (self.test(&projected, at, &projected.score), at))
            .collect();
        // The bootstrap knows how large candidates are by chance beside a background that has their part, too.
        candidates.retain(|(test, _)| test.p_value() < TAKEN * critical);
        candidates.sort_by(|(one, _), (other, _)| one.by_chance(other));
        candidates.truncate(SHORTLIST);
        // One that the held ones reproduce has no fit beside them.
        let closely = |(_, at): &(Test, usize)| Some((*at, self.criterion(fit, *at)?));
        let looked_at: Vec<(usize, (f64, Test))> = candidates.par_iter().filter_map(closely).collect();
        let mut best: Option<(f64, usize)> = None;
        for (at, (criterion, test)) in looked_at {
            let is_found = test.p_value() < critical && test.square > least;
            if is_found && best.is_none_or(|(least, _)| criterion < least) {
                best = Some((criterion, at));
            }
        }
        Some(best.map(|(_, at)| at))
    }

    /// Schwarz's criterion of the fit with a candidate beside the held causes, and the candidate's test. The covariance is found
    /// anew, so that the background does not take the candidate's part.
    fn criterion(&self, fit: &AttributionFit, at: usize) -> Option<(f64, Test)> {
        let held = || fit.applied.iter().map(|(held, _)| *held);
        let both = self.columns.fitted(held().chain([at]));
        let background = fit.systems.resized(&both, &fit.background)?;
        let marginal = fit.systems.marginal_with(&both.columns, &background)?;
        let projected = Projected::of(&marginal, &self.columns.fitted(held()))?;
        let test = self.test(&projected, at, &projected.score);
        let deviance = marginal.square - both.solved(&marginal)?.removed + marginal.log_determinant();
        Some((deviance + test.freedom as f64 * (self.observations.rows() as f64).ln(), test))
    }

    /// The place in the fit of a cause that is not significant beside the others; the least of them.
    fn superfluous(&self, fit: &AttributionFit, critical: f64) -> Option<Option<usize>> {
        let mut worst: Option<(f64, usize)> = None;
        let least = self.least_square(fit)?;
        for at in 0..fit.applied.len() {
            let test = self.test_within(fit, at)?;
            let p_value = test.p_value();
            if (p_value > critical || test.square < least)
                && worst.is_none_or(|(greatest, _)| p_value > greatest)
            {
                worst = Some((p_value, at));
            }
        }
        Some(worst.map(|(_, at)| at))
    }

    /// What a cause must take off the weighted squares to be more than the signatures of those with a course may be wrong by: where a
    /// signature goes with the load in proportion the background holds its error; where it has a course of its own, so much of what the
    /// cause explains may be that cause still, in another guise.
    fn least_square(&self, fit: &AttributionFit) -> Option<f64> {
        let has_course = |at: &usize| !self.columns.shapes[fit.applied[*at].0].is_empty();
        let mut squares =
            (0..fit.applied.len()).filter(has_course).map(|at| Some(self.test_within(fit, at)?.square));
        let largest = squares.try_fold(0.0, |largest, square| Some(f64::max(largest, square?)))?;
        Some(SIGNATURE_ERROR * SIGNATURE_ERROR * largest)
    }

    /// The test of a fitted cause beside all others that are fitted.
    pub(crate) fn test_within(&self, fit: &AttributionFit, at: usize) -> Option<Test> {
        let (hypothesis, _) = fit.applied[at];
        let own = &self.columns.of_hypothesis[hypothesis];
        let (projected, score) = self.without(fit, at)?;
        Some(projected.test(own, &score))
    }

    /// Everything but one fitted cause projected out, and the score of the residual without that cause.
    pub(crate) fn without(&self, fit: &AttributionFit, at: usize) -> Option<(Projected, Vec<f64>)> {
        let others =
            fit.applied.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, (held, _))| *held);
        let projected = Projected::of(&fit.marginal, &self.columns.fitted(others))?;
        let (hypothesis, coordinates) = &fit.applied[at];
        // r + J ψ̂: the residual about the point without the cause, to first order.
        let mut score = projected.score.clone();
        for (column, psi) in self.columns.of_hypothesis[*hypothesis].iter().zip(coordinates) {
            score
                .iter_mut()
                .zip(projected.fisher.row(*column))
                .for_each(|(score, entry)| *score += psi * entry);
        }
        Some((projected, score))
    }

    /// Covariance of a fitted cause's coordinates.
    pub(crate) fn covariance(&self, fit: &AttributionFit, at: usize) -> Option<Matrix> {
        let (projected, _) = self.without(fit, at)?;
        let own: Vec<usize> = self.columns.all_of(fit.applied[at].0).collect();
        let mut inner = projected.fisher.picked(&own, &own);
        for (row, column) in own.iter().enumerate() {
            inner.row_mut(row)[row] += self.columns.precisions[*column];
        }
        let factor = inner.factorised()?;
        let unit = |at: usize| (0..own.len()).map(|k| f64::from(u8::from(k == at))).collect::<Vec<_>>();
        Some(Matrix::from_rows(&(0..own.len()).map(|at| factor.solve(&unit(at))).collect::<Vec<_>>()))
    }
}

/// How much of a step is taken after one of which t₀ was taken, and of which it is ρ times: the steps vanish at the fit, and by the secant
///
/// ```text
/// t = min(1, t₀/(1 − ρ))
/// ```
///
/// All of it where they grow, or nothing is known of the last one.
fn fraction(last: f64, ratio: f64) -> f64 {
    if ratio < 1.0 { (last / (1.0 - ratio)).min(1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::attribution::atlas::Atlas;
    use crate::diagnosis::data::observations::Sample;
    use crate::tangent::SimulatedPad;
    use tactpad_core::numeric::random::SplitMix64;
    use tactpad_core::pad::device::Device;
    use tactpad_core::pad::field::PadField;
    use tactpad_core::quantity::CHANNELS;

    /// Where steps lead from 0, each a share of what it should be.
    fn led(step: impl Fn(f64) -> f64, taken: impl Fn(f64, f64) -> f64) -> f64 {
        let (mut at, mut last) = (0.0, None);
        for _ in 0..REFITS {
            let next: f64 = step(at);
            let part = last.map_or(1.0, |(before, part)| taken(part, next / before));
            at += part * next;
            last = Some((next, part));
        }
        at
    }

    #[test]
    fn steps_that_turn_back_as_far_as_they_went_lead_to_the_fit() {
        // Twice as long as they should be a unit from the fit, which is at 1, and longer nearby: whole ones go from side to side for ever.
        let too_long = |at: f64| 2.2 * (1.0 - at) / (1.0 + 0.1 * (1.0 - at).powi(2));
        assert!((led(too_long, |_, _| 1.0) - 1.0).abs() > 0.3, "{}", led(too_long, |_, _| 1.0));
        assert!((led(too_long, fraction) - 1.0).abs() < 1e-9, "{}", led(too_long, fraction));
        // Too short: whole ones are right.
        assert_eq!([fraction(1.0, 0.5), fraction(0.5, 1.5), fraction(1.0, f64::NAN)], [1.0; 3]);
        assert_eq!([fraction(1.0, -1.0), fraction(0.5, -1.0)], [0.5, 0.25]);
    }

    /// Five loads at each of 72 places.
    fn contacts(random: &mut SplitMix64) -> Observations {
        let mut sample = |at: usize| {
            let (angle, radius_mm) = (2.4 * (at % 72) as f64, 27.0 * ((at % 72) as f64 / 72.0).sqrt());
            let fz = 1.0 + 4.0 * f64::from(random.fraction());
            let [fx, fy] = [0; 2].map(|_| 0.4 * fz * f64::from(random.uniform()));
            let place_mm = [radius_mm * libm::cos(angle), radius_mm * libm::sin(angle)];
            Sample { place_mm, load: [fx, fy, fz], ..Sample::default() }
        };
        let samples: Vec<Sample> = (0..360).map(&mut sample).collect();
        Observations {
            channels: vec![String::new(); CHANNELS],
            readings: vec![vec![0.0; samples.len()]; CHANNELS],
            is_told: vec![vec![true; samples.len()]; CHANNELS],
            numbers: (0..samples.len()).collect(),
            samples,
        }
    }

    /// A smooth map with a mean square of about 1: a few waves of some 60 mm.
    fn smooth_map(random: &mut SplitMix64) -> impl Fn([f64; 2]) -> f64 + use<> {
        let waves: Vec<[f64; 3]> =
            (0..8).map(|_| [0.1, 0.1, 3.0].map(|size| size * f64::from(random.uniform()))).collect();
        move |[x, y]| waves.iter().map(|[a, b, c]| 0.5 * libm::cos(a * x + b * y + c)).sum()
    }

    /// A sound pad's readings, but for noise of 0.4 % and a smooth error of 2 %.
    fn sound(model: &Atlas<'_>, unread: &Observations, random: &mut SplitMix64) -> Observations {
        let mut measured = unread.clone();
        let load_rms = unread.load_rms();
        for ((channel, modelled), size) in
            measured.readings.iter_mut().zip(model.readings(&[])).zip(model.sizes())
        {
            let maps = [(); 3].map(|()| smooth_map(random));
            for ((to, from), sample) in channel.iter_mut().zip(modelled).zip(&unread.samples) {
                let error: f64 =
                    maps.iter().zip(sample.load).map(|(map, n)| map(sample.place_mm) * n / load_rms).sum();
                *to = from + 0.004 * (size + from.abs()) * f64::from(random.normal()) + 0.02 * size * error;
            }
        }
        measured
    }

    /// Whether any cause is found.
    fn is_alarm(search: &Search<'_>) -> bool {
        let fit = search.fitted(&Vec::new(), None).unwrap();
        let critical = search.critical(&fit).unwrap();
        search.next(&fit, critical, &[]).unwrap().is_some()
    }

    #[test]
    fn without_the_background_sound_pads_raise_alarms() {
        let (device, field) = (Device::nominal(), PadField::nominal());
        let pad = SimulatedPad::known(&device, &field);
        let mut alarms = [0; 2];
        for seed in 41..45 {
            let random = &mut SplitMix64::new(seed);
            let unread = contacts(random);
            let measured = sound(&Atlas::new(&pad, &[], &unread, &unread), &unread, random);
            let model = Atlas::new(&pad, &[], &measured, &measured);
            let mut search = Search::new(&model, &measured, &measured);
            alarms[0] += usize::from(is_alarm(&search));
            search.smooth = Arc::new(Smooth::of(&measured, &measured).without());
            alarms[1] += usize::from(is_alarm(&search));
        }
        assert!(alarms[0] <= 1 && alarms[1] == 4, "{alarms:?}");
    }
}
