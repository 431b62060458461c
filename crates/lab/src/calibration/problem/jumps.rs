//! Jumps of the zero: what the untouched pad reads now, less what it read before. Hysteresis and creep make them, and drift.

use crate::calibration::data::contacts::Lags;
use crate::calibration::model::ParameterLayout;
use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::recording::{Recording, UntouchedReading};

/// Standard deviation of a zero's drift between two readings: its least value, and the one that the fit begins with.
const DRIFT_MIN_UV: f64 = 1.0;
pub(crate) const DRIFT_UV: f64 = 10.0;
/// A jump's standard deviation is at least this part of its residual, so that an outlier loses weight: temperature may have
/// changed.
const JUMP_PART: f64 = 1.0 / 3.0;

/// All jumps of a recording.
#[derive(Clone)]
pub(crate) struct Jumps {
    pub(crate) all: Vec<Jump>,
}

/// The untouched pad at two times.
#[derive(Clone)]
pub(crate) struct Jump {
    pub(crate) rows: [usize; 2],
    pub(crate) change_uv: [f64; CHANNELS],
    /// Change of the play operators' states.
    pub(crate) lags: Lags,
    /// Change of the creep states.
    pub(crate) crept_uv: [f64; CHANNELS],
}

impl Jumps {
    /// From each reading of the untouched pad to the next one of its table.
    pub(crate) fn of(recording: &Recording) -> Self {
        Self { all: recording.zeros().flat_map(jumps).collect() }
    }

    /// Every jump of a zero: the channel, its residual beside hysteresis and creep, the variance of that, and its derivatives by
    /// the parameters.
    pub(crate) fn each(
        &self,
        layout: &ParameterLayout,
        values: &[f64],
        drift_uv: &[f64; CHANNELS],
        mut then: impl FnMut(usize, f64, f64, &[f64]),
    ) {
        let mut derivatives = vec![0.0; layout.size()];
        for Jump { change_uv, lags, crept_uv, .. } in &self.all {
            for channel in 0..CHANNELS {
                derivatives.fill(0.0);
                ParameterLayout::add_memory_slopes(channel, lags, crept_uv, &mut derivatives);
                let memory_uv = ParameterLayout::memory_uv(values, channel, lags, crept_uv);
                let residual_uv = change_uv[channel] - memory_uv;
                // σ = max(drift, |r|/3): beyond three standard deviations an outlier weighs 9/r².
                let deviation = drift_uv[channel].max(JUMP_PART * residual_uv.abs());
                then(channel, residual_uv, deviation * deviation, &derivatives);
            }
        }
    }

    /// Standard deviation of each channel's drift between readings of the zero, by the median magnitude of the jumps' residuals.
    pub(crate) fn drift_uv(&self, layout: &ParameterLayout, values: &[f64]) -> [f64; CHANNELS] {
        let mut magnitudes = [const { Vec::new() }; CHANNELS];
        self.each(layout, values, &[DRIFT_UV; CHANNELS], |channel, residual_uv, _, _| {
            magnitudes[channel].push(residual_uv.abs());
        });
        magnitudes.map(|mut magnitudes| {
            magnitudes.sort_by(f64::total_cmp);
            // Of a normal number the median magnitude is 0.6745 of its standard deviation.
            magnitudes
                .get(magnitudes.len() / 2)
                .map_or(DRIFT_UV, |median| (median / 0.6745).max(DRIFT_MIN_UV))
        })
    }

    /// ln p(jumps | θ) = −½ Σ (r²/σ² + ln σ²), but for a constant.
    pub(crate) fn log_likelihood(
        &self,
        layout: &ParameterLayout,
        values: &[f64],
        drift_uv: &[f64; CHANNELS],
    ) -> f64 {
        let mut cost = 0.0;
        self.each(layout, values, drift_uv, |_, residual_uv, variance, _| {
            cost += residual_uv * residual_uv / variance + variance.ln();
        });
        -0.5 * cost
    }
}

/// From each reading of the untouched pad to the next.
fn jumps(zeros: Vec<UntouchedReading>) -> Vec<Jump> {
    let jump = |((first, earlier), (second, later)): (&UntouchedReading, &UntouchedReading)| Jump {
        rows: [*first, *second],
        change_uv: std::array::from_fn(|k| later[k] - earlier[k]),
        lags: [[0.0; CHANNELS]; PLAYS],
        crept_uv: [0.0; CHANNELS],
    };
    zeros.iter().zip(zeros.get(1..).unwrap_or_default()).map(jump).collect()
}
