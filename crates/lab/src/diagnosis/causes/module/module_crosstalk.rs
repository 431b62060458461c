//! A module strains another one, axis by axis: through the base, before the channels.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Share of the source's three strains.
pub(crate) struct ModuleCrosstalk;

const PARAMETERS: [Parameter; 1] = [Parameter::additive("share", [-0.9, 0.9], 1e-3)];

impl Cause for ModuleCrosstalk {
    fn effect(&self) -> &'static str {
        "module_crosstalk"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Channels
    }

    fn targets(&self, setting: &Setting) -> Vec<Target> {
        let between =
            (0..setting.modules).flat_map(|into| (0..setting.modules).map(move |from| (into, from)));
        between
            .filter(|(into, from)| into != from)
            .map(|(into, from)| Target::Modules { into, from })
            .collect()
    }

    fn apply(&self, target: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        if let Target::Modules { into, from } = *target {
            let axes = (0..3).map(|axis| (3 * into + axis, 3 * from + axis, values[0]));
            chain.channels.module_shares.extend(axes);
        }
    }
}
