//! Times that stand still or go back within a series.
//!
//! A row that comes late is sorted to its place; where the clock was set back, what follows is a series of its own; of rows with
//! one time the first has weight. A clock that hardly ever moves tells no order, and is only reported.

use crate::diagnosis::gatekeepers::gate::Gate;
use tactpad_core::counted::counted;
use tactpad_numeric::statistics::{Line, deviation};

/// So many rows that are earlier than one before them came late; of more, the clock was set back.
const LATE_MAX: usize = 8;
/// If more than this part of a series repeats its times, the clock is coarse, not the row doubled.
const DOUBLED_MAX: f64 = 0.1;
/// The offset between the labels' clock and the channels' shows if it is this part of the time between two rows.
const APART: f64 = 0.5;

pub(crate) fn check(gate: &mut Gate) {
    let mut order: Vec<usize> = (0..gate.observations.rows()).collect();
    let mut next_trial =
        gate.observations.samples.iter().filter_map(|it| it.trial).max().map_or(0, |last| last + 1);
    let (mut late, mut resets) = (0, 0);
    for series in gate.series() {
        let parts = parts(gate, &series);
        resets += parts.len() - 1;
        let mut sorted = Vec::new();
        for (at, part) in parts.into_iter().enumerate() {
            late += part.windows(2).filter(|pair| gate.t_s(pair[1]) < gate.t_s(pair[0])).count();
            let mut part = part.to_vec();
            part.sort_by(|one, other| gate.t_s(*one).total_cmp(&gate.t_s(*other)));
            if at > 0 {
                part.iter().for_each(|row| gate.observations.samples[*row].trial = Some(next_trial));
                next_trial += 1;
            }
            sorted.extend(part);
        }
        series.iter().zip(sorted).for_each(|(place, row)| order[*place] = row);
    }
    if late > 0 {
        let detail = format!(
            "{} of time series come after a later one; the series are sorted by t_s; see whether the recorder buffers",
            counted(late, "row")
        );
        gate.notice("time", None, detail);
    }
    if resets > 0 {
        let detail = format!(
            "t_s goes back for good at {} of time series; what follows counts as a series of its own; give it a trial of its own",
            counted(resets, "row")
        );
        gate.notice("time", None, detail);
    }
    gate.put_in_order(&order);
    doubled(gate);
}

/// A series in parts, at the rows at which the clock was set back.
fn parts<'s>(gate: &Gate, series: &'s [usize]) -> Vec<&'s [usize]> {
    let mut parts = Vec::new();
    let (mut begin, mut latest, mut behind) = (0, f64::NEG_INFINITY, 0);
    for (at, row) in series.iter().enumerate() {
        let t_s = gate.t_s(*row);
        behind = if t_s < latest { behind + 1 } else { 0 };
        if behind > LATE_MAX {
            let first = at + 1 - behind;
            parts.push(&series[begin..first]);
            (begin, behind) = (first, 0);
            latest = series[first..=at].iter().map(|row| gate.t_s(*row)).fold(f64::NEG_INFINITY, f64::max);
        }
        latest = latest.max(t_s);
    }
    parts.push(&series[begin..]);
    parts
}

/// Rows that have the time of the row before.
fn doubled(gate: &mut Gate) {
    let (mut doubled, mut coarse) = (Vec::new(), 0);
    for series in gate.series() {
        let same: Vec<usize> = series
            .windows(2)
            .filter(|pair| gate.t_s(pair[0]) == gate.t_s(pair[1]))
            .map(|pair| pair[1])
            .collect();
        if same.len() as f64 > DOUBLED_MAX * series.len() as f64 {
            coarse += same.len();
        } else {
            doubled.extend(same);
        }
    }
    if !doubled.is_empty() {
        (0..gate.channels()).for_each(|channel| gate.mask(channel, &doubled));
        let detail = format!(
            "{} have the time of the row before; the first of each keeps its weight, the others have none; see whether the \
             recorder writes samples twice",
            counted(doubled.len(), "row")
        );
        gate.notice("time", None, detail);
    }
    if coarse > 0 {
        let detail = format!(
            "{} of time series have the time of the row before: t_s is written too coarsely; nothing is changed, but what goes \
             with time is seen less well; write more digits",
            counted(coarse, "row")
        );
        gate.notice("time", None, detail);
    }
}

/// Holds `label_t_s` against `t_s`.
pub(crate) fn apart(gate: &mut Gate) {
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
