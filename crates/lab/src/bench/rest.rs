//! What the inputs read while nothing touches the pad: noise, drift, the hum of the mains, and inputs that tell nothing.

use super::samples::BenchSample;
use crate::diagnosis::gatekeepers::checks::line::RowRun;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::statistics::{Line, mean};

/// Noise is what is left beside a straight line in stretches of this length: slower changes are drift.
const STRETCH_S: f64 = 0.5;
/// Fewest samples of a stretch.
const SAMPLES_MIN: usize = 20;
/// The grids' frequencies, and frequencies beside them by which noise is told from hum.
const GRIDS_HZ: [f64; 2] = [50.0, 60.0];
const BESIDE_HZ: [f64; 4] = [-7.0, -5.0, 5.0, 7.0];
/// A line that is so many times as strong as what lies beside it is hum: of ten stretches' white noise fewer than one in 10,000 is.
const HUM_RATIO: f64 = 4.0;

/// Hum of the mains in an input.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Hum {
    /// Of the grid.
    pub frequency_hz: f64,
    /// Its amplitude.
    pub amplitude_uv: f64,
}

/// What an input does at rest.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct InputRest {
    /// Its mean: the bridge's offset.
    pub zero_uv: f64,
    /// Root mean square of what changes within half a second, hum included.
    pub noise_uv: f64,
    /// How fast the zero drifts.
    pub drift_uv_per_min: f64,
    /// The mains, where they are seen.
    pub hum: Option<Hum>,
    /// Why it tells nothing, if it does not.
    pub fault: Option<InputFault>,
}

/// Why an input tells nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum InputFault {
    /// It is at the end of its range, or its bridge is open.
    OutOfRange,
    /// It sends the same number all the time, which no converter with a bridge does.
    Constant,
    /// Its noise is so large that presses drown in it.
    Noisy,
    /// It reads next to nothing in all deeds.
    Silent,
}

/// An input with more noise than this tells no press.
pub const NOISE_MAX_UV: f64 = 400.0;
/// Share of samples out of range from which an input counts as that.
const OUT_OF_RANGE_SHARE: f64 = 0.01;

/// What all inputs do in these samples; `None` where they are too few.
pub fn rest(samples: &[BenchSample]) -> Option<[InputRest; CHANNELS]> {
    let first = samples.first()?;
    let stretches: Vec<&[BenchSample]> = samples
        .chunk_by(|one, other| stretch(one, first) == stretch(other, first))
        .filter(|stretch| stretch.len() >= SAMPLES_MIN)
        .collect();
    if stretches.is_empty() {
        return None;
    }
    let runs: Vec<RowRun> = stretches
        .iter()
        .map(|stretch| RowRun::of((0..stretch.len()).collect(), stretch.iter().map(|it| it.t_s).collect()))
        .collect();
    Some(std::array::from_fn(|input| of_input(input, samples, &stretches, &runs)))
}

fn stretch(sample: &BenchSample, first: &BenchSample) -> i64 {
    ((sample.t_s - first.t_s) / STRETCH_S) as i64
}

fn of_input(
    input: usize,
    samples: &[BenchSample],
    stretches: &[&[BenchSample]],
    runs: &[RowRun],
) -> InputRest {
    let points = |samples: &[BenchSample]| -> Vec<[f64; 2]> {
        samples.iter().map(|it| [it.t_s, it.uv[input]]).collect()
    };
    let left: Vec<Vec<f64>> = stretches
        .iter()
        .map(|stretch| {
            let points = points(stretch);
            let line = Line::through(&points);
            points.iter().map(|[t_s, uv]| uv - line.at(*t_s)).collect()
        })
        .collect();
    let noise_uv = mean(left.iter().flatten().map(|uv| uv * uv)).sqrt();
    let whole = Line::through(&points(samples));
    let out_of_range = samples.iter().filter(|it| it.is_out_of_range[input]).count();
    let fault = if out_of_range as f64 > OUT_OF_RANGE_SHARE * samples.len() as f64 {
        Some(InputFault::OutOfRange)
    } else if samples.iter().all(|it| it.uv[input] == samples[0].uv[input]) {
        Some(InputFault::Constant)
    } else if noise_uv > NOISE_MAX_UV {
        Some(InputFault::Noisy)
    } else {
        None
    };
    InputRest {
        zero_uv: mean(samples.iter().map(|it| it.uv[input])),
        noise_uv,
        drift_uv_per_min: 60.0 * whole.slope,
        hum: if fault == Some(InputFault::Constant) { None } else { hum(&left, runs) },
        fault,
    }
}

/// The stronger of the two grids' lines, if it stands out.
fn hum(left: &[Vec<f64>], runs: &[RowRun]) -> Option<Hum> {
    let square = |hz: f64| {
        let squares = runs.iter().zip(left).filter_map(|(run, left)| Some(run.waves(hz)?.square(left)));
        mean(squares)
    };
    let of_grid = |grid_hz: f64| {
        let beside = mean(BESIDE_HZ.map(|by| square(grid_hz + by)));
        let own = square(grid_hz);
        let weight = mean(runs.iter().filter_map(|run| Some(run.waves(grid_hz)?.weight())));
        // S = A² w + what noise makes
        let amplitude_uv = ((own - beside) / weight).max(0.0).sqrt();
        (own > HUM_RATIO * beside).then_some(Hum { frequency_hz: grid_hz, amplitude_uv })
    };
    let lines = GRIDS_HZ.into_iter().filter_map(of_grid);
    lines.max_by(|one, other| one.amplitude_uv.total_cmp(&other.amplitude_uv))
}
