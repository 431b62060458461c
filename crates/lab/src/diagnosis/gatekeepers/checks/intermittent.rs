//! A channel whose gain jumps between two values and back: a loose connector, a wire that is nearly broken.
//!
//! Beside what goes smoothly with place, load, time, temperature and the way to the load, it reads
//!
//! ```text
//! yᵢ = smoothᵢ + d bᵢ fᵢ + noise,    bᵢ = 0 or 1, with few changes from row to row
//! ```
//!
//! where f is what it should read. The states b of the least squares, with a price for each change, are Viterbi's; they, d and the
//! smooth part are fitted in turns. Two states are believed if they take away half of the squares, and more than so many changes take
//! away by chance: by Schwarz's criterion, where a change, which may be at any of n rows, costs 3 ln n.
//!
//! And not if rows near one another in place have one state.
//!
//! Source: A. J. Viterbi, IEEE Trans. Inf. Theory 13 (1967) 260; G. Schwarz, Ann. Statist. 6 (1978) 461.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::gatekeepers::gate::{Gate, LEVEL};
use crate::diagnosis::gatekeepers::prediction::Fitted;
use crate::diagnosis::report::Estimate;
use crate::effect::Effect;
use tactpad_core::counted::counted;
use tactpad_inference::observations::Sample;
use tactpad_inference::policy::WITHIN_95;
use tactpad_numeric::statistics::{rms, squares};

/// Rows for each number of the smooth part, at least.
const ROWS_PER_COLUMN: usize = 8;
/// Fewer rows in a state are outliers.
const STATE_ROWS_MIN: usize = 5;
/// It goes and comes back.
const CHANGES_MIN: usize = 2;
/// A smaller jump, as a share of the gain, is no wire's.
const JUMP_MIN: f64 = 0.03;
/// Two states leave this part of the squares over, or less.
const LEFT_MAX: f64 = 0.5;
/// A search that begins with more left over is none.
const BEGINNING_MAX: f64 = 0.8;
/// Jumps and shares of rows from which it begins.
const JUMPS: [f64; 10] = [-0.9, -0.5, -0.25, -0.12, -0.06, 0.06, 0.12, 0.25, 0.5, 0.9];
const SHARES: [f64; 3] = [0.15, 0.4, 0.7];
const ROUNDS: usize = 12;
/// What leaves less than so many times the squares over explains as much.
const AS_MUCH: f64 = 1.2;
/// Of a row so many neighbours in place are asked for their states, and of so many rows at most.
const NEIGHBOURS: usize = 6;
const ASKED_MAX: usize = 500;
/// A row shows the state if the channel should read this part of its root mean square.
const SHOWING: f64 = 0.5;
/// Where they differ from the row's own less than this part as often as those of any two rows, the place says the state.
const APART_MIN: f64 = 0.72;
/// A change counts as so many numbers: it may be at any row.
const CHANGE_NUMBERS: f64 = 3.0;
/// Two channels whose states agree in more rows have one cause, which is none of a channel's wires.
const AGREE: f64 = 0.8;

/// A channel in two states.
struct TwoStates {
    rows: Vec<usize>,
    /// Of each of these, whether it is of the loose state.
    is_loose: Vec<bool>,
    /// Gain of the loose state over that of the other, and its standard deviation.
    ratio: [f64; 2],
    p_value: f64,
}

pub(crate) fn check(gate: &mut Gate) {
    let found: Vec<(usize, TwoStates)> =
        (0..gate.channels()).filter_map(|channel| Some((channel, two_states(gate, channel)?))).collect();
    for (channel, it) in &found {
        if found.iter().any(|(other, others)| other != channel && agrees(it, others)) {
            continue;
        }
        let of =
            |loose: bool| it.rows.iter().zip(&it.is_loose).filter(move |(_, is_loose)| **is_loose == loose);
        let loose: Vec<usize> = of(true).map(|(row, _)| *row).collect();
        let [ratio, deviation] = it.ratio;
        let detail = format!(
            "{} reads {ratio:.3} times as much in {}, and goes there and back; these have no weight; move its wires and its \
             connector while the pad is under a weight",
            gate.name(*channel),
            counted(loose.len(), "row")
        );
        let share = loose.len() as f64 / it.rows.len() as f64;
        let taken = gate.mended(|gate| gate.mask(*channel, &loose));
        gate.notice("intermittent", Some(*channel), detail);
        let within = WITHIN_95 * deviation;
        gate.find(Effect::ChannelIntermittent, Target::Channel(*channel), it.p_value, taken).parameters = vec![
            Estimate { name: "gain", value: ratio, interval95: [ratio - within, ratio + within] },
            Estimate { name: "share_of_rows", value: share, interval95: [share; 2] },
        ];
    }
}

fn agrees(one: &TwoStates, other: &TwoStates) -> bool {
    let loose = |it: &TwoStates| -> std::collections::BTreeSet<usize> {
        it.rows.iter().zip(&it.is_loose).filter(|(_, is_loose)| **is_loose).map(|(row, _)| *row).collect()
    };
    let (one, other) = (loose(one), loose(other));
    let both = one.intersection(&other).count() as f64;
    both > AGREE * one.len().max(other.len()) as f64
}

/// The two states of a channel; none where one gain explains it, or nothing can be said.
fn two_states(gate: &Gate, channel: usize) -> Option<TwoStates> {
    let rows = gate.told(channel);
    let own = gate.expected(channel, &rows)?;
    let channel = Channel { readings: gate.readings(channel, &rows), smooth: smooth(gate, &rows, &own), own };
    if rows.len() < ROWS_PER_COLUMN * channel.smooth.len() {
        return None;
    }
    let (one_state, _) = channel.left(&channel.smooth)?;
    let (count, whole) = (rows.len() as f64, squares(&one_state));
    let fit = channel.settled(channel.beginning(&one_state)?)?;
    let changes = fit.changes();
    let seconds = fit.is_second.iter().filter(|it| **it).count();
    let gain = channel.gain(&fit)?;
    // The loose state is the one that is farther from what the channel should read.
    let is_second_loose = (gain + fit.jump - 1.0).abs() > (gain - 1.0).abs();
    let is_loose: Vec<bool> = fit.is_second.iter().map(|it| *it == is_second_loose).collect();
    let sound_gain = if is_second_loose { gain } else { gain + fit.jump };
    let ratio = (2.0 * gain + fit.jump - sound_gain) / sound_gain;
    // Schwarz's criterion of one more number and its changes.
    let numbers = 1.0 + CHANGE_NUMBERS * changes as f64;
    let p_value = (-0.5 * (count * (whole / fit.square).ln() - numbers * count.ln())).exp();
    let is_believed = changes >= CHANGES_MIN
        && seconds.min(rows.len() - seconds) >= STATE_ROWS_MIN
        && fit.square < LEFT_MAX * whole
        && (ratio - 1.0).abs() > JUMP_MIN
        && p_value * (gate.channels() as f64) < LEVEL
        && !channel.changes_once(&fit)
        && !is_of_the_place(gate, &rows, &is_loose, &channel.own);
    let loose: Vec<f64> =
        channel.own.iter().zip(&is_loose).map(|(f, it)| if *it { *f } else { 0.0 }).collect();
    let variance = fit.square / (count - channel.smooth.len() as f64 - 2.0);
    let deviation = (variance / squares(&loose)).sqrt() / sound_gain.abs();
    let p_value = p_value.max(f64::MIN_POSITIVE);
    is_believed.then_some(TwoStates { rows, is_loose, ratio: [ratio, deviation], p_value })
}

/// Whether rows that are near in place have one state, however far they are apart in time: a plan goes from place to place, and what a
/// model lacks of a place looks like a change of the gain there.
fn is_of_the_place(gate: &Gate, rows: &[usize], is_loose: &[bool], own: &[f64]) -> bool {
    // A channel that should read next to nothing does not show its gain.
    let least = SHOWING * rms(own.iter().copied());
    let shows: Vec<usize> = (0..rows.len()).filter(|at| own[*at].abs() >= least).collect();
    let place_mm = |at: usize| gate.observations.samples[rows[at]].place_mm;
    let (mut apart, mut asked) = (0.0, 0.0);
    for at in shows.iter().copied().step_by(shows.len().div_ceil(ASKED_MAX).max(1)) {
        let [x, y] = place_mm(at);
        let mut others: Vec<(f64, std::cmp::Reverse<usize>, usize)> = shows
            .iter()
            .filter(|other| **other != at)
            .map(|&other| {
                let [other_x, other_y] = place_mm(other);
                // To a micrometre, so that one place is one place.
                let mm = (1e3 * libm::hypot(other_x - x, other_y - y)).round();
                (mm, std::cmp::Reverse(other.abs_diff(at)), other)
            })
            .collect();
        let count = NEIGHBOURS.min(others.len());
        if count == 0 {
            continue;
        }
        others.select_nth_unstable_by(count - 1, |one, other| {
            one.0.total_cmp(&other.0).then_with(|| one.1.cmp(&other.1))
        });
        apart += others[..count].iter().filter(|it| is_loose[it.2] != is_loose[at]).count() as f64;
        asked += count as f64;
    }
    let loose = shows.iter().filter(|at| is_loose[**at]).count() as f64 / shows.len().max(1) as f64;
    apart < APART_MIN * 2.0 * loose * (1.0 - loose) * asked
}

/// A channel in the rows in which it tells something.
struct Channel {
    readings: Vec<f64>,
    /// f.
    own: Vec<f64>,
    smooth: Vec<Vec<f64>>,
}

/// The least squares of two states.
struct Fit {
    is_second: Vec<bool>,
    /// d.
    jump: f64,
    /// What it leaves over.
    square: f64,
}

impl Fit {
    fn changes(&self) -> usize {
        self.is_second.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }
}

impl Channel {
    /// What these columns leave over.
    fn left(&self, columns: &[Vec<f64>]) -> Option<(Vec<f64>, Fitted)> {
        let fitted = Fitted::of(&self.readings, columns)?;
        let left = self.readings.iter().enumerate().map(|(row, y)| y - fitted.predicted(columns, row));
        Some((left.collect(), fitted))
    }

    /// The best states of some jumps, beside what one state leaves over; none where none helps.
    fn beginning(&self, one_state: &[f64]) -> Option<Vec<bool>> {
        let (count, whole) = (one_state.len() as f64, squares(one_state));
        let starts = JUMPS.iter().flat_map(|jump| SHARES.map(|share| [*jump, share])).map(|[jump, share]| {
            // The smooth part has the states' mean.
            let levels = [-jump * share, jump * (1.0 - share)];
            states(one_state, &self.own, levels, price(0.25 * whole / count, count))
        });
        let (is_second, cost) = starts.min_by(|one, other| one.1.total_cmp(&other.1))?;
        (cost <= BEGINNING_MAX * whole).then_some(is_second)
    }

    /// States, jump and smooth part in turns, until the states stay.
    fn settled(&self, mut is_second: Vec<bool>) -> Option<Fit> {
        let count = is_second.len() as f64;
        let mut rounds = 0;
        loop {
            let jumped: Vec<f64> =
                is_second.iter().zip(&self.own).map(|(it, f)| if *it { *f } else { 0.0 }).collect();
            let columns: Vec<Vec<f64>> = self.smooth.iter().cloned().chain([jumped.clone()]).collect();
            let (residual, fitted) = self.left(&columns)?;
            let (jump, square) = (fitted.factor(self.smooth.len()), squares(&residual));
            let of_first: Vec<f64> = residual.iter().zip(&jumped).map(|(left, f)| left + jump * f).collect();
            let next = states(&of_first, &self.own, [0.0, jump], price(square / count, count)).0;
            rounds += 1;
            if next == is_second || rounds == ROUNDS {
                return Some(Fit { is_second, jump, square });
            }
            is_second = next;
        }
    }

    /// Whether one change explains as much: what smooth parts make of it may look like several.
    fn changes_once(&self, fit: &Fit) -> bool {
        let rows = self.own.len();
        let once = |tenth: usize| {
            let later = self.settled((0..rows).map(|row| 10 * row >= tenth * rows).collect());
            later.is_some_and(|it| it.changes() < CHANGES_MIN && it.square < AS_MUCH * fit.square)
        };
        (1..10).any(once)
    }

    /// The gain of the first state.
    fn gain(&self, fit: &Fit) -> Option<f64> {
        let jumps = self.own.iter().zip(&fit.is_second).map(|(f, it)| if *it { fit.jump * f } else { 0.0 });
        let of_first: Vec<f64> = self.readings.iter().zip(jumps).map(|(y, jumped)| y - jumped).collect();
        Some(Fitted::of(&of_first, std::slice::from_ref(&self.own))?.factor(0))
    }
}

/// What a change of the state costs beside squares of this variance.
fn price(variance: f64, rows: f64) -> f64 {
    CHANGE_NUMBERS * variance * rows.ln()
}

/// The states of the least cost Σ (r − level f)² + price · changes, and that cost.
fn states(residual: &[f64], own: &[f64], levels: [f64; 2], price: f64) -> (Vec<bool>, f64) {
    let mut costs = [0.0; 2];
    // Of each row and state, whether the row before was in the second.
    let mut came_from: Vec<[bool; 2]> = Vec::with_capacity(residual.len());
    for (left, f) in residual.iter().zip(own) {
        let by_change = [costs[1] + price < costs[0], costs[1] <= costs[0] + price];
        let before = [costs[0].min(costs[1] + price), costs[1].min(costs[0] + price)];
        costs = std::array::from_fn(|state| before[state] + (left - levels[state] * f).powi(2));
        came_from.push(by_change);
    }
    let mut is_second = costs[1] < costs[0];
    let mut states = vec![false; residual.len()];
    for (state, from) in states.iter_mut().zip(&came_from).rev() {
        *state = is_second;
        is_second = from[usize::from(is_second)];
    }
    (states, costs[0].min(costs[1]))
}

/// What goes smoothly: loads by the place in second order, and the channel's own reading by time, temperature, cycles, and how the
/// load was come to.
fn smooth(gate: &Gate, rows: &[usize], own: &[f64]) -> Vec<Vec<f64>> {
    let samples: Vec<&Sample> = rows.iter().map(|row| &gate.observations.samples[*row]).collect();
    let size =
        samples.iter().flat_map(|it| it.place_mm).fold(f64::MIN_POSITIVE, |most, mm| most.max(mm.abs()));
    let mut columns = Vec::new();
    for axis in 0..3 {
        let terms: [fn(f64, f64) -> f64; 6] =
            [|_, _| 1.0, |x, _| x, |_, y| y, |x, _| x * x, |x, y| x * y, |_, y| y * y];
        columns.extend(terms.map(|term| {
            let [x, y] = [0, 1];
            samples
                .iter()
                .map(|it| it.load[axis] * term(it.place_mm[x] / size, it.place_mm[y] / size))
                .collect()
        }));
    }
    let courses: [fn(&Sample) -> Option<f64>; 5] = [
        |it| it.t_s,
        |it| it.temp_c,
        |it| it.cycle,
        |it| it.dwell_s,
        |it| Some(f64::from(u8::from(it.is_unloading))),
    ];
    columns.push(own.to_vec());
    columns.push(own.iter().map(|f| f * f).collect());
    for course in courses {
        let values: Option<Vec<f64>> = samples.iter().map(|it| course(it)).collect();
        // What stays the same tells nothing beside the others.
        let Some(values) = values.filter(|values| squares(values) > 0.0) else { continue };
        let largest = values.iter().fold(f64::MIN_POSITIVE, |most, value| most.max(value.abs()));
        let along: Vec<f64> = values.iter().map(|value| value / largest).collect();
        columns.push(along.iter().zip(own).map(|(x, f)| x * f).collect());
        columns.push(along.iter().zip(own).map(|(x, f)| x * x * f).collect());
        columns.push(along);
    }
    columns
}
