//! The numbers in which a pad may differ, what they do to the channels, and what is known of them before.

use super::contacts::{Maps, Measured, Place};
use crate::device::parameter::Parameter;
use crate::device::unit::Unit;
use crate::quantity::CHANNELS;

/// Degree of the background's polynomials: features of some 10 mm.
pub(super) const BACKGROUND_DEGREE: usize = 5;
/// How many polynomials that are.
pub(super) const TERMS: usize = (BACKGROUND_DEGREE + 1) * (BACKGROUND_DEGREE + 2) / 2;

/// Standard deviations before anything is measured. Gains: the authors' earlier pad has 0.83 to 1.33.
const GAIN: f64 = 0.3;
/// Assembled by hand.
const SHIFT_MM: f64 = 0.3;
const TURN_DEG: f64 = 2.0;
/// Of a modulus.
const STIFFNESS: f64 = 0.3;
/// Of the other channel's microvolts.
const CROSSTALK: f64 = 0.02;
/// What is left of a zero that was taken off.
const ZERO_UV: f64 = 20.0;

/// The numbers by kind, one after the other in a vector: zeros, gains, crosstalk (into, from), physical numbers, background
/// (channel, force, polynomial).
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) physical: Vec<Parameter>,
}

const ZEROS: usize = 0;
const GAINS: usize = ZEROS + CHANNELS;
const CROSSTALKS: usize = GAINS + CHANNELS;
const PHYSICAL: usize = CROSSTALKS + CHANNELS * CHANNELS;

impl Layout {
    pub(super) const fn size(&self) -> usize {
        self.background(0, 0) + 3 * CHANNELS * TERMS
    }

    const fn background(&self, channel: usize, axis: usize) -> usize {
        PHYSICAL + self.physical.len() + (3 * channel + axis) * TERMS
    }

    /// The nominal pad.
    pub(super) fn nominal(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.size()];
        values[GAINS..GAINS + CHANNELS].fill(1.0);
        values
    }

    /// One over the variances before anything is measured. `background` is the standard deviation of the field's smooth
    /// error, as a share of each map's root mean square `scale`; zero: no background.
    pub(super) fn precisions(&self, background: f64) -> Vec<f64> {
        let mut deviations = vec![0.0; self.size()];
        deviations[ZEROS..GAINS].fill(ZERO_UV);
        deviations[GAINS..CROSSTALKS].fill(GAIN);
        for (index, deviation) in deviations[CROSSTALKS..PHYSICAL].iter_mut().enumerate() {
            *deviation = if index / CHANNELS == index % CHANNELS { 0.0 } else { CROSSTALK };
        }
        for (deviation, parameter) in deviations[PHYSICAL..].iter_mut().zip(&self.physical) {
            *deviation = match parameter.unit() {
                Unit::Millimetre => SHIFT_MM,
                Unit::Degree => TURN_DEG,
                _ => STIFFNESS,
            };
        }
        let shares: Vec<f64> =
            (0..=BACKGROUND_DEGREE).flat_map(|n| std::iter::repeat_n(share(n), n + 1)).collect();
        for terms in deviations[self.background(0, 0)..].chunks_exact_mut(TERMS) {
            terms.iter_mut().zip(&shares).for_each(|(deviation, share)| *deviation = background * share);
        }
        // What cannot differ is held so firmly that no measurement moves it.
        deviations.iter().map(|deviation| 1.0 / deviation.max(1e-9).powi(2)).collect()
    }

    pub(super) fn gain(values: &[f64], channel: usize) -> f64 {
        values[GAINS + channel]
    }

    /// µV/N of the strains at a place, before gains: the simulator's field and what differs.
    fn strained(&self, values: &[f64], scale: &Maps, place: &Place) -> Maps {
        let mut maps = place.gains;
        for (value, slope) in values[PHYSICAL..].iter().zip(&place.slopes) {
            for (map, slope) in maps.as_flattened_mut().iter_mut().zip(slope.as_flattened()) {
                *map += value * slope;
            }
        }
        let background = values[self.background(0, 0)..].chunks_exact(TERMS);
        for ((map, scale), terms) in
            maps.as_flattened_mut().iter_mut().zip(scale.as_flattened()).zip(background)
        {
            *map += scale * terms.iter().zip(&place.terms).map(|(value, term)| value * term).sum::<f64>();
        }
        maps
    }

    /// µV/N of the channels at a place.
    pub(super) fn maps(&self, values: &[f64], scale: &Maps, place: &Place) -> Maps {
        let strained = self.strained(values, scale, place);
        std::array::from_fn(|into| {
            std::array::from_fn(|axis| {
                let own = Self::gain(values, into) * strained[into][axis];
                let others = &values[CROSSTALKS + into * CHANNELS..][..CHANNELS];
                own + others.iter().zip(&strained).map(|(share, from)| share * from[axis]).sum::<f64>()
            })
        })
    }

    /// What the channels read at a contact, and how each reading changes with each number: (channel, µV, slopes).
    pub(super) fn readings(
        &self,
        values: &[f64],
        scale: &Maps,
        contact: &Measured,
        mut each: impl FnMut(usize, f64, &[f64]),
    ) {
        let Measured { place, force_n, .. } = contact;
        let strained = self.strained(values, scale, place);
        let strains_uv = strained.map(|map| loaded(&map, force_n));
        let mut slopes = vec![0.0; self.size()];
        for channel in 0..CHANNELS {
            slopes.fill(0.0);
            let gain = Self::gain(values, channel);
            let shares = &values[CROSSTALKS + channel * CHANNELS..][..CHANNELS];
            let crosstalk_uv: f64 = shares.iter().zip(strains_uv).map(|(share, uv)| share * uv).sum();
            slopes[ZEROS + channel] = 1.0;
            slopes[GAINS + channel] = strains_uv[channel];
            slopes[CROSSTALKS + channel * CHANNELS..][..CHANNELS].copy_from_slice(&strains_uv);
            slopes[CROSSTALKS + channel * CHANNELS + channel] = 0.0;
            for (slope, maps) in slopes[PHYSICAL..].iter_mut().zip(&place.slopes) {
                *slope = gain * loaded(&maps[channel], force_n);
            }
            for axis in 0..3 {
                let factor = gain * scale[channel][axis] * force_n[axis];
                let terms = slopes[self.background(channel, axis)..].iter_mut().zip(&place.terms);
                terms.for_each(|(slope, term)| *slope = factor * term);
            }
            each(channel, values[ZEROS + channel] + gain * strains_uv[channel] + crosstalk_uv, &slopes);
        }
    }
}

/// A background of degree n has this share of the whole: smooth, so less of what is finer; together 1.
fn share(n: usize) -> f64 {
    let size = |n: usize| 1.0 / (1 + n) as f64;
    let whole: f64 = (0..=BACKGROUND_DEGREE).map(|n| (n + 1) as f64 * size(n).powi(2)).sum();
    size(n) / whole.sqrt()
}

fn loaded(map: &[f64; 3], force_n: &[f64; 3]) -> f64 {
    map.iter().zip(force_n).map(|(map, n)| map * n).sum()
}
