//! The scripted force-holding task: how steady the output is while 1, 3 and 5 N are held.

use serde::Serialize;

use super::output::sum_uv;
use super::rows::{is_load, is_press};
use super::series::{self, Sample, Trials, mean_fz_n, mean_sum_uv};
use super::{FULL_SCALE_N, Needs, filter};
use tactpad_core::tables::measured::Table;
use tactpad_numeric::statistics::{deviation, mean};

/// The loads of the task.
pub const LOADS_N: [f64; 3] = [1.0, 3.0, FULL_SCALE_N];

/// Least time for which each is held.
const HELD_S: f64 = 2.0;

const NEEDED: &str = "a trial that holds 1, 3 and 5 N for 2 s or longer each, with unloaded rows";

/// One load of the task.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HoldingLoad {
    /// The load of the task.
    pub load_n: f64,
    /// Mean output minus mean labelled force.
    pub mean_error_n: f64,
    /// Standard deviation of the output.
    pub deviation_n: f64,
}

/// The first trial that holds all three loads. The output stands behind the mean filter of 6 and is
/// calibrated at the 5 N of the trial itself, so its error there is zero but for the filter's start.
///
/// # Errors
/// No such trial.
pub fn of_task(table: &Table) -> Result<[HoldingLoad; 3], Needs> {
    Trials::of(table).each().find_map(|trial| task(&trial)).ok_or(Needs::Rows(NEEDED))
}

fn task(trial: &[Sample]) -> Option<[HoldingLoad; 3]> {
    let presses = series::held(trial, HELD_S)
        .filter(|part| part.first().is_some_and(|sample| is_press(sample.label())));
    let presses: Vec<&[Sample]> = presses.collect();
    let held = |load_n: f64| presses.iter().find(|part| is_load(mean_fz_n(part), load_n)).copied();
    let [one, three, full] = LOADS_N.map(held);
    let (one, three, full) = (one?, three?, full?);
    let uv_per_n = mean_sum_uv(full) / mean_fz_n(full);
    let of = |load_n: f64, part: &[Sample]| {
        let output_n: Vec<f64> = filter::means(part, Sample::uv).map(|uv| sum_uv(&uv) / uv_per_n).collect();
        HoldingLoad {
            load_n,
            mean_error_n: mean(&output_n) - mean_fz_n(part),
            deviation_n: deviation(&output_n),
        }
    };
    Some([of(LOADS_N[0], one), of(LOADS_N[1], three), of(LOADS_N[2], full)])
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, series, table};
    use super::*;

    #[test]
    fn errors_and_deviations_come_out() {
        let task = |t_s: f64| {
            let load = [0.0, 1.0, 3.0, 5.0][(t_s / 5.0) as usize];
            // 2 % of the square too much below 5 N, and a wave that the filter passes nearly whole.
            let bent = load + 0.02 * load * (5.0 - load);
            let wave = if load > 0.0 { 0.01 * (std::f64::consts::TAU * t_s / 2.5).sin() } else { 0.0 };
            (press(load), 8.0 + 250.0 * (bent + wave))
        };
        let found = of_task(&table(series(0, 45.0, 20.0, task))).unwrap();
        for (held, (load, error)) in found.iter().zip([(1.0, 0.08), (3.0, 0.12), (5.0, 0.0)]) {
            assert_eq!(held.load_n, load);
            assert!((held.mean_error_n - error).abs() < 1e-3, "{held:?}");
            assert!((held.deviation_n / (0.01 * 0.5_f64.sqrt()) - 1.0).abs() < 0.05, "{held:?}");
        }
    }

    #[test]
    fn it_says_what_it_needs() {
        let two = table(series(0, 45.0, 15.0, |t_s| (press([0.0, 1.0, 3.0][(t_s / 5.0) as usize]), t_s)));
        for table in [Table::default(), two] {
            assert_eq!(of_task(&table), Err(Needs::Rows(NEEDED)));
        }
    }
}
