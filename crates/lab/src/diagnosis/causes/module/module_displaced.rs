//! A module stands elsewhere under the plate.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Displacement from its place.
pub(crate) struct ModuleDisplaced;

const PARAMETERS: [Parameter; 2] = [
    Parameter::additive("radial_mm", [-5.0, 5.0], 1e-2),
    Parameter::additive("tangential_mm", [-5.0, 5.0], 1e-2),
];

impl Cause for ModuleDisplaced {
    fn effect(&self) -> &'static str {
        "module_displaced"
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
            chain.mechanics.add(setting, &format!("module.{module}.radial_mm"), values[0]);
            chain.mechanics.add(setting, &format!("module.{module}.tangential_mm"), values[1]);
        }
    }
}
