//! From strains to readings, row by row, of any number of channels: what they remember, and the law of the channels.

use super::chain::{Chain, Reference};
use super::memory::RowSequence;
use tactpad_inference::hypothesis::Parameter;
use tactpad_inference::model::Signature;
use tactpad_inference::observations::Sample;

/// Readings that change by less than this part of the largest reading do not change.
const NOTHING: f64 = 1e-9;

/// The strains of rows that follow each other so, with what the channels remember of them.
pub(crate) fn remembered<R: AsRef<[f64]> + AsMut<[f64]>>(
    mut strains: Vec<R>,
    chain: &Chain,
    course: &RowSequence,
    full_scale: &[f64],
) -> Vec<R> {
    for (channel, full_scale) in full_scale.iter().enumerate() {
        let own: Vec<f64> = strains.iter().map(|strain| strain.as_ref()[channel]).collect();
        let added = chain.memory.added(course, channel, *full_scale, &own, 0.0).unwrap_or_default();
        strains.iter_mut().zip(added).for_each(|(strain, added)| strain.as_mut()[channel] += added);
    }
    strains
}

/// Readings of the channels at strains with their memory, channel by channel.
pub(crate) fn read<R: AsRef<[f64]>>(
    strains: &[R],
    chain: &Chain,
    course: &RowSequence,
    reference: &Reference,
    samples: &[Sample],
) -> Vec<Vec<f64>> {
    let mut channels = vec![Vec::with_capacity(strains.len()); reference.full_scale.len()];
    for (strain, sample) in strains.iter().zip(samples) {
        let mut row = strain.as_ref().to_vec();
        chain.channels.read(&mut row, &reference.conditions(sample));
        channels.iter_mut().zip(row).for_each(|(channel, value)| channel.push(value));
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
