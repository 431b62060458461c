//! Tables relative to the untouched pad.
//!
//! Channels are written raw. A pad's offset is larger than many a signal, and follows the temperature; so a table has
//! rows in which nothing touches the pad, again and again. Between two of them the zero is taken to change evenly.

use super::{Label, Row, Table};
use crate::quantity::CHANNELS;

/// The session of rows in which nothing touches the pad.
pub const ZERO: &str = "zero";

/// The rows of a table in which nothing touches the pad, and where every row lies between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Zeros {
    /// The table's untouched rows, in order; at least one.
    rows: Vec<usize>,
    /// Each row's time, or its place in the table.
    places: Vec<f64>,
}

/// Places of the rows in which something presses: what a decoder is fitted to.
///
/// Static samples if the table has any, else the rows of its time series: a series has many rows of one contact. Rows
/// without channels are none.
pub fn contacts(table: &Table) -> Vec<usize> {
    let pressed = || {
        let rows = table.rows.iter().enumerate();
        rows.filter(|(_, row)| row.uv.is_some() && !is_untouched(table, row))
    };
    let samples: Vec<usize> = pressed().filter(|(_, row)| row.trial.is_none()).map(|(at, _)| at).collect();
    if samples.is_empty() { pressed().map(|(at, _)| at).collect() } else { samples }
}

impl Zeros {
    /// Finds them; `None` if the table never reads the untouched pad.
    ///
    /// Untouched is a static sample of the session [`ZERO`], or one whose three forces are written as 0.
    pub fn of(table: &Table) -> Option<Self> {
        let is_timed = table.rows.iter().all(|row| row.t_s.is_some());
        let places = (0_u32..).zip(&table.rows);
        let places = places.map(|(place, row)| row.t_s.filter(|_| is_timed).unwrap_or(f64::from(place)));
        let is_zero = |row: &Row| row.trial.is_none() && row.uv.is_some() && is_untouched(table, row);
        let rows: Vec<usize> =
            (0..).zip(&table.rows).filter(|(_, row)| is_zero(row)).map(|(at, _)| at).collect();
        (!rows.is_empty()).then(|| Self { rows, places: places.collect() })
    }

    /// The untouched rows, in order.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// What is to be taken off a row, if `value` is what is to be taken off the untouched rows.
    ///
    /// It lies between those of the two untouched rows around it, by their times where all rows have times, else by
    /// their places in the table; before the first and after the last it stays.
    pub fn at(&self, row: usize, value: impl Fn(usize) -> [f64; CHANNELS]) -> [f64; CHANNELS] {
        let after = self.rows.partition_point(|zero| *zero < row);
        let (Some(before), Some(after)) =
            (after.checked_sub(1).and_then(|k| self.rows.get(k)), self.rows.get(after))
        else {
            return self.rows.get(after).or(self.rows.last()).map_or([0.0; CHANNELS], |zero| value(*zero));
        };
        let [here, first, second] = [row, *before, *after].map(|row| self.places[row]);
        let share = if second > first { ((here - first) / (second - first)).clamp(0.0, 1.0) } else { 0.5 };
        let (first, second) = (value(*before), value(*after));
        std::array::from_fn(|k| first[k] + share * (second[k] - first[k]))
    }
}

/// The table with its zero taken off the channels of each row; `None` if it never reads the untouched pad.
pub fn tared(table: &Table) -> Option<Table> {
    let zeros = Zeros::of(table)?;
    let mut tared = table.clone();
    for (at, row) in tared.rows.iter_mut().enumerate() {
        let zero_uv = zeros.at(at, |zero| table.rows[zero].uv.unwrap_or_default());
        row.uv.iter_mut().flatten().zip(zero_uv).for_each(|(uv, zero_uv)| *uv -= zero_uv);
    }
    Some(tared)
}

fn is_untouched(table: &Table, row: &Row) -> bool {
    let Label { fx_n, fy_n, fz_n, .. } = row.label;
    let session = row.session.and_then(|session| table.sessions.get(session));
    session.is_some_and(|name| name == ZERO) || [fx_n, fy_n, fz_n] == [0.0; 3]
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn without_a_reading_of_the_untouched_pad_there_is_no_zero() {
        let series = |row| Row { trial: Some(0), ..row };
        let table = table(vec![series(row(1.0, 100.0)), series(row(0.0, 7.0))]);
        assert_eq!(tared(&table), None);
        assert_eq!(contacts(&table), [0], "a series alone is better than nothing");
    }
}
