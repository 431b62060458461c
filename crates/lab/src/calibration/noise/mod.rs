//! The channels' noise by the residuals of a calibration: variance components of each channel, and what all channels share.
//!
//! The variance of a channel that reads s under a force F is σ² = a² + (b s)² + (c F)²: `additive_uv`, `share` and
//! `force_uv_per_n`.

pub(crate) mod lasting;
pub(crate) mod model;
pub(crate) mod normal_equations;
pub(crate) mod residual;

use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::pipeline::compensation::hysteresis::Hysteresis;
use tactpad_core::pipeline::contact::inverse::{Expected, Inverse};
use tactpad_core::pipeline::contact::uncertainty::{Covariance, Noise, UNKNOWNS};
use tactpad_core::quantity::{CHANNELS, Contact, Strain};
use tactpad_numeric::linear::Factor;
use tactpad_numeric::simd::widest;

/// Readings with the standard deviations below that the prior of the noise counts as.
const PSEUDO_READINGS: f64 = 10.0;
const ADDITIVE_UV: f64 = 8.0;
const SHARE: f64 = 0.02;
/// Pads of one kind have the same gauges and amplifiers: their noise is alike to some ten percent, as after fifty readings.
const PSEUDO_READINGS_OF_KIND: f64 = 50.0;
/// Standard deviation of a gain that all channels share; its prior counts as thirty contacts.
const GAIN: f64 = 0.006;
const GAIN_PSEUDO_CONTACTS: f64 = 30.0;
/// The same from one recording to another, which none of them shows: wear, temperature.
const GAIN_BETWEEN: f64 = 0.005;
/// Standard deviation of a play operator's state by means of a second, as a share of what it keeps at rest: a finger that is
/// not still pushes it further than the mean shows.
const HYSTERESIS_STATE_ERROR: f64 = 0.08;
const FORCE_UV_PER_N: f64 = 1.0;
/// Variance components: a², b², c².
const PARTS: usize = 3;
/// Least standard deviations: no pad is quieter.
const ADDITIVE_MIN_UV: f64 = 0.5;
pub(crate) const SHARE_MIN: f64 = 5e-4;
const LEAST_UV2: f64 = ADDITIVE_MIN_UV * ADDITIVE_MIN_UV;
/// Rounds of reweighting.
const ROUNDS: usize = 40;

/// Posterior covariance of the channels at a contact, in µV²: what the contacts leave open of the field.
pub(crate) struct FieldCovariance {
    pub(crate) place_mm: [f64; 2],
    pub(crate) force_n: [f64; 3],
    pub(crate) uv2: [[f64; CHANNELS]; CHANNELS],
}

/// The prior of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoisePrior {
    pub(crate) noise: Noise,
    /// Readings that it counts as.
    pseudo_readings: f64,
}

impl NoisePrior {
    /// Of a pad of an unknown kind.
    pub(crate) const SIMULATED: Self = Self {
        noise: Noise {
            gain: GAIN,
            force_uv_per_n: [FORCE_UV_PER_N; CHANNELS],
            ..Noise::of_channels([ADDITIVE_UV; CHANNELS], [SHARE; CHANNELS])
        },
        pseudo_readings: PSEUDO_READINGS,
    };

    /// Of a pad of the same kind as one with this noise.
    pub(crate) const fn of_kind(noise: &Noise) -> Self {
        let Noise { additive_uv, share, force_uv_per_n, gain, .. } = *noise;
        let noise = Noise { force_uv_per_n, gain, ..Noise::of_channels(additive_uv, share) };
        Self { noise, pseudo_readings: PSEUDO_READINGS_OF_KIND }
    }

    /// Readings that it counts as.
    pub(crate) const fn pseudo_readings(&self) -> f64 {
        self.pseudo_readings
    }

    /// Variance components of a channel.
    fn parts(&self, channel: usize) -> [f64; PARTS] {
        let Noise { additive_uv, share, force_uv_per_n, .. } = &self.noise;
        [additive_uv, share, force_uv_per_n].map(|deviations| deviations[channel].powi(2))
    }
}

/// A channel's squared residual, and what its variance depends on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SquaredResidual {
    /// The reading s.
    pub(crate) uv: f64,
    /// The force F of the contact.
    pub(crate) force_n: f64,
    /// The square's expected value, given the residual.
    pub(crate) square_uv2: f64,
}

/// The variance components of each channel, none of them negative, by its squared residuals. The standard deviation of a
/// squared residual is proportional to σ², so its weight is 1/σ⁴: iteratively reweighted least squares.
pub(crate) fn from_residuals(residuals: &[Vec<SquaredResidual>; CHANNELS], prior: &NoisePrior) -> Noise {
    let parts: [[f64; PARTS]; CHANNELS] =
        std::array::from_fn(|k| parts(&residuals[k], &prior.parts(k), prior.pseudo_readings).map(f64::sqrt));
    let mut noise = Noise::of_channels(
        parts.map(|[own, ..]| own.max(ADDITIVE_MIN_UV)),
        parts.map(|[_, share, _]| share.max(SHARE_MIN)),
    );
    noise.force_uv_per_n = parts.map(|[.., force]| force);
    noise
}

/// The noise with the variance of the zeros, whose readings differ by `drift_uv` from one to the next, and of the hysteresis states.
/// All contacts between two readings share these errors, so the residuals show only a part of them.
pub(crate) fn with_zeros(noise: Noise, drift_uv: &[f64; CHANNELS], hysteresis: &Hysteresis) -> Noise {
    let kept_uv = |k: usize| hysteresis.iter().map(|plays| plays[k].share * plays[k].threshold).sum::<f64>();
    // A difference D of two zeros has the variance of both beside that of two readings, D² = 2 Z² + 2 σ². A zero interpolated between
    // two has Z² (w² + (1 − w)²), on average over w ⅔ Z².
    let variance = |k: usize| {
        noise.additive_uv[k].powi(2)
            + (drift_uv[k].powi(2) / 2.0 - noise.additive_uv[k].powi(2)).max(0.0) * 2.0 / 3.0
            + (HYSTERESIS_STATE_ERROR * kept_uv(k)).powi(2)
    };
    Noise { additive_uv: std::array::from_fn(|k| variance(k).sqrt()), ..noise }
}

/// The noise with the field's posterior covariance Σ, as a mean over these contacts: of each channel per newton, √(Σₖₖ/F²).
pub(crate) fn with_field_deviations(
    field: &InfluenceField,
    noise: Noise,
    field_covariances: &[FieldCovariance],
) -> Noise {
    let count = field_covariances.len().max(1) as f64;
    // √(mean of Σₖₖ/F²), without what all channels share: an error of the scale is one of the force and of no channel.
    let mut per_n2 = [0.0; CHANNELS];
    for covariance in field_covariances {
        let own_uv2 = own_variances(covariance, field, &noise);
        let force_n2 = square(&covariance.force_n) * count;
        per_n2.iter_mut().zip(own_uv2).for_each(|(sum, uv2)| *sum += uv2.max(0.0) / force_n2);
    }
    Noise { field_uv_per_n: per_n2.map(f64::sqrt), ..noise }
}

/// What these covariances Σ of the channels do to decoded contacts, as a mean: R Σ Rᵀ with R = ∂(x, y, Fx, Fy, Fz)/∂s and forces as
/// shares of the whole force.
pub(crate) fn mean_by_field(decoder: &Inverse, field_covariances: &[FieldCovariance]) -> Covariance {
    let count = field_covariances.len().max(1) as f64;
    let mut by_field = [[0.0; UNKNOWNS]; UNKNOWNS];
    for FieldCovariance { place_mm, force_n, uv2 } in field_covariances {
        let Some(Expected { response, .. }) = decoder.expected(&contact(place_mm, force_n)) else { continue };
        // Entry (i, j) of R Σ Rᵀ, with forces as shares of F.
        let whole_n = square(force_n).sqrt();
        let scale = [1.0, 1.0, whole_n, whole_n, whole_n];
        for (i, line) in by_field.iter_mut().enumerate() {
            for (j, entry) in line.iter_mut().enumerate() {
                *entry += form(&response[i], uv2, &response[j]) / (scale[i] * scale[j] * count);
            }
        }
    }
    by_field
}

/// As a decoder has it.
pub(crate) fn contact([x_mm, y_mm]: &[f64; 2], [fx_n, fy_n, fz_n]: &[f64; 3]) -> Contact {
    let [x_mm, y_mm, fx_n, fy_n, fz_n] = [x_mm, y_mm, fx_n, fy_n, fz_n].map(|number| *number as f32);
    Contact { x_mm, y_mm, fx_n, fy_n, fz_n }
}

/// The channels' variances at a contact, without that of a factor that all of them share: the diagonal of P Σ Pᵀ with
/// P = I − s sᵀW/(sᵀW s), where s are the signals and W one over their noise.
fn own_variances(
    FieldCovariance { place_mm, force_n, uv2 }: &FieldCovariance,
    field: &InfluenceField,
    noise: &Noise,
) -> [f64; CHANNELS] {
    let [x_mm, y_mm] = place_mm.map(|mm| mm as f32);
    let maps = field.gains(x_mm, y_mm).value;
    let signals_uv = maps.map(|map| map.iter().zip(force_n).map(|(map, n)| map * n).sum::<f64>());
    let variances = noise.variances(&signals_uv, square(force_n).sqrt()).noise;
    let weighted: [f64; CHANNELS] = std::array::from_fn(|k| signals_uv[k] / variances[k]);
    let whole: f64 = weighted.iter().zip(signals_uv).map(|(weighted, uv)| weighted * uv).sum();
    std::array::from_fn(|k| {
        let row: [f64; CHANNELS] = std::array::from_fn(|l| {
            f64::from(u8::from(k == l)) - signals_uv[k] * weighted[l] / whole.max(f64::MIN_POSITIVE)
        });
        form(&row, uv2, &row)
    })
}

/// F².
pub(crate) fn square(force_n: &[f64; 3]) -> f64 {
    force_n.iter().map(|n| n * n).sum()
}

/// Bilinear form leftᵀ M right.
pub(crate) fn form(
    left: &[f64; CHANNELS],
    matrix: &[[f64; CHANNELS]; CHANNELS],
    right: &[f64; CHANNELS],
) -> f64 {
    let line = |(left, line): (&f64, &[f64; CHANNELS])| {
        left * line.iter().zip(right).map(|(entry, right)| entry * right).sum::<f64>()
    };
    left.iter().zip(matrix).map(line).sum()
}

/// Standard deviation of the gain that all channels share, from contact to contact: wear and temperature change it, and no
/// channel disagrees. It shows in the force errors e along the force F, beyond their variance v by the decoder, in proportion
/// to F; the reference's own noise does not grow with F:
///
/// ```text
/// E[e² − v] = c + g² F²,    c, g² ≥ 0,    weights 1/v²
/// ```
pub(crate) fn common_gain(decoder: &Inverse, contacts: &[(Strain, [f64; 3])], prior: &NoisePrior) -> f64 {
    // Normal equations of c (0) and g² (1).
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
    // c = (Σ w (e² − v) − g² Σ w F²)/Σ w; where the unconstrained one is negative, c = 0 and g² = Σ w F² (e² − v)/Σ w F⁴.
    let constant = |slope: f64| (right[0] - normal[0][1] * slope) / normal[0][0];
    let unconstrained = Factor::of(&normal).map_or([0.0; 2], |factor| factor.solve(&right));
    let slope = if constant(unconstrained[1]) < 0.0 { right[1] / normal[1][1] } else { unconstrained[1] };
    let (count, slope) = (contacts.len() as f64, if slope.is_finite() { slope.max(0.0) } else { 0.0 });
    // The prior's g² as pseudo-observations, then the variance between recordings.
    let within =
        (count * slope + GAIN_PSEUDO_CONTACTS * prior.noise.gain.powi(2)) / (count + GAIN_PSEUDO_CONTACTS);
    (within + GAIN_BETWEEN * GAIN_BETWEEN).sqrt()
}

/// The decoded force F, the written one's error e along it, and the variance v of that by the decoder's covariance C of the
/// forces, u being the force's direction.
fn off_along_force(decoder: &Inverse, strain: &Strain, written_n: &[f64; 3]) -> Option<(f64, f64, f64)> {
    let estimate = decoder.estimate(strain)?;
    let Contact { fx_n, fy_n, fz_n, .. } = estimate.contact;
    let decoded_n = [fx_n, fy_n, fz_n].map(f64::from);
    let force_n = square(&decoded_n).sqrt();
    let along = decoded_n.map(|n| n / force_n);
    let written_n: f64 = along.iter().zip(written_n).map(|(along, n)| along * n).sum();
    // v = uᵀ C u.
    let mut variance = 0.0;
    for (i, left) in along.iter().enumerate() {
        for (j, right) in along.iter().enumerate() {
            variance += left * right * estimate.covariance[2 + i][2 + j];
        }
    }
    (variance > 0.0).then_some((force_n, written_n - force_n, variance))
}

/// The variance components a², b², c² of a channel. The prior counts as `pseudo_readings` readings.
fn parts(residuals: &[SquaredResidual], prior: &[f64; PARTS], pseudo_readings: f64) -> [f64; PARTS] {
    let count = residuals.len().max(1) as f64;
    let typical =
        |of: fn(&SquaredResidual) -> f64| residuals.iter().map(|it| of(it).powi(2)).sum::<f64>() / count;
    let (uv2, n2) = (typical(|it| it.uv), typical(|it| it.force_n));
    let measured = residuals.iter().map(|it| Squared {
        terms: [1.0, it.uv * it.uv, it.force_n * it.force_n],
        square: it.square_uv2,
        count: 1.0,
    });
    // The prior as pseudo-observations: half of them at rest, half at a typical reading.
    let known = [[1.0, 0.0, 0.0], [1.0, uv2, n2]].map(|terms| Squared {
        terms,
        square: sum(&terms, prior),
        count: pseudo_readings / 2.0,
    });
    let all: Vec<Squared> = measured.chain(known).collect();
    let groups: Vec<VarianceGroup> = all.chunks(LANES).map(VarianceGroup::of).collect();
    widest(
        #[inline(always)]
        || (0..ROUNDS).fold(*prior, |parts, _| reweighted(&parts, &groups)),
    )
}

/// A squared residual y with its terms x = (1, s², F²), and how many times it counts.
struct Squared {
    terms: [f64; PARTS],
    square: f64,
    count: f64,
}

/// So many squared residuals side by side, for vectors of the processor.
const LANES: usize = 8;

/// The same for each of them, number by number. What a group lacks counts nothing.
#[derive(Clone, Copy)]
struct VarianceGroup {
    terms: [[f64; LANES]; PARTS],
    square: [f64; LANES],
    count: [f64; LANES],
}

impl VarianceGroup {
    fn of(squared: &[Squared]) -> Self {
        let each =
            |of: &dyn Fn(&Squared) -> f64| std::array::from_fn(|lane| squared.get(lane).map_or(0.0, of));
        Self {
            terms: std::array::from_fn(|part| each(&|it| it.terms[part])),
            square: each(&|it| it.square),
            count: each(&|it| it.count),
        }
    }
}

/// A round of D. D. Lee's and H. S. Seung's multiplicative rule (Nature 401 (1999) 788), under which no component ever becomes
/// negative, with weights from the components themselves:
///
/// ```text
/// pₖ ← pₖ Σ w xₖ y / Σ w xₖ ŷ,    ŷ = Σₖ xₖ pₖ,    w = count/ŷ²
/// ```
#[inline(always)]
fn reweighted(parts: &[f64; PARTS], groups: &[VarianceGroup]) -> [f64; PARTS] {
    let [mut wanted, mut found] = [[[0.0; LANES]; PARTS]; 2];
    for VarianceGroup { terms, square, count } in groups {
        // By indices: iterators would be calls of their own, outside the widest vectors.
        for lane in 0..LANES {
            let mut expected = 0.0;
            for k in 0..PARTS {
                expected += terms[k][lane] * parts[k];
            }
            let expected = if expected > LEAST_UV2 { expected } else { LEAST_UV2 };
            let weight = count[lane] / (expected * expected);
            for k in 0..PARTS {
                wanted[k][lane] += weight * terms[k][lane] * square[lane];
                found[k][lane] += weight * terms[k][lane] * expected;
            }
        }
    }
    let [wanted, found] = [wanted, found].map(|sums| sums.map(|lanes| lanes.iter().sum::<f64>()));
    std::array::from_fn(|k| if found[k] > 0.0 { parts[k] * wanted[k] / found[k] } else { parts[k] })
}

fn sum(terms: &[f64; PARTS], parts: &[f64; PARTS]) -> f64 {
    terms.iter().zip(parts).map(|(term, part)| term * part).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;

    #[test]
    fn all_parts_are_found() {
        let mut random = SplitMix64::new(1);
        let mut residual = || {
            let (uv, force_n) = (3000.0 * f64::from(random.uniform()), 5.0 * f64::from(random.fraction()));
            let parts = [12.0, 0.015 * uv, 8.0 * force_n];
            let residual_uv: f64 = parts.iter().map(|part| part * f64::from(random.normal())).sum();
            SquaredResidual { uv, force_n, square_uv2: residual_uv * residual_uv }
        };
        let residuals: [Vec<SquaredResidual>; CHANNELS] =
            std::array::from_fn(|_| (0..3000).map(|_| residual()).collect());
        let Noise { additive_uv, share, force_uv_per_n, .. } =
            from_residuals(&residuals, &NoisePrior::SIMULATED);
        assert!(additive_uv.iter().all(|uv| (uv / 12.0 - 1.0).abs() < 0.25), "{additive_uv:?}");
        assert!(share.iter().all(|share| (share / 0.015 - 1.0).abs() < 0.2), "{share:?}");
        assert!(force_uv_per_n.iter().all(|uv| (uv / 8.0 - 1.0).abs() < 0.3), "{force_uv_per_n:?}");
    }

    #[test]
    fn without_rests_it_is_what_was_known() {
        let Noise { additive_uv, share, .. } =
            from_residuals(&[const { Vec::new() }; CHANNELS], &NoisePrior::SIMULATED);
        assert!(additive_uv.iter().all(|uv| (uv - ADDITIVE_UV).abs() < 1.0), "{additive_uv:?}");
        assert!(share.iter().all(|share| *share < 0.05), "{share:?}");
    }
}
