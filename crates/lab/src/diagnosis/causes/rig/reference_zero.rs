//! The force sensor of the rig has a zero of its own.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Written minus true force.
pub(crate) struct ReferenceZero;

const PARAMETERS: [Parameter; 3] = [
    Parameter::additive("fx_n", [-20.0, 20.0], 1e-3),
    Parameter::additive("fy_n", [-20.0, 20.0], 1e-3),
    Parameter::additive("fz_n", [-20.0, 20.0], 1e-3),
];

impl Cause for ReferenceZero {
    fn effect(&self) -> &'static str {
        "reference_zero"
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
        chain.rig.zero_n.iter_mut().zip(values).for_each(|(zero_n, by_n)| *zero_n += by_n);
    }
}
