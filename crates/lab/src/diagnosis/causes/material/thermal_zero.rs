//! Zeros follow the temperature.

use crate::diagnosis::causes::cause::{Cause, ChainStage, each_channel, pad_and_channels};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Slope of the zero, of one channel or of all alike.
pub(crate) struct ThermalZero;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("uv_per_c", [-2e3, 2e3], 0.1)];

impl Cause for ThermalZero {
    fn effect(&self) -> &'static str {
        "thermal_zero"
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
        each_channel(target, &mut chain.channels.zero_per_c, values[0]);
    }
}
