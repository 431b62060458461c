//! Difference between loading and unloading at the same force.

use serde::Serialize;

use super::output::sum_uv;
use super::rows::is_same_place;
use super::series::{self, Sample, Trials};
use super::{FULL_SCALE_N, Needs};
use tactpad_core::tables::measured::Table;
use tactpad_numeric::statistics::{Line, mean};

/// Where the branches are compared.
const LEVELS_N: [f64; 4] = [1.0, 2.0, 3.0, 4.0];

/// Largest distance from a level of samples that count for the branch there.
const NEAR_N: f64 = 0.25;

/// Least distance below and above the levels at which a branch begins and ends.
const BEYOND_N: f64 = 0.5;

/// Largest distance from the largest load of samples that count for its reading.
const TOP_N: f64 = 0.1;

const NEEDED: &str = "trials that load one place from below 0.5 N to above 4.5 N and unload it again";

/// The loop of loading and unloading.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hysteresis {
    /// Largest difference of the branches at 1, 2, 3, 4 N, as a share of the output at 5 N; the mean over the
    /// trials.
    pub share: f64,
    /// Number of trials.
    pub trials: usize,
    /// Labelled force and output of the first trial, both in newtons, loading; for the plot.
    #[serde(skip)]
    pub loading: Vec<[f64; 2]>,
    /// The same, unloading.
    #[serde(skip)]
    pub unloading: Vec<[f64; 2]>,
}

/// A trial's way up and down: labelled force and output in newtons.
struct Loop {
    loading: Vec<[f64; 2]>,
    unloading: Vec<[f64; 2]>,
}

/// The mean over the trials that go up to full scale and down again at one place. The output is calibrated at
/// each trial's own largest load.
///
/// # Errors
/// No such trial.
pub fn of_loops(table: &Table) -> Result<Hysteresis, Needs> {
    let loops: Vec<Loop> = Trials::of(table).each().filter_map(|trial| up_and_down(&trial)).collect();
    let differences: Vec<f64> = loops.iter().map(Loop::largest_difference_n).collect();
    let trials = loops.len();
    let Loop { loading, unloading } = loops.into_iter().next().ok_or(Needs::Rows(NEEDED))?;
    Ok(Hysteresis { share: mean(&differences) / FULL_SCALE_N, trials, loading, unloading })
}

/// `None` for a trial that is none, or that moves.
fn up_and_down(trial: &[Sample]) -> Option<Loop> {
    let first = trial.first()?;
    let stays = trial.iter().all(|sample| is_same_place(first.label(), sample.label()));
    let (top, _) = trial.iter().enumerate().max_by(|a, b| a.1.label().fz_n.total_cmp(&b.1.label().fz_n))?;
    let uv_per_n = sensitivity(trial)?;
    let branch = |samples: &[Sample]| -> Vec<[f64; 2]> {
        samples.iter().map(|sample| [sample.label().fz_n, sum_uv(&sample.uv()) / uv_per_n]).collect()
    };
    let (up, down) = trial.split_at(top + 1);
    let found = Loop { loading: branch(up), unloading: branch(down) };
    (stays && spans(&found.loading) && spans(&found.unloading)).then_some(found)
}

/// µV per newton at the largest load; `None` where there is none.
fn sensitivity(trial: &[Sample]) -> Option<f64> {
    let largest_n = trial.iter().map(|sample| sample.label().fz_n).fold(0.0, f64::max);
    let top: Vec<Sample> =
        trial.iter().filter(|sample| sample.label().fz_n >= largest_n - TOP_N).copied().collect();
    let uv_per_n = series::mean_sum_uv(&top) / series::mean_fz_n(&top);
    (uv_per_n.is_finite() && uv_per_n != 0.0).then_some(uv_per_n)
}

fn spans(branch: &[[f64; 2]]) -> bool {
    let forces = || branch.iter().map(|[fz_n, _]| *fz_n);
    let (least, most) = (forces().fold(f64::MAX, f64::min), forces().fold(f64::MIN, f64::max));
    least <= LEVELS_N[0] - BEYOND_N && most >= LEVELS_N[3] + BEYOND_N
}

impl Loop {
    fn largest_difference_n(&self) -> f64 {
        let differences = LEVELS_N.map(|level| (at(&self.unloading, level) - at(&self.loading, level)).abs());
        differences.into_iter().fold(0.0, f64::max)
    }
}

/// Reading of a branch at a force: by a line through the samples near it, else between the two samples around
/// it.
fn at(branch: &[[f64; 2]], level_n: f64) -> f64 {
    let near: Vec<[f64; 2]> =
        branch.iter().filter(|[fz_n, _]| (fz_n - level_n).abs() <= NEAR_N).copied().collect();
    if near.len() > 1 {
        return Line::through(&near).at(level_n);
    }
    let nearest = |wanted: fn(f64) -> bool| {
        let side = branch.iter().filter(|[fz_n, _]| wanted(fz_n - level_n));
        side.min_by(|a, b| (a[0] - level_n).abs().total_cmp(&(b[0] - level_n).abs())).copied()
    };
    let around: Vec<[f64; 2]> =
        [nearest(|above| above <= 0.0), nearest(|above| above > 0.0)].into_iter().flatten().collect();
    Line::through(&around).at(level_n)
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, series, table};
    use super::*;
    use tactpad_core::tables::measured::{Label, Row};

    /// A triangle up and down, after a second of rest. The way down reads `gap_n` more at 2 N, less at other
    /// forces.
    fn triangle(trial: usize, gap_n: f64, rate_hz: f64) -> impl Iterator<Item = Row> {
        series(trial, rate_hz, 22.0, move |t_s| {
            let fz_n = (5.0 - 0.5 * (11.0 - t_s).abs()).max(0.0);
            let gap = if t_s > 11.0 { gap_n * (1.0 - (fz_n - 2.0).abs() / 3.0).max(0.0) } else { 0.0 };
            (press(fz_n), 20.0 + 300.0 * (fz_n + gap))
        })
    }

    #[test]
    fn the_mean_of_the_largest_gaps_comes_out() {
        // The line through samples near the gap's peak cuts it by NEAR_N/2 of 3 N on each side at most.
        let rows = triangle(0, 0.1, 45.0).chain(triangle(1, 0.2, 45.0)).chain(triangle(2, -0.3, 45.0));
        let found = of_loops(&table(rows)).unwrap();
        assert_eq!(found.trials, 3);
        assert!((found.share / 0.04 - 1.0).abs() < 0.06, "{}", found.share);
    }

    #[test]
    fn steps_do_as_well_as_ramps() {
        // At 1 Hz only every second force is near a level.
        let found = of_loops(&table(triangle(0, 0.2, 1.0))).unwrap();
        assert!((found.share / 0.04 - 1.0).abs() < 0.03, "{}", found.share);
    }

    #[test]
    fn a_pad_without_memory_has_no_loop() {
        assert!(of_loops(&table(triangle(0, 0.0, 45.0))).unwrap().share < 1e-9);
    }

    #[test]
    fn it_says_what_it_needs() {
        let half = |t_s: f64| (press((0.5 * t_s).min(5.0)), 300.0 * t_s);
        let moving = |t_s: f64| {
            let fz_n = 5.0 - (5.0 - t_s).abs();
            (Label { x_mm: t_s, ..press(fz_n) }, 300.0 * fz_n)
        };
        let dead = |t_s: f64| (press(5.0 - (5.0 - t_s).abs()), 0.0);
        let [half, moving, dead] = [
            table(series(0, 45.0, 20.0, half)),
            table(series(0, 45.0, 10.0, moving)),
            table(series(0, 45.0, 10.0, dead)),
        ];
        for table in [half, moving, dead, Table::default()] {
            assert_eq!(of_loops(&table).unwrap_err().to_string(), format!("needs {NEEDED}"));
        }
    }
}
