//! A channel is converted later than the others, or earlier.

use crate::diagnosis::causes::cause::{Cause, ChainStage, each_channel};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// By how much its readings are late.
pub(crate) struct ChannelSkew;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("skew_us", [-1e6, 1e6], 500.0)];

impl Cause for ChannelSkew {
    fn effect(&self) -> &'static str {
        "channel_skew"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Channels
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        setting.each_channel().collect()
    }

    fn missing(&self, setting: &Setting) -> Option<&'static str> {
        (!setting.has_series).then_some("trial")
    }

    fn apply(&self, target: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        each_channel(target, &mut chain.channels.skew_s, 1e-6 * values[0]);
    }
}
