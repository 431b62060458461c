//! The plate bends less, or more: another thickness, another modulus.

use crate::diagnosis::cause::{Cause, Stage};
use crate::diagnosis::chain::Chain;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::setting::Setting;
use crate::diagnosis::target::Target;

/// Factor of its bending stiffness.
pub(super) struct PlateStiffness;

const PARAMETERS: [Parameter; 1] = [Parameter::factor("factor", [0.05, 20.0])];

impl Cause for PlateStiffness {
    fn effect(&self) -> &'static str {
        "plate_stiffness"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> Stage {
        Stage::Mechanics
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
