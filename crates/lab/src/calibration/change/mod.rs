//! Changes of a pad between two recordings without labels, or since it was calibrated, beside all that both share.
//!
//! The pad as it was has the parameters θ of the fit. In the later play each channel reads beyond f(θ) also M a + B c + N n, with the
//! columns B of possible changes (a channel's gain, a change of the field's maps), N of what may always differ (the finger's blur, the
//! shares of hysteresis and creep, what is left of the zeros), and the modes M of what was not known of its field. An earlier play has
//! contacts of its own and tells θ: it has no modes. A decoder says θ and the modes, whose weights a are N(0, 1) ([`FieldError`]). The
//! equations of all together are
//!
//! ```text
//! | H  Gᵀ | |δ|   |h|        S = K − G H⁻¹ Gᵀ
//! | G  K  | |c| = |k|        s = k − G H⁻¹ h
//! ```
//!
//! where θ, a and n, with their priors, stand above and the changes below. S is the information about the changes that is left when
//! everything above is free, s what they are pulled by: a set of changes C has the estimate (CᵀSC)⁻¹ Cᵀs and explains
//! χ² = sᵀC (CᵀSC)⁻¹ Cᵀs.
//!
//! The same is asked of the plays themselves: gains that differ between the parts of one play. What these contrasts explain
//! beyond chance is what the model lacks.
//!
//! Source: C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50 (score tests beside free parameters).
//!
//! [`FieldError`]: tactpad_core::pipeline::contact::field_error::FieldError

mod columns;
pub mod plays;
mod reference;

use self::columns::Columns;
use self::plays::{Changes, PlayEstimate, Plays};
use self::reference::ReferenceState;
use super::fit::{FitError, same_plate};
use super::model::ParameterLayout;
use super::problem::Problem;
use crate::calibration::data::contacts::Fitted;
use crate::calibration::data::earlier::EarlierCalibration;
use crate::calibration::fit::prepared::PreparedRecording;
use crate::calibration::fit::search::{NOISE_TIMES_S, Report};
use crate::calibration::model::prior::Prior;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pipeline::contact::inverse::own_uv;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::products::dot;

/// Every so many contacts settle the settings of the fit, which is tried for many of them.
const SETTLING_STRIDE: usize = 2;

/// A play that is held against the pad as it was.
pub struct Comparison<'p> {
    plays: Plays<'p>,
    device: &'p Device,
    maps: Changes<'p>,
    prepared: PreparedRecording,
    prior: Prior,
    reference: ReferenceState<'p>,
}

impl<'p> Comparison<'p> {
    /// Against an earlier play. It alone says how the pad was: what changed must not count as noise, nor be half of it. `field` is
    /// that of `device`, the nominal pad.
    ///
    /// # Errors
    /// No contact, or readings beyond anything that a pad can read.
    pub fn with_play(
        plays: Plays<'p>,
        device: &'p Device,
        field: &PadField,
        maps: Changes<'p>,
        report: Report<'_>,
    ) -> Result<Self, FitError> {
        let Plays { recording, fitted, later } = plays;
        let earlier: Vec<Fitted> = fitted.iter().filter(|it| it.row < later).copied().collect();
        if earlier.is_empty() {
            return Err(FitError::TooFew { contacts: 0, least: 1 });
        }
        let prepared = PreparedRecording::of(recording, fitted, device, field).ok_or(FitError::Senseless)?;
        let prior = Prior::simulated(field);
        // Thresholds and times are asked of some contacts, and all other numbers then of all.
        let some: Vec<Fitted> = earlier.iter().step_by(SETTLING_STRIDE).copied().collect();
        let [some, all] = [&some, &earlier].map(|it| prepared.problem(it, device, &prior));
        let reference = ReferenceState::by_play([some, all], &prior, report).ok_or(FitError::Senseless)?;
        Ok(Self { plays, device, maps, prepared, prior, reference })
    }

    /// Against the pad as a calibrated decoder has it.
    ///
    /// # Errors
    /// A decoder of a pad with another plate, or readings beyond anything that a pad can read.
    pub fn with_decoder(
        plays: Plays<'p>,
        device: &'p Device,
        field: &PadField,
        decoder: &EarlierCalibration<'p>,
        maps: Changes<'p>,
    ) -> Result<Self, FitError> {
        same_plate(decoder, field)?;
        let Plays { recording, fitted, .. } = plays;
        let prepared = PreparedRecording::of(recording, fitted, device, field).ok_or(FitError::Senseless)?;
        // The decoder has what its pad is, and not by which of the device's numbers.
        let prior = Prior::at(field, decoder);
        let reference =
            ReferenceState::by_decoder(&prepared.problem(fitted, device, &prior), &prior, decoder.inverse);
        let mut comparison = Self { plays, device, maps, prepared, prior, reference };
        comparison.reference = comparison.lasting().ok_or(FitError::Senseless)?;
        Ok(comparison)
    }

    /// How long relative noise lasts in the later play: a decoder does not say.
    fn lasting(&self) -> Option<ReferenceState<'p>> {
        let problem = self.problem(&self.prepared);
        let columns = Columns::of(&problem, &self.reference, &self.plays, self.maps, &[]);
        let problem = columns.located(problem);
        let tried = NOISE_TIMES_S.into_iter().filter_map(|time_s| {
            let reference = self.reference.lasting(time_s);
            let columns = Columns::of(&problem, &reference, &self.plays, self.maps, &[]);
            let log_evidence = columns.log_evidence(&problem)?;
            Some((log_evidence, reference))
        });
        tried.max_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, reference)| reference)
    }

    /// The equations of the changes about these, in their order: those of the whole changes, not of what is beyond these.
    ///
    /// # Errors
    /// Readings beyond anything that a pad can read.
    pub fn about(&self, changes: &[f64]) -> Result<PlayEstimate, FitError> {
        // y = (1 + L)(1 + C) s, in the contacts and along the load path between them: what was read with C is taken to be read without.
        let crosstalk = ParameterLayout::crosstalk(&self.reference.values);
        let as_before = |uv: &[f64; CHANNELS]| {
            let own = own_uv(uv, &crosstalk);
            let own: [f64; CHANNELS] =
                std::array::from_fn(|k| own[k] / (1.0 + changes.get(k).copied().unwrap_or_default()));
            std::array::from_fn(|into| own[into] + dot(&crosstalk[into], &own))
        };
        let prepared = self.prepared.changed(self.plays.later, as_before);
        let problem = self.problem(&prepared);
        let columns = Columns::of(&problem, &self.reference, &self.plays, self.maps, changes);
        let problem = columns.located(problem);
        columns.compared(&problem).ok_or(FitError::Senseless)
    }

    fn problem<'a>(&'a self, prepared: &'a PreparedRecording) -> Problem<'a> {
        prepared.problem(self.plays.fitted, self.device, &self.prior)
    }
}
