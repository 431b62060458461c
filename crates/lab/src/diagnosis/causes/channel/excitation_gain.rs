//! All channels have one gain: the excitation, or the converter's reference, differs.

use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Measured over modelled signal, of all channels alike.
pub(crate) struct ExcitationGain;

const PARAMETERS: [Parameter; 1] = [Parameter::factor("gain", [0.05, 20.0])];

impl Cause for ExcitationGain {
    fn effect(&self) -> &'static str {
        "excitation_gain"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Channels
    }

    fn targets(&self, _: &Setting) -> Vec<Target> {
        vec![Target::Pad]
    }

    fn apply(&self, _: &Target, values: &[f64], _: &Setting, chain: &mut Chain) {
        chain.channels.gain.iter_mut().for_each(|gain| *gain *= values[0]);
    }
}
