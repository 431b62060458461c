//! The fit: Gauss and Newton's method on all numbers, for several sizes of the background.

use std::fmt;

use rayon::prelude::*;

use super::before::Before;
use super::model::Layout;
use super::noise;
use super::prepared::Prepared;
use super::problem::{Fit, Problem, Settings};
use super::warmth::Warmth;
use crate::contact::creep::Creep;
use crate::contact::friction::Friction;
use crate::contact::inverse::Inverse;
use crate::contact::recording::Recording;
use crate::contact::uncertainty::Noise;
use crate::device::Device;
use crate::device::parameter::Parameter;
use crate::field::PadField;
use crate::influence::InfluenceField;
use crate::quantity::CHANNELS;

/// Sizes of the background that are tried, as a share of each map.
const BACKGROUNDS: [f64; 5] = [1e-6, 0.004, 0.01, 0.025, 0.06];
/// Thresholds of play operators that are tried, each this much larger than the one before.
const THRESHOLD_MIN_UV: f64 = 40.0;
const THRESHOLD_RATIO: f64 = 1.6;
const THRESHOLDS: i32 = 11;
const HALVINGS: i32 = 3;
/// Relaxation times that are tried: between the length of a press and that of a pause.
const CREEP_TIMES_S: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
/// What is not thought at first (a play operator, creep, another pad's field) must make what was measured so much more probable; ln.
const EVIDENCE_GAIN: f64 = 15.0;
/// Plates that differ by less are of one kind.
const PLATE_TOLERANCE_MM: f32 = 0.1;

/// A calibrated pad.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The pad's own field.
    pub field: InfluenceField,
    /// The channels' noise around it.
    pub noise: Noise,
    /// Each channel's gain.
    pub gain: [f64; CHANNELS],
    /// Poses and stiffnesses: number, value, standard deviation.
    pub physical: Vec<(Parameter, f64, f64)>,
    /// Size of the smooth background, as a share of each map.
    pub background: f64,
    /// Whether another pad's field explains the contacts better than the simulated one.
    pub from_earlier: bool,
    /// What the channels remember of earlier loads.
    pub friction: Friction,
    /// How the channels creep.
    pub creep: Creep,
    /// What the untouched pad reads; none if the recording reads it itself.
    pub zero_uv: Option<[f64; CHANNELS]>,
    /// How the pad follows the temperature; none if it was measured at one.
    pub warmth: Option<Warmth>,
    /// Contacts that it was fitted to.
    pub contacts: usize,
}

/// Why there is no calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitError {
    /// There are fewer contacts than numbers to find.
    TooFew {
        /// There are so many.
        contacts: usize,
        /// It takes so many.
        least: usize,
    },
    /// The earlier decoder is of a pad with another plate.
    OtherPlate,
    /// The numbers are beyond anything that a pad can read.
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
        let field = problem.corrected(values);
        let friction = Layout::friction(values, &settings.thresholds_uv);
        let creep = Layout::creep(values, settings.creep_time_s);
        let contacts = problem.freed(values, &friction, &creep);
        let noise = noise::with_zeros(fit.scatter.noise, &fit.drift_uv, &friction);
        let noise = noise::with_doubts(&field, noise, &problem.doubts(fit));
        let decoder = Inverse::new(field.clone(), noise, friction);
        Self {
            noise: Noise { gain: noise::common_gain(&decoder, &contacts, problem.known_noise()), ..noise },
            field,
            gain: std::array::from_fn(|channel| Layout::gain(values, channel)),
            physical: problem.physical(fit),
            background: settings.background,
            from_earlier,
            friction,
            creep,
            zero_uv: prepared.zero_uv(fit),
            warmth: prepared.warmth(fit),
            contacts: problem.contacts(),
        }
    }

    /// The decoder of this pad.
    pub fn decoder(&self) -> Inverse {
        Inverse::new(self.field.clone(), self.noise, self.friction).of_pad(
            self.zero_uv,
            self.warmth.map(|warmth| warmth.thermal),
            self.creep,
        )
    }
}

/// Calibrates the pad that was measured, by these rows of a recording. `field` is that of `device`, the pad as it is thought
/// to be.
///
/// With the decoder of an earlier pad of the same kind its gains, friction and noise are what is thought of this one, and its
/// field may be, too, if the contacts say so by far.
///
/// # Errors
/// No contact, another kind of pad, or senseless numbers.
pub fn fit(
    recording: &Recording,
    rows: &[usize],
    device: &Device,
    field: &PadField,
    earlier: Option<&Inverse>,
) -> Result<Calibration, FitError> {
    let radius_mm = field.signals.radius_mm();
    if earlier.is_some_and(|it| (it.field().radius_mm() - radius_mm).abs() > PLATE_TOLERANCE_MM) {
        return Err(FitError::OtherPlate);
    }
    if rows.is_empty() {
        return Err(FitError::TooFew { contacts: 0, least: 1 });
    }
    let prepared = Prepared::of(recording, rows, device, field).ok_or(FitError::Senseless)?;
    let mut best: Option<(f64, Calibration)> = None;
    for Thought { before, handicap, from_earlier } in thoughts(field, earlier) {
        let (problem, found) = calibrated(&prepared, rows, device, &before)?;
        let evidence = found.evidence - handicap;
        if best.as_ref().is_none_or(|(before, _)| evidence > *before) {
            best = Some((evidence, Calibration::of(&prepared, &problem, &found, from_earlier)));
        }
    }
    let is_sound = |it: &Calibration| it.warmth.is_none_or(|warmth| warmth.thermal.is_sound());
    best.map(|(_, calibration)| calibration).filter(is_sound).ok_or(FitError::Senseless)
}

/// What a pad may be like.
struct Thought {
    before: Before,
    /// By how much it must make what was measured more probable; ln.
    handicap: f64,
    /// Whether its field is another pad's.
    from_earlier: bool,
}

fn thoughts(field: &PadField, earlier: Option<&Inverse>) -> Vec<Thought> {
    let thought = |before, handicap, from_earlier| Thought { before, handicap, from_earlier };
    let Some(earlier) = earlier else { return vec![thought(Before::simulated(field), 0.0, false)] };
    vec![
        thought(Before::made_like(field, earlier), 0.0, false),
        // Few contacts are near to another pad's field by chance.
        thought(Before::like(field, earlier), EVIDENCE_GAIN, true),
        // Where less is thought of the noise, it can follow the contacts more closely.
        thought(Before::simulated(field), EVIDENCE_GAIN, false),
    ]
}

/// The problem of these contacts for a pad of which so much is known, and its most probable numbers.
fn calibrated<'b>(
    prepared: &'b Prepared,
    rows: &[usize],
    device: &Device,
    before: &'b Before,
) -> Result<(Problem<'b>, Fit), FitError> {
    let problem = prepared.problem(rows, device, before);
    if problem.contacts() == 0 {
        return Err(FitError::TooFew { contacts: 0, least: 1 });
    }
    let plain = with_friction(&problem, before).ok_or(FitError::Senseless)?;
    let plain = with_creep(&problem, plain);
    let problem = problem.with_background();
    let best = most_probable(BACKGROUNDS.to_vec(), |background| {
        problem.clone().fitted(Settings { background, ..plain.settings }, Some(&plain))
    });
    Ok((problem, best.ok_or(FitError::Senseless)?))
}

/// The numbers without a background, and with as many play operators as make what was measured more probable. Those of which
/// thresholds are known are only looked for around them.
fn with_friction(problem: &Problem<'_>, before: &Before) -> Option<Fit> {
    let Before { thresholds_uv, creep: Creep { time_s: creep_time_s, .. }, .. } = *before;
    let mut best = problem.clone().fitted(Settings { background: 0.0, thresholds_uv, creep_time_s }, None)?;
    for (play, known_uv) in thresholds_uv.into_iter().enumerate() {
        let tried = |threshold_uv| {
            let mut settings = best.settings;
            settings.thresholds_uv[play] = threshold_uv;
            problem.clone().fitted(settings, Some(&best))
        };
        if known_uv > 0.0 {
            best = refined(play, best.clone(), &tried);
            continue;
        }
        match searched(play, tried) {
            Some(found) if found.evidence > best.evidence + EVIDENCE_GAIN => best = found,
            _ => break,
        }
    }
    Some(best)
}

/// The same with creep, if that makes what was measured so much more probable.
fn with_creep(problem: &Problem<'_>, best: Fit) -> Fit {
    let found = most_probable(CREEP_TIMES_S.to_vec(), |creep_time_s| {
        problem.clone().fitted(Settings { creep_time_s, ..best.settings }, Some(&best))
    });
    found.filter(|found| found.evidence > best.evidence + EVIDENCE_GAIN).unwrap_or(best)
}

/// The threshold of the largest evidence: on a coarse scale first, then by ever smaller steps around the best.
fn searched(play: usize, tried: impl Fn(f64) -> Option<Fit> + Send + Sync) -> Option<Fit> {
    let coarse = (0..THRESHOLDS).map(|step| THRESHOLD_MIN_UV * THRESHOLD_RATIO.powi(step));
    let best = most_probable(coarse.collect(), &tried)?;
    Some(refined(play, best, &tried))
}

/// By ever smaller steps around the best.
fn refined(play: usize, mut best: Fit, tried: &(impl Fn(f64) -> Option<Fit> + Send + Sync)) -> Fit {
    for halving in 1..=HALVINGS {
        let factor = THRESHOLD_RATIO.powf(0.5_f64.powi(halving));
        let centre_uv = best.settings.thresholds_uv[play];
        let around = most_probable(vec![centre_uv / factor, centre_uv * factor], tried);
        best = around.filter(|around| around.evidence > best.evidence).unwrap_or(best);
    }
    best
}

/// Tries settings side by side; of equally probable ones the last.
fn most_probable(settings: Vec<f64>, tried: impl Fn(f64) -> Option<Fit> + Send + Sync) -> Option<Fit> {
    let fits: Vec<Fit> = settings.into_par_iter().filter_map(tried).collect();
    fits.into_iter().max_by(|one, other| one.evidence.total_cmp(&other.evidence))
}
