//! Stretches in which a channel repeats a value to the last digit while others move.
//!
//! A converter's steps let values repeat by chance: with the share p of repeats in the rest of the channel, a run of k repeats
//! somewhere in n rows has at most the probability n pᵏ.

use crate::diagnosis::gatekeepers::gate::{Gate, LEVEL};
use tactpad_core::counted::counted;
use tactpad_numeric::statistics::{median, squares};

/// Others move if their mean square in the stretch is this part of that of all rows: a third of its deviation.
const MOVES: f64 = 0.1;
/// A channel that repeats in more than this part of its rows is held, not stuck.
const HELD: f64 = 0.5;
/// Of such a channel's changes, so many come after one and the same number of rows.
const REGULAR: f64 = 0.8;
/// Fewest changes to tell that.
const CHANGES_MIN: usize = 10;

pub(crate) fn check(gate: &mut Gate) {
    for channel in 0..gate.channels() {
        let told = gate.told(channel);
        let stuck: Vec<&[usize]> = runs(gate, channel, &told);
        let rows: Vec<usize> = stuck.concat();
        if rows.is_empty() {
            continue;
        }
        let detail = format!(
            "{} repeats one value to the last digit in {} of {} that stand together, while other channels move; these have no \
             weight; look for a loose contact or a frozen converter",
            gate.name(channel),
            counted(rows.len(), "row"),
            if stuck.len() == 1 { "a stretch".to_owned() } else { format!("{} stretches", stuck.len()) }
        );
        gate.mask(channel, &rows);
        gate.notice("stuck", Some(channel), detail);
    }
}

/// Channels that are sampled less often than the table has rows.
pub(crate) fn held(gate: &mut Gate) {
    (0..gate.channels()).for_each(|channel| keep_first(gate, channel));
}

/// Keeps the first of the rows over which a channel is held.
fn keep_first(gate: &mut Gate, channel: usize) {
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
        counted(repeats.len(), "row")
    );
    gate.mask(channel, &repeats);
    gate.notice("rates", Some(channel), detail);
}

/// The stretches in which a channel is stuck.
fn runs<'r>(gate: &Gate, channel: usize, told: &'r [usize]) -> Vec<&'r [usize]> {
    let readings = &gate.observations.readings[channel];
    let runs: Vec<&[usize]> = told.chunk_by(|one, other| readings[*one] == readings[*other]).collect();
    let [least, most] = [f64::min, f64::max].map(|of| told.iter().map(|row| readings[*row]).reduce(of));
    // At the ends of its range a channel may be clipped.
    let is_inside = |run: &[usize]| {
        run.first().map(|row| readings[*row]).is_some_and(|y| Some(y) != least && Some(y) != most)
    };
    let count = told.len() as f64;
    let longest_first = {
        let mut lengths: Vec<usize> = runs.iter().map(|run| run.len() - 1).collect();
        lengths.sort_unstable_by(|one, other| other.cmp(one));
        lengths
    };
    let repeats = longest_first.iter().sum::<usize>() as f64;
    if repeats > HELD * count {
        return Vec::new();
    }
    // Stuck stretches themselves are no part of what chance does: the largest one is left out.
    let rest = repeats - longest_first.first().copied().unwrap_or(0) as f64;
    let share = ((rest + 1.0) / (count + 1.0)).min(1.0);
    let is_chance = |run: &[usize]| count * share.powi(run.len() as i32 - 1) * gate.channels() as f64 > LEVEL;
    runs.into_iter()
        .filter(|run| run.len() > 2 && is_inside(run) && !is_chance(run) && others_move(gate, channel, run))
        .collect()
}

/// Whether half of the other channels move in these rows.
fn others_move(gate: &Gate, channel: usize, rows: &[usize]) -> bool {
    let moves = |other: usize| {
        let all = gate.readings(other, &gate.told(other));
        let [within, whole] =
            [squares(&gate.readings(other, rows)) / rows.len() as f64, squares(&all) / all.len() as f64];
        f64::from(u8::from(within > MOVES * whole))
    };
    median((0..gate.channels()).filter(|other| *other != channel).map(moves)).is_some_and(|it| it > 0.5)
}
