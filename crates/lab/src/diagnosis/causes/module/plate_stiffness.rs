//! The plate bends less, or more: another thickness, another modulus.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Factor of its bending stiffness.
pub(crate) struct PlateStiffness;

const PARAMETERS: [Parameter; 1] = [Parameter::factor("factor", [0.05, 20.0])];

impl Cause for PlateStiffness {
    fn effect(&self) -> &'static str {
        "plate_stiffness"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Mechanics
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        if setting.has_field { vec![Target::Pad] } else { Vec::new() }
    }

    fn apply(&self, target: &Target, values: &[f64], setting: &Setting, chain: &mut Chain) {
        if *target == Target::Pad {
            chain.mechanics.stiffen(setting, "material.plate.e_mpa", values[0]);
        }
    }
}
