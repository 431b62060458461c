//! The hyperparameters of a fit: those that a fit is given, and those that it estimates.

use super::jumps::DRIFT_UV;
use super::noise::NoisePrior;
use super::noise_model::NoiseModel;
use super::prior_deviations::PriorDeviations;
use super::rig::RigPrior;
use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
use tactpad_core::quantity::CHANNELS;

/// Hyperparameters that stay fixed while the parameters are fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Settings {
    /// Prior standard deviation of the background, as a share of each map's root mean square; zero: none.
    pub(super) background: f64,
    /// Thresholds of the play operators, in strains before gains; an operator with zero does nothing.
    pub(super) thresholds_uv: [f64; PLAYS],
    /// Relaxation time of creep; zero: no creep.
    pub(super) creep_time_s: f64,
    /// Time constant of relative noise; zero: it is drawn anew for each contact.
    pub(super) noise_time_s: f64,
    /// Prior standard deviations of stiffnesses, moduli and the plate's thickness, as a share of those that pads of all kinds have.
    pub(super) elastic_scale: f64,
}

/// Hyperparameters that are estimated anew at each step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimates {
    pub(super) noise_model: NoiseModel,
    pub(super) prior_deviations: PriorDeviations,
    /// Standard deviation of each zero's drift from one reading to the next.
    pub(super) drift_uv: [f64; CHANNELS],
    /// The prior of the rig's errors.
    pub(super) rig: RigPrior,
}

impl Estimates {
    /// Before any contact was looked at.
    pub(super) fn first(noise: NoisePrior, noise_time_s: f64, is_tared: bool) -> Self {
        Self {
            noise_model: NoiseModel::prior(noise, noise_time_s),
            prior_deviations: if is_tared { PriorDeviations::TARED } else { PriorDeviations::RAW },
            drift_uv: [DRIFT_UV; CHANNELS],
            rig: RigPrior::new(),
        }
    }
}
