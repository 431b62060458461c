//! Tables for the tests, made from closed forms.
#![cfg(test)]

use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::measured::{Label, Row, Table};

/// A static row without anything else known.
pub(super) fn row(label: Label, uv: [f64; CHANNELS]) -> Row {
    Row { uv: Some(uv), ..Row::of(label) }
}

/// No load; all channels read `uv`.
pub(super) fn unloaded(uv: f64) -> Row {
    row(Label::default(), [uv; CHANNELS])
}

/// A press at the centre; all channels read `uv`.
pub(super) fn pressed(fz_n: f64, uv: f64) -> Row {
    row(Label { fz_n, ..Label::default() }, [uv; CHANNELS])
}

/// The table of these rows, with as many trials and sessions as they name.
pub(super) fn table(rows: impl IntoIterator<Item = Row>) -> Table {
    let rows: Vec<Row> = rows.into_iter().collect();
    let names = |of: fn(&Row) -> Option<usize>| -> Vec<String> {
        let count = rows.iter().filter_map(of).max().map_or(0, |last| last + 1);
        (0..count).map(|index| index.to_string()).collect()
    };
    let (trials, sessions) = (names(|row| row.trial), names(|row| row.session));
    Table { rows, trials, sessions, ..Table::default() }
}

/// Samples of trial `trial`, `rate_hz` a second: the label and what all channels read, by time.
pub(super) fn series(
    trial: usize,
    rate_hz: f64,
    seconds: f64,
    of: impl Fn(f64) -> (Label, f64),
) -> impl Iterator<Item = Row> {
    (0..(seconds * rate_hz) as usize).map(move |sample| {
        let t_s = sample as f64 / rate_hz;
        let (label, uv) = of(t_s);
        Row { trial: Some(trial), t_s: Some(t_s), ..row(label, [uv; CHANNELS]) }
    })
}

/// A press at the centre as a label.
pub(super) fn press(fz_n: f64) -> Label {
    Label { fz_n, ..Label::default() }
}
