//! Strains become smaller with the cycles of load: glue and film tire.

use crate::diagnosis::causes::cause::{Cause, ChainStage, each_channel, pad_and_channels};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Loss at the end of the measurement, of one channel or of all alike.
pub(crate) struct Ageing;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("share_at_end", [-0.9, 0.9], 1e-3)];

impl Cause for Ageing {
    fn effect(&self) -> &'static str {
        "ageing"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Channels
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        pad_and_channels(setting)
    }

    fn missing(&self, setting: &Setting) -> Option<&'static str> {
        (!setting.has_cycles).then_some("cycle")
    }
    fn is_individual(&self) -> bool {
        true
    }

    fn apply(&self, target: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        each_channel(target, &mut chain.channels.loss, values[0]);
    }
}
