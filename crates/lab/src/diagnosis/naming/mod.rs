//! Which of the fitted causes may be named, and what is said of those that are and of those that are not.

pub(crate) mod experiments;
mod findings;
pub(crate) mod proposal;
pub(crate) mod separation;
pub(crate) mod untestable;
pub(crate) mod withdrawal;

use self::withdrawal::{OVER_NEAR, doubted, is_over};
use super::report::{Finding, NotDetected};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::label::Search;
use crate::effect::Effect;
use tactpad_inference::error::InferenceError;
use tactpad_inference::policy::WITHIN_95;
use tactpad_inference::search::Attribution;
use tactpad_inference::search::estimates::{Detectable, Estimate};
use tactpad_numeric::chi_square;

/// The zeros that are not zero. Beside what is `left_by_channel` without a name each is doubted, if it is far more than that; else it
/// is none.
pub(crate) fn offsets(
    search: &Search<'_>,
    found: &Attribution,
    whole: f64,
    left_by_channel: &[f64],
) -> Result<Vec<Finding>, InferenceError> {
    let finding = |(channel, [zero, variance]): (usize, [f64; 2])| {
        let square = zero * zero / variance;
        let spread = WITHIN_95 * variance.sqrt();
        let p_value = chi_square::exceeded(square, 1);
        let is_clear = left_by_channel[channel] <= 0.0 && is_over(square, left_by_channel);
        let is_found = p_value < found.critical
            && square > OVER_NEAR * left_by_channel[channel]
            && search.zero_holds_throughout(&found.fit, channel, square).unwrap_or(false);
        let finding = Finding {
            effect: Effect::ChannelOffset,
            target: Target::Channel(channel),
            parameters: vec![Estimate {
                name: "offset_uv",
                value: zero,
                interval95: [zero - spread, zero + spread],
            }],
            shapes: Vec::new(),
            p_value,
            share: square / whole,
            confounded_with: Vec::new(),
            separate_by: None,
            labels: None,
        };
        is_found.then(|| if is_clear { finding } else { doubted(finding) })
    };
    Ok(search.least_zeros(found)?.into_iter().enumerate().filter_map(finding).collect())
}

/// What was asked for and not found, with the size that would have been.
pub(crate) fn not_detected(
    search: &Search<'_>,
    found: &Attribution,
) -> Result<Vec<NotDetected>, InferenceError> {
    let of = |(at, Detectable { minimum, rival_share }): (usize, Detectable)| {
        let (effect, target) = search.model.hypotheses()[at].label;
        NotDetected { effect, target, minimum_detectable: minimum, rival_share }
    };
    Ok(search.detectable(found)?.into_iter().map(of).collect())
}
