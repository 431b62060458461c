//! The force sensor of the rig stands askew.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Turns about x and y, right-handed, from true to written force.
pub(crate) struct ReferenceTilt;

const PARAMETERS: [Parameter; 2] =
    [Parameter::additive("x_deg", [-45.0, 45.0], 0.01), Parameter::additive("y_deg", [-45.0, 45.0], 0.01)];

impl Cause for ReferenceTilt {
    fn effect(&self) -> &'static str {
        "reference_tilt"
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
        chain.rig.tilt_deg[0] += values[0];
        chain.rig.tilt_deg[1] += values[1];
    }
}
