//! The numbers in which a pad may differ, what they do to the channels, and what is known of them before.

use super::before::Before;
use super::contacts::{BACKGROUND_DEGREE, Maps, Measured, Place, TERMS};
use super::spread::{Kind, Spread};
use crate::contact::creep::{Creep, NO_CREEP};
use crate::contact::friction::{Friction, PLAYS, Play};
use crate::contact::recording::Lags;
use crate::contact::uncertainty::UNKNOWNS;
use crate::device::parameter::Parameter;
use crate::quantity::CHANNELS;

/// Standard deviations before anything is measured. Gains: the authors' earlier pad has 0.83 to 1.33.
const GAIN: f64 = 0.3;
/// Half the mean square of the distance at which a contact's force acts from its place, along each axis: an indenter of
/// another size, or a finger that is not still.
const BLUR_MM2: f64 = 0.5;
/// Of a play operator in all channels.
const FRICTION: f64 = 0.05;
/// Of what creeps in the end, as a share of a load: adhesive and polyimide.
const CREEP_SHARE: f64 = 0.01;
/// Of a gain, per degree: adhesive and polyimide soften by a thousandth.
const GAIN_PER_C: f64 = 1e-3;
/// No play operator has a larger share. A negative one corrects another.
const SHARE_MAX: f64 = 0.25;

/// The numbers by kind, one after the other in a vector: zeros, gains, crosstalk (into, from), friction (shares of all
/// channels; what each channel differs by), creep, blur, changes of the gains by temperature, physical numbers, background
/// (channel, force, polynomial).
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) physical: Vec<Parameter>,
    /// Polynomials of the background for each channel and force: 0 or [`TERMS`].
    pub(super) terms: usize,
}

const ZEROS: usize = 0;
const GAINS: usize = ZEROS + CHANNELS;
const CROSSTALKS: usize = GAINS + CHANNELS;
const SHARES: usize = CROSSTALKS + CHANNELS * CHANNELS;
const OWN_SHARES: usize = SHARES + PLAYS;
const CREEP: usize = OWN_SHARES + PLAYS * CHANNELS;
const BLUR: usize = CREEP + 1;
const WARMTH: usize = BLUR + 1;
const PHYSICAL: usize = WARMTH + CHANNELS;

impl Layout {
    pub(super) const fn size(&self) -> usize {
        self.background(0, 0) + 3 * CHANNELS * self.terms
    }

    const fn background(&self, channel: usize, axis: usize) -> usize {
        PHYSICAL + self.physical.len() + (3 * channel + axis) * self.terms
    }

    /// The numbers of a pad of which no more is known.
    pub(super) fn before(&self, before: &Before) -> Vec<f64> {
        let mut values = vec![0.0; self.size()];
        values[GAINS..CROSSTALKS].copy_from_slice(&before.gain);
        for (play, shares) in before.shares.iter().enumerate() {
            values[SHARES + play] = shares.iter().sum::<f64>() / CHANNELS as f64;
            for (channel, share) in shares.iter().enumerate() {
                values[OWN_SHARES + play * CHANNELS + channel] = share - values[SHARES + play];
            }
        }
        values[CREEP] = before.creep.share;
        values
    }

    /// One over the variances before anything is measured. `background` is the standard deviation of the field's smooth
    /// error, as a share of each map's root mean square `scale`; zero: no background.
    pub(super) fn precisions(&self, background: f64, spread: &Spread) -> Vec<f64> {
        let mut deviations = vec![0.0; self.size()];
        deviations[ZEROS..GAINS].fill(spread.of(Kind::Zero));
        deviations[GAINS..CROSSTALKS].fill(GAIN);
        for (index, deviation) in deviations[CROSSTALKS..SHARES].iter_mut().enumerate() {
            *deviation = if index / CHANNELS == index % CHANNELS { 0.0 } else { spread.of(Kind::Crosstalk) };
        }
        deviations[SHARES..OWN_SHARES].fill(FRICTION);
        deviations[OWN_SHARES..CREEP].fill(spread.of(Kind::OwnFriction));
        deviations[CREEP] = CREEP_SHARE;
        deviations[BLUR] = BLUR_MM2;
        deviations[WARMTH..PHYSICAL].fill(GAIN_PER_C);
        for (deviation, parameter) in deviations[PHYSICAL..].iter_mut().zip(&self.physical) {
            *deviation = spread.of(Kind::of(*parameter));
        }
        let shares: Vec<f64> =
            (0..=BACKGROUND_DEGREE).flat_map(|n| std::iter::repeat_n(share(n), n + 1)).collect();
        for terms in deviations[self.background(0, 0)..].chunks_exact_mut(TERMS) {
            terms.iter_mut().zip(&shares).for_each(|(deviation, share)| *deviation = background * share);
        }
        // What cannot differ is held so firmly that no measurement moves it.
        deviations.iter().map(|deviation| 1.0 / deviation.max(1e-9).powi(2)).collect()
    }

    /// Where the numbers stand that are of a kind with others.
    pub(super) fn kinds(&self) -> impl Iterator<Item = (Kind, usize)> {
        let between = (0..CHANNELS * CHANNELS).filter(|index| index / CHANNELS != index % CHANNELS);
        let physical = self.physical.iter().zip(PHYSICAL..).map(|(it, at)| (Kind::of(*it), at));
        let own = (OWN_SHARES..CREEP).map(|at| (Kind::OwnFriction, at));
        let zeros = (ZEROS..GAINS).map(|at| (Kind::Zero, at));
        zeros.chain(between.map(|index| (Kind::Crosstalk, CROSSTALKS + index))).chain(own).chain(physical)
    }

    pub(super) fn gain(values: &[f64], channel: usize) -> f64 {
        values[GAINS + channel]
    }

    /// The friction of these numbers, if its play operators have these thresholds in strains, before gains.
    pub(super) fn friction(values: &[f64], thresholds_uv: &[f64; PLAYS]) -> Friction {
        std::array::from_fn(|play| Play {
            threshold_uv: std::array::from_fn(|k| thresholds_uv[play] * Self::gain(values, k).abs()),
            share: std::array::from_fn(|k| Self::share(values, play, k).clamp(-SHARE_MAX, SHARE_MAX)),
        })
    }

    /// How much the channels creep by these numbers.
    pub(super) fn creep(values: &[f64], time_s: f64) -> Creep {
        if time_s == 0.0 {
            return NO_CREEP;
        }
        Creep { time_s, share: values[CREEP].clamp(-SHARE_MAX, SHARE_MAX) }
    }

    fn share(values: &[f64], play: usize, channel: usize) -> f64 {
        values[SHARES + play] + values[OWN_SHARES + play * CHANNELS + channel]
    }

    /// What the past adds to a channel, and how that changes with the numbers of friction and creep, which are set in
    /// `slopes`.
    pub(super) fn remembered(
        values: &[f64],
        channel: usize,
        lags: &Lags,
        crept_uv: &[f64; CHANNELS],
        slopes: &mut [f64],
    ) -> f64 {
        slopes[CREEP] = crept_uv[channel];
        let mut uv = values[CREEP] * crept_uv[channel];
        for (play, lags) in lags.iter().enumerate() {
            slopes[SHARES + play] = lags[channel];
            slopes[OWN_SHARES + play * CHANNELS + channel] = lags[channel];
            uv += Self::share(values, play, channel) * lags[channel];
        }
        uv
    }

    /// What is left of the zeros.
    pub(super) fn zeros(values: &[f64]) -> [f64; CHANNELS] {
        std::array::from_fn(|channel| values[ZEROS + channel])
    }

    /// Where the gains' changes by temperature begin, per degree.
    pub(super) const fn first_warmth() -> usize {
        WARMTH
    }

    /// Where the physical numbers begin.
    pub(super) const fn first_physical() -> usize {
        PHYSICAL
    }

    /// µV/N of the strains at a place, before gains: the simulator's field and what differs.
    fn strained(&self, values: &[f64], scale: &Maps, place: &Place) -> Maps {
        let mut maps = place.gains;
        for (map, bent) in maps.as_flattened_mut().iter_mut().zip(place.bent.as_flattened()) {
            *map += values[BLUR] * bent;
        }
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

    /// What a contact does to the channels but for friction and creep, beyond their zeros.
    pub(super) fn loaded_uv(&self, values: &[f64], scale: &Maps, contact: &Measured) -> [f64; CHANNELS] {
        self.maps(values, scale, &contact.place).map(|map| loaded(&map, &contact.force_n))
    }

    /// How the channels change with x, y, Fx, Fy, Fz; with the place, as on the simulated pad.
    pub(super) fn slopes(
        &self,
        values: &[f64],
        scale: &Maps,
        contact: &Measured,
    ) -> [[f64; UNKNOWNS]; CHANNELS] {
        let maps = self.maps(values, scale, &contact.place);
        let along = |channel: usize, axis: usize| {
            Self::gain(values, channel) * loaded(&contact.place.along[axis][channel], &contact.force_n)
        };
        std::array::from_fn(|channel| {
            let [fx, fy, fz] = maps[channel];
            [along(channel, 0), along(channel, 1), fx, fy, fz]
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
        let Measured { place, force_n, lags, crept_uv, above_c, .. } = contact;
        let strained = self.strained(values, scale, place);
        let strains_uv = strained.map(|map| loaded(&map, force_n));
        let mut slopes = vec![0.0; self.size()];
        for channel in 0..CHANNELS {
            slopes.fill(0.0);
            let warmed = 1.0 + values[WARMTH + channel] * above_c;
            let gain = warmed * Self::gain(values, channel);
            let shares = &values[CROSSTALKS + channel * CHANNELS..][..CHANNELS];
            let crosstalk_uv: f64 = shares.iter().zip(strains_uv).map(|(share, uv)| share * uv).sum();
            slopes[ZEROS + channel] = 1.0;
            slopes[GAINS + channel] = warmed * strains_uv[channel];
            slopes[WARMTH + channel] = above_c * Self::gain(values, channel) * strains_uv[channel];
            slopes[CROSSTALKS + channel * CHANNELS..][..CHANNELS].copy_from_slice(&strains_uv);
            slopes[CROSSTALKS + channel * CHANNELS + channel] = 0.0;
            slopes[BLUR] = gain * loaded(&place.bent[channel], force_n);
            for (slope, maps) in slopes[PHYSICAL..].iter_mut().zip(&place.slopes) {
                *slope = gain * loaded(&maps[channel], force_n);
            }
            for axis in 0..3 {
                let factor = gain * scale[channel][axis] * force_n[axis];
                let terms = slopes[self.background(channel, axis)..].iter_mut().zip(&place.terms);
                terms.for_each(|(slope, term)| *slope = factor * term);
            }
            let remembered_uv = Self::remembered(values, channel, lags, crept_uv, &mut slopes);
            let uv = values[ZEROS + channel] + gain * strains_uv[channel] + crosstalk_uv + remembered_uv;
            each(channel, uv, &slopes);
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
