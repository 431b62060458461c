//! A module stands askew under the plate.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Turns about its tangential and its radial axis, right-handed.
pub(crate) struct ModuleTilted;

const PARAMETERS: [Parameter; 2] = [
    Parameter::additive("tangential_deg", [-10.0, 10.0], 1e-2),
    Parameter::additive("radial_deg", [-10.0, 10.0], 1e-2),
];

impl Cause for ModuleTilted {
    fn effect(&self) -> &'static str {
        "module_tilted"
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
            chain.mechanics.add(setting, &format!("module.{module}.tilt_tangential_deg"), values[0]);
            chain.mechanics.add(setting, &format!("module.{module}.tilt_radial_deg"), values[1]);
        }
    }
}
