//! Dispersion of the output when one load comes again and again.

use serde::Serialize;

use super::output::sum_uv;
use super::rows::{StaticReading, Zeros, by_place, is_load, is_ordinary, is_press, readings};
use super::series::{Sample, Trials, mean_fz_n, mean_sum_uv};
use super::{FULL_SCALE_N, Needs};
use tactpad_core::tables::measured::{Label, Table};
use tactpad_numeric::statistics::{deviation, mean};

/// Least number of cycles.
const CYCLES_MIN: usize = 10;

/// The top of a trial: at least this share of its largest load.
const TOP_SHARE: f64 = 0.98;

const NEEDED: &str = "ten cycles or more of a press of 5 N at one place, with unloaded rows";

/// Dispersion under a repeated load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Repeatability {
    /// Standard deviation of the output, as a share of the output at 5 N.
    pub share: f64,
    /// Number of cycles.
    pub cycles: usize,
}

/// One cycle's load and output.
struct Cycle {
    label: Label,
    sum_uv: f64,
}

/// The dispersion of the output under presses of 5 N at one place, at the place with the most of them.
///
/// Static rows count first, each tared by the unloaded rows around it; where they are too few, trials, each
/// by its rows at the largest load.
///
/// # Errors
/// Fewer than ten cycles.
pub fn at_full_scale(table: &Table) -> Result<Repeatability, Needs> {
    dispersion(static_cycles(table)).or_else(|| dispersion(trial_cycles(table))).ok_or(Needs::Rows(NEEDED))
}

fn dispersion(cycles: Vec<Cycle>) -> Option<Repeatability> {
    let places = by_place(cycles, |cycle| cycle.label);
    let most = places.each().max_by_key(ExactSizeIterator::len).filter(|place| place.len() >= CYCLES_MIN)?;
    let sums_uv: Vec<f64> = most.clone().map(|cycle| cycle.sum_uv).collect();
    let loads_n: Vec<f64> = most.clone().map(|cycle| cycle.label.fz_n).collect();
    let full_uv = mean(&sums_uv) * FULL_SCALE_N / mean(&loads_n);
    Some(Repeatability { share: deviation(&sums_uv) / full_uv.abs(), cycles: most.len() })
}

fn is_full(label: &Label) -> bool {
    is_press(label) && is_load(label.fz_n, FULL_SCALE_N)
}

fn static_cycles(table: &Table) -> Vec<Cycle> {
    let is_ordinary = is_ordinary(table);
    let is_wanted = |reading: &StaticReading| is_full(&reading.row().label) && is_ordinary(reading.row());
    let zeros = Zeros::of(table);
    let full = readings(&zeros).filter(is_wanted);
    full.map(|reading| Cycle { label: reading.row().label, sum_uv: sum_uv(&reading.uv()) }).collect()
}

fn trial_cycles(table: &Table) -> Vec<Cycle> {
    Trials::of(table).each().filter_map(|trial| top(&trial)).collect()
}

fn top(trial: &[Sample]) -> Option<Cycle> {
    let largest_n = trial.iter().map(|sample| sample.label().fz_n).fold(0.0, f64::max);
    let samples: Vec<Sample> =
        trial.iter().filter(|sample| sample.label().fz_n >= TOP_SHARE * largest_n).copied().collect();
    let label = Label { fz_n: mean_fz_n(&samples), ..*samples.first()?.label() };
    is_full(&label).then(|| Cycle { label, sum_uv: mean_sum_uv(&samples) })
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, pressed, series, table, unloaded};
    use super::*;
    use tactpad_core::tables::measured::Row;

    /// Outputs of 5 N that differ by ± this share by turns.
    const SHARE: f64 = 0.013;

    fn gain(cycle: usize) -> f64 {
        if cycle.is_multiple_of(2) { 1.0 + SHARE } else { 1.0 - SHARE }
    }

    fn expected(cycles: f64) -> f64 {
        SHARE * (cycles / (cycles - 1.0)).sqrt()
    }

    #[test]
    fn the_deviation_of_static_cycles_comes_out_beside_a_drifting_zero() {
        let cycle = |k: usize| {
            let zero = 10.0 * k as f64;
            [unloaded(zero), pressed(5.0, zero + 10.0 + 2000.0 * gain(k))]
        };
        let rows = (0..100).flat_map(cycle).chain([unloaded(1000.0)]);
        // Another place, other loads.
        let others =
            (0..20).map(|k| Row { label: Label { x_mm: 9.0, ..press(5.0) }, ..pressed(5.0, k.into()) });
        let found = at_full_scale(&table(rows.chain(others).chain([pressed(1.0, 77.0)]))).unwrap();
        assert_eq!(found.cycles, 100);
        // Halfway between two zeros, 5 of 2005 µV are the zero's.
        assert!((found.share - expected(100.0) * 2000.0 / 2005.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn trials_are_cycles_too() {
        let trial = |k: usize| {
            series(k, 45.0, 12.0, move |t_s| {
                let fz_n = (5.0 - (6.0 - t_s).abs()).max(0.0);
                (press(fz_n), 3.0 + 400.0 * fz_n * gain(k))
            })
        };
        let found = at_full_scale(&table((0..10).flat_map(trial))).unwrap();
        // The top of a trial is its last 0.1 N, 4.95 of 5 N in the mean.
        assert!((found.share - 0.99 * expected(10.0)).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn it_says_what_it_needs() {
        let few = (0..9).flat_map(|_| [unloaded(0.0), pressed(5.0, 1.0)]).collect();
        let low = (0..30).flat_map(|_| [unloaded(0.0), pressed(3.0, 1.0)]).collect();
        let untared = (0..30).map(|_| pressed(5.0, 1.0)).collect();
        for rows in [few, low, untared, vec![]] {
            let told = at_full_scale(&table(rows)).unwrap_err().to_string();
            assert_eq!(told, format!("needs {NEEDED}"));
        }
    }
}
