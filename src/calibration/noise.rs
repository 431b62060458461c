//! The channels' noise, from what a calibration leaves over: a part of its own and one that grows with the reading.

use crate::contact::friction::{Friction, NO_FRICTION};
use crate::contact::inverse::Inverse;
use crate::contact::uncertainty::Noise;
use crate::influence::InfluenceField;
use crate::linear::Factor;
use crate::quantity::{CHANNELS, Contact, Strain};

/// What is known before: as much as so many readings of this noise.
const KNOWN: f64 = 10.0;
const ADDITIVE_UV: f64 = 8.0;
const SHARE: f64 = 0.02;
/// Pads of one kind have the same gauges and amplifiers; their noise is alike to some ten percent, as fifty readings tell.
const KNOWN_OF_KIN: f64 = 50.0;
/// Of a gain that all channels share; known before as if so many contacts had told it.
const GAIN: f64 = 0.006;
const GAIN_KNOWN: f64 = 30.0;
/// How much it changes from one recording to another, which none of them shows: wear, warmth.
const GAIN_BETWEEN: f64 = 0.005;
/// How far the state of a play operator is known from means of a second, as a part of what it keeps at rest: a finger that
/// is not still pushes it further than the mean shows.
const FRICTION_DOUBT: f64 = 0.08;
const FORCE_UV_PER_N: f64 = 1.0;
/// How many parts noise has.
const PARTS: usize = 3;
/// No pad is quieter.
const ADDITIVE_MIN_UV: f64 = 0.5;
const SHARE_MIN: f64 = 5e-4;
/// So often the weights are taken anew.
const ROUNDS: usize = 40;

/// The covariance of the channels, in µV², that comes from what the fitted numbers leave open about a contact.
pub(super) struct Doubt {
    pub(super) place_mm: [f64; 2],
    pub(super) force_n: [f64; 3],
    pub(super) uv2: [[f64; CHANNELS]; CHANNELS],
}

/// The noise before any measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    pub(super) noise: Noise,
    /// As much as so many readings tell.
    readings: f64,
}

impl Known {
    /// Of a pad of which nothing is known.
    pub(super) const SIMULATED: Self = Self {
        noise: Noise {
            gain: GAIN,
            force_uv_per_n: [FORCE_UV_PER_N; CHANNELS],
            ..Noise::of_channels([ADDITIVE_UV; CHANNELS], [SHARE; CHANNELS])
        },
        readings: KNOWN,
    };

    /// Of a pad of the same kind as one with this noise.
    pub(super) const fn of_kin(noise: &Noise) -> Self {
        let Noise { additive_uv, share, force_uv_per_n, gain, .. } = *noise;
        let noise = Noise { force_uv_per_n, gain, ..Noise::of_channels(additive_uv, share) };
        Self { noise, readings: KNOWN_OF_KIN }
    }

    /// Squares of a channel's parts.
    fn parts(&self, channel: usize) -> [f64; PARTS] {
        let Noise { additive_uv, share, force_uv_per_n, .. } = &self.noise;
        [additive_uv, share, force_uv_per_n].map(|deviations| deviations[channel].powi(2))
    }
}

/// What a channel left over.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    /// Its reading.
    pub(super) uv: f64,
    /// The force of the contact.
    pub(super) force_n: f64,
    /// The expected square of what is left over.
    pub(super) square_uv2: f64,
}

/// The noise that these rests have: their squares are a sum of a constant, a part of the square of the reading and one of
/// the square of the force, none of them negative. Squares scatter in proportion to what they should be, so the sum is
/// fitted with weights from itself.
pub(super) fn of_rests(rests: &[Vec<Rest>; CHANNELS], known: &Known) -> Noise {
    let parts: [[f64; PARTS]; CHANNELS] =
        std::array::from_fn(|k| parts(&rests[k], &known.parts(k), known.readings).map(f64::sqrt));
    let mut noise = Noise::of_channels(
        parts.map(|[own, ..]| own.max(ADDITIVE_MIN_UV)),
        parts.map(|[_, share, _]| share.max(SHARE_MIN)),
    );
    noise.force_uv_per_n = parts.map(|[.., force]| force);
    noise
}

/// The noise with that of the zeros, which change by so much from one reading of the untouched pad to the next. All contacts
/// between two readings share their errors, so a calibration takes a part of them for the pad's. What is not known of the
/// friction's states counts like that of the zeros.
pub(super) fn with_zeros(noise: Noise, drift_uv: &[f64; CHANNELS], friction: &Friction) -> Noise {
    let kept_uv = |k: usize| friction.iter().map(|play| play.share[k] * play.threshold_uv[k]).sum::<f64>();
    // A change has the variance of two zeros, and between two zeros two thirds of that of one are left.
    let variance = |k: usize| {
        noise.additive_uv[k].powi(2) + drift_uv[k].powi(2) / 3.0 + (FRICTION_DOUBT * kept_uv(k)).powi(2)
    };
    Noise { additive_uv: std::array::from_fn(|k| variance(k).sqrt()), ..noise }
}

/// The noise with what the field does not know: the mean over these contacts of what it leaves open about each channel, and
/// of what that does to what is decoded.
pub(super) fn with_doubts(field: &InfluenceField, noise: Noise, doubts: &[Doubt]) -> Noise {
    let count = doubts.len().max(1) as f64;
    let channel = |k: usize| {
        let per_n2 = |it: &Doubt| it.uv2[k][k] / square(&it.force_n);
        (doubts.iter().map(per_n2).sum::<f64>() / count).sqrt()
    };
    let noise = Noise { field_uv_per_n: std::array::from_fn(channel), ..noise };
    let decoder = Inverse::new(field.clone(), noise, NO_FRICTION);
    let mut by_field = noise.by_field;
    for Doubt { place_mm, force_n, uv2 } in doubts {
        let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) = (place_mm.map(|mm| mm as f32), force_n.map(|n| n as f32));
        let Some(response) = decoder.response(&Contact { x_mm, y_mm, fx_n, fy_n, fz_n }) else { continue };
        let whole_n = square(force_n).sqrt();
        let scale = [1.0, 1.0, whole_n, whole_n, whole_n];
        for (i, line) in by_field.iter_mut().enumerate() {
            for (j, entry) in line.iter_mut().enumerate() {
                *entry += form(&response[i], uv2, &response[j]) / (scale[i] * scale[j] * count);
            }
        }
    }
    Noise { by_field, ..noise }
}

fn square(force_n: &[f64; 3]) -> f64 {
    force_n.iter().map(|n| n * n).sum()
}

fn form(left: &[f64; CHANNELS], matrix: &[[f64; CHANNELS]; CHANNELS], right: &[f64; CHANNELS]) -> f64 {
    let line = |(left, line): (&f64, &[f64; CHANNELS])| {
        left * line.iter().zip(right).map(|(entry, right)| entry * right).sum::<f64>()
    };
    left.iter().zip(matrix).map(line).sum()
}

/// How much the gain of all channels together changes from contact to contact, as a standard deviation: wear and warmth
/// do that, and channels do not disagree about it. It is what the written forces differ by in their own direction beyond
/// the decoder's noise, in proportion to them; the reference's own noise does not grow with the force.
pub(super) fn common_gain(decoder: &Inverse, contacts: &[(Strain, [f64; 3])], known: &Known) -> f64 {
    let mut normal = [[0.0; 2]; 2];
    let mut right = [0.0; 2];
    for (strain, written_n) in contacts {
        let Some((force_n, off_n, variance)) = off_along_force(decoder, strain, written_n) else { continue };
        let weight = 1.0 / (variance * variance);
        let excess = off_n * off_n - variance;
        for (i, left) in [1.0, force_n * force_n].into_iter().enumerate() {
            normal[i][0] += weight * left;
            normal[i][1] += weight * left * force_n * force_n;
            right[i] += weight * left * excess;
        }
    }
    let constant = |slope: f64| (right[0] - normal[0][1] * slope) / normal[0][0];
    let free = Factor::of(&normal).map_or([0.0; 2], |factor| factor.solve(&right));
    let slope = if constant(free[1]) < 0.0 { right[1] / normal[1][1] } else { free[1] };
    let (count, slope) = (contacts.len() as f64, if slope.is_finite() { slope.max(0.0) } else { 0.0 });
    let within = (count * slope + GAIN_KNOWN * known.noise.gain.powi(2)) / (count + GAIN_KNOWN);
    (within + GAIN_BETWEEN * GAIN_BETWEEN).sqrt()
}

/// The decoded force, how far the written one is from it along it, and the variance of that by the decoder.
fn off_along_force(decoder: &Inverse, strain: &Strain, written_n: &[f64; 3]) -> Option<(f64, f64, f64)> {
    let estimate = decoder.estimate(strain)?;
    let Contact { fx_n, fy_n, fz_n, .. } = estimate.contact;
    let decoded_n = [fx_n, fy_n, fz_n].map(f64::from);
    let force_n = square(&decoded_n).sqrt();
    let along = decoded_n.map(|n| n / force_n);
    let written_n: f64 = along.iter().zip(written_n).map(|(along, n)| along * n).sum();
    let mut variance = 0.0;
    for (i, left) in along.iter().enumerate() {
        for (j, right) in along.iter().enumerate() {
            variance += left * right * estimate.covariance[2 + i][2 + j];
        }
    }
    (variance > 0.0).then_some((force_n, written_n - force_n, variance))
}

/// Squares of the parts; before, they are known as well as so many readings tell.
fn parts(rests: &[Rest], before: &[f64; PARTS], readings: f64) -> [f64; PARTS] {
    let count = rests.len().max(1) as f64;
    let typical = |of: fn(&Rest) -> f64| rests.iter().map(|rest| of(rest).powi(2)).sum::<f64>() / count;
    let (uv2, n2) = (typical(|rest| rest.uv), typical(|rest| rest.force_n));
    let measured = rests.iter().map(|it| ([1.0, it.uv * it.uv, it.force_n * it.force_n], it.square_uv2, 1.0));
    // What was known: half of it at rest, half at a typical reading.
    let known = [[1.0, 0.0, 0.0], [1.0, uv2, n2]];
    let known = known.map(|terms| (terms, sum(&terms, before), readings / 2.0));
    let all: Vec<([f64; PARTS], f64, f64)> = measured.chain(known).collect();
    (0..ROUNDS).fold(*before, |parts, _| improved(&parts, &all))
}

/// A round of D. D. Lee's and H. S. Seung's rule (Nature 401 (1999) 788), under which no part ever becomes negative.
fn improved(parts: &[f64; PARTS], all: &[([f64; PARTS], f64, f64)]) -> [f64; PARTS] {
    let [mut wanted, mut found] = [[0.0; PARTS]; 2];
    for (terms, square, count) in all {
        let expected = sum(terms, parts).max(ADDITIVE_MIN_UV * ADDITIVE_MIN_UV);
        let weight = count / (expected * expected);
        for (k, term) in terms.iter().enumerate() {
            wanted[k] += weight * term * square;
            found[k] += weight * term * expected;
        }
    }
    std::array::from_fn(|k| if found[k] > 0.0 { parts[k] * wanted[k] / found[k] } else { parts[k] })
}

fn sum(terms: &[f64; PARTS], parts: &[f64; PARTS]) -> f64 {
    terms.iter().zip(parts).map(|(term, part)| term * part).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn all_parts_are_found() {
        let mut random = SplitMix64::new(1);
        let mut rest = || {
            let (uv, force_n) = (3000.0 * f64::from(random.uniform()), 5.0 * f64::from(random.fraction()));
            let parts = [12.0, 0.015 * uv, 8.0 * force_n];
            let rest_uv: f64 = parts.iter().map(|part| part * f64::from(random.normal())).sum();
            Rest { uv, force_n, square_uv2: rest_uv * rest_uv }
        };
        let rests: [Vec<Rest>; CHANNELS] = std::array::from_fn(|_| (0..3000).map(|_| rest()).collect());
        let Noise { additive_uv, share, force_uv_per_n, .. } = of_rests(&rests, &Known::SIMULATED);
        assert!(additive_uv.iter().all(|uv| (uv / 12.0 - 1.0).abs() < 0.25), "{additive_uv:?}");
        assert!(share.iter().all(|share| (share / 0.015 - 1.0).abs() < 0.2), "{share:?}");
        assert!(force_uv_per_n.iter().all(|uv| (uv / 8.0 - 1.0).abs() < 0.3), "{force_uv_per_n:?}");
    }

    #[test]
    fn without_rests_it_is_what_was_known() {
        let Noise { additive_uv, share, .. } = of_rests(&[const { Vec::new() }; CHANNELS], &Known::SIMULATED);
        assert!(additive_uv.iter().all(|uv| (uv - ADDITIVE_UV).abs() < 1.0), "{additive_uv:?}");
        assert!(share.iter().all(|share| *share < 0.05), "{share:?}");
    }
}
