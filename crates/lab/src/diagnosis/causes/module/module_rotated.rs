//! A module is turned about its own axis.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Turn, counter-clockwise seen from above.
pub(crate) struct ModuleRotated;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("deg", [-30.0, 30.0], 1e-2)];

impl Cause for ModuleRotated {
    fn effect(&self) -> &'static str {
        "module_rotated"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Mechanics
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        setting.each_module().collect()
    }

    fn apply(&self, target: &Target, values: &[f64], setting: &Setting, chain: &mut Chain) {
        if let Target::Module(module) = *target {
            chain.mechanics.add(setting, &format!("module.{module}.rotation_deg"), values[0]);
        }
    }
}
