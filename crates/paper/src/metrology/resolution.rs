//! The smallest step of force that can be told from none.

use serde::Serialize;

use super::Needs;
use super::output::sum_uv;
use super::rows::is_unloaded;
use super::series::{self, Sample, Trials, duration_s, mean_label, mean_sum_uv};
use tactpad_core::tables::measured::Table;
use tactpad_numeric::statistics::{Line, deviation};

/// Least time for which a trial holds its load.
const HELD_S: f64 = 30.0;

/// Time over which the output is averaged.
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
    /// From no load at all, by the means as they are, where a trial has no load for as long.
    pub unloaded_step_n: Option<f64>,
    /// The load that was held.
    pub load_n: f64,
    /// Number of means.
    pub means: usize,
}

/// The smallest step of the longest constant load.
///
/// A 1 s mean scatters around the load's output by its standard deviation s. It is called a step where it is
/// off by more than 1.960 s; a true step of (1.960 + 1.645) s is off by more than that in 95 % of the means.
/// The baseline is taken as known. The output is calibrated at the load itself.
///
/// # Errors
/// No load is held for 30 s.
pub fn smallest_step(table: &Table) -> Result<Resolution, Needs> {
    let trials = Trials::of(table);
    let trials: Vec<Vec<Sample>> = trials.each().collect();
    let held: Vec<&[Sample]> = trials.iter().flat_map(|trial| series::held(trial, HELD_S)).collect();
    let (unloaded, loaded): (Vec<&[Sample]>, Vec<&[Sample]>) =
        held.into_iter().partition(|part| is_unloaded(&mean_label(part)));
    longest(&loaded).map(|load| of_plateau(load, longest(&unloaded))).ok_or(Needs::Rows(NEEDED))
}

fn longest<'s, 't>(parts: &[&'s [Sample<'t>]]) -> Option<&'s [Sample<'t>]> {
    parts.iter().max_by(|a, b| duration_s(a).total_cmp(&duration_s(b))).copied()
}

fn of_plateau(load: &[Sample], unloaded: Option<&[Sample]>) -> Resolution {
    let load_n = mean_label(load).fz_n;
    let uv_per_n = mean_sum_uv(load) / load_n;
    let means = means(load, uv_per_n);
    let line = Line::through(&means);
    let beside: Vec<[f64; 2]> =
        means.iter().map(|[t_s, output_n]| [*t_s, output_n - line.at(*t_s)]).collect();
    // A line takes two degrees of freedom, their mean takes one: √((n − 1)/(n − 2)).
    let count = means.len() as f64;
    let correction = ((count - 1.0) / (count - 2.0)).sqrt();
    Resolution {
        step_n: step_n(&means),
        without_drift_n: step_n(&beside) * correction,
        unloaded_step_n: unloaded.map(|samples| step_n(&self::means(samples, uv_per_n))),
        load_n,
        means: means.len(),
    }
}

/// The smallest step that stands out from the standard deviation of these means.
fn step_n(means: &[[f64; 2]]) -> f64 {
    let outputs_n: Vec<f64> = means.iter().map(|[_, output_n]| *output_n).collect();
    // (z₀.₉₇₅ + z₀.₉₅) σ.
    (FALSE_ALARM + POWER) * deviation(&outputs_n)
}

/// Start and mean output of each whole second.
fn means(samples: &[Sample], uv_per_n: f64) -> Vec<[f64; 2]> {
    seconds(samples).map(|(t_s, sum_uv)| [t_s, sum_uv / uv_per_n]).collect()
}

/// Start and mean of each whole second, in µV.
fn seconds(samples: &[Sample]) -> impl Iterator<Item = (f64, f64)> {
    let start_s = samples.first().map_or(0.0, |sample| sample.t_s());
    let second = move |sample: &Sample| ((sample.t_s() - start_s) / AVERAGED_S).floor();
    let whole = (duration_s(samples) / AVERAGED_S).floor();
    let chunks = samples.chunk_by(move |one, next| second(one) == second(next));
    let mean = move |chunk: &[Sample]| {
        let sum_uv: f64 = chunk.iter().map(|sample| sum_uv(&sample.uv())).sum();
        chunk.first().map(|first| (second(first), sum_uv / chunk.len() as f64))
    };
    chunks.filter_map(mean).filter(move |(second, _)| *second < whole)
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, series, table};
    use super::*;
    use tactpad_core::quantity::CHANNELS;
    use tactpad_core::tables::measured::Row;
    use tactpad_numeric::random::SplitMix64;

    const RATE_HZ: f64 = 45.0;

    /// 1 N for a long time after a second without load, white noise of `noise_n` in the output, a drift per
    /// second.
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
    fn the_unloaded_output_is_calibrated_at_the_load() {
        // Means that alternate by ±1 µV in each of the three z channels, against 2100 µV per newton.
        let waves = series(1, RATE_HZ, 60.5, |t_s| {
            (press(0.0), if (t_s as u32).is_multiple_of(2) { 1.0 } else { -1.0 })
        });
        let found = smallest_step(&table(held(60.0, 0.0, 0.0).into_iter().chain(waves))).unwrap();
        let expected = 3.605 * (3.0 / 2100.0) * (60.0_f64 / 59.0).sqrt();
        assert!((found.unloaded_step_n.unwrap() / expected - 1.0).abs() < 1e-6, "{found:?} {expected}");
        assert_eq!(smallest_step(&table(held(60.0, 0.0, 0.0))).unwrap().unloaded_step_n, None);
    }

    #[test]
    fn it_says_what_it_needs() {
        let unloaded = series(0, RATE_HZ, 60.0, |_| (press(0.0), 0.0)).collect();
        for rows in [held(20.0, 0.01, 0.0), unloaded, vec![]] {
            assert_eq!(smallest_step(&table(rows)).unwrap_err().to_string(), format!("needs {NEEDED}"));
        }
    }
}
