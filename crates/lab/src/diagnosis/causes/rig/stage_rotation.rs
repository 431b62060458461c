//! The stage is turned against the pad.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// From written to true place, counter-clockwise.
pub(crate) struct StageRotation;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("deg", [-180.0, 180.0], 0.01)];

impl Cause for StageRotation {
    fn effect(&self) -> &'static str {
        "stage_rotation"
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
        chain.rig.rotation_deg += values[0];
    }
}
