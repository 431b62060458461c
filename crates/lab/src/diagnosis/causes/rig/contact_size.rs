//! The load is spread over another patch than the model's: an indenter of another size, a soft finger.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;
use crate::diagnosis::model::{Coordinate, Parameter};

/// Radius of the disc on which the load lies evenly.
pub(crate) struct ContactSize;

/// Larger ones would reach over the modules.
const RADIUS_MAX_MM: f64 = 15.0;

impl Cause for ContactSize {
    fn effect(&self) -> &'static str {
        "contact_size"
    }

    fn parameters(&self, setting: &Setting) -> Vec<Parameter> {
        let none = setting.patch_radius_mm;
        let range = [1e-3, RADIUS_MAX_MM.max(2.0 * none)];
        vec![Parameter {
            name: "radius_mm",
            none,
            range,
            step: 0.05 * none * none,
            coordinate: Coordinate::Square,
            shape: None,
        }]
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Mechanics
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        setting.rig()
    }

    fn apply(&self, _: &Target, values: &[f64], setting: &Setting, chain: &mut Chain) {
        // R² − R₀².
        chain.mechanics.patch_mm2 = values[0] * values[0] - setting.patch_radius_mm * setting.patch_radius_mm;
    }
}
