//! Checks before any physics: faults of the recording and the electronics.
//!
//! Each check mends what it finds, or takes away the weight of the readings that it cannot mend, and leaves a [`Notice`] that
//! says which channel, how many rows, what was done, and how to look at it. What has a name among the effects is a finding,
//! too. Nothing here knows of nine channels or of a pad: where a model says what the channels should read, that helps, and
//! where none does, the channels are held against each other and against themselves.
//!
//! A check is a file, and a line in [`CHECKS`].

mod clipping;
mod clock;
mod dead;
pub(super) mod excess;
mod line;
mod mains;
mod missing;
mod prediction;
mod rates;
mod steps;
mod stuck;
mod wiring;

use super::observations::Observations;
use super::report::{Finding, NotDetected, NotTestable, Notice};
use super::target::Target;
use crate::numeric::statistics::mean;

/// Probability by which a check may find anything in a sound recording.
const LEVEL: f64 = 1e-3;

/// All checks, in their order: times before series, codes before anything that calculates, wires before whatever holds a
/// channel against its own model.
const CHECKS: [fn(&mut Gate); 9] = [
    clock::check,
    missing::check,
    stuck::check,
    rates::check,
    dead::check,
    wiring::check,
    clipping::check,
    steps::check,
    mains::check,
];

/// Observations on their way through the checks.
#[derive(Clone, Debug)]
pub(super) struct Gate {
    /// As far as they are mended.
    pub(super) observations: Observations,
    /// What the channels should read, if a model says so.
    expected: Option<Vec<Vec<f64>>>,
    /// What was found and done.
    pub(super) notices: Vec<Notice>,
    /// What of it has a name among the effects.
    pub(super) findings: Vec<Finding>,
    /// Effects that were asked for and not found.
    pub(super) not_detected: Vec<NotDetected>,
    /// Effects that could not be asked for.
    pub(super) not_testable: Vec<NotTestable>,
    /// The part of the squared residual that no repair took away.
    pub(super) left: f64,
}

/// The observations after all checks. `expected` are each channel's readings by a model, row by row; `None`: there is no model.
///
/// Tables of any size pass, also ones without rows; whether enough is left in them is for the caller to ask.
pub(super) fn guarded(observations: &Observations, expected: Option<&[Vec<f64>]>) -> Gate {
    let mut gate = Gate {
        observations: observations.clone(),
        expected: expected.map(<[Vec<f64>]>::to_vec),
        notices: Vec::new(),
        findings: Vec::new(),
        not_detected: Vec::new(),
        not_testable: Vec::new(),
        left: 1.0,
    };
    CHECKS.iter().for_each(|check| check(&mut gate));
    gate
}

impl Gate {
    fn channels(&self) -> usize {
        self.observations.readings.len()
    }

    /// The rows in which a channel tells something.
    fn told(&self, channel: usize) -> Vec<usize> {
        let is_told = &self.observations.is_told[channel];
        (0..self.observations.rows()).filter(|row| is_told[*row]).collect()
    }

    /// A channel's readings in these rows.
    fn readings(&self, channel: usize, rows: &[usize]) -> Vec<f64> {
        rows.iter().map(|row| self.observations.readings[channel][*row]).collect()
    }

    /// What a channel should read in these rows.
    fn expected(&self, channel: usize, rows: &[usize]) -> Option<Vec<f64>> {
        let expected = self.expected.as_ref()?.get(channel)?;
        Some(rows.iter().map(|row| expected[*row]).collect())
    }

    /// The rows of each time series, in order.
    fn series(&self) -> Vec<Vec<usize>> {
        let samples = &self.observations.samples;
        let trials = samples.iter().filter_map(|sample| sample.trial).max().map_or(0, |last| last + 1);
        let mut series = vec![Vec::new(); trials];
        for (row, sample) in samples.iter().enumerate() {
            if let (Some(trial), Some(_)) = (sample.trial, sample.t_s) {
                series[trial].push(row);
            }
        }
        series.retain(|rows| rows.len() > 1);
        series
    }

    /// Seconds on the channels' clock.
    fn t_s(&self, row: usize) -> f64 {
        self.observations.samples[row].t_s.unwrap_or(0.0)
    }

    /// Takes away the weight of these readings.
    fn mask(&mut self, channel: usize, rows: &[usize]) {
        rows.iter().for_each(|row| self.observations.is_told[channel][*row] = false);
    }

    /// Puts the rows in this order.
    fn put_in_order(&mut self, order: &[usize]) {
        self.observations = self.observations.picked(order);
        for channel in self.expected.iter_mut().flatten() {
            *channel = order.iter().map(|row| channel[*row]).collect();
        }
    }

    fn name(&self, channel: usize) -> &str {
        self.observations.channels.get(channel).map_or("?", String::as_str)
    }

    fn notice(&mut self, check: &'static str, channel: Option<usize>, detail: String) {
        self.notices.push(Notice { check, channel, detail });
    }

    fn find(&mut self, effect: &'static str, target: Target, p_value: f64, share: f64) -> &mut Finding {
        let at = self.findings.len();
        self.findings.push(Finding {
            effect,
            target,
            parameters: Vec::new(),
            p_value,
            share,
            confounded_with: Vec::new(),
            separate_by: None,
        });
        &mut self.findings[at]
    }

    /// The squared residual beside the model and a zero, each channel's in units of its model's variance; not a number
    /// without a model.
    fn square(&self) -> f64 {
        let of_channel = |channel: usize| {
            let rows = self.told(channel);
            let expected = self.expected(channel, &rows)?;
            let left: Vec<f64> =
                self.readings(channel, &rows).iter().zip(&expected).map(|(y, f)| y - f).collect();
            let [residual, whole] = [squares(&left), squares(&expected)];
            Some(if whole > 0.0 { residual / whole } else { 0.0 })
        };
        let channels: Vec<f64> = (0..self.channels()).filter_map(of_channel).collect();
        if channels.is_empty() { f64::NAN } else { channels.iter().sum() }
    }

    /// Mends, and says what part of the first squared residual that takes away; not a number without a model.
    fn mended(&mut self, mend: impl FnOnce(&mut Self)) -> f64 {
        let before = self.square();
        mend(self);
        let after = self.square();
        let left = if before > 0.0 { self.left * (after / before).clamp(0.0, 1.0) } else { self.left };
        let share = if before.is_nan() { f64::NAN } else { self.left - left };
        self.left = left;
        share
    }
}

/// Σ (x − mean)²; 0 without values.
fn squares(values: &[f64]) -> f64 {
    let middle = mean(values);
    values.iter().map(|value| (value - middle).powi(2)).sum()
}

/// The correlation of two columns; 0 where one stays the same.
fn correlation(one: &[f64], other: &[f64]) -> f64 {
    let [mean_one, mean_other] = [mean(one), mean(other)];
    let product: f64 = one.iter().zip(other).map(|(a, b)| (a - mean_one) * (b - mean_other)).sum();
    let whole = (squares(one) * squares(other)).sqrt();
    if whole > 0.0 && product.is_finite() { (product / whole).clamp(-1.0, 1.0) } else { 0.0 }
}

/// `1 row`, `2 rows`.
fn rows_text(count: usize) -> String {
    if count == 1 { "1 row".to_owned() } else { format!("{count} rows") }
}

#[cfg(test)]
mod tests;
