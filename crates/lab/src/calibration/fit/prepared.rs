//! A recording as the fit takes it: relative to zeros that follow the temperature, which are
//! estimated where none was read.

use crate::calibration::data::contacts::Fitted;
use crate::calibration::data::thermal_fit::ThermalFit;
use crate::calibration::model::ParameterLayout;
use crate::calibration::model::prior::Prior;
use crate::calibration::problem::effort::Effort;
use crate::calibration::problem::hyperparameters::Settings;
use crate::calibration::problem::{PosteriorFit, Problem};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
use tactpad_core::pipeline::compensation::thermal::Thermal;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::recording::Recording;

/// The recording, and what was taken off.
#[derive(Clone, Debug)]
pub(crate) struct PreparedRecording {
    recording: Recording,
    /// Temperature coefficients; those of the gains are for the fit to find.
    thermal: Option<ThermalFit>,
    /// Zeros by the contacts themselves, for a recording that never reads the untouched pad.
    zero_uv: Option<[f64; CHANNELS]>,
    /// Whether the contacts that are fitted to span enough temperatures for the gains' coefficients.
    tells_gains: bool,
}

impl PreparedRecording {
    /// `None` where the zeros cannot be found, as the readings are beyond anything that a pad can read.
    pub(crate) fn of(
        recording: &Recording,
        fitted: &[Fitted],
        device: &Device,
        field: &PadField,
    ) -> Option<Self> {
        let thermal = ThermalFit::of_zeros(recording);
        let recording = thermal
            .map_or_else(|| recording.clone(), |fit| recording.clone().at_reference(&fit.coefficients));
        let contacts = fitted.iter().filter_map(|it| recording.tared().rows.get(it.row));
        let tells_gains = ThermalFit::is_told_by(contacts);
        let prepared = Self { recording, thermal, zero_uv: None, tells_gains };
        if prepared.recording.is_tared() {
            return Some(prepared);
        }
        // Hysteresis and noise go with what is beyond the zeros, so these have to be known about before anything else.
        let prior = Prior::simulated(field);
        let plain = Settings {
            thresholds_uv: [0.0; PLAYS],
            creep_time_s: 0.0,
            noise_time_s: 0.0,
            elastic_scale: 1.0,
        };
        let fit = prepared.problem(fitted, device, &prior).fitted(plain, None, Effort::FULL);
        let zero_uv = ParameterLayout::zeros(&fit?.values);
        Some(Self { recording: prepared.recording.less(&zero_uv), zero_uv: Some(zero_uv), ..prepared })
    }

    /// The same with other readings, from a row on.
    pub(crate) fn changed(
        &self,
        first: usize,
        other_uv: impl Fn(&[f64; CHANNELS]) -> [f64; CHANNELS],
    ) -> Self {
        Self { recording: self.recording.clone().changed(first, other_uv), ..self.clone() }
    }

    /// The least-squares problem of these contacts under a prior.
    pub(crate) fn problem<'p>(&'p self, fitted: &[Fitted], device: &Device, prior: &'p Prior) -> Problem<'p> {
        let reference_c = self.thermal.map(|fit| fit.coefficients.reference_c);
        Problem::of(&self.recording, reference_c, fitted, device, prior)
    }

    /// The zeros, corrected by those of a fit.
    pub(crate) fn zero_uv(&self, fit: &PosteriorFit) -> Option<[f64; CHANNELS]> {
        let remainder_uv = ParameterLayout::zeros(&fit.values);
        self.zero_uv.map(|zero_uv| std::array::from_fn(|k| zero_uv[k] + remainder_uv[k]))
    }

    /// Whether a fit tells the gains' temperature coefficients.
    pub(crate) const fn tells_gains(&self) -> bool {
        self.thermal.is_some() && self.tells_gains
    }

    /// The temperature coefficients, completed by those of a fit.
    pub(crate) fn thermal(&self, fit: &PosteriorFit) -> Option<ThermalFit> {
        let thermal = self.thermal?;
        if !self.tells_gains() {
            return Some(thermal);
        }
        let at = |channel: usize| ParameterLayout::first_gain_slope() + channel;
        let gain_per_c = std::array::from_fn(|channel| fit.values[at(channel)]);
        Some(ThermalFit {
            coefficients: Thermal { gain_per_c, ..thermal.coefficients },
            gain_deviation: Some(std::array::from_fn(|channel| fit.deviation(at(channel)))),
            ..thermal
        })
    }
}
