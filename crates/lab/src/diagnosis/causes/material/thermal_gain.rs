//! Gains follow the temperature: moduli of polymers, gauge factor.

use crate::diagnosis::causes::cause::{Cause, ChainStage, each_channel, pad_and_channels};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Relative change of the gain, of one channel or of all alike.
pub(crate) struct ThermalGain;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("per_c", [-0.05, 0.05], 1e-4)];

impl Cause for ThermalGain {
    fn effect(&self) -> &'static str {
        "thermal_gain"
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
        (!setting.has_temperature).then_some("temp_c")
    }
    fn is_individual(&self) -> bool {
        true
    }

    fn apply(&self, target: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        each_channel(target, &mut chain.channels.gain_per_c, values[0]);
    }
}
