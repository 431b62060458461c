//! The inverse decoder: the contact whose channels, by the pad's influence field, come closest to the measured ones.
//!
//! At a fixed place the channels are linear in the force, s = G(x, y) F. So the best force for a place has a closed form,
//! and only x and y are sought, by Gauss and Newton's method: a few steps from a start that is a linear function of the
//! channels. Distances are counted in the channels' noise, so the result is the most likely contact, and the curvature
//! there is the inverse of its covariance.
//!
//! Source: G. H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, for least squares whose variables separate.

use super::field_error::{FieldError, FieldPoint};
use super::uncertainty::{Covariance, Estimate, Linear, Noise, UNKNOWNS, Variances};
use crate::pad::influence::{Gains, InfluenceField};
use crate::quantity::{CHANNELS, Contact, Strain};
use tactpad_numeric::linear::Factor;

/// Steps at most, the first one included.
const STEPS_MAX: usize = 8;
/// A step so small ends the search, in mm: the location error of any pad is larger.
const STEP_END_MM: f64 = 2e-3;
/// No step is longer.
const STEP_MAX_MM: f64 = 12.0;
/// The prior: places lie on the plate, forces are those of a finger. Standard deviations.
const PLACE_MM: f64 = 20.0;
const FORCE_N: f64 = 100.0;
/// Rings and places on each from which the start is learnt.
const RING_MM: f64 = 2.0;
const RING_PLACES: usize = 36;

/// Into each channel, from each: a share of the other's own signal. None has any of itself.
pub type Crosstalk = [[f32; CHANNELS]; CHANNELS];

/// No pad's channels have more of one another.
pub const CROSSTALK_MAX: f32 = 0.1;
/// Channels that have nothing of one another.
pub const NO_CROSSTALK: Crosstalk = [[0.0; CHANNELS]; CHANNELS];

/// Rounds in which crosstalk is taken off. Its lines add up to 8 CROSSTALK_MAX at most, which leaves a ten-millionth.
const OWN_ROUNDS: usize = 64;

/// The channels' own signals s among readings, y = (1 + L) s: s ← y − L s.
pub fn own_uv(uv: &[f64; CHANNELS], crosstalk: &[[f64; CHANNELS]; CHANNELS]) -> [f64; CHANNELS] {
    let mut own = *uv;
    for _ in 0..OWN_ROUNDS {
        own = std::array::from_fn(|into| {
            uv[into] - crosstalk[into].iter().zip(own).map(|(l, s)| l * s).sum::<f64>()
        });
    }
    own
}

/// The decoder.
#[derive(Clone, Debug)]
pub struct Inverse {
    field: InfluenceField,
    noise: Noise,
    field_error: FieldError,
    crosstalk: Crosstalk,
    /// Fz, x Fz and y Fz as linear functions of the channels.
    start: Moments,
    /// The same of all channels but this one.
    start_without: [Moments; CHANNELS],
}

/// Fz, x Fz and y Fz as linear functions of the channels, in 1/µV times N and mm.
type Moments = [[f64; CHANNELS]; 3];

/// A place with its best force.
struct Trial {
    place_mm: [f64; 2],
    force_n: [f64; 3],
    /// H = JᵀWJ + Λ, the lower triangle; Λ is the prior's.
    curvature: [[f64; UNKNOWNS]; UNKNOWNS],
    /// JᵀW r, less what the prior pulls the place by.
    slope: [f64; UNKNOWNS],
    /// r = u − G F.
    left_uv: [f64; CHANNELS],
    /// χ² = rᵀW r.
    misfit: f64,
    /// χ² with the prior of the place.
    cost: f64,
}

/// A contact and what it does not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFit {
    /// The most likely contact.
    pub contact: Contact,
    /// Residual of each channel, µV.
    pub left_uv: [f64; CHANNELS],
}

/// A contact that was fitted without one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FitWithout {
    /// Sum of the squares of what it leaves over of the other channels, by their weights.
    pub misfit: f64,
    /// What the channel should read then, µV.
    pub expected_uv: f64,
    /// The force Fx, Fy, Fz, N.
    pub force_n: [f64; 3],
}

/// Expected error of the estimate of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// How it follows the nine channels: x, y in mm and Fx, Fy, Fz in N, per microvolt.
    pub response: [[f64; CHANNELS]; UNKNOWNS],
    /// Its covariance.
    pub covariance: Covariance,
    /// The part of that which is of the field's errors.
    pub by_field: Covariance,
}

impl Inverse {
    /// The decoder of a pad with this field, whose channels scatter so. Each channel must scatter.
    pub fn new(field: InfluenceField, noise: Noise) -> Self {
        let equations = MomentEquations::of(&field);
        Self {
            field,
            noise,
            field_error: FieldError::NONE,
            crosstalk: NO_CROSSTALK,
            start: equations.solved(None),
            start_without: std::array::from_fn(|channel| equations.solved(Some(channel))),
        }
    }

    /// The same of a field that may be off so.
    pub fn with_field_error(self, field_error: FieldError) -> Self {
        Self { field_error, ..self }
    }

    /// The same, and what its channels have of one another. The field has it, too: only who asks what came from where needs it.
    #[must_use]
    pub fn with_crosstalk(self, crosstalk: Crosstalk) -> Self {
        Self { crosstalk, ..self }
    }

    /// The same of a pad whose channels read `factor` times as much, with this noise.
    #[must_use]
    pub fn scaled(&self, factor: f64, noise: Noise) -> Self {
        Self::new(self.field.scaled(factor), noise)
            .with_field_error(self.field_error.scaled(factor))
            .with_crosstalk(self.crosstalk)
    }

    /// The pad's field.
    pub const fn field(&self) -> &InfluenceField {
        &self.field
    }

    /// How the channels scatter.
    pub const fn noise(&self) -> &Noise {
        &self.noise
    }

    /// Of each channel, what it has of the others' own signals, as a share of these.
    pub const fn crosstalk(&self) -> &Crosstalk {
        &self.crosstalk
    }

    /// The channels' own signals s among readings: y = (1 + L) s with the crosstalk L.
    pub fn own_uv(&self, uv: &[f64; CHANNELS]) -> [f64; CHANNELS] {
        own_uv(uv, &self.crosstalk.map(|line| line.map(f64::from)))
    }

    /// How far the field may be off.
    pub const fn field_error(&self) -> &FieldError {
        &self.field_error
    }

    /// The contact that explains `strain` best. Without force it is in the middle. Strain that is not finite, or beyond
    /// anything that a pad can read, is no contact.
    pub fn decode(&self, strain: &Strain) -> Contact {
        self.explain(strain).map(|explained| explained.contact).unwrap_or_default()
    }

    /// The same with what it leaves over; `None` for strain that is not finite, or beyond anything that a pad can read.
    pub fn explain(&self, strain: &Strain) -> Option<ContactFit> {
        let (trial, _) = self.searched(strain)?;
        let contact = Some(trial.contact()).filter(is_finite)?;
        Some(ContactFit { contact, left_uv: trial.left_uv })
    }

    /// The contact that explains the other channels best, where each counts by its weight.
    pub(super) fn without(
        &self,
        channel: usize,
        uv: &[f64; CHANNELS],
        weights: &[f64; CHANNELS],
    ) -> Option<FitWithout> {
        let (mut others_uv, mut weights) = (*uv, *weights);
        (others_uv[channel], weights[channel]) = (0.0, 0.0);
        let trial = self.best(&others_uv, &weights, &self.start_without[channel])?;
        Some(FitWithout {
            misfit: trial.misfit,
            expected_uv: -trial.left_uv[channel],
            force_n: trial.force_n,
        })
    }

    /// The same with its uncertainty; `None` for strain that is not finite, or beyond anything that a pad can read.
    pub fn estimate(&self, strain: &Strain) -> Option<Estimate> {
        let (trial, variances) = self.searched(strain)?;
        let linear = self.linear(trial.place_mm, trial.force_n, &variances)?;
        let by_field = self.by_field(&linear, trial.place_mm, &trial.force_n);
        let covariance = linear.covariance(&self.noise, &variances, &trial.force_n, &by_field);
        let contact = Some(trial.contact()).filter(is_finite)?;
        Some(Estimate { contact, covariance, misfit: trial.misfit })
    }

    /// How the estimate of a contact follows the channels, and what it states; `None` where it does not follow them.
    pub fn expected(&self, contact: &Contact) -> Option<Expected> {
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
        let (place_mm, force_n) = ([x_mm, y_mm].map(f64::from), [fx_n, fy_n, fz_n].map(f64::from));
        let uv = self.field.strain_uv(contact).uv.map(f64::from);
        let variances = self.noise.variances(&uv, force_n[2]);
        let linear = self.linear(place_mm, force_n, &variances)?;
        let by_field = self.by_field(&linear, place_mm, &force_n);
        let covariance = linear.covariance(&self.noise, &variances, &force_n, &by_field);
        Some(Expected { response: linear.response, covariance, by_field })
    }

    /// How the channels follow a contact: x, y in µV/mm; Fx, Fy, Fz in µV/N.
    pub fn slopes(&self, place_mm: [f64; 2], force_n: &[f64; 3]) -> [[f64; UNKNOWNS]; CHANNELS] {
        let gains = self.field.gains(place_mm[0] as f32, place_mm[1] as f32);
        std::array::from_fn(|channel| slopes(&gains, channel, force_n))
    }

    /// Addition of each mode of the field's error to the channels under a load, µV.
    pub fn modes_uv(&self, place_mm: [f64; 2], force_n: &[f64; 3]) -> Vec<[f64; CHANNELS]> {
        self.asked(place_mm, force_n, |it| self.field_error.channels_uv(it).collect())
    }

    /// Asks about the field's error under a load.
    fn asked<T>(&self, place_mm: [f64; 2], force_n: &[f64; 3], ask: impl FnOnce(&FieldPoint<'_>) -> T) -> T {
        let place = self.within(place_mm).map(|mm| mm / f64::from(self.field.radius_mm()));
        let gains = self.field.gains(place_mm[0] as f32, place_mm[1] as f32);
        let signals_uv = gains.value.map(|gain| dot(&gain, force_n));
        ask(&FieldPoint { place, force_n, signals_uv: &signals_uv })
    }

    /// Covariance of a contact by the field's errors.
    fn by_field(&self, linear: &Linear, place_mm: [f64; 2], force_n: &[f64; 3]) -> Covariance {
        let alike = self.noise.covariance_by_field(force_n);
        let by_place = self.asked(place_mm, force_n, |it| self.field_error.covariance(it, &linear.response));
        std::array::from_fn(|i| std::array::from_fn(|j| alike[i][j] + by_place[i][j]))
    }

    /// The place of the least cost with its force, and the variances of the channels.
    fn searched(&self, strain: &Strain) -> Option<(Trial, Variances)> {
        let uv = strain.uv.map(f64::from);
        let [fz_n, ..] = started(&self.start, &uv);
        let variances = self.noise.variances(&uv, fz_n);
        Some((self.best(&uv, &variances.weights(), &self.start)?, variances))
    }

    fn best(&self, uv: &[f64; CHANNELS], weights: &[f64; CHANNELS], start: &Moments) -> Option<Trial> {
        // At each place the best force, then the place's part of Gauss and Newton's step H δ = JᵀW r − Λ (x, y). One that makes
        // it worse is taken back and tried at a quarter of its length.
        let [fz_n, x_fz, y_fz] = started(start, uv);
        let mut best = self.trial(self.sensible([x_fz / fz_n, y_fz / fz_n]), uv, weights)?;
        let mut shorter = 1.0;
        for _ in 1..STEPS_MAX {
            let step = best.step(shorter)?;
            if libm::hypot(step[0], step[1]) < STEP_END_MM {
                break;
            }
            let place_mm = self.within([best.place_mm[0] + step[0], best.place_mm[1] + step[1]]);
            let next = self.trial(place_mm, uv, weights)?;
            if next.cost < best.cost {
                (best, shorter) = (next, 1.0);
            } else {
                shorter *= 0.25;
            }
        }
        Some(best)
    }

    /// The normal force of any sum or difference of contacts, to some percent: a linear function of the channels.
    pub fn load_n(&self, strain: &Strain) -> f32 {
        let [fz_n, ..] = started(&self.start, &strain.uv.map(f64::from));
        fz_n as f32
    }

    fn linear(&self, place_mm: [f64; 2], force_n: [f64; 3], variances: &Variances) -> Option<Linear> {
        let rows = self.slopes(place_mm, &force_n);
        Linear::of(&rows, &variances.weights(), &prior_precision())
    }

    /// Where the search begins.
    fn sensible(&self, place_mm: [f64; 2]) -> [f64; 2] {
        if place_mm.iter().all(|mm| mm.is_finite()) { self.within(place_mm) } else { [0.0; 2] }
    }

    /// The nearest place that the field covers.
    fn within(&self, [x_mm, y_mm]: [f64; 2]) -> [f64; 2] {
        let share = f64::from(self.field.radius_mm()) / libm::hypot(x_mm, y_mm);
        if share < 1.0 { [share * x_mm, share * y_mm] } else { [x_mm, y_mm] }
    }

    /// The best force at a place, and how the misfit changes around it.
    fn trial(&self, place_mm: [f64; 2], uv: &[f64; CHANNELS], weights: &[f64; CHANNELS]) -> Option<Trial> {
        let gains = self.field.gains(place_mm[0] as f32, place_mm[1] as f32);
        let force_n = best_force(&gains, uv, weights)?;
        let mut trial = Trial {
            place_mm,
            force_n,
            curvature: prior_precision(),
            slope: [0.0; UNKNOWNS],
            left_uv: [0.0; CHANNELS],
            misfit: 0.0,
            cost: 0.0,
        };
        // rₖ = uₖ − Gₖ F, and wₖ rₖ², wₖ Jₖ rₖ, wₖ Jₖ Jₖᵀ are summed over the channels.
        for k in 0..CHANNELS {
            let row = slopes(&gains, k, &force_n);
            trial.left_uv[k] = uv[k] - dot(&gains.value[k], &force_n);
            trial.add(&row, trial.left_uv[k], weights[k]);
        }
        // χ² + (x² + y²) / σ²
        trial.cost = trial.misfit;
        for (axis, mm) in place_mm.iter().enumerate() {
            trial.slope[axis] -= mm / (PLACE_MM * PLACE_MM);
            trial.cost += mm * mm / (PLACE_MM * PLACE_MM);
        }
        trial.cost.is_finite().then_some(trial)
    }
}

impl Trial {
    fn add(&mut self, row: &[f64; UNKNOWNS], left_uv: f64, weight: f64) {
        for (i, left) in row.iter().enumerate() {
            self.slope[i] += weight * left * left_uv;
            for (j, right) in row.iter().enumerate().take(i + 1) {
                self.curvature[i][j] += weight * left * right;
            }
        }
        self.misfit += weight * left_uv * left_uv;
    }

    /// Gauss and Newton's step of the place, or a part of it.
    fn step(&self, part: f64) -> Option<[f64; 2]> {
        let [x_mm, y_mm, ..] = Factor::of(&self.curvature)?.solve(&self.slope);
        let part = part * (STEP_MAX_MM / libm::hypot(x_mm, y_mm)).min(1.0);
        (x_mm.is_finite() && y_mm.is_finite()).then_some([part * x_mm, part * y_mm])
    }

    fn contact(&self) -> Contact {
        let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) =
            (self.place_mm.map(|mm| mm as f32), self.force_n.map(|n| n as f32));
        Contact { x_mm, y_mm, fx_n, fy_n, fz_n }
    }
}

const fn is_finite(contact: &Contact) -> bool {
    let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
    x_mm.is_finite() && y_mm.is_finite() && fx_n.is_finite() && fy_n.is_finite() && fz_n.is_finite()
}

/// Λ: one over the variances of the prior.
fn prior_precision() -> [[f64; UNKNOWNS]; UNKNOWNS] {
    let deviations = [PLACE_MM, PLACE_MM, FORCE_N, FORCE_N, FORCE_N];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| if i == j { 1.0 / (deviations[i] * deviations[i]) } else { 0.0 })
    })
}

/// The force that explains the channels best at the place of these gains.
fn best_force(gains: &Gains, uv: &[f64; CHANNELS], weights: &[f64; CHANNELS]) -> Option<[f64; 3]> {
    // (GᵀWG + I / σ²) F = GᵀW u
    let mut normal = [[0.0; 3]; 3];
    let mut right = [0.0; 3];
    for ((gain, uv), weight) in gains.value.iter().zip(uv).zip(weights) {
        for (i, left) in gain.iter().enumerate() {
            right[i] += weight * left * uv;
            for (j, other) in gain.iter().enumerate().take(i + 1) {
                normal[i][j] += weight * left * other;
            }
        }
    }
    (0..3).for_each(|i| normal[i][i] += 1.0 / (FORCE_N * FORCE_N));
    Factor::of(&normal).map(|factor| factor.solve(&right))
}

/// How a channel changes with x, y, Fx, Fy, Fz.
fn slopes(gains: &Gains, channel: usize, force_n: &[f64; 3]) -> [f64; UNKNOWNS] {
    // Jₖ = (∂Gₖ/∂x F, ∂Gₖ/∂y F, Gₖ)
    let [fx, fy, fz] = gains.value[channel];
    [dot(&gains.dx[channel], force_n), dot(&gains.dy[channel], force_n), fx, fy, fz]
}

fn dot(left: &[f64; 3], right: &[f64; 3]) -> f64 {
    left[0] * right[0] + left[1] * right[1] + left[2] * right[2]
}

/// About Fz, x Fz and y Fz.
fn started(start: &Moments, uv: &[f64; CHANNELS]) -> [f64; 3] {
    start.map(|row| row.iter().zip(uv).map(|(a, uv)| a * uv).sum())
}

/// Normal equations of the linear functions of the channels that come closest to Fz, x Fz and y Fz over the plate.
struct MomentEquations {
    normal: [[f64; CHANNELS]; CHANNELS],
    right: [[f64; CHANNELS]; 3],
}

impl MomentEquations {
    fn of(field: &InfluenceField) -> Self {
        // Rows a that make Σ ω (aᵀu − t)² least over unit forces at places all over the plate, t being Fz, x Fz or y Fz and ω in
        // proportion to the ring: (Σ ω u uᵀ + ε I) a = Σ ω u t. With ε there is an answer for any field.
        let mut normal = [[0.0; CHANNELS]; CHANNELS];
        let mut right = [[0.0; CHANNELS]; 3];
        let rings = (field.radius_mm() / RING_MM as f32) as usize;
        for ring in 0..=rings {
            for place in 0..RING_PLACES {
                let angle = std::f64::consts::TAU * place as f64 / RING_PLACES as f64;
                let radius_mm = RING_MM * ring as f64;
                let (x_mm, y_mm) = (radius_mm * libm::cos(angle), radius_mm * libm::sin(angle));
                let gains = field.gains(x_mm as f32, y_mm as f32).value;
                for (axis, wanted) in [[0.0; 3], [0.0; 3], [1.0, x_mm, y_mm]].iter().enumerate() {
                    let uv: [f64; CHANNELS] = std::array::from_fn(|k| gains[k][axis]);
                    add_products(&uv, radius_mm + 1.0, wanted, &mut normal, &mut right);
                }
            }
        }
        let trace: f64 = (0..CHANNELS).map(|k| normal[k][k]).sum();
        (0..CHANNELS).for_each(|k| normal[k][k] += 1e-9 * trace);
        Self { normal, right }
    }

    /// The functions of all channels, or of all but one.
    fn solved(&self, without: Option<usize>) -> Moments {
        let Self { mut normal, mut right } = *self;
        if let Some(channel) = without {
            normal[channel] = [0.0; CHANNELS];
            normal.iter_mut().for_each(|row| row[channel] = 0.0);
            normal[channel][channel] = 1.0;
            right.iter_mut().for_each(|right| right[channel] = 0.0);
        }
        Factor::of(&normal).map_or([[0.0; CHANNELS]; 3], |factor| right.map(|right| factor.solve(&right)))
    }
}

fn add_products(
    uv: &[f64; CHANNELS],
    weight: f64,
    wanted: &[f64; 3],
    normal: &mut [[f64; CHANNELS]; CHANNELS],
    right: &mut [[f64; CHANNELS]; 3],
) {
    for (i, left) in uv.iter().enumerate() {
        right.iter_mut().zip(wanted).for_each(|(right, wanted)| right[i] += weight * left * wanted);
        normal[i].iter_mut().zip(uv).for_each(|(entry, other)| *entry += weight * left * other);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::OnceLock;

    use super::*;
    use crate::pad::field::PadField;
    use tactpad_numeric::random::SplitMix64;

    const NOISE: Noise = Noise::of_channels([6.0; CHANNELS], [0.01; CHANNELS]);

    #[test]
    fn channels_own_signals_with_crosstalk_are_what_was_read() {
        let most = f64::from(CROSSTALK_MAX);
        let crosstalk: [[f64; CHANNELS]; CHANNELS] =
            std::array::from_fn(|into| std::array::from_fn(|from| if into == from { 0.0 } else { most }));
        let uv: [f64; CHANNELS] = std::array::from_fn(|k| 900.0 - 250.0 * k as f64);
        let own = own_uv(&uv, &crosstalk);
        for (into, line) in crosstalk.iter().enumerate() {
            let read: f64 = own[into] + line.iter().zip(own).map(|(share, own)| share * own).sum::<f64>();
            assert!((read - uv[into]).abs() < 1e-2, "{into}: {read} {}", uv[into]);
        }
    }

    fn decoder() -> &'static Inverse {
        static DECODER: OnceLock<Inverse> = OnceLock::new();
        DECODER.get_or_init(|| Inverse::new(PadField::nominal().signals, NOISE))
    }

    /// Contacts anywhere on the plate, with forces in a cone of 45° and more.
    fn contacts(seed: u64, count: usize) -> Vec<Contact> {
        let mut random = SplitMix64::new(seed);
        let mut draw = || {
            let [x_mm, y_mm] = [0; 2].map(|_| 20.0 * random.uniform());
            let fz_n = 0.5 + 4.5 * random.fraction();
            Contact { x_mm, y_mm, fx_n: fz_n * random.uniform(), fy_n: fz_n * random.uniform(), fz_n }
        };
        (0..count).map(|_| draw()).collect()
    }

    fn numbers(contact: &Contact) -> [f64; UNKNOWNS] {
        [contact.x_mm, contact.y_mm, contact.fx_n, contact.fy_n, contact.fz_n].map(f64::from)
    }

    #[test]
    fn what_the_field_reads_is_decoded_again() {
        for contact in contacts(1, 5000) {
            let found = decoder().estimate(&decoder().field().strain_uv(&contact)).unwrap();
            let off = numbers(&found.contact).into_iter().zip(numbers(&contact)).enumerate();
            for (k, (found_k, wanted)) in off {
                // The search ends before its last step; and what was known before pulls a weak press a little inwards.
                let allowed = STEP_END_MM + 0.03 * found.covariance[k][k].sqrt();
                assert!((found_k - wanted).abs() < allowed, "{contact:?} {found:?}");
            }
            assert!(found.misfit < 2e-3, "{contact:?} {found:?}");
        }
    }

    #[test]
    fn errors_are_as_large_as_is_said() {
        let mut random = SplitMix64::new(2);
        let (mut squares, mut misfit, count) = ([0.0; UNKNOWNS], 0.0, 4000);
        for contact in contacts(3, count) {
            let mut strain = decoder().field().strain_uv(&contact);
            for uv in &mut strain.uv {
                *uv += 6.0 * random.normal() + 0.01 * *uv * random.normal();
            }
            let found = decoder().estimate(&strain).unwrap();
            misfit += found.misfit / count as f64;
            let off = numbers(&found.contact).into_iter().zip(numbers(&contact));
            for (k, (found_k, wanted)) in off.enumerate() {
                squares[k] += (found_k - wanted).powi(2) / found.covariance[k][k] / count as f64;
            }
        }
        // Each error in its own standard deviation: 1. Four channels are more than the unknowns need.
        assert!(squares.iter().all(|square| (square - 1.0).abs() < 0.12), "{squares:?}");
        assert!((misfit - 4.0).abs() < 0.25, "{misfit}");
    }

    #[test]
    fn without_force_it_is_in_the_middle_and_nonsense_is_nothing() {
        let rest = decoder().decode(&Strain::default());
        assert!(numbers(&rest).iter().all(|number| number.abs() < 1e-3), "{rest:?}");
        for uv in [f32::NAN, f32::INFINITY, f32::MAX] {
            let mut strain = Strain { uv: [100.0; CHANNELS] };
            strain.uv[4] = uv;
            assert!(numbers(&decoder().decode(&strain)).iter().all(|number| number.is_finite()), "{uv}");
        }
    }
}
