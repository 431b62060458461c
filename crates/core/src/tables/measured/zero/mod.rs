//! Tables relative to the untouched pad.
//!
//! Channels are written raw. A pad's offset is larger than many a signal, and follows the temperature; so a table has
//! rows in which nothing touches the pad, again and again. Between two of them the zero is taken to change evenly.
//!
//! # The rule
//!
//! *Untouched* is a static sample of the session [`ZERO`], or one whose forces are written as 0. A reference is noisy, so
//! small forces may be none, too:
//!
//! - Figures of merit look at loads of 0.5 N and more. For them forces up to [`UNLOADED_N`] are none
//!   ([`UntouchedRows::unloaded`]).
//! - A decoder is fitted to light contacts, too. For it such forces are none only if the table's loads stand apart from
//!   them, the least one being three times as large or more ([`UntouchedRows::of`]).
//!
//! The *zero of a row* lies between those of the two untouched rows around it, by their times where all rows have times, else by
//! their places in the table; before the first and after the last it stays.
//!
//! - A decoder knows how the zero follows the temperature, or takes it to be constant: all untouched rows count, and where their
//!   readings are noisier than the zero drifts, the zero of each is smoothed over its neighbours ([`Drift`]).
//! - Figures of merit do not know: untouched rows of the row's own temperature count, those of its own session first
//!   ([`alike::ZerosByTemperature`]).

pub mod alike;
pub mod drift;

use self::drift::Drift;
use super::{Row, Table};
use crate::quantity::CHANNELS;

/// The session of rows in which nothing touches the pad.
pub const ZERO: &str = "zero";

/// Forces up to this may be none: a reference for 100 N does not know its own zero better.
pub const UNLOADED_N: f64 = 0.1;

/// The least load over the largest force of the untouched rows.
const APART: f64 = 3.0;

/// Which rows of a table are untouched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UntouchedRows {
    /// The table's session [`ZERO`].
    session: Option<usize>,
    /// The largest force that is none.
    force_max_n: f64,
}

/// The rows of a table in which nothing touches the pad, and where every row lies between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Zeros {
    /// The table's untouched static rows with channels, in order; at least one.
    rows: Vec<usize>,
    /// Each row's time, or its place in the table.
    places: Vec<f64>,
    /// How each channel's zero goes from one untouched row to the next.
    drifts: [Drift; CHANNELS],
}

/// Places of the rows in which something presses: what a decoder is fitted to.
///
/// Static samples if the table has any, else the rows of its time series: a series has many rows of one contact. Rows
/// without channels are none.
pub fn contacts(table: &Table) -> Vec<usize> {
    let untouched = UntouchedRows::of(table);
    let pressed = || {
        let rows = table.rows.iter().enumerate();
        rows.filter(|(_, row)| row.uv.is_some() && !untouched.is(row))
    };
    let samples: Vec<usize> = pressed().filter(|(_, row)| row.trial.is_none()).map(|(at, _)| at).collect();
    if samples.is_empty() { pressed().map(|(at, _)| at).collect() } else { samples }
}

impl UntouchedRows {
    /// What figures of merit take as untouched.
    pub fn unloaded(table: &Table) -> Self {
        let session = table.sessions.iter().position(|name| name == ZERO);
        Self { session, force_max_n: UNLOADED_N }
    }

    /// What a decoder takes as untouched.
    pub fn of(table: &Table) -> Self {
        let unloaded = Self::unloaded(table);
        let by_name = Self { force_max_n: 0.0, ..unloaded };
        let samples = table.rows.iter().filter(|row| row.trial.is_none() && !by_name.is(row));
        let (mut light_n, mut load_n) = (0.0_f64, f64::INFINITY);
        for force_n in samples.map(|row| row.label.resultant_n()) {
            if force_n <= UNLOADED_N { light_n = light_n.max(force_n) } else { load_n = load_n.min(force_n) }
        }
        if load_n >= APART * light_n { unloaded } else { by_name }
    }

    /// Whether nothing touches the pad in this row.
    pub fn is(&self, row: &Row) -> bool {
        let is_named = row.session.is_some() && row.session == self.session;
        is_named || row.label.resultant_n() <= self.force_max_n
    }
}

impl Zeros {
    /// Finds those that a decoder takes; `None` if the table never reads the untouched pad.
    pub fn of(table: &Table) -> Option<Self> {
        Self::by(table, &UntouchedRows::of(table))
    }

    /// Finds those that are `untouched`; `None` if there is none.
    pub fn by(table: &Table, untouched: &UntouchedRows) -> Option<Self> {
        let is_zero = |row: &Row| row.trial.is_none() && row.uv.is_some() && untouched.is(row);
        let rows = (0..).zip(&table.rows).filter(|(_, row)| is_zero(row)).map(|(at, _)| at).collect();
        Self::at_rows(table, rows)
    }

    /// Those that are known to be untouched, in order; `None` if there is none.
    pub fn at_rows(table: &Table, rows: Vec<usize>) -> Option<Self> {
        let is_timed = table.rows.iter().all(|row| row.t_s.is_some());
        let places = (0_u32..).zip(&table.rows);
        let places = places.map(|(place, row)| row.t_s.filter(|_| is_timed).unwrap_or(f64::from(place)));
        let places: Vec<f64> = places.collect();
        let here: Vec<f64> = rows.iter().map(|at| places[*at]).collect();
        let drift = |channel: usize| {
            let reading = |at: &usize| table.rows[*at].uv.map_or(0.0, |uv| uv[channel]);
            Drift::of(&here, &rows.iter().map(reading).collect::<Vec<_>>())
        };
        let drifts = std::array::from_fn(drift);
        (!rows.is_empty()).then_some(Self { rows, places, drifts })
    }

    /// The untouched rows, in order.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// What is to be taken off each row of a channel, if its untouched rows read these values.
    pub fn of_channel<const N: usize>(&self, channel: usize, values: &[[f64; N]]) -> Vec<[f64; N]> {
        let smoothed = self.drifts[channel].smoothed(&self.here(), values);
        let value = |zero: usize| smoothed[self.rows.partition_point(|at| *at < zero)];
        let of_row = |row: usize| {
            let (before, after) = self.rows.split_at(self.rows.partition_point(|zero| *zero < row));
            self.between(row, before.last().copied(), after.first().copied(), value).unwrap_or([0.0; N])
        };
        (0..self.places.len()).map(of_row).collect()
    }

    /// Times or places of the untouched rows.
    fn here(&self) -> Vec<f64> {
        self.rows.iter().map(|at| self.places[*at]).collect()
    }

    /// Between the values of an untouched row before a row and one after it, as far as there are any.
    pub(super) fn between<const N: usize>(
        &self,
        row: usize,
        before: Option<usize>,
        after: Option<usize>,
        value: impl Fn(usize) -> [f64; N],
    ) -> Option<[f64; N]> {
        let (Some(before), Some(after)) = (before, after) else {
            return before.or(after).map(value);
        };
        let [here, first, second] = [row, before, after].map(|row| self.places[row]);
        // Clocks that start anew say nothing.
        let share = if second > first { ((here - first) / (second - first)).clamp(0.0, 1.0) } else { 0.5 };
        let (first, second) = (value(before), value(after));
        Some(std::array::from_fn(|k| first[k] + share * (second[k] - first[k])))
    }

    /// Takes the zero off the channels of each row of the table, and gives what the untouched rows read.
    pub fn tare(&self, table: &mut Table) -> Vec<(usize, [f64; CHANNELS])> {
        let read_uv = |at: &usize| table.rows[*at].uv.unwrap_or_default();
        let readings: Vec<[f64; CHANNELS]> = self.rows.iter().map(read_uv).collect();
        // One channel at a time takes a ninth of the memory, and tables may have a million rows.
        for channel in 0..CHANNELS {
            let own: Vec<[f64; 1]> = readings.iter().map(|uv| [uv[channel]]).collect();
            for (row, [zero_uv]) in table.rows.iter_mut().zip(self.of_channel(channel, &own)) {
                row.uv.iter_mut().for_each(|uv| uv[channel] -= zero_uv);
            }
        }
        self.rows.iter().copied().zip(readings).collect()
    }
}

/// The table with its zero taken off the channels of each row, as it was read, as the paper does it; `None` if it never reads the
/// untouched pad.
pub fn tared(table: &Table) -> Option<Table> {
    let zeros = Zeros { drifts: [Drift::AS_READ; CHANNELS], ..Zeros::of(table)? };
    let mut tared = table.clone();
    zeros.tare(&mut tared);
    Some(tared)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::measured::Label;

    fn row(fz_n: f64, uv: f64) -> Row {
        Row { uv: Some([uv; CHANNELS]), ..Row::of(Label { fz_n, ..Label::default() }) }
    }

    fn table(rows: Vec<Row>) -> Table {
        Table { rows, sessions: vec![ZERO.into(), "spread".into()], ..Table::default() }
    }

    fn first_channel(table: &Table) -> Vec<f64> {
        table.rows.iter().map(|row| row.uv.unwrap()[0]).collect()
    }

    #[test]
    fn the_zero_goes_evenly_from_one_reading_to_the_next() {
        let rows = vec![row(1.0, 100.0), row(0.0, 10.0), row(2.0, 200.0), row(0.0, 30.0), row(1.0, 100.0)];
        assert_eq!(first_channel(&tared(&table(rows)).unwrap()), [90.0, 0.0, 180.0, 0.0, 70.0]);
    }

    #[test]
    fn times_count_where_all_rows_have_them() {
        let at = |t_s: f64, row: Row| Row { t_s: Some(t_s), ..row };
        let mut rows = vec![at(0.0, row(0.0, 10.0)), at(30.0, row(2.0, 200.0)), at(40.0, row(0.0, 30.0))];
        assert_eq!(first_channel(&tared(&table(rows.clone())).unwrap()), [0.0, 175.0, 0.0]);
        rows[1].t_s = None;
        assert_eq!(first_channel(&tared(&table(rows)).unwrap()), [0.0, 180.0, 0.0]);
    }

    #[test]
    fn a_noisy_reference_does_not_hide_a_zero_and_a_series_is_none() {
        let zero = Row { session: Some(0), ..row(0.004, 10.0) };
        let released = Row { trial: Some(0), ..row(0.0, 50.0) };
        let pressed = Row { session: Some(1), ..row(1.0, 100.0) };
        let table = table(vec![zero, released, pressed]);
        assert_eq!(first_channel(&tared(&table).unwrap()), [0.0, 40.0, 90.0]);
        assert_eq!(contacts(&table), [2]);
    }

    #[test]
    fn without_a_name_a_noisy_reference_reads_zeros_where_loads_stand_apart() {
        let rows = vec![row(0.03, 10.0), row(0.5, 60.0), row(-0.02, 30.0)];
        let noisy = table(rows.clone());
        assert_eq!(first_channel(&tared(&noisy).unwrap()), [0.0, 40.0, 0.0]);
        assert_eq!(contacts(&noisy), [1]);
        // Contacts of all sizes: the lightest ones are none either.
        let light = table([rows, vec![row(0.08, 20.0), row(0.15, 40.0)]].concat());
        assert_eq!((tared(&light), contacts(&light).len()), (None, 5));
        // But what is exactly 0 stays so.
        assert_eq!(Zeros::by(&light, &UntouchedRows::unloaded(&light)).unwrap().rows(), [0, 2, 3]);
        let exact = table(vec![row(0.0, 10.0), row(0.08, 20.0), row(0.15, 40.0)]);
        assert_eq!(first_channel(&tared(&exact).unwrap()), [0.0, 10.0, 30.0]);
    }

    #[test]
    fn without_a_reading_of_the_untouched_pad_there_is_no_zero() {
        let series = |row| Row { trial: Some(0), ..row };
        let table = table(vec![series(row(1.0, 100.0)), series(row(0.0, 7.0))]);
        assert_eq!(tared(&table), None);
        assert_eq!(contacts(&table), [0], "a series alone is better than nothing");
    }
}
