//! Zeros drift evenly in time.

use crate::diagnosis::causes::cause::{Cause, ChainStage, each_channel, pad_and_channels};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Slope of the zero, of one channel or of all alike.
pub(crate) struct ZeroDrift;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("uv_per_h", [-1e5, 1e5], 1.0)];

impl Cause for ZeroDrift {
    fn effect(&self) -> &'static str {
        "zero_drift"
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
        (!setting.has_time).then_some("t_s")
    }
    fn is_individual(&self) -> bool {
        true
    }

    fn apply(&self, target: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        each_channel(target, &mut chain.channels.drift_per_h, values[0]);
    }
}
