//! The pad as it was: what its readings follow from, and how well that is known.

use crate::calibration::fit::search::{Report, settled_reported};
use crate::calibration::model::CERTAIN;
use crate::calibration::model::prior::Prior;
use crate::calibration::model::prior_deviations::ParameterKind;
use crate::calibration::problem::Problem;
use crate::calibration::problem::effort::Effort;
use crate::calibration::problem::hyperparameters::{Estimates, Settings};
use tactpad_core::pipeline::contact::inverse::Inverse;

/// State of the pad before the change: the parameters and settings that its earlier readings follow from, with the precision of each.
#[derive(Clone)]
pub(super) struct ReferenceState<'d> {
    pub(super) settings: Settings,
    /// The parameters θ.
    pub(super) values: Vec<f64>,
    pub(super) estimates: Estimates,
    /// Mean and precisions of their prior, beside which the plays stand.
    pub(super) mean: Vec<f64>,
    pub(super) precisions: Vec<f64>,
    /// The decoder whose field's errors are open, if it is a decoder's.
    pub(super) decoder: Option<&'d Inverse>,
}

impl ReferenceState<'_> {
    /// By an earlier play: `some` of its contacts settle the settings, `all` the parameters.
    pub(super) fn by_play([some, all]: [Problem<'_>; 2], prior: &Prior, report: Report<'_>) -> Option<Self> {
        let settled = settled_reported(&some, prior, report)?;
        let fit = all.clone().fitted(settled.settings, None, Effort::FULL)?;
        let (mean, precisions) = all.prior_of(&fit);
        let (settings, estimates) = (fit.settings, fit.estimates);
        Some(Self { settings, values: fit.values, estimates, mean, precisions, decoder: None })
    }

    /// The same where relative noise lasts so long.
    pub(super) fn lasting(&self, noise_time_s: f64) -> Self {
        let mut reference = self.clone();
        reference.settings.noise_time_s = noise_time_s;
        reference.estimates.noise_model.lasting_s = noise_time_s;
        reference
    }
}

impl<'d> ReferenceState<'d> {
    /// By a decoder on whose field and compensation the prior is centred. Its field is wrong by its modes alone. Of its hysteresis it
    /// says no deviation: each channel's own share is as open as that of any pad.
    pub(super) fn by_decoder(problem: &Problem<'_>, prior: &Prior, decoder: &'d Inverse) -> Self {
        let settings = Settings {
            thresholds_uv: prior.thresholds_uv,
            creep_time_s: prior.creep.time_s,
            noise_time_s: 0.0,
            elastic_scale: 1.0,
        };
        let mut estimates = Estimates::first(prior.noise, 0.0, problem.recording.is_tared());
        let mean = problem.layout.prior_mean(prior, &estimates.rig);
        estimates.drift_uv = problem.jumps.drift_uv(&problem.layout, &mean);
        let mut precisions = vec![CERTAIN; mean.len()];
        for (.., at) in problem.layout.kinds().filter(|(kind, ..)| *kind == ParameterKind::OwnHysteresis) {
            precisions[at] = estimates.prior_deviations.of(ParameterKind::OwnHysteresis).powi(-2);
        }
        Self { settings, values: mean.clone(), estimates, mean, precisions, decoder: Some(decoder) }
    }
}
