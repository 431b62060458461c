//! The stage does not stand where it says: its zero is not the middle of the pad.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// True minus written place.
pub(crate) struct StageOffset;

const PARAMETERS: [Parameter; 2] =
    [Parameter::additive("x_mm", [-15.0, 15.0], 1e-2), Parameter::additive("y_mm", [-15.0, 15.0], 1e-2)];

impl Cause for StageOffset {
    fn effect(&self) -> &'static str {
        "stage_offset"
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
        chain.rig.offset_mm[0] += values[0];
        chain.rig.offset_mm[1] += values[1];
    }
}
