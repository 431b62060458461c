//! A module gives way more, or less: the modulus of its frame differs.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Factor of the frame's modulus.
pub(crate) struct ModuleStiffness;

const PARAMETERS: [Parameter; 1] = [Parameter::factor("factor", [0.02, 10.0])];

impl Cause for ModuleStiffness {
    fn effect(&self) -> &'static str {
        "module_stiffness"
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
            chain.mechanics.stiffen(setting, &format!("module.{module}.frame_e_factor"), values[0]);
        }
    }
}
