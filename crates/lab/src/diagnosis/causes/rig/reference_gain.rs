//! The force sensor of the rig has a wrong gain.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Written over true force.
pub(crate) struct ReferenceGain;

const PARAMETERS: [Parameter; 1] = [Parameter::factor("gain", [0.1, 10.0])];

impl Cause for ReferenceGain {
    fn effect(&self) -> &'static str {
        "reference_gain"
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

    fn apply(&self, _: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        chain.rig.gain *= values[0];
    }
}
