//! The fit: Gauss and Newton's method on all parameters, for several values of the hyperparameters; the evidence selects.
//!
//! Source: C. M. Bishop, Pattern Recognition and Machine Learning, section 3.4 (model comparison by the evidence).

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::contacts::{Fitted, Knowledge};
use super::earlier::Earlier;
use super::effort::Effort;
use super::field_error;
use super::hyperparameters::Settings;
use super::known::Known;
use super::linearised::{self, SOLVED_MAX};
use super::model::Layout;
use super::noise;
use super::numbers::{Asked, Number, Pair};
use super::open::{OpenByRig, by_rig};
use super::predictive::{Check, checks};
use super::prepared::Prepared;
use super::prior::Prior;
use super::problem::{Fit, Problem};
use super::thermal_fit::ThermalFit;
use crate::lab::tangent::Simulated;
use crate::pad::device::Device;
use crate::pad::field::PadField;
use crate::pad::influence::InfluenceField;
use crate::pipeline::compensation::Compensation;
use crate::pipeline::compensation::creep::Creep;
use crate::pipeline::contact::Decoder;
use crate::pipeline::contact::field_error::FieldError;
use crate::pipeline::contact::inverse::{Crosstalk, Inverse};
use crate::pipeline::contact::uncertainty::Noise;
use crate::quantity::CHANNELS;
use crate::tables::recording::Recording;

/// Prior standard deviations of the background that are tried beside none, as a share of each map: the larger ones where the
/// larger of the small ones is best.
const SMALL_BACKGROUNDS: [f64; 2] = [0.004, 0.01];
const LARGE_BACKGROUNDS: [f64; 2] = [0.025, 0.06];
/// Thresholds of play operators that are tried: a geometric sequence, then halved steps of its exponent around the best.
const THRESHOLD_MIN_UV: f64 = 40.0;
const THRESHOLD_RATIO: f64 = 1.6;
const THRESHOLDS: i32 = 11;
const HALVINGS: i32 = 3;
/// Relaxation times that are tried: between the length of a press and that of a pause.
const CREEP_TIMES_S: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
/// Time constants of relative noise that are tried in play.
pub(super) const NOISE_TIMES_S: [f64; 4] = [0.7, 2.0, 6.0, 18.0];
/// ln of the Bayes factor that a richer hypothesis (a play operator, creep, another pad's field) must exceed.
const LOG_EVIDENCE_GAIN: f64 = 15.0;
/// Plates that differ by less are of one kind.
const PLATE_TOLERANCE_MM: f32 = 0.1;

/// Hears how many fits of at most how many are done.
pub type Report<'r> = &'r (dyn Fn(usize, usize) + Sync);

/// Fits, counted.
struct Counted<'r> {
    done: AtomicUsize,
    most: AtomicUsize,
    report: Report<'r>,
}

impl<'r> Counted<'r> {
    /// As many as all hypotheses can ask for.
    fn of(hypotheses: &[Hypothesis], report: Report<'r>) -> Self {
        let most = hypotheses.iter().map(Self::most).sum();
        Self { done: AtomicUsize::new(0), most: AtomicUsize::new(most), report }
    }

    /// As many as one of them can ask for, about one pad.
    fn most(Hypothesis { prior, .. }: &Hypothesis) -> usize {
        let refinements = 2 * HALVINGS as usize;
        let search = |known_uv: &f64| {
            if *known_uv > 0.0 { refinements } else { THRESHOLDS as usize + 1 + refinements }
        };
        NOISE_TIMES_S.len()
            + prior.thresholds_uv.iter().map(search).sum::<usize>()
            + CREEP_TIMES_S.len()
            + SMALL_BACKGROUNDS.len()
            + LARGE_BACKGROUNDS.len()
    }

    /// Hears that a hypothesis is fitted again.
    fn expect(&self, hypothesis: &Hypothesis) {
        self.most.fetch_add(Self::most(hypothesis), Ordering::Relaxed);
    }

    fn fitted(
        &self,
        problem: &Problem<'_>,
        settings: Settings,
        (from, effort): (Option<&Fit>, Effort),
    ) -> Option<Fit> {
        let fit = problem.clone().fitted(settings, from, effort);
        (self.report)(self.done.fetch_add(1, Ordering::Relaxed) + 1, self.most.load(Ordering::Relaxed));
        fit
    }
}

/// A calibrated pad.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The pad's own field.
    pub field: InfluenceField,
    /// How far it may be off.
    pub field_error: FieldError,
    /// What its channels have of one another.
    pub crosstalk: Crosstalk,
    /// The channels' noise around it.
    pub noise: Noise,
    /// Each channel's gain.
    pub gain: [f64; CHANNELS],
    /// The fit's numbers, each with its deviation and with who tells it.
    pub numbers: Vec<Number>,
    /// Pairs of them that the contacts do not tell apart, the strongest first.
    pub not_told_apart: Vec<Pair>,
    /// Prior standard deviation of the smooth background that the evidence chose, as a share of each map.
    pub background: f64,
    /// Whether the prior is centred on another pad's field, not on the simulated one.
    pub from_earlier: bool,
    /// What is to be taken off the channels. It has a zero if the recording does not read the untouched pad itself.
    pub compensation: Compensation,
    /// Temperature coefficients; none if the pad was measured at one temperature.
    pub thermal: Option<ThermalFit>,
    /// Contacts that it was fitted to.
    pub contacts: usize,
    /// How well the pad's field is known, at places all over the plate.
    pub map: Vec<Known>,
    /// Errors of the rig that are a large part of what is open there.
    pub open_by_rig: Vec<OpenByRig>,
    /// Parts of the contacts, held against all of them; none without labels.
    pub checks: Vec<Check>,
}

/// Why there is no calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FitError {
    /// There are fewer contacts than the method needs.
    TooFew {
        /// Contacts with nine channels.
        contacts: usize,
        /// Contacts that it takes at least.
        least: usize,
    },
    /// There are more contacts than the decoder keeps.
    TooMany {
        /// Contacts with nine channels.
        contacts: usize,
        /// Contacts that it keeps at most.
        most: usize,
    },
    /// The earlier decoder is of a pad with another plate.
    OtherPlate,
    /// The readings are beyond anything that a pad can read: the normal equations have no solution.
    Senseless,
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { contacts, least } => {
                write!(
                    f,
                    "it takes {least} contacts with nine channels at least, and here are {contacts}; measure more"
                )
            }
            Self::TooMany { contacts, most } => {
                write!(
                    f,
                    "the decoder keeps each contact, {most} at most, and here are {contacts}; take some of them with --rows {most}"
                )
            }
            Self::OtherPlate => {
                f.write_str("the earlier decoder is of a pad with another plate; begin without it")
            }
            Self::Senseless => f.write_str("the channels are beyond anything that a pad can read"),
        }
    }
}

impl std::error::Error for FitError {}

impl Calibration {
    fn of(prepared: &Prepared, problem: &Problem<'_>, fit: &Fit, from_earlier: bool) -> Self {
        let Fit { settings, values, .. } = fit;
        let hysteresis = Layout::hysteresis(values, &settings.thresholds_uv);
        let creep = Layout::creep(values, settings.creep_time_s);
        let contacts = problem.compensated(values, &hysteresis, &creep);
        // What the residuals do not show: drift of the zeros, hysteresis states, the field's posterior covariance.
        let noise = noise::with_zeros(fit.estimates.noise_model.noise, &fit.estimates.drift_uv, &hysteresis);
        let decoder = field_error::decoder(problem, fit, noise);
        let (zero_uv, thermal_fit) = (prepared.zero_uv(fit), prepared.thermal(fit));
        let thermal = thermal_fit.map(|fit| fit.coefficients);
        let asked = Asked { zero_uv, gains_follow_temperature: prepared.tells_gains() };
        let (numbers, not_told_apart) = Number::all(&problem.layout, fit, &asked);
        let map = Known::map(&decoder);
        let open_by_rig = by_rig(&numbers, &map);
        Self {
            noise: Noise {
                gain: noise::common_gain(&decoder, &contacts, problem.noise_prior()),
                ..*decoder.noise()
            },
            field: decoder.field().clone(),
            field_error: decoder.field_error().clone(),
            crosstalk: *decoder.crosstalk(),
            gain: std::array::from_fn(|channel| Layout::gain(values, channel)),
            numbers,
            not_told_apart,
            background: settings.background,
            from_earlier,
            compensation: Compensation { zero_uv, thermal, creep, hysteresis },
            thermal: thermal_fit,
            contacts: problem.contacts(),
            open_by_rig,
            map,
            checks: checks(&problem.clone().explained(fit)),
        }
    }

    /// The decoder of this pad.
    pub fn decoder(&self) -> Decoder {
        let inverse = Inverse::new(self.field.clone(), self.noise)
            .with_field_error(self.field_error.clone())
            .with_crosstalk(self.crosstalk);
        Decoder::from(inverse).compensated_by(self.compensation)
    }
}

/// Calibrates the pad that was measured, by these rows of a recording. `field` is that of `device`, the
/// nominal pad.
///
/// With the decoder of an earlier pad of the same kind its gains, hysteresis and noise are the prior of this one. So may be its
/// field, and so may the simulated pad alone, where the contacts' evidence for it outweighs the prior odds.
///
/// # Errors
/// No contact, another kind of pad, or readings beyond anything that a pad can read.
pub fn fit(
    recording: &Recording,
    rows: &[usize],
    device: &Device,
    field: &PadField,
    earlier: Option<Earlier<'_>>,
) -> Result<Calibration, FitError> {
    fit_reported(recording, rows, &Simulated::known(device, field), earlier, &|_, _| ())
}

/// [`fit`], and `report` hears how far it is. Where a pad is found that the tangent of `pad`'s field does not reach, that pad's field is
/// solved for, and the fit is made about it.
///
/// # Errors
/// The same.
pub fn fit_reported(
    recording: &Recording,
    rows: &[usize],
    pad: &Simulated<'_>,
    earlier: Option<Earlier<'_>>,
    report: Report<'_>,
) -> Result<Calibration, FitError> {
    let written: Vec<Fitted> =
        rows.iter().map(|row| Fitted { row: *row, knowledge: Knowledge::Written }).collect();
    fit_known(recording, &written, pad, earlier, report)
}

/// [`fit_reported`], where contacts may be known otherwise than by a written label.
///
/// # Errors
/// The same.
pub fn fit_known(
    recording: &Recording,
    fitted: &[Fitted],
    pad: &Simulated<'_>,
    earlier: Option<Earlier<'_>>,
    report: Report<'_>,
) -> Result<Calibration, FitError> {
    let field = pad.field;
    earlier.map_or(Ok(()), |it| same_plate(&it, field))?;
    if fitted.is_empty() {
        return Err(FitError::TooFew { contacts: 0, least: 1 });
    }
    let prepared = Prepared::of(recording, fitted, pad.device, field).ok_or(FitError::Senseless)?;
    let mut best: Option<(f64, Calibration)> = None;
    let hypotheses = hypotheses(field, earlier);
    let counted = Counted::of(&hypotheses, report);
    for mut hypothesis in hypotheses {
        for solved in 0..=SOLVED_MAX {
            let (problem, found) = calibrated(&prepared, fitted, pad.device, &hypothesis.prior, &counted)?;
            // The numbers of another pad's field are not known.
            let is_last = solved == SOLVED_MAX || hypothesis.from_earlier;
            let nearer = if is_last { None } else { linearised::solved(&problem, &found, pad) };
            if let Some((device, field)) = nearer {
                hypothesis.prior = hypothesis.prior.about(device, field);
                counted.expect(&hypothesis);
                continue;
            }
            // ln p(H | y) = ln p(y | H) + ln p(H), but for a constant that all hypotheses share.
            let log_probability = found.log_evidence + hypothesis.log_prior_odds;
            if best.as_ref().is_none_or(|(largest, _)| log_probability > *largest) {
                let calibration = Calibration::of(&prepared, &problem, &found, hypothesis.from_earlier);
                best = Some((log_probability, calibration));
            }
            break;
        }
    }
    let is_sound = |it: &Calibration| it.thermal.is_none_or(|fit| fit.coefficients.is_sound());
    best.map(|(_, calibration)| calibration).filter(is_sound).ok_or(FitError::Senseless)
}

/// Refuses a decoder of a pad with another plate.
pub(super) fn same_plate(earlier: &Earlier<'_>, field: &PadField) -> Result<(), FitError> {
    let [one_mm, other_mm] = [earlier.inverse.field(), &field.signals].map(InfluenceField::radius_mm);
    if (one_mm - other_mm).abs() > PLATE_TOLERANCE_MM { Err(FitError::OtherPlate) } else { Ok(()) }
}

/// A prior that the pad may have been drawn from.
struct Hypothesis {
    prior: Prior,
    /// ln of its prior probability over that of the first hypothesis. A negative one demands as much more evidence.
    log_prior_odds: f64,
    /// Whether it is centred on another pad's field.
    from_earlier: bool,
}

fn hypotheses(field: &PadField, earlier: Option<Earlier<'_>>) -> Vec<Hypothesis> {
    let hypothesis = |prior, log_prior_odds, from_earlier| Hypothesis { prior, log_prior_odds, from_earlier };
    let Some(earlier) = earlier else { return vec![hypothesis(Prior::simulated(field), 0.0, false)] };
    vec![
        hypothesis(Prior::of_kind(field, &earlier), 0.0, false),
        // Few contacts lie near another pad's field by chance.
        hypothesis(Prior::centred_on(field, &earlier), -LOG_EVIDENCE_GAIN, true),
        // Its noise prior is weaker, so its noise can follow the contacts more closely: that must not count as evidence.
        hypothesis(Prior::simulated(field), -LOG_EVIDENCE_GAIN, false),
    ]
}

/// The problem of these contacts under this prior, and its fit with the background of the largest evidence.
fn calibrated<'b>(
    prepared: &'b Prepared,
    fitted: &[Fitted],
    device: &Device,
    prior: &'b Prior,
    counted: &Counted<'_>,
) -> Result<(Problem<'b>, Fit), FitError> {
    let problem = prepared.problem(fitted, device, prior);
    if problem.contacts() == 0 {
        return Err(FitError::TooFew { contacts: 0, least: 1 });
    }
    // The memory first, as a background would explain part of it; then the background's size with the memory's settings.
    let plain = settled(&problem, prior, counted).ok_or(FitError::Senseless)?;
    Ok(with_background(problem, plain, counted))
}

/// The same with a background, if the evidence asks for one.
fn with_background<'b>(problem: Problem<'b>, plain: Fit, counted: &Counted<'_>) -> (Problem<'b>, Fit) {
    let smooth = problem.clone().with_background();
    // Of so many parameters a step that gains little may stand before one that gains much: each is carried to its maximum.
    let tried = |background| {
        let mut settings = plain.settings;
        settings.background = background;
        counted.fitted(&smooth, settings, (Some(&plain), Effort::FULL))
    };
    let [_, largest] = SMALL_BACKGROUNDS;
    let small = most_probable(SMALL_BACKGROUNDS.to_vec(), tried);
    let is_largest = small.as_ref().is_some_and(|it| it.settings.background == largest);
    let large = if is_largest { most_probable(LARGE_BACKGROUNDS.to_vec(), tried) } else { None };
    let evidence = |fit: &Fit| fit.log_evidence;
    let found = small.into_iter().chain(large).max_by(|one, other| evidence(one).total_cmp(&evidence(other)));
    match found.filter(|found| evidence(found) > evidence(&plain)) {
        Some(found) => (smooth, found),
        None => (problem, plain),
    }
}

/// The fit without a background, whose memory and lasting noise are what the evidence asks for; `report` hears how far it is.
pub(super) fn settled_reported(problem: &Problem<'_>, prior: &Prior, report: Report<'_>) -> Option<Fit> {
    let hypothesis = Hypothesis { prior: prior.clone(), log_prior_odds: 0.0, from_earlier: false };
    settled(problem, prior, &Counted::of(&[hypothesis], report))
}

fn settled(problem: &Problem<'_>, prior: &Prior, counted: &Counted<'_>) -> Option<Fit> {
    let plain = with_lasting_noise(problem, prior, counted)?;
    let plain = with_hysteresis(problem, prior, plain, counted);
    Some(with_creep(problem, plain, counted))
}

/// The fit with nothing but what is known of pads of this kind. In play noise lasts from one contact to the next: as long as
/// the evidence says.
fn with_lasting_noise(problem: &Problem<'_>, prior: &Prior, counted: &Counted<'_>) -> Option<Fit> {
    let Prior { thresholds_uv, creep: Creep { time_s: creep_time_s, .. }, .. } = *prior;
    let tried = |noise_time_s: f64| {
        let settings = Settings { background: 0.0, thresholds_uv, creep_time_s, noise_time_s };
        counted.fitted(problem, settings, (None, Effort::FULL))
    };
    if problem.layout.is_play { most_probable(NOISE_TIMES_S.to_vec(), tried) } else { tried(0.0) }
}

/// The same with as many play operators as the evidence asks for. Known thresholds are only refined.
fn with_hysteresis(problem: &Problem<'_>, prior: &Prior, mut best: Fit, counted: &Counted<'_>) -> Fit {
    for (play, known_uv) in prior.thresholds_uv.into_iter().enumerate() {
        let tried = |threshold_uv, from: &Fit, effort| {
            let mut settings = from.settings;
            settings.thresholds_uv[play] = threshold_uv;
            counted.fitted(problem, settings, (Some(from), effort))
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
fn with_creep(problem: &Problem<'_>, best: Fit, counted: &Counted<'_>) -> Fit {
    let least = best.log_evidence + LOG_EVIDENCE_GAIN;
    let found = most_probable(CREEP_TIMES_S.to_vec(), |creep_time_s| {
        let mut settings = best.settings;
        settings.creep_time_s = creep_time_s;
        counted.fitted(problem, settings, (Some(&best), Effort { least, ..Effort::FULL }))
    });
    found.filter(|found| found.log_evidence > least).unwrap_or(best)
}

/// The threshold of the largest evidence: on a coarse scale first, then by ever smaller steps around the best. Of what does not come
/// to the evidence `least` nobody asks how far it came.
fn searched(
    play: usize,
    plain: &Fit,
    least: f64,
    tried: impl Fn(f64, &Fit, Effort) -> Option<Fit> + Send + Sync,
) -> Option<Fit> {
    // 40 µV · 1.6ᵏ: up to 4.4 mV.
    let coarse = (0..THRESHOLDS).map(|step| THRESHOLD_MIN_UV * THRESHOLD_RATIO.powi(step));
    let effort = Effort { least, ..Effort::COARSE };
    let best = most_probable(coarse.collect(), |threshold_uv| tried(threshold_uv, plain, effort))?;
    let effort = Effort { least, ..Effort::FULL };
    let best = tried(best.settings.thresholds_uv[play], &best, effort)?;
    Some(refined(play, best, effort, &tried))
}

/// The threshold of the largest evidence near the best one, by a factor ±½, ±¼, ±⅛ of a coarse step.
fn refined(
    play: usize,
    mut best: Fit,
    effort: Effort,
    tried: &(impl Fn(f64, &Fit, Effort) -> Option<Fit> + Send + Sync),
) -> Fit {
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
fn most_probable(settings: Vec<f64>, tried: impl Fn(f64) -> Option<Fit> + Send + Sync) -> Option<Fit> {
    let fits: Vec<Fit> = settings.into_par_iter().filter_map(tried).collect();
    fits.into_iter().max_by(|one, other| one.log_evidence.total_cmp(&other.log_evidence))
}
