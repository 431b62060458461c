//! A part of one channel's signal appears in another: wires, multiplexer.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Share of the source's signal, after its gain.
pub(crate) struct ChannelCrosstalk;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("share", [-0.9, 0.9], 1e-3)];

impl Cause for ChannelCrosstalk {
    fn effect(&self) -> &'static str {
        "channel_crosstalk"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Channels
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        let between =
            (0..setting.channels).flat_map(|into| (0..setting.channels).map(move |from| (into, from)));
        between
            .filter(|(into, from)| into != from)
            .map(|(into, from)| Target::Channels { into, from })
            .collect()
    }

    fn apply(&self, target: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        if let Target::Channels { into, from } = *target {
            chain.channels.shares.push((into, from, values[0]));
        }
    }
}
