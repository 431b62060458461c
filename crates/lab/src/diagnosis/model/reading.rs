//! From strains to readings, row by row, of any number of channels: what they remember, and the law of the channels.

use super::chain::{Chain, Reference};
use super::memory::{MemoryChain, RowSequence};
use tactpad_inference::hypothesis::Parameter;
use tactpad_inference::model::Signature;
use tactpad_inference::observations::Sample;

/// Readings that change by less than this part of the largest reading do not change.
const NOTHING: f64 = 1e-9;

/// Strains of rows that follow each other so, and the same with what the channels remember of them.
pub(crate) struct StrainHistory<R> {
    pub(crate) strains: Vec<R>,
    memory: MemoryChain,
    pub(crate) remembered: Vec<R>,
}

impl<R: AsRef<[f64]> + AsMut<[f64]> + Clone> StrainHistory<R> {
    /// A channel whose strains and memory are those of a history `near` it is taken from there.
    pub(crate) fn of(
        strains: Vec<R>,
        chain: &Chain,
        course: &RowSequence,
        full_scale: &[f64],
        near: Option<&Self>,
    ) -> Self {
        let mut remembered = strains.clone();
        for (channel, full_scale) in full_scale.iter().enumerate() {
            let own = |of: &[R]| of.iter().map(|strain| strain.as_ref()[channel]).collect::<Vec<f64>>();
            let is_same = |near: &&Self| {
                chain.memory.is_same(&near.memory, channel) && own(&strains) == own(&near.strains)
            };
            let values = match near.filter(is_same) {
                Some(near) => own(&near.remembered),
                None => {
                    let strains = own(&strains);
                    let Some(added) = chain.memory.added(course, channel, *full_scale, &strains, 0.0) else {
                        continue;
                    };
                    strains.iter().zip(added).map(|(strain, added)| strain + added).collect()
                }
            };
            remembered.iter_mut().zip(values).for_each(|(strain, value)| strain.as_mut()[channel] = value);
        }
        Self { strains, memory: chain.memory.clone(), remembered }
    }
}

/// Readings of the channels at strains with their memory, channel by channel.
pub(crate) fn read<R: AsRef<[f64]> + AsMut<[f64]> + Clone>(
    strains: &[R],
    chain: &Chain,
    course: &RowSequence,
    reference: &Reference,
    samples: &[Sample],
) -> Vec<Vec<f64>> {
    let mut channels = vec![Vec::with_capacity(strains.len()); reference.full_scale.len()];
    for (strain, sample) in strains.iter().zip(samples) {
        let mut row = strain.clone();
        chain.channels.read(row.as_mut(), &reference.conditions(sample));
        channels.iter_mut().zip(row.as_ref()).for_each(|(channel, value)| channel.push(*value));
    }
    let late = channels.iter_mut().zip(&chain.skew_s).filter(|(_, skew_s)| **skew_s != 0.0);
    for (channel, skew_s) in late {
        let then = |row: usize| course.moment(row, -skew_s).of(|row| channel[row]);
        *channel = (0..channel.len()).map(then).collect();
    }
    channels
}

/// ∂readings/∂ψ by a coordinate, where `moved` has the readings with so much of it beyond `readings`: a central difference, or one upwards
/// where the number cannot be below none.
pub(crate) fn slopes(
    parameter: &Parameter,
    readings: &[Vec<f64>],
    moved: impl Fn(f64) -> Vec<Vec<f64>>,
    full_scale: &[f64],
) -> Signature {
    let (step, is_one_sided) = (parameter.step, parameter.is_one_sided());
    let above = moved(step);
    let below = if is_one_sided { readings } else { &moved(-step) };
    let width = if is_one_sided { step } else { 2.0 * step };
    let channels = above.into_iter().zip(below).zip(full_scale);
    channels
        .map(|((above, below), full_scale)| {
            let slopes: Vec<f64> = above.iter().zip(below).map(|(a, b)| (a - b) / width).collect();
            slopes.iter().any(|slope| (slope * step).abs() > NOTHING * full_scale).then_some(slopes)
        })
        .collect()
}
