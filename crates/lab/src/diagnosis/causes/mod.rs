//! The catalogue of causes: one row of [`CATALOGUE`](catalogue::CATALOGUE) each, with its physics, numbers, bounds, and what data it needs.
//!
//! A cause says how it changes the [`Chain`](super::model::chain::Chain); derivatives and refits follow from that.

pub(crate) mod catalogue;
pub(crate) mod cause;
pub(crate) mod memory;

use self::catalogue::CATALOGUE;
use self::cause::{Cause, ChainStage};
use super::data::target::Target;
use super::label::Hypothesis;
use super::model::setting::Setting;
use super::report::NotTestable;
use crate::effect::Effect;
use tactpad_inference::policy::SIGNATURE_ERROR;

/// The hypotheses of the catalogue that can be asked for, each with its cause.
pub(crate) fn hypotheses(
    setting: &Setting,
    asks_for: impl Fn(Effect) -> bool,
) -> (Vec<Hypothesis>, Vec<&'static Cause>) {
    let is_asked = |cause: &&Cause| asks_for(cause.effect) && cause.missing(setting).is_none();
    let of_cause = |cause: &'static Cause| {
        cause.targets(setting).into_iter().map(move |target| (hypothesis(cause, target, setting), cause))
    };
    CATALOGUE.iter().filter(is_asked).flat_map(of_cause).unzip()
}

fn hypothesis(cause: &Cause, target: Target, setting: &Setting) -> Hypothesis {
    Hypothesis {
        zero_of: match (cause.effect, target) {
            (Effect::ChannelOffset, Target::Channel(channel)) => Some(channel),
            _ => None,
        },
        label: (cause.effect, target),
        parameters: cause.parameters(setting),
        signature_error: match cause.stage {
            ChainStage::Contact | ChainStage::Mechanics => SIGNATURE_ERROR,
            ChainStage::Coupling | ChainStage::Channels => 0.0,
        },
        prior_deviation: if target == Target::Pad { cause.prior_deviation } else { 0.0 },
    }
}

/// The causes of the catalogue that cannot be asked for, and what is missing.
pub(crate) fn missing(setting: &Setting) -> Vec<NotTestable> {
    let missing = CATALOGUE.iter().filter_map(|cause| Some((cause.effect, cause.missing(setting)?)));
    missing.map(|(effect, needs)| NotTestable { effect, needs }).collect()
}
