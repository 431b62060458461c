//! What a pad remembers: creep, hysteresis, ageing.

use crate::plan::Row;
use crate::truth::Truth;

/// Works on the strain of all rows.
pub(crate) fn remember(truths: &[Truth], rows: &[Row], strain: &mut [[f64; 9]], full_scale: &[f64; 9]) {
    for truth in truths {
        for channel in truth.channels() {
            let seen: Vec<f64> = strain.iter().map(|strain| strain[channel]).collect();
            let add = match truth.effect.as_str() {
                "creep" => creep(truth.value("share_at_20s"), rows, &seen),
                "hysteresis" => lag(
                    truth.value("share_of_full_scale") * full_scale[channel],
                    full_scale[channel],
                    rows,
                    &seen,
                ),
                "ageing" => loss(truth.value("share_at_end"), rows, &seen),
                _ => continue,
            };
            strain.iter_mut().zip(add).for_each(|(strain, add)| strain[channel] += add);
        }
    }
}

/// Logarithmic creep, 1 after 20 s: what polymers do over decades of time, and no sum of few exponentials.
fn course(after_s: f64) -> f64 {
    (1.0 + after_s.max(0.0) / 0.5).ln() / (1.0 + 20.0_f64 / 0.5).ln()
}

/// Each change of the strain goes on creeping by itself; a static contact is read when it has been held.
fn creep(share: f64, rows: &[Row], strain: &[f64]) -> Vec<f64> {
    let one = |index: usize| match rows[index].in_trial_s {
        None => share * strain[index] * course(rows[index].dwell_s),
        Some(now) => {
            let first = trial_start(rows, index);
            let step = |earlier: usize| {
                let before = if earlier == first { 0.0 } else { strain[earlier - 1] };
                (strain[earlier] - before) * course(now - rows[earlier].in_trial_s.unwrap_or_default())
            };
            share * (first..=index).map(step).sum::<f64>()
        }
    };
    (0..rows.len()).map(one).collect()
}

fn trial_start(rows: &[Row], index: usize) -> usize {
    let other = |row: &Row| row.trial != rows[index].trial;
    rows[..index].iter().rposition(other).map_or(0, |last| last + 1)
}

/// Thresholds of the friction elements as shares of full scale, and their parts of the loop.
const FRICTION: [[f64; 2]; 3] = [[0.02, 0.3], [0.06, 0.4], [0.15, 0.3]];

/// Dry friction: elements that stick until the strain is their threshold ahead, and hold it back as long. The loop of a
/// full stroke, up against down, is `width` high.
fn lag(width: f64, full_scale: f64, rows: &[Row], strain: &[f64]) -> Vec<f64> {
    let mut held = vec![0.0; rows.len()];
    for [threshold, part] in FRICTION {
        let threshold = threshold * full_scale;
        let mut state = 0.0;
        for (index, row) in rows.iter().enumerate() {
            // A static contact comes from rest; from above it comes from full scale in the same direction.
            let fresh = row.in_trial_s.is_none() || trial_start(rows, index) == index;
            if fresh {
                state =
                    if row.unloading { slid(0.0, strain[index] * row.overload(), threshold) } else { 0.0 };
            }
            state = slid(state, strain[index], threshold);
            held[index] += part * width / 2.0 * (state - strain[index]) / threshold;
        }
    }
    held
}

fn slid(state: f64, strain: f64, threshold: f64) -> f64 {
    state.clamp(strain - threshold, strain + threshold)
}

/// Wear that slows down: as the logarithm of the cycles.
fn loss(share: f64, rows: &[Row], strain: &[f64]) -> Vec<f64> {
    let worn = |cycle: f64| (1.0 + cycle / 400.0).ln();
    let end = rows.iter().map(|row| row.cycle).fold(1.0, f64::max);
    rows.iter().zip(strain).map(|(row, strain)| -share * strain * worn(row.cycle) / worn(end)).collect()
}
