//! Observations on their way through the checks, and what checks do with them.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::report::{Finding, NotDetected, NotTestable, Notice};
use crate::effect::Effect;
use tactpad_inference::observations::Observations;
use tactpad_numeric::statistics::squares;

/// Probability by which a check may find anything in a sound recording.
pub(super) const LEVEL: f64 = 1e-3;

/// Observations on their way through the checks.
#[derive(Clone, Debug)]
pub(crate) struct Gate {
    /// As far as they are mended.
    pub(crate) observations: Observations,
    /// The same before what channels and electronics do was mended, where anything was.
    pub(crate) unrepaired: Option<Observations>,
    /// Expected readings of the channels, if a model gives them.
    pub(super) expected: Option<Vec<Vec<f64>>>,
    /// What was found and done.
    pub(crate) notices: Vec<Notice>,
    /// What of it has a name among the effects.
    pub(crate) findings: Vec<Finding>,
    /// Effects that were asked for and not found.
    pub(crate) not_detected: Vec<NotDetected>,
    /// Effects that could not be asked for.
    pub(crate) not_testable: Vec<NotTestable>,
    /// The part of the squared residual that no repair took away.
    pub(crate) left: f64,
}

impl Gate {
    pub(super) fn channels(&self) -> usize {
        self.observations.readings.len()
    }

    /// The rows in which a channel tells something.
    pub(super) fn told(&self, channel: usize) -> Vec<usize> {
        let is_told = &self.observations.is_told[channel];
        (0..self.observations.rows()).filter(|row| is_told[*row]).collect()
    }

    /// A channel's readings in these rows.
    pub(super) fn readings(&self, channel: usize, rows: &[usize]) -> Vec<f64> {
        rows.iter().map(|row| self.observations.readings[channel][*row]).collect()
    }

    /// Expected readings of a channel in these rows.
    pub(super) fn expected(&self, channel: usize, rows: &[usize]) -> Option<Vec<f64>> {
        let expected = self.expected.as_ref()?.get(channel)?;
        Some(rows.iter().map(|row| expected[*row]).collect())
    }

    /// The rows of each time series, in order.
    pub(super) fn series(&self) -> Vec<Vec<usize>> {
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
    pub(super) fn t_s(&self, row: usize) -> f64 {
        self.observations.samples[row].t_s.unwrap_or(0.0)
    }

    /// Takes away the weight of these readings.
    pub(super) fn mask(&mut self, channel: usize, rows: &[usize]) {
        rows.iter().for_each(|row| self.observations.is_told[channel][*row] = false);
    }

    /// Puts the rows in this order.
    pub(super) fn put_in_order(&mut self, order: &[usize]) {
        self.observations = self.observations.as_whole(order);
        for channel in self.expected.iter_mut().flatten() {
            *channel = order.iter().map(|row| channel[*row]).collect();
        }
    }

    pub(super) fn name(&self, channel: usize) -> &str {
        self.observations.channels.get(channel).map_or("?", String::as_str)
    }

    pub(super) fn notice(&mut self, check: &'static str, channel: Option<usize>, detail: String) {
        self.notices.push(Notice { check, channel, detail });
    }

    pub(super) fn find(&mut self, effect: Effect, target: Target, p_value: f64, share: f64) -> &mut Finding {
        let at = self.findings.len();
        self.findings.push(Finding {
            effect,
            target,
            parameters: Vec::new(),
            shapes: Vec::new(),
            p_value,
            share,
            confounded_with: Vec::new(),
            separate_by: None,
            labels: None,
        });
        &mut self.findings[at]
    }

    /// The squared residual beside the model and a zero, each channel's in units of its model's variance; not a number
    /// without a model.
    pub(super) fn square(&self) -> f64 {
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
    pub(super) fn mended(&mut self, mend: impl FnOnce(&mut Self)) -> f64 {
        let before = self.square();
        mend(self);
        let after = self.square();
        let left = if before > 0.0 { self.left * (after / before).clamp(0.0, 1.0) } else { self.left };
        let share = if before.is_nan() { f64::NAN } else { self.left - left };
        self.left = left;
        share
    }
}
