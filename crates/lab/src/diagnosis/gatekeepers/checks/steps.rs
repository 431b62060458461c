//! Steps of the converter that are larger than the noise.
//!
//! The step is the least distance of two values, if all distances are whole multiples of it.

use crate::diagnosis::gatekeepers::gate::Gate;
use tactpad_core::counted::counted;
use tactpad_numeric::statistics::median;

/// Values in all for a step to be told, and distances from a multiple that digits of a file may leave.
const VALUES_MIN: usize = 6;
const ROUNDING: f64 = 0.05;
/// Distances of more steps than this are not looked at: their rounding adds up.
const MULTIPLES_MAX: f64 = 10.0;
/// Of so many distances this share is a multiple.
const MULTIPLES: f64 = 0.95;
/// A range of fewer steps than a converter of twelve bits has is coarse.
const COARSE: f64 = 4096.0;
/// Standard deviation of normal numbers whose magnitudes have the median 1.
const DEVIATION_OF_MEDIAN: f64 = 1.482_602;

pub(crate) fn check(gate: &mut Gate) {
    for channel in 0..gate.channels() {
        let rows = gate.told(channel);
        let values = gate.readings(channel, &rows);
        let Some(step) = step(&values) else { continue };
        let Some(noise) = noise(gate, channel) else { continue };
        let range =
            values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min);
        if step <= noise || range / step > COARSE {
            continue;
        }
        let detail = format!(
            "{} goes in steps of {step:.6}, more than its noise of {noise:.3}, in all its {}; nothing is changed: steps count \
             as noise; a larger gain before the converter would use it better",
            gate.name(channel),
            counted(rows.len(), "row")
        );
        gate.notice("steps", Some(channel), detail);
    }
}

/// The least distance of two different values; none if all are the same.
pub(crate) fn least_gap(values: &[f64]) -> Option<f64> {
    gaps(values).into_iter().reduce(f64::min)
}

fn gaps(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > 0.0 && gap.is_finite()).collect()
}

/// The converter's step, if these values have one.
fn step(values: &[f64]) -> Option<f64> {
    let gaps = gaps(values);
    // A tenth of a step is a rounding error of the file, not a step.
    let least = gaps.iter().copied().reduce(f64::min)?;
    let small: Vec<f64> = gaps.iter().map(|gap| gap / least).filter(|it| *it <= MULTIPLES_MAX).collect();
    let whole = small.iter().filter(|it| (*it - it.round()).abs() <= ROUNDING * it.max(1.0)).count();
    let is_stepped = gaps.len() >= VALUES_MIN && whole as f64 >= MULTIPLES * small.len() as f64;
    is_stepped.then_some(least)
}

/// The noise: of three samples of a series that follow each other, (y₋ − 2 y + y₊)/√6.
fn noise(gate: &Gate, channel: usize) -> Option<f64> {
    let is_told = &gate.observations.is_told[channel];
    let readings = &gate.observations.readings[channel];
    let bends: Vec<f64> = gate
        .series()
        .iter()
        .flat_map(|rows| rows.windows(3))
        .filter(|rows| rows.iter().all(|row| is_told[*row]))
        .map(|rows| (readings[rows[0]] - 2.0 * readings[rows[1]] + readings[rows[2]]).abs() / 6.0_f64.sqrt())
        .collect();
    median(bends).map(|it| DEVIATION_OF_MEDIAN * it)
}
