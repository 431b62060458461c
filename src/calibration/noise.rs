//! The channels' noise, from what a calibration leaves over: a part of its own and one that grows with the reading.

use super::problem::Doubt;
use crate::contact::friction::NO_FRICTION;
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
/// No pad is quieter.
const ADDITIVE_MIN_UV: f64 = 0.5;
const SHARE_MIN: f64 = 5e-4;
/// So often the weights are taken anew.
const ROUNDS: usize = 20;

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
        noise: Noise { gain: GAIN, ..Noise::of_channels([ADDITIVE_UV; CHANNELS], [SHARE; CHANNELS]) },
        readings: KNOWN,
    };

    /// Of a pad of the same kind as one with this noise.
    pub(super) const fn of_kin(noise: &Noise) -> Self {
        let Noise { additive_uv, share, gain, .. } = *noise;
        Self { noise: Noise { gain, ..Noise::of_channels(additive_uv, share) }, readings: KNOWN_OF_KIN }
    }
}

/// What a channel left over: its reading and the rest, both in µV.
pub(super) type Rest = (f64, f64);

/// The noise that these rests have.
///
/// Squares of rests are a straight line over squares of readings; the line is fitted with weights from itself, as squares
/// scatter in proportion to what they should be.
pub(super) fn of_rests(rests: &[Vec<Rest>; CHANNELS], known: &Known) -> Noise {
    let lines: [[f64; 2]; CHANNELS] = std::array::from_fn(|k| {
        line(&rests[k], known.noise.additive_uv[k].powi(2), known.noise.share[k].powi(2), known.readings)
    });
    Noise::of_channels(
        lines.map(|[constant, _]| constant.sqrt().max(ADDITIVE_MIN_UV)),
        lines.map(|[_, slope]| slope.sqrt().max(SHARE_MIN)),
    )
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
    ((count * slope + GAIN_KNOWN * known.noise.gain.powi(2)) / (count + GAIN_KNOWN)).sqrt()
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

/// The line of squares; before, its constant and slope are known as well as so many readings tell them.
fn line(rests: &[Rest], known_uv2: f64, known_slope: f64, known_readings: f64) -> [f64; 2] {
    let (mut constant, mut slope) = (known_uv2, known_slope);
    let count = rests.len().max(1) as f64;
    let typical = rests.iter().map(|(uv, _)| uv * uv).sum::<f64>() / count;
    for _ in 0..ROUNDS {
        let mut normal = [[0.0; 2]; 2];
        let mut right = [0.0; 2];
        let mut add = |square: f64, rest: f64, count: f64| {
            let weight = count / (constant + slope * square).powi(2);
            normal[0][0] += weight;
            normal[0][1] += weight * square;
            normal[1][1] += weight * square * square;
            right[0] += weight * rest;
            right[1] += weight * rest * square;
        };
        rests.iter().for_each(|(uv, rest)| add(uv * uv, rest * rest, 1.0));
        // What was known: half of it at rest, half at a typical reading.
        add(0.0, known_uv2, known_readings / 2.0);
        add(typical, known_uv2 + known_slope * typical, known_readings / 2.0);
        let determinant = normal[0][0] * normal[1][1] - normal[0][1] * normal[0][1];
        let found = [
            (normal[1][1] * right[0] - normal[0][1] * right[1]) / determinant,
            (normal[0][0] * right[1] - normal[0][1] * right[0]) / determinant,
        ];
        if found.iter().all(|number| number.is_finite()) {
            constant = found[0].max(ADDITIVE_MIN_UV * ADDITIVE_MIN_UV);
            slope = found[1].max(SHARE_MIN * SHARE_MIN);
        }
    }
    [constant, slope]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn both_parts_are_found() {
        let mut random = SplitMix64::new(1);
        let mut rest = || {
            let uv = 3000.0 * f64::from(random.uniform());
            (uv, 12.0 * f64::from(random.normal()) + 0.015 * uv * f64::from(random.normal()))
        };
        let rests: [Vec<Rest>; CHANNELS] = std::array::from_fn(|_| (0..2000).map(|_| rest()).collect());
        let Noise { additive_uv, share, .. } = of_rests(&rests, &Known::SIMULATED);
        assert!(additive_uv.iter().all(|uv| (uv / 12.0 - 1.0).abs() < 0.2), "{additive_uv:?}");
        assert!(share.iter().all(|share| (share / 0.015 - 1.0).abs() < 0.1), "{share:?}");
    }

    #[test]
    fn without_rests_it_is_what_was_known() {
        let Noise { additive_uv, share, .. } = of_rests(&[const { Vec::new() }; CHANNELS], &Known::SIMULATED);
        assert!(additive_uv.iter().all(|uv| (uv - ADDITIVE_UV).abs() < 1.0), "{additive_uv:?}");
        assert!(share.iter().all(|share| *share < 0.05), "{share:?}");
    }
}
