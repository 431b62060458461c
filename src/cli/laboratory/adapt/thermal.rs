//! How channels follow the temperature.

use std::fmt;

use serde::Serialize;

use tactpad::lab::calibration::data::thermal_fit::ThermalFit;
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

/// Coefficients per degree; null where nothing tells them.
#[derive(Serialize)]
pub(super) struct FoundThermal {
    reference_c: f64,
    zero_uv_per_c: Option<[f64; CHANNELS]>,
    zero_deviation: Option<[f64; CHANNELS]>,
    gain_per_c: Option<[f64; CHANNELS]>,
    gain_deviation: Option<[f64; CHANNELS]>,
}

impl FoundThermal {
    pub(super) fn of(fit: &ThermalFit) -> Self {
        let ThermalFit { coefficients, zero_deviation, gain_deviation } = *fit;
        Self {
            reference_c: coefficients.reference_c,
            zero_uv_per_c: zero_deviation.map(|_| coefficients.zero_uv_per_c),
            zero_deviation,
            gain_per_c: gain_deviation.map(|_| coefficients.gain_per_c),
            gain_deviation,
        }
    }
}

impl fmt::Display for FoundThermal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { reference_c, zero_uv_per_c, zero_deviation, gain_per_c, gain_deviation } = self;
        writeln!(f, "channel  zero µV/°C  gain %/°C, around {reference_c:.1} °C")?;
        let text =
            |found: &Option<[f64; CHANNELS]>, deviation: &Option<[f64; CHANNELS]>, k: usize, unit: f64| {
                found.zip(*deviation).map_or_else(
                    || "not told".into(),
                    |(found, deviation)| format!("{:+.3} ± {:.3}", unit * found[k], unit * deviation[k]),
                )
            };
        for (k, name) in CHANNEL_NAMES.iter().enumerate() {
            let zero = text(zero_uv_per_c, zero_deviation, k, 1.0);
            writeln!(f, "{name:<7} {zero}  {}", text(gain_per_c, gain_deviation, k, 100.0))?;
        }
        Ok(())
    }
}
