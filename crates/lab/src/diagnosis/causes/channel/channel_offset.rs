//! A channel's zero is not zero: the bridge is out of balance.

use crate::diagnosis::causes::cause::{Cause, ChainStage, each_channel};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Zero of the untouched channel.
pub(crate) struct ChannelOffset;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("offset_uv", [-1e6, 1e6], 1.0)];

impl Cause for ChannelOffset {
    fn effect(&self) -> &'static str {
        "channel_offset"
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

    fn apply(&self, target: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        each_channel(target, &mut chain.channels.offset, values[0]);
    }
}
