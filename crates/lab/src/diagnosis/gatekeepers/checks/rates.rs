//! Rates that do not match: channels that are held over several rows, and a label's clock that runs away from the channels'.

use crate::diagnosis::gatekeepers::gate::{Gate, rows_text};
use tactpad_numeric::statistics::{Line, deviation};

/// Of a held channel's changes, so many come after one and the same number of rows.
const REGULAR: f64 = 0.8;
/// Fewest changes to tell that.
const CHANGES_MIN: usize = 10;
/// The offset between two clocks shows if it is this part of the time between two rows.
const APART: f64 = 0.5;

pub(crate) fn check(gate: &mut Gate) {
    (0..gate.channels()).for_each(|channel| held(gate, channel));
    clocks(gate);
}

/// Keeps the first of the rows over which a channel is held.
fn held(gate: &mut Gate, channel: usize) {
    let readings = &gate.observations.readings[channel];
    let told = gate.told(channel);
    let runs: Vec<&[usize]> = told.chunk_by(|one, other| readings[*one] == readings[*other]).collect();
    // The first and the last may be cut off.
    let lengths: Vec<usize> = runs.iter().map(|run| run.len()).skip(1).rev().skip(1).collect();
    let count = |length: usize| lengths.iter().filter(|it| **it == length).count();
    let Some(every) = lengths.iter().copied().max_by_key(|length| count(*length)) else { return };
    let is_held =
        every > 1 && lengths.len() >= CHANGES_MIN && count(every) as f64 >= REGULAR * lengths.len() as f64;
    if !is_held {
        return;
    }
    let repeats: Vec<usize> = runs.iter().flat_map(|run| run[1..].to_vec()).collect();
    let detail = format!(
        "{} changes only at one row in {every}: it is sampled less often than the table has rows; the {} that repeat a reading \
         have no weight; write each channel at its own times",
        gate.name(channel),
        rows_text(repeats.len())
    );
    gate.mask(channel, &repeats);
    gate.notice("rates", Some(channel), detail);
}

/// Holds `label_t_s` against `t_s`.
fn clocks(gate: &mut Gate) {
    let times: Vec<[f64; 2]> = gate
        .observations
        .samples
        .iter()
        .filter_map(|sample| Some([sample.t_s?, sample.label_t_s?]))
        .collect();
    let mut steps: Vec<f64> =
        times.windows(2).map(|pair| pair[1][0] - pair[0][0]).filter(|by| *by > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let Some(step) = steps.get(steps.len() / 2).copied() else { return };
    let apart: Vec<[f64; 2]> = times.iter().map(|[t, label]| [*t, label - t]).collect();
    let [Some(first), Some(last)] = [times.first(), times.last()] else { return };
    let line = Line::through(&apart);
    let [begin, end] = [first, last].map(|[t, _]| line.at(*t));
    let left: Vec<f64> = apart.iter().map(|[t, by]| by - line.at(*t)).collect();
    if begin.abs().max(end.abs()) > APART * step {
        let detail = format!(
            "label_t_s is {begin:.4} s from t_s at the beginning and {end:.4} s at the end, beside a scatter of {:.4} s; rows are \
             taken as they stand; merge the two recordings by one clock",
            deviation(&left)
        );
        gate.notice("clocks", None, detail);
    }
}
