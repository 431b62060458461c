//! Step response of the stream, behind the mean filter of 6.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use serde::Serialize;

use super::output::sum_uv;
use super::series::{self, Sample, Trials, duration_s, mean_fz_n};
use super::{Needs, filter};
use tactpad_core::tables::measured::Table;
use tactpad_numeric::statistics::{mean, median};

/// The least step.
const STEP_N: f64 = 0.5;

/// Least share of a step that comes from one sample to the next: a ramp has less.
const AT_ONCE: f64 = 0.8;

/// Least time at rest before and after a step.
const STAY_S: f64 = 1.0;

/// Time after the step that is evaluated.
const LOOKED_S: f64 = 0.5;

/// Frequencies are tried in steps of this share of the sampling rate.
const FREQUENCY_SHARE: f64 = 1e-4;

const NEEDED: &str = "a trial with a step of load of 0.5 N or more from one sample to the next, held for 1 s \
                      before and after, and unloaded rows";

/// The stream's answer to a step of load, behind the mean filter of 6.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepResponse {
    /// From half of the label's step to half of the output's.
    pub delay_ms: f64,
    /// From 10 to 90 % of the output's step.
    pub rise_ms: f64,
    /// Where the response of the stream, the filter included, falls to 1/√2. Half the sampling rate if it
    /// does not.
    pub bandwidth_hz: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Number of steps.
    pub steps: usize,
}

/// The answer to the steps up of a table, as the mean over those with the first one's sampling rate.
///
/// # Errors
/// No step.
pub fn to_steps(table: &Table) -> Result<StepResponse, Needs> {
    let steps: Vec<Step> = Trials::of(table).each().flat_map(|trial| steps(&trial)).collect();
    let first = steps.first().ok_or(Needs::Rows(NEEDED))?;
    let alike: Vec<&Step> = steps.iter().filter(|step| step.response.len() == first.response.len()).collect();
    let response: Vec<f64> =
        (0..first.response.len()).map(|k| mean(alike.iter().map(|step| step.response[k]))).collect();
    let interval_s = first.interval_s;
    let crossing = |level: f64| crossing(&response, level).unwrap_or(f64::NAN);
    // The label's step is halfway between the samples before and at BEFORE.
    let half = BEFORE as f64 - 0.5;
    Ok(StepResponse {
        delay_ms: 1e3 * interval_s * (crossing(0.5) - half),
        rise_ms: 1e3 * interval_s * (crossing(0.9) - crossing(0.1)),
        bandwidth_hz: bandwidth(&response) / interval_s,
        rate_hz: 1.0 / interval_s,
        steps: alike.len(),
    })
}

/// Samples of a response before its step.
const BEFORE: usize = filter::WINDOW;

/// One step: the filtered output from 0 to 1, from [`BEFORE`] samples before the first one with the new label
/// on.
struct Step {
    response: Vec<f64>,
    interval_s: f64,
}

fn steps(trial: &[Sample]) -> Vec<Step> {
    let times = trial.windows(2).map(|pair| pair[1].t_s() - pair[0].t_s());
    let Some(interval_s) = median(times).filter(|interval_s| *interval_s > 0.0) else { return Vec::new() };
    let plateaus = series::plateaus(trial);
    let mut start = 0;
    let mut found = Vec::new();
    for pair in plateaus.windows(2) {
        start += pair[0].len();
        let stays = pair.iter().all(|part| duration_s(part) >= STAY_S);
        let step_n = mean_fz_n(pair[1]) - mean_fz_n(pair[0]);
        let jump_n = pair[0]
            .last()
            .zip(pair[1].first())
            .map_or(0.0, |(last, first)| first.label().fz_n - last.label().fz_n);
        if stays && step_n >= STEP_N && jump_n >= AT_ONCE * step_n {
            found.extend(step(trial, start, pair[1].len(), interval_s));
        }
    }
    found
}

/// The step at sample `start`, whose load stays for `held` samples.
fn step(trial: &[Sample], start: usize, held: usize, interval_s: f64) -> Option<Step> {
    let looked = ((LOOKED_S / interval_s).round() as usize).min(held);
    // From BEFORE samples before the step on; the filter looks at some before these.
    let first = start.checked_sub(BEFORE)?;
    let from = first.saturating_sub(filter::WINDOW);
    let filtered = filter::means(trial.get(from..start + held)?, Sample::uv).skip(first - from);
    let filtered: Vec<f64> = filtered.map(|uv| sum_uv(&uv)).collect();
    let around = filtered.get(..BEFORE + looked)?;
    let before = mean(filtered.get(..BEFORE)?);
    let settled = mean(filtered.get(BEFORE + looked..).filter(|rest| !rest.is_empty())?);
    let change = settled - before;
    let response = around.iter().map(|uv| (uv - before) / change).collect();
    (change != 0.0).then_some(Step { response, interval_s })
}

/// Where a response first passes a level, in samples from its start.
pub(super) fn crossing(response: &[f64], level: f64) -> Option<f64> {
    let pair = response.windows(2).position(|pair| pair[0] < level && pair[1] >= level)?;
    let [from, to] = [response[pair], response[pair + 1]];
    Some(pair as f64 + (level - from) / (to - from))
}

/// The −3 dB frequency as a share of the sampling rate, by the transform of the response's differences.
fn bandwidth(response: &[f64]) -> f64 {
    let impulse: Vec<f64> = response.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let gain = |share: f64| {
        let phase = |k: usize| TAU * share * k as f64;
        let part = |wave: fn(f64) -> f64| -> f64 {
            impulse.iter().enumerate().map(|(k, change)| change * wave(phase(k))).sum()
        };
        part(f64::cos).hypot(part(f64::sin))
    };
    let still = gain(0.0);
    let tried = (1..=(0.5 / FREQUENCY_SHARE) as usize).map(|k| FREQUENCY_SHARE * k as f64);
    tried.into_iter().find(|share| gain(*share) < FRAC_1_SQRT_2 * still).unwrap_or(0.5)
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{press, series, table};
    use super::*;
    use tactpad_core::tables::measured::Row;

    const RATE_HZ: f64 = 45.0;

    /// Three steps of 2 N; the pad follows with a first-order lag.
    fn stepped(lag_s: f64) -> impl Iterator<Item = Row> {
        series(0, RATE_HZ, 15.0, move |t_s| {
            let since = t_s % 5.0 - 2.0;
            let fz_n = if since < -1e-9 { 0.0 } else { 2.0 };
            let follows = match (since < -1e-9, lag_s > 0.0) {
                (true, _) => 0.0,
                (false, true) => 1.0 - (-since / lag_s).exp(),
                (false, false) => 1.0,
            };
            (press(fz_n), 4.0 + 500.0 * follows)
        })
    }

    #[test]
    fn the_filter_alone_gives_its_own_figures() {
        let found = to_steps(&table(stepped(0.0))).unwrap();
        let interval_ms = 1e3 / RATE_HZ;
        // y climbs by 1/6 each sample: 10 % at 0.6 samples, 50 % at 3, 90 % at 5.4; the label's half is at
        // 0.5.
        assert!((found.delay_ms - 2.5 * interval_ms).abs() < 1e-6, "{found:?}");
        assert!((found.rise_ms - 4.8 * interval_ms).abs() < 1e-6, "{found:?}");
        // sin(6πf/fs) = 6/√2 · sin(πf/fs) at f = 0.07477 fs.
        let share = found.bandwidth_hz / RATE_HZ;
        let gain = |share: f64| {
            (6.0 * std::f64::consts::PI * share).sin() / (6.0 * (std::f64::consts::PI * share).sin())
        };
        assert!((gain(share) - FRAC_1_SQRT_2).abs() < 1e-3, "{share}");
        assert!((found.rate_hz - RATE_HZ).abs() < 1e-6 && found.steps == 3);
    }

    #[test]
    fn a_lag_adds_to_it() {
        let (swift, slow) =
            (to_steps(&table(stepped(0.0))).unwrap(), to_steps(&table(stepped(0.05))).unwrap());
        // The label steps half a sample before the lag begins; its half is at 0.05 s · ln 2.
        let later_ms = slow.delay_ms - swift.delay_ms;
        assert!(later_ms > 34.0 && later_ms < 75.0, "{later_ms}");
        assert!(slow.rise_ms > swift.rise_ms && slow.bandwidth_hz < swift.bandwidth_hz);
        // A lag of 50 ms alone falls to 1/√2 at 3.2 Hz, the filter at 3.4 Hz; both together at 2.3 Hz.
        assert!((slow.bandwidth_hz - 2.3).abs() < 0.15, "{slow:?}");
    }

    #[test]
    fn it_says_what_it_needs() {
        let ramp = table(series(0, RATE_HZ, 40.0, |t_s| (press(0.2 * (t_s - 3.0).clamp(0.0, 25.0)), t_s)));
        let short = table(series(0, RATE_HZ, 2.5, |t_s| (press(if t_s < 2.0 { 0.0 } else { 1.0 }), t_s)));
        for table in [Table::default(), ramp, short] {
            assert_eq!(to_steps(&table), Err(Needs::Rows(NEEDED)));
        }
    }
}
