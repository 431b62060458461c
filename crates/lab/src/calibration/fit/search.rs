//! The fit: Gauss and Newton's method on all parameters, for several settings of lasting noise, the prior, hysteresis and creep,
//! without a background and with one; the evidence selects.
//!
//! Source: C. M. Bishop, Pattern Recognition and Machine Learning, section 3.4 (model comparison by the evidence).

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::calibration::model::prior::Prior;
use crate::calibration::problem::effort::Effort;
use crate::calibration::problem::hyperparameters::Settings;
use crate::calibration::problem::{PosteriorFit, Problem};
use tactpad_core::quantity::MODULES;
use tactpad_numeric::memory::Relaxation;

/// Thresholds of play operators that are tried: a geometric sequence, then halved steps of its exponent around the best.
const THRESHOLD_MIN_UV: f64 = 40.0;
const THRESHOLD_RATIO: f64 = 1.6;
const THRESHOLDS: i32 = 11;
const HALVINGS: i32 = 3;
/// Relaxation times that are tried: between the length of a press and that of a pause.
const CREEP_TIMES_S: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
/// Time constants of relative noise that are tried in play: a factor √3 apart, as what a minute tells of a gain goes with them.
pub(crate) const NOISE_TIMES_S: [f64; 7] = [0.7, 1.2, 2.0, 3.5, 6.0, 10.5, 18.0];
/// The share of their deviations that stiffnesses, moduli and the plate's thickness may have in play: pads that are built alike.
const ALIKE: f64 = 0.25;
/// ln of the Bayes factor that a richer hypothesis (a play operator, creep, another pad's field) must exceed.
pub(crate) const LOG_EVIDENCE_GAIN: f64 = 15.0;

/// Hears how many fits of at most how many are done.
pub type Report<'r> = &'r (dyn Fn(usize, usize) + Sync);

/// Fits, counted.
pub(crate) struct FitCount<'r> {
    done: AtomicUsize,
    most: AtomicUsize,
    report: Report<'r>,
}

impl<'r> FitCount<'r> {
    /// As many as all priors can ask for.
    pub(crate) fn of<'p>(priors: impl IntoIterator<Item = &'p Prior>, report: Report<'r>) -> Self {
        let most = priors.into_iter().map(Self::most).sum();
        Self { done: AtomicUsize::new(0), most: AtomicUsize::new(most), report }
    }

    /// As many as one of them can ask for.
    fn most(prior: &Prior) -> usize {
        let refinements = 2 * HALVINGS as usize;
        let search = |known_uv: &f64| {
            if *known_uv > 0.0 { refinements } else { THRESHOLDS as usize + 1 + refinements }
        };
        2 * NOISE_TIMES_S.len()
            + 1
            + prior.thresholds_uv.iter().map(search).sum::<usize>()
            + CREEP_TIMES_S.len()
            + 2
            + MODULES
    }

    /// Hears of so many more.
    pub(crate) fn expect(&self, fits: usize) {
        self.most.fetch_add(fits, Ordering::Relaxed);
    }

    /// Hears of a prior more.
    pub(crate) fn expect_all(&self, prior: &Prior) {
        self.expect(Self::most(prior));
    }

    pub(crate) fn fitted(
        &self,
        problem: &Problem<'_>,
        settings: Settings,
        from: Option<&PosteriorFit>,
        effort: Effort,
    ) -> Option<PosteriorFit> {
        let fit = problem.clone().fitted(settings, from, effort);
        (self.report)(self.done.fetch_add(1, Ordering::Relaxed) + 1, self.most.load(Ordering::Relaxed));
        fit
    }
}

/// The fit with the background of the largest evidence, and the problem that it is of: with a background or without. `None` where the
/// equations have no solution.
pub(crate) fn fitted<'b>(
    problem: Problem<'b>,
    prior: &Prior,
    counted: &FitCount<'_>,
) -> Option<(Problem<'b>, PosteriorFit)> {
    let plain = with_lasting_noise(&problem, prior, counted)?;
    let plain = if problem.layout.is_play { built_alike(&problem, plain, counted) } else { plain };
    // The memory first, as a background would explain part of it; then the background's size with the memory's settings.
    let plain = with_memory(&problem, prior, plain, counted);
    Some(with_background(problem, plain, counted))
}

/// The same with a background: where labels tell the field, always, as no field is the simulator's; in play, if the evidence asks for
/// one. Of several maxima it is the most probable one.
fn with_background<'b>(
    problem: Problem<'b>,
    plain: PosteriorFit,
    counted: &FitCount<'_>,
) -> (Problem<'b>, PosteriorFit) {
    let smooth = problem.clone().with_background();
    // From the plain fit, whose poses, moduli and rig may have taken up what is the background's, and without it, where the background
    // may take up what is theirs.
    let tried = |from| counted.fitted(&smooth, plain.settings, from, Effort::FULL);
    let (one, other) = rayon::join(|| tried(None), || tried(Some(&plain)));
    let mut found: Vec<PosteriorFit> = one.into_iter().chain(other).collect();
    let best = found.iter().map(|it| it.log_evidence).fold(f64::NEG_INFINITY, f64::max);
    let are_displaced = |it: &PosteriorFit| it.estimates.prior_deviations.are_displaced();
    if !problem.layout.is_play && found.iter().any(are_displaced) {
        // One module that is far off, and all that are off a little on a stage that is, look alike, and none of the two leads to the other.
        let effort = Effort { least: best, ..Effort::FULL };
        let displaced: Vec<PosteriorFit> = (0..MODULES)
            .into_par_iter()
            .filter_map(|module| {
                counted.fitted(&smooth, plain.settings, Some(&plain.displaced(module)), effort)
            })
            .collect();
        found.extend(displaced);
    }
    let found =
        found.into_iter().max_by(|one, other| one.log_probability().total_cmp(&other.log_probability()));
    let is_asked = |it: &PosteriorFit| !problem.layout.is_play || it.log_evidence > plain.log_evidence;
    match found.filter(is_asked) {
        Some(found) => (smooth, found),
        None => (problem, plain),
    }
}

/// The fit without a background, whose memory and lasting noise are what the evidence asks for; `report` hears how far it is.
pub(crate) fn settled_reported(
    problem: &Problem<'_>,
    prior: &Prior,
    report: Report<'_>,
) -> Option<PosteriorFit> {
    let counted = FitCount::of([prior], report);
    let plain = with_lasting_noise(problem, prior, &counted)?;
    Some(with_memory(problem, prior, plain, &counted))
}

fn with_memory(
    problem: &Problem<'_>,
    prior: &Prior,
    plain: PosteriorFit,
    counted: &FitCount<'_>,
) -> PosteriorFit {
    let plain = with_hysteresis(problem, prior, plain, counted);
    // Friction that nothing explained looked like noise that lasts as long as a press.
    let plain = with_noise_time(problem, plain, counted);
    with_creep(problem, plain, counted)
}

/// The fit with nothing but what is known of pads of this kind. In play noise lasts from one contact to the next: as long as
/// the evidence says.
fn with_lasting_noise(problem: &Problem<'_>, prior: &Prior, counted: &FitCount<'_>) -> Option<PosteriorFit> {
    let Prior { thresholds_uv, creep: Relaxation { time_s: creep_time_s, .. }, .. } = *prior;
    let tried = |noise_time_s: f64| {
        let settings = Settings { thresholds_uv, creep_time_s, noise_time_s, elastic_scale: 1.0 };
        counted.fitted(problem, settings, None, Effort::FULL)
    };
    if problem.layout.is_play { most_probable(NOISE_TIMES_S.to_vec(), tried) } else { tried(0.0) }
}

/// The same where noise lasts as long as the evidence says now, if it lasts.
fn with_noise_time(problem: &Problem<'_>, plain: PosteriorFit, counted: &FitCount<'_>) -> PosteriorFit {
    if plain.settings.noise_time_s == 0.0 {
        return plain;
    }
    let found = most_probable(NOISE_TIMES_S.to_vec(), |noise_time_s| {
        counted.fitted(problem, Settings { noise_time_s, ..plain.settings }, Some(&plain), Effort::FULL)
    });
    found.unwrap_or(plain)
}

/// The same where stiffnesses, moduli and thickness are near what they should be, if that is more probable. Presses without labels
/// hardly tell them from gains and crosstalk.
fn built_alike(problem: &Problem<'_>, plain: PosteriorFit, counted: &FitCount<'_>) -> PosteriorFit {
    let settings = Settings { elastic_scale: ALIKE, ..plain.settings };
    let alike = counted.fitted(problem, settings, None, Effort::FULL);
    alike.filter(|alike| alike.log_probability() > plain.log_probability()).unwrap_or(plain)
}

/// The same with as many play operators as the evidence asks for. Known thresholds are only refined.
fn with_hysteresis(
    problem: &Problem<'_>,
    prior: &Prior,
    mut best: PosteriorFit,
    counted: &FitCount<'_>,
) -> PosteriorFit {
    for (play, known_uv) in prior.thresholds_uv.into_iter().enumerate() {
        let tried = |threshold_uv, from: &PosteriorFit, effort| {
            let mut settings = from.settings;
            settings.thresholds_uv[play] = threshold_uv;
            counted.fitted(problem, settings, Some(from), effort)
        };
        if known_uv > 0.0 {
            best = refined(play, best.clone(), Effort::FULL, &tried);
            continue;
        }
        let least = best.log_evidence + LOG_EVIDENCE_GAIN;
        match searched(play, &best, least, tried) {
            Some(found) if found.log_evidence > least => best = found,
            _ => break,
        }
    }
    best
}

/// The same with creep, if the evidence asks for it.
fn with_creep(problem: &Problem<'_>, best: PosteriorFit, counted: &FitCount<'_>) -> PosteriorFit {
    let least = best.log_evidence + LOG_EVIDENCE_GAIN;
    let found = most_probable(CREEP_TIMES_S.to_vec(), |creep_time_s| {
        let mut settings = best.settings;
        settings.creep_time_s = creep_time_s;
        counted.fitted(problem, settings, Some(&best), Effort { least, ..Effort::FULL })
    });
    found.filter(|found| found.log_evidence > least).unwrap_or(best)
}

/// The threshold of the largest evidence: on a coarse scale first, then by ever smaller steps around the best. Of what does not come
/// to the evidence `least` nobody asks how far it came.
fn searched(
    play: usize,
    plain: &PosteriorFit,
    least: f64,
    tried: impl Fn(f64, &PosteriorFit, Effort) -> Option<PosteriorFit> + Send + Sync,
) -> Option<PosteriorFit> {
    // 40 µV · 1.6ᵏ: up to 4.4 mV.
    let coarse = (0..THRESHOLDS).map(|step| THRESHOLD_MIN_UV * THRESHOLD_RATIO.powi(step));
    let effort = Effort { least, ..Effort::COARSE };
    let best = most_probable(coarse.collect(), |threshold_uv| tried(threshold_uv, plain, effort))?;
    // A coarse step off the best threshold an operator that is there explains most of what it will.
    if best.log_evidence < plain.log_evidence {
        return None;
    }
    let effort = Effort { least, ..Effort::FULL };
    let best = tried(best.settings.thresholds_uv[play], &best, effort)?;
    Some(refined(play, best, effort, &tried))
}

/// The threshold of the largest evidence near the best one, by a factor ±½, ±¼, ±⅛ of a coarse step.
fn refined(
    play: usize,
    mut best: PosteriorFit,
    effort: Effort,
    tried: &(impl Fn(f64, &PosteriorFit, Effort) -> Option<PosteriorFit> + Send + Sync),
) -> PosteriorFit {
    for halving in 1..=HALVINGS {
        let factor = THRESHOLD_RATIO.powf(0.5_f64.powi(halving));
        let centre_uv = best.settings.thresholds_uv[play];
        let around =
            most_probable(vec![centre_uv / factor, centre_uv * factor], |uv| tried(uv, &best, effort));
        best = around.filter(|around| around.log_evidence > best.log_evidence).unwrap_or(best);
    }
    best
}

/// The fit of the largest evidence, tried in parallel; of equal ones the last.
fn most_probable(
    settings: Vec<f64>,
    tried: impl Fn(f64) -> Option<PosteriorFit> + Send + Sync,
) -> Option<PosteriorFit> {
    let fits: Vec<PosteriorFit> = settings.into_par_iter().filter_map(tried).collect();
    fits.into_iter().max_by(|one, other| one.log_evidence.total_cmp(&other.log_evidence))
}
