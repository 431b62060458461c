//! Codes that stand for a missing reading: not a number, one value over and over that does not belong there, or a single one that no
//! contact can make.
//!
//! A value that recurs to the last digit is a code if it lies further from all others than the others lie apart; or if the readings
//! jump to it and back again and again while no other channel does. Limits of a converter and its steps do neither: the readings
//! around them are next to them.

use crate::diagnosis::gatekeepers::gate::{Gate, LEVEL};
use tactpad_core::counted::counted;

/// Fewest rows of a code.
const ROWS_MIN: usize = 3;
/// Of so many of a channel's most frequent values any may be a code, and its extremes.
const CANDIDATES: usize = 8;
/// A code comes and goes so often at least.
const RUNS_MIN: usize = 3;
/// Of readings that jump, this is the ordinary part: no more than one in a hundred.
const ORDINARY: f64 = 0.99;
/// A jump is this much larger than an ordinary one.
const JUMP: f64 = 2.0;
/// Of a code's rows this share are jumps at least; a real event takes as many other channels along.
const JUMPS: f64 = 0.2;

/// A reading that no contact can make is so many widths of the ordinary ones away from them …
const WILD: f64 = 20.0;
/// … while no other channel is so many of its own.
const ALONG: f64 = 2.0;

pub(crate) fn check(gate: &mut Gate) {
    unwritten(gate);
    (0..gate.channels()).for_each(|channel| not_numbers(gate, channel));
    let ordinary: Vec<Option<[f64; 2]>> =
        (0..gate.channels()).map(|channel| ordinary(gate, channel)).collect();
    for channel in 0..gate.channels() {
        wild(gate, channel, &ordinary);
        while let Some((code, rows)) = code(gate, channel) {
            let detail = format!(
                "{} reads {code} in {}, which no reading around it is near: a code for a missing one; these have no weight; leave \
                 such cells empty, or name the code where the file is written",
                gate.name(channel),
                counted(rows.len(), "row")
            );
            gate.mask(channel, &rows);
            gate.notice("missing", Some(channel), detail);
        }
    }
}

/// Rows whose labels are not numbers say nothing.
fn unwritten(gate: &mut Gate) {
    let samples = &mut gate.observations.samples;
    let mut rows = Vec::new();
    for (row, sample) in samples.iter_mut().enumerate() {
        let numbers = sample.place_mm.iter_mut().chain(&mut sample.load);
        let lost: Vec<&mut f64> = numbers.filter(|number| !number.is_finite()).collect();
        if !lost.is_empty() {
            rows.push(row);
        }
        lost.into_iter().for_each(|number| *number = 0.0);
        sample.t_s = sample.t_s.filter(|t_s| t_s.is_finite());
    }
    if rows.is_empty() {
        return;
    }
    (0..gate.channels()).for_each(|channel| gate.mask(channel, &rows));
    let detail = format!(
        "{} have a place or a load that is no number; they have no weight; write both down for every row",
        counted(rows.len(), "row")
    );
    gate.notice("missing", None, detail);
}

fn not_numbers(gate: &mut Gate, channel: usize) {
    let readings = &mut gate.observations.readings[channel];
    let rows: Vec<usize> = (0..readings.len()).filter(|row| !readings[*row].is_finite()).collect();
    // Without weight, but a factor of zero times not a number would be none.
    rows.iter().for_each(|row| readings[*row] = 0.0);
    if rows.is_empty() {
        return;
    }
    gate.mask(channel, &rows);
    let detail = format!(
        "{} has no number in {}; these have no weight; see what the recorder writes there",
        gate.name(channel),
        counted(rows.len(), "row")
    );
    gate.notice("missing", Some(channel), detail);
}

/// The ends of a channel's ordinary readings; `None` where it has only one.
fn ordinary(gate: &Gate, channel: usize) -> Option<[f64; 2]> {
    let mut sorted = gate.readings(channel, &gate.told(channel));
    sorted.sort_by(f64::total_cmp);
    let left_out = ((1.0 - ORDINARY) * sorted.len() as f64).ceil() as usize;
    let [low, high] = [*sorted.get(left_out)?, *sorted.get(sorted.len().checked_sub(1 + left_out)?)?];
    (low < high).then_some([low, high])
}

/// By how many widths of the ordinary readings one lies beyond them.
fn beyond(reading: f64, [low, high]: [f64; 2]) -> f64 {
    (reading - high).max(low - reading).max(0.0) / (high - low)
}

/// Readings that are far from all ordinary ones by themselves.
fn wild(gate: &mut Gate, channel: usize, ordinary: &[Option<[f64; 2]>]) {
    let Some(own) = ordinary[channel] else { return };
    let goes_along = |row: usize| {
        ordinary.iter().enumerate().any(|(other, ends)| {
            let reading = gate.observations.readings[other][row];
            other != channel && ends.is_some_and(|ends| beyond(reading, ends) > ALONG)
        })
    };
    let readings = &gate.observations.readings[channel];
    let is_wild = |row: &usize| beyond(readings[*row], own) > WILD && !goes_along(*row);
    let rows: Vec<usize> = gate.told(channel).into_iter().filter(is_wild).collect();
    let Some(first) = rows.first() else { return };
    let detail = format!(
        "{} reads {} in {}, far beyond all its other readings, and no other channel moves; these have no weight; see what the recorder \
         writes there",
        gate.name(channel),
        readings[*first],
        counted(rows.len(), "row")
    );
    gate.mask(channel, &rows);
    gate.notice("missing", Some(channel), detail);
}

/// A channel's code and its rows.
fn code(gate: &Gate, channel: usize) -> Option<(f64, Vec<usize>)> {
    let told = gate.told(channel);
    let readings = &gate.observations.readings[channel];
    let mut sorted: Vec<f64> = gate.readings(channel, &told);
    sorted.sort_by(f64::total_cmp);
    let rows =
        |code: f64| -> Vec<usize> { told.iter().copied().filter(|row| readings[*row] == code).collect() };
    let is_code = |code: &f64| {
        is_apart(&sorted, *code)
            || (jumps(readings, &told, *code) && others_rest(gate, channel, &told, &rows(*code)))
    };
    candidates(&sorted)
        .into_iter()
        .filter(is_code)
        .map(|code| (code, rows(code)))
        .find(|(_, rows)| rows.len() < told.len())
}

/// Values that recur: the most frequent ones and the extremes.
fn candidates(sorted: &[f64]) -> Vec<f64> {
    let repeated = sorted.chunk_by(|one, other| one == other).filter(|it| it.len() >= ROWS_MIN);
    let mut counted: Vec<(usize, f64)> = repeated.map(|it| (it.len(), it[0])).collect();
    let ends: Vec<(usize, f64)> = counted.first().into_iter().chain(counted.last()).copied().collect();
    counted.sort_by_key(|(count, _)| usize::MAX - count);
    counted.truncate(CANDIDATES);
    ends.into_iter().chain(counted).map(|(_, value)| value).collect()
}

/// Whether a value lies further from all others than they lie apart.
fn is_apart(sorted: &[f64], code: f64) -> bool {
    let others: Vec<f64> = sorted.iter().copied().filter(|value| *value != code).collect();
    let [Some(least), Some(most)] = [others.first(), others.last()] else { return false };
    others.len() >= ROWS_MIN && most > least && (least - code).max(code - most) > most - least
}

/// Whether more of the rows with this value are jumps than chance makes of ordinary ones: k of m with the probability q each have
/// at most the probability exp(−m (x ln(x/q) + (1 − x) ln((1 − x)/(1 − q)))), x = k/m (Chernoff's bound).
fn jumps(readings: &[f64], rows: &[usize], code: f64) -> bool {
    let runs = rows.chunk_by(|one, other| readings[*one] == readings[*other]);
    if runs.filter(|run| run.first().is_some_and(|row| readings[*row] == code)).count() < RUNS_MIN {
        return false;
    }
    let (own, others): (Vec<usize>, Vec<usize>) = rows.iter().partition(|row| readings[**row] == code);
    let own = distances(readings, &others, &own);
    let share = share_above(&own, &distances(readings, &others, &others));
    let part = |share: f64, chance: f64| if share > 0.0 { share * (share / chance).ln() } else { 0.0 };
    let exponent = part(share, 1.0 - ORDINARY) + part(1.0 - share, ORDINARY);
    share > JUMPS && (-(own.len() as f64) * exponent).exp() < LEVEL / CANDIDATES as f64
}

/// The share of distances that are larger than ordinary ones.
fn share_above(own: &[f64], others: &[f64]) -> f64 {
    let mut ordinary = others.to_vec();
    ordinary.sort_by(f64::total_cmp);
    let Some(limit) = ordinary.get((ORDINARY * ordinary.len() as f64) as usize) else { return 0.0 };
    own.iter().filter(|distance| **distance > JUMP * limit).count() as f64 / own.len().max(1) as f64
}

/// Whether the other channels make no jump in these rows: where they do, something happened.
fn others_rest(gate: &Gate, channel: usize, told: &[usize], rows: &[usize]) -> bool {
    let mut others = (0..gate.channels()).filter(|other| *other != channel).peekable();
    let jump = |other: usize| {
        let readings = &gate.observations.readings[other];
        let quiet: Vec<usize> = told.iter().copied().filter(|row| rows.binary_search(row).is_err()).collect();
        share_above(&distances(readings, &quiet, rows), &distances(readings, &quiet, &quiet)) > JUMPS
    };
    others.peek().is_some() && !others.any(jump)
}

/// How far each of these rows is from the line between the nearest of the `ordinary` ones before and after it.
fn distances(readings: &[f64], ordinary: &[usize], rows: &[usize]) -> Vec<f64> {
    let distance = |row: &usize| {
        let before = ordinary.partition_point(|other| other < row).checked_sub(1)?;
        let after = ordinary.partition_point(|other| other <= row);
        let [low, high] = [*ordinary.get(before)?, *ordinary.get(after)?];
        let part = (*row - low) as f64 / (high - low) as f64;
        Some((readings[*row] - readings[low] - part * (readings[high] - readings[low])).abs())
    };
    rows.iter().filter_map(distance).collect()
}
