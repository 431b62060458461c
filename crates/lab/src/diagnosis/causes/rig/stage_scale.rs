//! The stage moves farther, or less far, than it says.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// True over written distance.
pub(crate) struct StageScale;

const PARAMETERS: [Parameter; 1] = [Parameter::factor("scale", [0.2, 5.0])];

impl Cause for StageScale {
    fn effect(&self) -> &'static str {
        "stage_scale"
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
        chain.rig.scale *= values[0];
    }
}
