//! The smallest step of force that is told from none.

use serde::Serialize;

use super::Needs;
use super::output::sum_uv;
use super::rows::is_unloaded;
use super::series::{self, Sample, duration_s, mean_fz_n, mean_sum_uv};
use super::statistics::{Line, deviation};
use crate::measured::Table;

/// A trial must hold its load so long.
const HELD_S: f64 = 30.0;

/// The output is averaged over so long.
const AVERAGED_S: f64 = 1.0;

/// Two-sided 5 % of false alarms: a mean beyond 1.960 s is called a step.
const FALSE_ALARM: f64 = 1.960;

/// 95 % of power: a step of (1.960 + 1.645) s is called one in 95 % of the means.
const POWER: f64 = 1.645;

const NEEDED: &str = "a trial that holds a load for 30 s or longer, with unloaded rows";

/// The smallest step of Fz that 1 s means tell from none in 95 % of the cases, at 5 % of false alarms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Resolution {
    /// By the means as they are: drift and creep count.
    pub step_n: f64,
    /// By what is left of the means beside a straight line.
    pub without_drift_n: f64,
    /// The load that was held.
    pub load_n: f64,
    /// How many means.
    pub means: usize,
}

/// The smallest step of the longest constant load.
///
/// A 1 s mean scatters around the load's output by its standard deviation s. It is called a step where it is off by more
/// than 1.960 s; a true step of (1.960 + 1.645) s is off by more than that in 95 % of the means. The baseline is taken
/// as known. The output is calibrated at the load itself.
///
/// # Errors
/// No load is held for 30 s.
pub fn smallest_step(table: &Table) -> Result<Resolution, Needs> {
    let trials = series::all(table);
    let held = trials.iter().flat_map(|trial| series::held(trial, HELD_S));
    let loaded = held.filter(|part| !is_unloaded(&series::mean_label(part)));
    let longest = loaded.max_by(|a, b| duration_s(a).total_cmp(&duration_s(b)));
    longest.map(of_plateau).ok_or(Needs::Rows(NEEDED))
}

fn of_plateau(samples: &[Sample]) -> Resolution {
    let uv_per_n = mean_sum_uv(samples) / mean_fz_n(samples);
    let means: Vec<[f64; 2]> = seconds(samples).map(|(t_s, sum_uv)| [t_s, sum_uv / uv_per_n]).collect();
    let line = Line::through(&means);
    let outputs_n: Vec<f64> = means.iter().map(|[_, output_n]| *output_n).collect();
    let beside: Vec<f64> = means.iter().map(|[t_s, output_n]| output_n - line.at(*t_s)).collect();
    // Two numbers of the line were found from the means, and one of them is the mean itself.
    let count = means.len() as f64;
    let freedom = ((count - 1.0) / (count - 2.0)).sqrt();
    Resolution {
        step_n: (FALSE_ALARM + POWER) * deviation(&outputs_n),
        without_drift_n: (FALSE_ALARM + POWER) * deviation(&beside) * freedom,
        load_n: mean_fz_n(samples),
        means: means.len(),
    }
}

/// Start and mean of each whole second, in µV.
fn seconds(samples: &[Sample]) -> impl Iterator<Item = (f64, f64)> {
    let start_s = samples.first().map_or(0.0, |sample| sample.t_s);
    let second = move |sample: &Sample| ((sample.t_s - start_s) / AVERAGED_S).floor();
    let whole = (duration_s(samples) / AVERAGED_S).floor();
    let chunks = samples.chunk_by(move |one, next| second(one) == second(next));
    let mean = move |chunk: &[Sample]| {
        let sum_uv: f64 = chunk.iter().map(|sample| sum_uv(&sample.uv)).sum();
        chunk.first().map(|first| (second(first), sum_uv / chunk.len() as f64))
    };
    chunks.filter_map(mean).filter(move |(second, _)| *second < whole)
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, series, table};
    use super::*;
    use crate::measured::Row;
    use crate::quantity::CHANNELS;
    use crate::random::SplitMix64;

    const RATE_HZ: f64 = 45.0;

    /// 1 N for a long time after a second without load, white noise of `noise_n` in the output, a drift per second.
    fn held(seconds: f64, noise_n: f64, drift_n_per_s: f64) -> Vec<Row> {
        let mut random = SplitMix64::new(5);
        let label = |t_s: f64| press(if t_s < 1.0 { 0.0 } else { 1.0 });
        let rows = series(0, RATE_HZ, seconds + 1.0, |t_s| (label(t_s), 0.0));
        let noisy = rows.map(|row| {
            let t_s = row.t_s.unwrap();
            let noise = if t_s < 1.0 { 0.0 } else { noise_n * f64::from(random.normal()) };
            let output_n = row.label.fz_n + noise + drift_n_per_s * (t_s - 1.0).max(0.0);
            Row { uv: Some([700.0 * output_n; CHANNELS]), ..row }
        });
        noisy.collect()
    }

    #[test]
    fn white_noise_gives_the_formula() {
        let found = smallest_step(&table(held(1000.0, 0.02, 0.0))).unwrap();
        let expected = 3.605 * 0.02 / RATE_HZ.sqrt();
        // The deviation of a thousand means is known to 2.2 %; four times that.
        assert!((found.step_n / expected - 1.0).abs() < 0.09, "{found:?} {expected}");
        assert!((found.without_drift_n / found.step_n - 1.0).abs() < 0.02, "{found:?}");
        assert_eq!(found.means, 999);
    }

    #[test]
    fn drift_counts_and_can_be_taken_off() {
        // An even ramp of n means has the deviation slope · √(n (n + 1) / 12).
        let drift = 1e-4;
        let found = smallest_step(&table(held(60.5, 0.0, drift))).unwrap();
        assert_eq!(found.means, 60);
        let expected = 3.605 * drift * (60.0_f64 * 61.0 / 12.0).sqrt();
        // The output is calibrated with the drift, 0.3 % on average.
        assert!((found.step_n / expected - 1.0).abs() < 0.005, "{found:?} {expected}");
        assert!(found.without_drift_n < 1e-3 * found.step_n, "{found:?}");
    }

    #[test]
    fn it_says_what_it_needs() {
        let unloaded = series(0, RATE_HZ, 60.0, |_| (press(0.0), 0.0)).collect();
        for rows in [held(20.0, 0.01, 0.0), unloaded, vec![]] {
            assert_eq!(smallest_step(&table(rows)).unwrap_err().to_string(), format!("needs {NEEDED}"));
        }
    }
}
