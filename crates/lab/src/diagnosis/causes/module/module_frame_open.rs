//! The frame of a module is missing on one side, over a part of its area.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Share of the frame's area that is missing, on that side.
pub(crate) struct ModuleFrameOpen;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("area_share", [0.0, 0.5], 1e-3)];

impl Cause for ModuleFrameOpen {
    fn effect(&self) -> &'static str {
        "module_frame_open"
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
            chain.mechanics.open(setting, module, side, values[0]);
        }
    }
}
