//! Glue and film give way slowly: a load that is held reads more and more, or less and less.

use crate::diagnosis::causes::cause::{Cause, ChainStage, channels_of, pad_and_channels};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::memory::{Dwells, Prony};
use crate::diagnosis::model::setting::Setting;
use crate::diagnosis::model::{Parameter, with_shapes};

/// Creep after 20 s, as a share of the load. How it goes differs from glue to glue: the parts of the relaxation times
/// are fitted beside the share.
///
/// Source: J. D. Ferry, Viscoelastic Properties of Polymers (1980), chapter 3 (spectra of relaxation times).
pub(crate) struct Creep;

const PARAMETERS: [Parameter; 1 + TIMES_S.len()] = with_shapes(
    Parameter::additive("share_at_20s", [-0.5, 0.5], 1e-3),
    [("part_0", 1.0), ("part_1", 1.0), ("part_2", 1.0), ("part_3", 1.0), ("part_4", 1.0)],
);
/// Evenly spread in their logarithm, over all that a recording shows.
const TIMES_S: [f64; 5] = [0.5, 2.0, 8.0, 32.0, 128.0];

impl Cause for Creep {
    fn effect(&self) -> &'static str {
        "creep"
    }

    fn parameters(&self, _: &Setting) -> Vec<Parameter> {
        PARAMETERS.to_vec()
    }

    fn stage(&self) -> ChainStage {
        ChainStage::Mechanics
    }

    /// One channel's is a gain where all loads are held equally long.
    fn targets(&self, setting: &Setting) -> Vec<Target> {
        if setting.has_series || setting.dwells == Dwells::Different {
            pad_and_channels(setting)
        } else {
            vec![Target::Pad]
        }
    }

    fn missing(&self, setting: &Setting) -> Option<&'static str> {
        (!setting.has_series && setting.dwells == Dwells::Unknown).then_some("dwell_s")
    }

    fn is_individual(&self) -> bool {
        true
    }

    fn apply(&self, target: &Target, values: &[f64], setting: &Setting, chain: &mut Chain) {
        for channel in channels_of(target, setting) {
            let term = |[time_s, share]: [f64; 2]| Prony { channel, time_s, share };
            chain.memory.prony.extend(terms(values).map(term));
        }
    }
}

/// Relaxation times and shares that the cause's numbers mean.
pub(crate) fn terms(values: &[f64]) -> impl Iterator<Item = [f64; 2]> {
    let whole: f64 = values[1..].iter().sum();
    // Parts are those of what has come after 20 s: c (1 − exp(−20 s/τ)).
    let share = move |time_s: f64, part: f64| values[0] * part / whole / -libm::expm1(-20.0 / time_s);
    TIMES_S.into_iter().zip(&values[1..]).map(move |(time_s, part)| [time_s, share(time_s, *part)])
}
