//! A recording as the fit takes it: what follows the temperature is off the zeros, and so are zeros that nobody read.

use super::before::Before;
use super::model::Layout;
use super::problem::{Fit, Problem, Settings};
use super::warmth::Warmth;
use crate::contact::friction::PLAYS;
use crate::contact::recording::Recording;
use crate::contact::thermal::Thermal;
use crate::device::Device;
use crate::field::PadField;
use crate::quantity::CHANNELS;

/// The recording, and what was taken off.
#[derive(Clone, Debug)]
pub(super) struct Prepared {
    recording: Recording,
    /// Coefficients by temperature; those of the gains are for the fit to find.
    warmth: Option<Warmth>,
    /// Zeros that the contacts themselves tell, for a recording that never reads the untouched pad.
    zero_uv: Option<[f64; CHANNELS]>,
    /// Whether the contacts that are fitted to tell the gains' coefficients.
    tells_gains: bool,
}

impl Prepared {
    /// `None` where the numbers make no sense.
    pub(super) fn of(
        recording: &Recording,
        rows: &[usize],
        device: &Device,
        field: &PadField,
    ) -> Option<Self> {
        let warmth = Warmth::of_zeros(recording);
        let recording = warmth
            .map_or_else(|| recording.clone(), |warmth| recording.clone().at_reference(&warmth.thermal));
        let contacts = rows.iter().filter_map(|at| recording.tared().rows.get(*at));
        let tells_gains = Warmth::is_told_by(contacts);
        let prepared = Self { recording, warmth, zero_uv: None, tells_gains };
        if prepared.recording.is_tared() {
            return Some(prepared);
        }
        // Friction and noise go with what is beyond the zeros, so these have to be known about before anything else.
        let before = Before::simulated(field);
        let plain = Settings { background: 0.0, thresholds_uv: [0.0; PLAYS], creep_time_s: 0.0 };
        let fit = prepared.problem(rows, device, &before).fitted(plain, None);
        let zero_uv = Layout::zeros(&fit?.values);
        Some(Self { recording: prepared.recording.less(&zero_uv), zero_uv: Some(zero_uv), ..prepared })
    }

    /// What there is to fit to these contacts.
    pub(super) fn problem<'p>(&'p self, rows: &[usize], device: &Device, before: &'p Before) -> Problem<'p> {
        let reference_c = self.warmth.map(|warmth| warmth.thermal.reference_c);
        Problem::of(&self.recording, reference_c, rows, device, before)
    }

    /// The zeros with what a fit has still found of them.
    pub(super) fn zero_uv(&self, fit: &Fit) -> Option<[f64; CHANNELS]> {
        let rest_uv = Layout::zeros(&fit.values);
        self.zero_uv.map(|zero_uv| std::array::from_fn(|k| zero_uv[k] + rest_uv[k]))
    }

    /// The coefficients with those of a fit.
    pub(super) fn warmth(&self, fit: &Fit) -> Option<Warmth> {
        let warmth = self.warmth?;
        if !self.tells_gains {
            return Some(warmth);
        }
        let at = |channel: usize| Layout::first_warmth() + channel;
        let gain_per_c = std::array::from_fn(|channel| fit.values[at(channel)]);
        Some(Warmth {
            thermal: Thermal { gain_per_c, ..warmth.thermal },
            gain_deviation: Some(std::array::from_fn(|channel| fit.deviation(at(channel)))),
            ..warmth
        })
    }
}
