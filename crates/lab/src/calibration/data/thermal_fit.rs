//! Temperature coefficients of a pad, as far as its measured contacts tell them.
//!
//! Those of the zeros are slopes of straight lines through the readings of the untouched pad, by least squares. Those of the
//! gains are parameters of the fit.

use tactpad_core::pipeline::compensation::thermal::Thermal;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::measured::Row;
use tactpad_core::tables::recording::Recording;
use tactpad_numeric::statistics::mean;

/// Least span of temperatures that tells a coefficient.
const SPAN_MIN_C: f64 = 1.0;

/// Coefficients with their standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalFit {
    /// Coefficients found; zero where nothing tells them.
    pub coefficients: Thermal,
    /// Standard deviations of the zeros' coefficients, µV/°C; none if the untouched pad was read at one temperature.
    pub zero_deviation: Option<[f64; CHANNELS]>,
    /// Standard deviations of the gains' coefficients, 1/°C; none if contacts were measured at one temperature.
    pub gain_deviation: Option<[f64; CHANNELS]>,
}

impl ThermalFit {
    /// The zeros' coefficients. `None` for a recording at one temperature, or at none.
    pub(crate) fn of_zeros(recording: &Recording) -> Option<Self> {
        let rows = &recording.tared().rows;
        let temperatures: Vec<f64> = rows.iter().filter_map(|row| row.temp_c).collect();
        if !are_apart(&temperatures) {
            return None;
        }
        let readings: Vec<(f64, [f64; CHANNELS])> =
            recording.zeros().flatten().filter_map(|(at, uv)| Some((rows[at].temp_c?, uv))).collect();
        let lines = lines(&readings);
        let coefficients = Thermal {
            reference_c: mean(temperatures.iter().copied()),
            zero_uv_per_c: lines.map_or([0.0; CHANNELS], |lines| lines.map(|[slope, _]| slope)),
            gain_per_c: [0.0; CHANNELS],
        };
        let zero_deviation = lines.map(|lines| lines.map(|[_, deviation]| deviation));
        Some(Self { coefficients, zero_deviation, gain_deviation: None })
    }

    /// Whether contacts tell how gains follow the temperature.
    pub(crate) fn is_told_by<'r>(rows: impl Iterator<Item = &'r Row>) -> bool {
        are_apart(&rows.filter_map(|row| row.temp_c).collect::<Vec<f64>>())
    }
}

fn are_apart(temperatures: &[f64]) -> bool {
    let (low, high) = temperatures
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (it.min(low), it.max(high)));
    high - low >= SPAN_MIN_C
}

/// For each channel the slope β of its readings u over the temperature T, and the slope's standard deviation σ by the residuals
/// of the n readings:
///
/// ```text
/// β = Σ (T − T̄)(u − ū)/S,    S = Σ (T − T̄)²,    σ² = Σ (u − ū − β (T − T̄))²/((n − 2) S)
/// ```
fn lines(readings: &[(f64, [f64; CHANNELS])]) -> Option<[[f64; 2]; CHANNELS]> {
    let temperatures: Vec<f64> = readings.iter().map(|(temp_c, _)| *temp_c).collect();
    // Two parameters, and at least one residual degree of freedom.
    if !are_apart(&temperatures) || readings.len() < 3 {
        return None;
    }
    let middle_c = mean(temperatures.iter().copied());
    let square: f64 = temperatures.iter().map(|temp_c| (temp_c - middle_c).powi(2)).sum();
    Some(std::array::from_fn(|k| {
        // β = Σ (T − T̄)(u − ū)/S.
        let middle_uv = mean(readings.iter().map(|(_, uv)| uv[k]));
        let slope =
            readings.iter().map(|(temp_c, uv)| (temp_c - middle_c) * (uv[k] - middle_uv)).sum::<f64>()
                / square;
        let residual_uv =
            |(temp_c, uv): &(f64, [f64; CHANNELS])| uv[k] - middle_uv - slope * (temp_c - middle_c);
        // σ² = Σ r²/((n − 2) S).
        let squares: f64 = readings.iter().map(|reading| residual_uv(reading).powi(2)).sum();
        [slope, (squares / (readings.len() - 2) as f64 / square).sqrt()]
    }))
}
