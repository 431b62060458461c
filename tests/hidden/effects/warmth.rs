//! Temperature and time: zeros and gains that follow them.

use crate::plan::Row;
use crate::truth::Truth;

/// Where gains and zeros are nominal, in °C: as the nominal device has it.
pub(crate) const REFERENCE_C: f64 = 25.0;

/// Works on the signals of all rows.
pub(crate) fn warm(truths: &[Truth], rows: &[Row], signals: &mut [[f64; 9]]) {
    for truth in truths {
        for (row, signal) in rows.iter().zip(signals.iter_mut()) {
            let warmer = row.temp_c - REFERENCE_C;
            for channel in truth.channels() {
                match truth.effect.as_str() {
                    "thermal_zero" => signal[channel] += truth.value("uv_per_c") * warmer,
                    "thermal_gain" => signal[channel] *= 1.0 + truth.value("per_c") * warmer,
                    "zero_drift" => signal[channel] += truth.value("uv_per_h") * row.time_s / 3600.0,
                    _ => {}
                }
            }
        }
    }
}
