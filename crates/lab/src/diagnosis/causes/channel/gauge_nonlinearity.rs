//! A channel bends: at full scale it reads more, or less, than its slope at rest promises.

use crate::diagnosis::causes::cause::{Cause, ChainStage, each_channel};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// The deviation at full scale, as a share of it; full scale is the channel's largest modelled reading.
pub(crate) struct GaugeNonlinearity;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("second_order_percent_fs", [-50.0, 50.0], 0.1)];

impl Cause for GaugeNonlinearity {
    fn effect(&self) -> &'static str {
        "gauge_nonlinearity"
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
        each_channel(target, &mut chain.channels.second_order, 0.01 * values[0]);
    }
}
