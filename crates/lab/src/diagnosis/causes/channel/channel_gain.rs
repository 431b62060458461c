//! A channel's sensitivity differs: gauge factor, glue, amplifier.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Measured over modelled signal.
pub(crate) struct ChannelGain;

const PARAMETERS: [Parameter; 1] = [Parameter::factor("gain", [0.05, 20.0])];

impl Cause for ChannelGain {
    fn effect(&self) -> &'static str {
        "channel_gain"
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

    fn is_individual(&self) -> bool {
        true
    }

    fn apply(&self, target: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        if let Target::Channel(channel) = *target {
            chain.channels.gain[channel] *= values[0];
        }
    }
}
