//! Forces act above, or below, the plate's surface: an indenter with a cap, a hinge in the reference.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Height above the surface.
pub(crate) struct ContactHeight;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("mm", [-20.0, 50.0], 1e-2)];

impl Cause for ContactHeight {
    fn effect(&self) -> &'static str {
        "contact_height"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Mechanics
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        setting.rig()
    }

    fn apply(&self, _: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        chain.mechanics.height_mm = values[0];
    }
}
