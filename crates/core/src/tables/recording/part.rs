//! One table of a recording, and how its rows follow each other: what hysteresis and creep make of a channel.
//!
//! Channels do not know of each other. One at a time takes a ninth of the memory, and tables may have a million rows.

use std::ops::Range;

use crate::pipeline::compensation::hysteresis::{Hysteresis, PLAYS};
use crate::quantity::CHANNELS;
use crate::tables::measured::zero::Zeros;
use crate::tables::measured::{Approach, DWELL_S, READ_S, Row};
use tactpad_numeric::memory::Relaxation;

/// A reading of the untouched pad: its row, and the channels.
pub type UntouchedReading = (usize, [f64; CHANNELS]);

/// A table of the recording.
#[derive(Clone, Debug)]
pub(super) struct RecordingPart {
    /// Its first row in the recording.
    pub(super) first: usize,
    pub(super) rows: usize,
    /// None in a table that never reads the untouched pad: there, channels are raw, or less a zero that is known otherwise.
    pub(super) zeros: Option<Zeros>,
    /// What the untouched pad reads in the rows of the zeros.
    pub(super) readings: Vec<UntouchedReading>,
    /// Places of what a decoder is fitted to, from the part's first row on.
    pub(super) contacts: Vec<usize>,
}

/// What play operators follow: a channel of these rows.
pub(super) struct Follow<'r> {
    /// Of the whole recording.
    pub(super) rows: &'r [Row],
    /// The pad's largest force.
    pub(super) full_scale_n: f64,
    pub(super) hysteresis: &'r Hysteresis,
    pub(super) channel: usize,
}

/// How long a row's load is held before the middle of its reading and after, and how long the pad rests before; `None` where that
/// is unknown and counts as long.
struct HoldTimes {
    rest_s: Option<f64>,
    before_s: f64,
    after_s: f64,
}

impl HoldTimes {
    fn of(row: &Row, previous: Option<&Row>) -> Self {
        // rest = (t − t_previous) − dwell − reading.
        let passed_s = previous.and_then(|previous| Some(row.t_s? - previous.t_s?)).filter(|s| *s >= 0.0);
        if row.trial.is_some() && previous.is_some_and(|previous| previous.trial == row.trial) {
            return Self { rest_s: Some(0.0), before_s: passed_s.unwrap_or(0.0), after_s: 0.0 };
        }
        let read_s = if row.trial.is_none() { READ_S } else { 0.0 };
        // Times in which the dwell has no room are no times of this kind: some count rows.
        let rest_s = passed_s.zip(row.dwell_s).map(|(passed_s, dwell_s)| passed_s - dwell_s - read_s);
        Self {
            rest_s: rest_s.filter(|rest_s| *rest_s >= 0.0),
            before_s: row.dwell_s.unwrap_or(DWELL_S) + read_s / 2.0,
            after_s: read_s / 2.0,
        }
    }
}

impl RecordingPart {
    /// Its rows in the recording, each with whether it is a reading of the untouched pad.
    fn places(&self) -> impl Iterator<Item = (usize, bool)> {
        let zeros = self.zeros.as_ref().map_or(&[][..], Zeros::rows);
        let mut zeros = zeros.iter().peekable();
        (0..self.rows).map(move |at| (self.first + at, zeros.next_if_eq(&&at).is_some()))
    }

    fn range(&self) -> Range<usize> {
        self.first..self.first + self.rows
    }

    /// Tells how far a channel has crept in each row, in order, by the strains there.
    pub(super) fn crept(
        &self,
        rows: &[Row],
        creep: &Relaxation,
        strain_uv: impl Fn(usize, bool) -> f64,
        mut tell: impl FnMut([f64; 1]),
    ) {
        let mut crept_uv = 0.0;
        let mut previous: Option<&Row> = None;
        for (at, is_zero) in self.places() {
            let row = &rows[at];
            let HoldTimes { rest_s, before_s, after_s } = HoldTimes::of(row, previous.replace(row));
            let rested_uv = rest_s.map_or(0.0, |rest_s| creep.held(crept_uv, 0.0, rest_s));
            let strain_uv = strain_uv(at, is_zero);
            let read_uv = creep.held(rested_uv, strain_uv, before_s);
            tell([read_uv]);
            crept_uv = creep.held(read_uv, strain_uv, after_s);
        }
    }

    /// Makes a channel's states in the recording's rows relative to those of the untouched pad, which without its reading is one at
    /// rest.
    pub(super) fn relative<const N: usize>(&self, channel: usize, states: &mut [[f64; N]]) {
        let (Some(zeros), states) = (&self.zeros, &mut states[self.range()]) else { return };
        let of_zeros: Vec<[f64; N]> = zeros.rows().iter().map(|at| states[*at]).collect();
        for (state, zero) in states.iter_mut().zip(zeros.of_channel(channel, &of_zeros)) {
            state.iter_mut().zip(zero).for_each(|(state, zero)| *state -= zero);
        }
    }

    /// Puts the play operators' states less the strains, which follow from what stood there before, in the place of that.
    pub(super) fn follow(
        &self,
        follow: &Follow,
        states: &mut [[f64; PLAYS]],
        free_uv: impl Fn(usize, bool, &[f64; PLAYS]) -> f64,
    ) {
        let Follow { rows, full_scale_n, hysteresis, channel } = *follow;
        let mut plays_uv = [0.0; PLAYS];
        let mut go = |uv: f64| {
            let plays = plays_uv.iter_mut().zip(hysteresis);
            plays.for_each(|(state_uv, plays)| *state_uv = plays[channel].pulled(*state_uv, uv));
            plays_uv
        };
        let mut previous: Option<usize> = None;
        for (at, is_zero) in self.places() {
            let row = &rows[at];
            let free_uv = free_uv(at, is_zero, &states[at]);
            if row.trial.is_none() || row.trial != previous {
                go(0.0);
            }
            if row.trial.is_none() && row.approach == Some(Approach::Unloading) {
                go(row.label.overload(full_scale_n) * free_uv);
            }
            states[at] = go(free_uv).map(|state_uv| state_uv - free_uv);
            previous = row.trial;
        }
    }
}
