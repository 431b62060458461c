//! The hyperparameters of a fit: those that a fit is given, and those that it estimates.

use super::jumps::DRIFT_UV;
use crate::calibration::data::rig::RigPrior;
use crate::calibration::model::prior_deviations::PriorDeviations;
use crate::calibration::noise::NoisePrior;
use crate::calibration::noise::model::NoiseModel;
use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
use tactpad_core::quantity::CHANNELS;

/// Hyperparameters that stay fixed while the parameters are fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Settings {
    /// Thresholds of the play operators, in strains before gains; an operator with zero does nothing.
    pub(crate) thresholds_uv: [f64; PLAYS],
    /// Relaxation time of creep; zero: no creep.
    pub(crate) creep_time_s: f64,
    /// Time constant of relative noise; zero: it is drawn anew for each contact.
    pub(crate) noise_time_s: f64,
    /// Prior standard deviations of stiffnesses, moduli and the plate's thickness, as a share of those that pads of all kinds have.
    pub(crate) elastic_scale: f64,
}

/// Hyperparameters that are estimated anew at each step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimates {
    pub(crate) noise_model: NoiseModel,
    pub(crate) prior_deviations: PriorDeviations,
    /// Standard deviation of each zero's drift from one reading to the next.
    pub(crate) drift_uv: [f64; CHANNELS],
    /// The prior of the rig's errors.
    pub(crate) rig: RigPrior,
}

impl Estimates {
    /// Before any contact was looked at.
    pub(crate) fn first(noise: NoisePrior, noise_time_s: f64, is_tared: bool) -> Self {
        Self {
            noise_model: NoiseModel::prior(noise, noise_time_s),
            prior_deviations: PriorDeviations::first(is_tared),
            drift_uv: [DRIFT_UV; CHANNELS],
            rig: RigPrior::new(),
        }
    }
}
