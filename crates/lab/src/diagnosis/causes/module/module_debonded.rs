//! The bond between a module's post and the plate has come off, from one side inwards, over a part of its area.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Share of the bond's area that has come off, from that side.
pub(crate) struct ModuleDebonded;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("area_share", [0.0, 0.8], 1e-3)];

impl Cause for ModuleDebonded {
    fn effect(&self) -> &'static str {
        "module_debonded"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Mechanics
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        setting.each_side()
    }

    fn apply(&self, target: &Target, values: &[f64], setting: &Setting, chain: &mut Chain) {
        if let Target::ModuleSide(module, side) = *target {
            chain.mechanics.debond(setting, module, side, values[0]);
        }
    }
}
