//! Ageing: strain gauges and glue lose signal with the cycles of load.

use tactpad_core::tables::measured::Row;

/// Cycles at which ageing begins to slow down.
const ONSET_CYCLES: f64 = 500.0;

/// How far ageing has come at a cycle: 1 at the last. Without cycles it has not begun.
pub fn aged(cycle: f64, last: f64) -> f64 {
    // ln(1 + n/n₀)/ln(1 + N/n₀)
    if last > 0.0 {
        libm::log1p(cycle.max(0.0) / ONSET_CYCLES) / libm::log1p(last / ONSET_CYCLES)
    } else {
        0.0
    }
}

/// Cycles of load up to each row. Where a row does not say, each load, or series of loads, is one more than before.
pub fn cycles(rows: &[Row]) -> Vec<f64> {
    let mut cycles = 0.0;
    let mut previous: Option<&Row> = None;
    let count = |row| {
        let goes_on = previous.replace(row).is_some_and(|it| it.trial.is_some() && it.trial == row.trial);
        let is_load = !goes_on && (row.trial.is_some() || row.label.resultant_n() > 0.0);
        cycles = row.cycle.unwrap_or(cycles + f64::from(u8::from(is_load)));
        cycles
    };
    rows.iter().map(count).collect()
}

/// For each row the part of the measurement's ageing that was still to come.
pub fn to_come(rows: &[Row]) -> Vec<f64> {
    let cycles = cycles(rows);
    let last = cycles.iter().copied().fold(0.0, f64::max);
    cycles.into_iter().map(|cycle| 1.0 - aged(cycle, last)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::tables::measured::Label;

    #[test]
    fn loads_are_counted_where_no_cycle_is_written() {
        let row = |fz_n, trial, cycle| Row { trial, cycle, ..Row::of(Label { fz_n, ..Label::default() }) };
        let rows = [
            row(0.0, None, None),
            row(2.0, None, None),
            row(2.0, None, None),
            row(1.0, Some(0), None),
            row(2.0, Some(0), None),
            row(0.0, None, None),
            row(2.0, None, Some(100.0)),
            row(2.0, None, None),
        ];
        assert_eq!(cycles(&rows), [0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 100.0, 101.0]);
    }

    #[test]
    fn it_is_whole_at_the_last_cycle() {
        assert_eq!((aged(0.0, 648.0), aged(648.0, 648.0), aged(5.0, 0.0)), (0.0, 1.0, 0.0));
        assert!(aged(324.0, 648.0) > 0.5);
    }
}
