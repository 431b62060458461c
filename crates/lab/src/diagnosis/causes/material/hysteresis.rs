//! Friction between the pad's parts: on the way down a channel reads more than on the way up.

use crate::diagnosis::causes::cause::{Cause, ChainStage, channels_of, pad_and_channels};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::memory::ChannelFriction;
use crate::diagnosis::model::setting::Setting;
use crate::diagnosis::model::{Parameter, with_shapes};

/// Height of the loop of a full stroke, as a share of full scale. How soon a loop has opened differs from glue to glue: the parts of
/// the play operators are fitted beside the height, and by any parts Prandtl's and Ishlinskii's model has any such loop. Nobody
/// writes from how far above a static load came, so that is fitted, too.
///
/// Source: M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis (1989), section 2.
pub(crate) struct Hysteresis;

const PARAMETERS: [Parameter; 3 + THRESHOLDS.len()] = with_shapes(
    Parameter::additive("share_of_full_scale", [0.0, 0.5], 1e-3),
    [
        ("part_0", 1.0),
        ("part_1", 1.0),
        ("part_2", 1.0),
        ("part_3", 1.0),
        ("part_4", 1.0),
        ("above", 1.0),
        ("full_scale", FULL_SCALE_ERROR),
    ],
);
/// What a height is a share of is the model's full scale, and that is no better known.
const FULL_SCALE_ERROR: f64 = 0.008;
/// As shares of full scale, evenly spread in their logarithm.
const THRESHOLDS: [f64; 5] = [0.01, 0.025, 0.063, 0.158, 0.4];

impl Cause for Hysteresis {
    fn effect(&self) -> &'static str {
        "hysteresis"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Mechanics
    }

    /// One channel's is a gain, or bends it, where all loads come from the same side.
    fn targets(&self, setting: &Setting) -> Vec<Target> {
        if setting.has_both_ways { pad_and_channels(setting) } else { vec![Target::Pad] }
    }

    fn is_individual(&self) -> bool {
        true
    }

    fn apply(&self, target: &Target, values: &[f64], setting: &Setting, chain: &mut Chain) {
        let above = values[1 + THRESHOLDS.len()];
        for channel in channels_of(target, setting) {
            let play = |[threshold, share]: [f64; 2]| ChannelFriction { channel, threshold, share, above };
            chain.memory.plays.extend(plays(values).map(play));
        }
    }
}

/// Thresholds and shares of the play operators that the cause's numbers mean.
pub(crate) fn plays(values: &[f64]) -> impl Iterator<Item = [f64; 2]> {
    let (parts, others) = values[1..].split_at(THRESHOLDS.len());
    let height = values[0] * others[1] / parts.iter().sum::<f64>();
    // A loop is 2 w r high.
    THRESHOLDS
        .into_iter()
        .zip(parts)
        .map(move |(threshold, part)| [threshold, height * part / (2.0 * threshold)])
}
