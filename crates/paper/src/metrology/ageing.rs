//! Change of the reading with cycles of load.

use serde::Serialize;

use super::Needs;
use super::output::sum_uv;
use super::rows::{StaticReading, Zeros, by_place, is_load, is_press, readings};
use tactpad_core::tables::measured::Table;
use tactpad_numeric::statistics::mean;

/// The load of the paper's test.
const LOAD_N: f64 = 1.0;

/// The reading of a new pad has fewer cycles than this behind it.
const NEW_CYCLES: f64 = 10.0;

/// The paper's test ends here.
const CYCLES: f64 = 50_000.0;

const NEEDED: &str =
    "static presses of 1 N at one place with cycle below 10 and from 50,000 on, with unloaded rows";

/// Change of the reading of 1 N with the cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ageing {
    /// Change of the output per newton after 50,000 cycles, as a share of its start; negative for a loss.
    pub change_share: f64,
    /// Cycles and change there, in order of the cycles; the first one is the start.
    pub curve: Vec<[f64; 2]>,
}

/// The change of the output per newton from a new pad to the first readings with 50,000 cycles or more, at
/// the place whose readings reach that far.
///
/// # Errors
/// No place with both.
pub fn after_cycles(table: &Table) -> Result<Ageing, Needs> {
    let is_wanted =
        |reading: &StaticReading| is_press(&reading.row().label) && is_load(reading.row().label.fz_n, LOAD_N);
    let zeros = Zeros::of(table);
    let presses = readings(&zeros).filter(is_wanted);
    let counted = presses.filter(|reading| reading.row().cycle.is_some());
    let places = by_place(counted, |reading| reading.row().label);
    places.each().find_map(of_place).ok_or(Needs::Rows(NEEDED))
}

fn of_place<'r>(place: impl Iterator<Item = &'r StaticReading<'r, 'r>>) -> Option<Ageing> {
    let mut points: Vec<[f64; 2]> = place
        .filter_map(|reading| Some([reading.row().cycle?, sum_uv(&reading.uv()) / reading.row().label.fz_n]))
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let means = points.chunk_by(|one, next| one[0] == next[0]).map(|same| {
        let sums: Vec<f64> = same.iter().map(|[_, uv_per_n]| *uv_per_n).collect();
        [same[0][0], mean(&sums)]
    });
    let means: Vec<[f64; 2]> = means.collect();
    let [_, new] = *means.first().filter(|[cycle, _]| *cycle < NEW_CYCLES)?;
    let curve: Vec<[f64; 2]> = means.iter().map(|[cycle, uv_per_n]| [*cycle, uv_per_n / new - 1.0]).collect();
    let [_, change_share] = *curve.iter().find(|[cycle, _]| *cycle >= CYCLES)?;
    Some(Ageing { change_share, curve })
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{pressed, table, unloaded};
    use super::*;
    use tactpad_core::tables::measured::Row;

    fn at(cycle: f64) -> [Row; 2] {
        // Logarithmic loss, 19 % at the end; the zero wanders with the cycles.
        let loss = 0.19 * (1.0 + cycle / 500.0).ln() / 101.0_f64.ln();
        let zero = 0.01 * cycle;
        let with = |row: Row| Row { cycle: Some(cycle), ..row };
        [with(unloaded(zero)), with(pressed(1.02, zero + 1.02 * 800.0 * (1.0 - loss)))]
    }

    #[test]
    fn the_loss_comes_out() {
        let cycles = [0.0, 100.0, 1_000.0, 10_000.0, 25_000.0, 50_000.0];
        // Each cycle count in its own session, as a pad is tared after a pause.
        let rows = cycles
            .iter()
            .enumerate()
            .flat_map(|(session, cycle)| at(*cycle).map(|row| Row { session: Some(session), ..row }));
        let found = after_cycles(&table(rows.chain([pressed(1.0, 5.0)]))).unwrap();
        assert!((found.change_share + 0.19).abs() < 1e-9, "{found:?}");
        assert_eq!(found.curve.len(), 6);
        assert_eq!(found.curve[0], [0.0, 0.0]);
    }

    #[test]
    fn it_says_what_it_needs() {
        let young = table([0.0, 40_000.0].into_iter().flat_map(at));
        let old = table([100.0, 50_000.0].into_iter().flat_map(at));
        for table in [young, old, Table::default()] {
            assert_eq!(after_cycles(&table).unwrap_err().to_string(), format!("needs {NEEDED}"));
        }
    }
}
