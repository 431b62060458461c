//! A calibration: the fit under each prior that the pad may have been drawn from, about the pad that is nearest to it.

pub(crate) mod flaws;
pub(crate) mod linearised;
pub(crate) mod posterior;
pub(crate) mod prepared;
pub mod search;

use std::fmt;

use self::linearised::SOLVED_MAX;
use self::prepared::PreparedRecording;
use self::search::{FitCount, LOG_EVIDENCE_GAIN, Report};
use super::model::ParameterLayout;
use super::noise;
use super::problem::hyperparameters::Estimates;
use super::problem::{PosteriorFit, Problem};
use crate::calibration::data::contacts::{Fitted, Knowledge};
use crate::calibration::data::earlier::EarlierCalibration;
use crate::calibration::data::thermal_fit::ThermalFit;
use crate::calibration::model::prior::Prior;
use crate::calibration::problem::effort::Effort;
use crate::calibration::result::field_error;
use crate::calibration::result::known::PressPrecision;
use crate::calibration::result::numbers::{Number, OptionalNumbers, Pair};
use crate::calibration::result::open::{OpenByRig, by_rig};
use crate::calibration::result::predictive::{PredictiveCheck, checks, widening};
use crate::tangent::SimulatedPad;
use tactpad_core::counted::counted;
use tactpad_core::pad::changes::Flaw;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::pipeline::compensation::Compensation;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::pipeline::contact::field_error::FieldError;
use tactpad_core::pipeline::contact::inverse::{Crosstalk, Inverse};
use tactpad_core::pipeline::contact::uncertainty::Noise;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::recording::Recording;

/// Plates that differ by less are of one kind.
const PLATE_TOLERANCE_MM: f32 = 0.1;

/// A calibrated pad.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The pad's own field.
    pub field: InfluenceField,
    /// How far it may be off.
    pub field_error: FieldError,
    /// Crosstalk between its channels.
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
    /// The flaw of a module with which the evidence is larger than with any crosstalk. It is no finding.
    pub flaw: Option<(usize, Flaw)>,
    /// Compensation to subtract from the channels. It has a zero if the recording does not read the untouched pad itself.
    pub compensation: Compensation,
    /// Temperature coefficients; none if the pad was measured at one temperature.
    pub thermal: Option<ThermalFit>,
    /// Contacts that it was fitted to.
    pub contacts: usize,
    /// How well the pad's field is known, at places all over the plate.
    pub map: Vec<PressPrecision>,
    /// Errors of the rig that are a large part of what is open there.
    pub open_by_rig: Vec<OpenByRig>,
    /// Contacts held out, all of them and by thirds; none without labels.
    pub checks: Vec<PredictiveCheck>,
    /// The factor by which the noise is larger than the residuals', for checks that are missed; 1 without.
    pub widening: f64,
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
                    "this needs at least {} with nine channels, and the table has {contacts}: measure more",
                    counted(least, "contact")
                )
            }
            Self::TooMany { contacts, most } => {
                write!(
                    f,
                    "the decoder keeps each contact, {most} at most, and the table has {contacts}: take some of them with --rows {most}"
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
    fn of(
        prepared: &PreparedRecording,
        problem: &Problem<'_>,
        fit: &PosteriorFit,
        from_earlier: bool,
    ) -> Self {
        let PosteriorFit { settings, values, .. } = fit;
        let hysteresis = ParameterLayout::hysteresis(values, &settings.thresholds_uv);
        let creep = ParameterLayout::creep(values, settings.creep_time_s);
        let contacts = problem.compensated(values, &hysteresis, &creep);
        // What the residuals do not show: drift of the zeros, hysteresis states, the field's posterior covariance.
        let Estimates { noise_model, drift_uv, .. } = &fit.estimates;
        let noise = noise::with_zeros(noise_model.noise, drift_uv, &hysteresis);
        let decoder = field_error::decoder(problem, fit, noise);
        let (zero_uv, thermal_fit) = (prepared.zero_uv(fit), prepared.thermal(fit));
        let thermal = thermal_fit.map(|fit| fit.coefficients);
        let asked = OptionalNumbers { zero_uv, gains_follow_temperature: prepared.tells_gains() };
        let (numbers, not_told_apart) = Number::all(&problem.layout, fit, &asked);
        let map = PressPrecision::map(&decoder);
        let open_by_rig = by_rig(&numbers, &map);
        let checks = checks(&problem.clone().explained(fit));
        let widening = widening(&checks);
        let gain = noise::common_gain(&decoder, &contacts, problem.noise_prior());
        Self {
            noise: Noise { gain, ..*decoder.noise() }.widened(widening),
            field: decoder.field().clone(),
            field_error: decoder.field_error().clone(),
            crosstalk: *decoder.crosstalk(),
            gain: std::array::from_fn(|channel| ParameterLayout::gain(values, channel)),
            numbers,
            not_told_apart,
            background: problem.background(fit),
            from_earlier,
            flaw: problem.prior.solved.as_ref().and_then(flaws::of),
            compensation: Compensation { zero_uv, thermal, creep, hysteresis },
            thermal: thermal_fit,
            contacts: problem.contacts(),
            open_by_rig,
            map,
            checks,
            widening,
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
    earlier: Option<EarlierCalibration<'_>>,
) -> Result<Calibration, FitError> {
    fit_reported(recording, rows, &SimulatedPad::known(device, field), earlier, &|_, _| ())
}

/// [`fit`], and `report` hears how far it is. Where a pad is found that the tangent of `pad`'s field does not reach, that pad's field is
/// solved for, and the fit is made about it.
///
/// # Errors
/// The same.
pub fn fit_reported(
    recording: &Recording,
    rows: &[usize],
    pad: &SimulatedPad<'_>,
    earlier: Option<EarlierCalibration<'_>>,
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
    pad: &SimulatedPad<'_>,
    earlier: Option<EarlierCalibration<'_>>,
    report: Report<'_>,
) -> Result<Calibration, FitError> {
    let field = pad.field;
    earlier.map_or(Ok(()), |it| same_plate(&it, field))?;
    if fitted.is_empty() {
        return Err(FitError::TooFew { contacts: 0, least: 1 });
    }
    let prepared = PreparedRecording::of(recording, fitted, pad.device, field).ok_or(FitError::Senseless)?;
    let hypotheses = hypotheses(field, earlier);
    let counted = FitCount::of(hypotheses.iter().map(|it| &it.prior), report);
    let contacts = Contacts { prepared: &prepared, fitted, pad, counted: &counted };
    let mut best: Option<(f64, Calibration)> = None;
    for hypothesis in hypotheses {
        let least = best.as_ref().map_or(f64::NEG_INFINITY, |(log_probability, _)| *log_probability);
        best = contacts.calibrated(hypothesis, least)?.or(best);
    }
    let is_sound = |it: &Calibration| it.thermal.is_none_or(|fit| fit.coefficients.is_sound());
    best.map(|(_, calibration)| calibration).filter(is_sound).ok_or(FitError::Senseless)
}

/// Measured contacts, and the simulated pad that they are compared with.
struct Contacts<'c> {
    prepared: &'c PreparedRecording,
    fitted: &'c [Fitted],
    pad: &'c SimulatedPad<'c>,
    counted: &'c FitCount<'c>,
}

impl Contacts<'_> {
    fn problem<'p>(&'p self, prior: &'p Prior) -> Problem<'p> {
        self.prepared.problem(self.fitted, self.pad.device, prior)
    }

    /// The calibration by a hypothesis with its log probability, if that is above `least`: about the pad of the prior, then, as long as
    /// there is one, about a pad that is nearer to what was found.
    fn calibrated(
        &self,
        mut hypothesis: PriorHypothesis,
        least: f64,
    ) -> Result<Option<(f64, Calibration)>, FitError> {
        let mut solved = 0;
        loop {
            let problem = self.problem(&hypothesis.prior);
            if problem.contacts() == 0 {
                return Err(FitError::TooFew { contacts: 0, least: 1 });
            }
            let found = search::fitted(problem, &hypothesis.prior, self.counted);
            let (problem, found) = found.ok_or(FitError::Senseless)?;
            // The numbers of another pad's field are not known.
            let is_last = solved == SOLVED_MAX || hypothesis.from_earlier;
            let Some((device, field)) = (!is_last).then(|| self.nearer(&problem, &found)).flatten() else {
                // ln p(H | y) = ln p(y | H) + ln p(H), but for a constant that all hypotheses share.
                let log_probability = found.log_evidence + hypothesis.log_prior_odds;
                let calibration =
                    || Calibration::of(self.prepared, &problem, &found, hypothesis.from_earlier);
                return Ok((log_probability > least).then(|| (log_probability, calibration())));
            };
            hypothesis.prior = hypothesis.prior.about(device, field);
            self.counted.expect_all(&hypothesis.prior);
            solved += 1;
        }
    }

    /// A pad with its field that is nearer to the one that was found than the one about which it was: one that the tangent does not
    /// reach, or one that lacks something. A module that is far off is not to be taken for one that does.
    fn nearer(&self, problem: &Problem<'_>, fit: &PosteriorFit) -> Option<(Device, PadField)> {
        let solved = linearised::solved(problem, fit, self.pad);
        if !flaws::are_asked(problem, fit, self.pad) {
            return solved;
        }
        let fitted = |prior: &Prior| {
            self.counted.expect(1);
            let about = self.problem(prior);
            let about = if problem.layout.terms > 0 { about.with_background() } else { about };
            self.counted.fitted(&about, fit.settings, None, Effort::FULL)
        };
        let about = |(device, field): &(Device, PadField)| {
            fitted(&problem.prior.clone().about(device.clone(), field.clone()))
        };
        let whole = solved.as_ref().and_then(about);
        flaws::found(problem, whole.as_ref().unwrap_or(fit), self.pad, fitted).or(solved)
    }
}

/// Refuses a decoder of a pad with another plate.
pub(crate) fn same_plate(earlier: &EarlierCalibration<'_>, field: &PadField) -> Result<(), FitError> {
    let [one_mm, other_mm] = [earlier.inverse.field(), &field.signals].map(InfluenceField::radius_mm);
    if (one_mm - other_mm).abs() > PLATE_TOLERANCE_MM { Err(FitError::OtherPlate) } else { Ok(()) }
}

/// A prior that the pad may have been drawn from.
struct PriorHypothesis {
    prior: Prior,
    /// ln of its prior probability over that of the first hypothesis. A negative one demands as much more evidence.
    log_prior_odds: f64,
    /// Whether it is centred on another pad's field.
    from_earlier: bool,
}

fn hypotheses(field: &PadField, earlier: Option<EarlierCalibration<'_>>) -> Vec<PriorHypothesis> {
    let hypothesis =
        |prior, log_prior_odds, from_earlier| PriorHypothesis { prior, log_prior_odds, from_earlier };
    let Some(earlier) = earlier else { return vec![hypothesis(Prior::simulated(field), 0.0, false)] };
    vec![
        hypothesis(Prior::of_kind(field, &earlier), 0.0, false),
        // Few contacts lie near another pad's field by chance.
        hypothesis(Prior::centred_on(field, &earlier), -LOG_EVIDENCE_GAIN, true),
        // Its noise prior is weaker, so its noise can follow the contacts more closely: that must not count as evidence.
        hypothesis(Prior::simulated(field), -LOG_EVIDENCE_GAIN, false),
    ]
}
