//! The clock of what was written down is behind that of the channels, or ahead of it.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// By how much places and forces are written too late.
pub(crate) struct TimeLag;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("ms", [-2000.0, 2000.0], 1.0)];

impl Cause for TimeLag {
    fn effect(&self) -> &'static str {
        "time_lag"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Contact
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        setting.rig()
    }

    fn missing(&self, setting: &Setting) -> Option<&'static str> {
        (!setting.has_series).then_some("trial")
    }

    fn apply(&self, _: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        chain.rig.lag_s += 1e-3 * values[0];
    }
}
