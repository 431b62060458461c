//! The newest weighing, as the status shows it.

use serde::Serialize;

use tactpad_core::pipeline::weighing::{Progress, WeighingReport};

/// Smallest change of the gain that is reported, as a share.
const REPORTED_CHANGE_MIN: f64 = 5e-4;

/// The newest weighing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WeighingStatus {
    /// Counts the weighings, from 1.
    pub number: u64,
    /// The weight.
    pub weight_g: f64,
    /// `waiting`, `resting`, `weighed` or `refused`.
    pub state: &'static str,
    /// The factor: the pad's readings over those at its calibration, without a unit.
    pub factor: Option<f64>,
    /// Standard deviation of the factor, without a unit.
    pub deviation: Option<f64>,
    /// Why there is no factor, for people.
    pub error: Option<String>,
}

impl WeighingStatus {
    /// Of this weighing.
    pub fn of(account: &WeighingReport) -> Self {
        let WeighingReport { number, weight, progress } = account;
        let (state, factor, deviation, error) = match progress {
            Progress::Waiting => ("waiting", None, None, None),
            Progress::Resting => ("resting", None, None, None),
            Progress::Ended(Ok(weighed)) => ("weighed", Some(weighed.factor), Some(weighed.deviation), None),
            Progress::Ended(Err(error)) => ("refused", None, None, Some(error.to_string())),
        };
        Self { number: *number, weight_g: weight.g(), state, factor, deviation, error }
    }
}

/// A sentence about a common gain; `None` for a gain of 1.
pub fn gain_sentence(factor: f64) -> Option<String> {
    let change = factor - 1.0;
    let than = if change < 0.0 { "less" } else { "more" };
    (change.abs() >= REPORTED_CHANGE_MIN).then(|| {
        format!(
            "the pad reads {:.1} % {than} than when it was calibrated; forces are corrected by it",
            100.0 * change.abs()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_a_sentence_unless_it_is_one() {
        let less = "the pad reads 8.9 % less than when it was calibrated; forces are corrected by it";
        assert_eq!(gain_sentence(0.911).as_deref(), Some(less));
        assert!(gain_sentence(1.02).unwrap().starts_with("the pad reads 2.0 % more"));
        assert_eq!(gain_sentence(1.0), None);
    }
}
