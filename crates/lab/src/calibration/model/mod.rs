//! The parameters in which a pad may differ from the nominal one, the model of the channels, and its prior.
//!
//! Channel k reads at a contact
//!
//! ```text
//! yₖ = zₖ + Σₗ (1 + X)ₖₗ sₗ + Σᵢ wᵢₖ lᵢₖ + c uₖ,    sₗ = (1 + αₗ ΔT) (S gₗ eₗ + dₗ)
//! eₗ = (1 + A b) Σₐ Fₐ Eₗₐ(x, y),    E = G + b ∇²G + Σⱼ wⱼ(qⱼ) ∂G/∂pⱼ,    dₗ = ρ (1 + A b) Σₐ Fₐ Dₗₐ(x, y)
//! ```
//!
//! with zeros z, a scale S that is 1 where labels tell newtons, gains g and their temperature coefficients α, strains e before gains,
//! crosstalk X by the law of the channels ([`tactpad_core::pad::channels`]; a test holds them against it), shares w and lags l of the
//! play operators, creep's share c and state u, blur b, and weights w of physical parameters q ([`physical`](self::physical)). G is
//! the simulator's field. A is what ageing takes over the measurement, and b the part of it that was still to come at the contact
//! ([`ageing`](super::ageing)): a decoder is of the pad as it was at last. Place and force of a written label are corrected by the
//! rig's errors ([`rig`](crate::calibration::data::rig)), of which ρ is the gain of the reference.
//!
//! D is the background: in readings by newtons as written, and at places as written. What gains and forces multiplied would have too
//! small a background, as the most probable product of a number and hundreds of small ones has them too small; and at corrected
//! places a fit would find that scale of the stage by which the background's polynomials suit best.

pub(crate) mod background_deviations;
pub(crate) mod physical;
pub(crate) mod prior;
pub(crate) mod prior_deviations;

use self::physical::Physical;
use self::prior::Prior;
use self::prior_deviations::{
    AGEING_DEVIATION, BLUR_DEVIATION_MM2, CREEP_DEVIATION, FINGER_BLUR_DEVIATION_MM2, GAIN_DEVIATION,
    GAIN_SLOPE_DEVIATION, LOG_SCALE_DEVIATION, ParameterKind, PriorDeviations, SHARE_DEVIATION,
    WEIGHT_BLUR_DEVIATION_MM2,
};
use crate::calibration::data::contacts::{
    BACKGROUND_DEGREE, FieldAtPlace, Knowledge, Lags, Maps, Measured, TERMS, response,
};
use crate::calibration::data::rig::{REFERENCE_GAIN, RIG_NUMBERS, RigPrior};
use tactpad_core::pipeline::compensation::hysteresis::{Hysteresis, PLAYS};
use tactpad_core::pipeline::contact::inverse::CROSSTALK_MAX;
use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;
use tactpad_core::quantity::{CHANNELS, MODULES};
use tactpad_numeric::memory::{PlayOperator, Relaxation};
use tactpad_numeric::products::{combined, dot};

/// A precision that no measurement outweighs.
pub(crate) const CERTAIN: f64 = 1e18;
/// Largest magnitude of a play operator's share. A negative one corrects another.
const SHARE_MAX: f64 = 0.25;

/// The parameter vector θ, by kind: zeros, gains, crosstalk (into, from), hysteresis (shares of all channels; each channel's
/// difference), creep, blur, temperature coefficients of the gains, ln S, blur of a weight, ageing, the rig, physical
/// parameters, background (channel, force, polynomial).
#[derive(Clone, Debug)]
pub(crate) struct ParameterLayout {
    pub(crate) physical: Vec<Physical>,
    /// Polynomials of the background for each channel and force: 0 or [`TERMS`].
    pub(crate) terms: usize,
    /// Whether no contact was written down by a reference.
    pub(crate) is_play: bool,
    /// Where the modules stand, counter-clockwise from +x.
    pub(crate) module_angles_deg: [f64; MODULES],
}

const ZEROS: usize = 0;
const GAINS: usize = ZEROS + CHANNELS;
const CROSSTALKS: usize = GAINS + CHANNELS;
const SHARES: usize = CROSSTALKS + CHANNELS * CHANNELS;
const OWN_SHARES: usize = SHARES + PLAYS;
const CREEP: usize = OWN_SHARES + PLAYS * CHANNELS;
const BLUR: usize = CREEP + 1;
const GAIN_SLOPES: usize = BLUR + 1;
const LOG_SCALE: usize = GAIN_SLOPES + CHANNELS;
const WEIGHT_BLUR: usize = LOG_SCALE + 1;
const AGEING: usize = WEIGHT_BLUR + 1;
const RIG_AT: usize = AGEING + 1;
const PHYSICAL: usize = RIG_AT + RIG_NUMBERS;

impl ParameterLayout {
    pub(crate) const fn size(&self) -> usize {
        self.background(0, 0) + 3 * CHANNELS * self.terms
    }

    /// Place of the first coefficient of the background in a channel's map of a force.
    pub(crate) const fn background(&self, channel: usize, axis: usize) -> usize {
        PHYSICAL + self.physical.len() + (3 * channel + axis) * self.terms
    }

    /// The prior's mean m.
    pub(crate) fn prior_mean(&self, prior: &Prior, rig: &RigPrior) -> Vec<f64> {
        let mut values = vec![0.0; self.size()];
        values[GAINS..CROSSTALKS].copy_from_slice(&prior.gain);
        values[CROSSTALKS..SHARES].copy_from_slice(prior.crosstalk.as_flattened());
        for (play, shares) in prior.shares.iter().enumerate() {
            // wᵢₖ = w̄ᵢ + (wᵢₖ − w̄ᵢ): the mean over the channels, and each channel's difference.
            values[SHARES + play] = shares.iter().sum::<f64>() / CHANNELS as f64;
            for (channel, share) in shares.iter().enumerate() {
                values[OWN_SHARES + play * CHANNELS + channel] = share - values[SHARES + play];
            }
        }
        values[CREEP] = prior.creep.share;
        values[RIG_AT..PHYSICAL].copy_from_slice(&rig.mean);
        values
    }

    /// The diagonal P of the prior's precisions.
    pub(crate) fn precisions(&self, prior_deviations: &PriorDeviations, rig: &RigPrior) -> Vec<f64> {
        let mut deviations = vec![0.0; self.size()];
        // P = 1/σ² with these σ, kind by kind.
        deviations[ZEROS..GAINS].fill(prior_deviations.of(ParameterKind::Zero));
        deviations[GAINS..CROSSTALKS].fill(GAIN_DEVIATION);
        // A channel has no crosstalk with itself.
        for (index, deviation) in deviations[CROSSTALKS..SHARES].iter_mut().enumerate() {
            *deviation = self.crosstalk_kind(index).map_or(0.0, |kind| prior_deviations.of(kind));
        }
        deviations[SHARES..OWN_SHARES].fill(SHARE_DEVIATION);
        deviations[OWN_SHARES..CREEP].fill(prior_deviations.of(ParameterKind::OwnHysteresis));
        deviations[CREEP] = CREEP_DEVIATION;
        deviations[BLUR] = BLUR_DEVIATION_MM2;
        deviations[GAIN_SLOPES..LOG_SCALE].fill(GAIN_SLOPE_DEVIATION);
        if self.is_play {
            deviations[BLUR] = FINGER_BLUR_DEVIATION_MM2;
            (deviations[LOG_SCALE], deviations[WEIGHT_BLUR]) =
                (LOG_SCALE_DEVIATION, WEIGHT_BLUR_DEVIATION_MM2);
        } else {
            // Only a reference tells what ageing takes, and only a rig has a rig's errors.
            deviations[AGEING] = AGEING_DEVIATION;
            let rig = deviations[RIG_AT..PHYSICAL].iter_mut().zip(rig.precision);
            rig.for_each(|(deviation, precision)| *deviation = precision.sqrt().recip());
        }
        for (deviation, parameter) in deviations[PHYSICAL..].iter_mut().zip(&self.physical) {
            *deviation = prior_deviations.of_one(parameter.kind(), parameter.parameter.module());
        }
        for (degree, at) in self.background_degrees() {
            deviations[at] = prior_deviations.background.of(degree);
        }
        // What cannot differ is certain.
        deviations.iter().map(|deviation| (1.0 / deviation.powi(2)).min(CERTAIN)).collect()
    }

    /// The kind of the crosstalk at this place of the matrix. Presses without labels hardly tell what is within a module from its
    /// pose: there all crosstalk has one deviation.
    fn crosstalk_kind(&self, index: usize) -> Option<ParameterKind> {
        let kind = ParameterKind::of_crosstalk(index)?;
        Some(if self.is_play { ParameterKind::CrosstalkUnlabelled } else { kind })
    }

    /// Places of the parameters whose kinds share a prior standard deviation, and the module that each is of.
    pub(crate) fn kinds(&self) -> impl Iterator<Item = (ParameterKind, Option<usize>, usize)> {
        let physical =
            self.physical.iter().zip(PHYSICAL..).map(|(it, at)| (it.kind(), it.parameter.module(), at));
        let own = (OWN_SHARES..CREEP).map(|at| (ParameterKind::OwnHysteresis, None, at));
        let zeros = (ZEROS..GAINS).map(|at| (ParameterKind::Zero, None, at));
        let crosstalk = (0..CHANNELS * CHANNELS)
            .filter_map(|index| Some((self.crosstalk_kind(index)?, None, CROSSTALKS + index)));
        zeros.chain(crosstalk).chain(own).chain(physical)
    }

    /// Degree and place of each coefficient of the background: n + 1 of degree n for each map.
    pub(crate) fn background_degrees(&self) -> impl Iterator<Item = (usize, usize)> {
        let degrees = (0..=BACKGROUND_DEGREE).flat_map(|n| std::iter::repeat_n(n, n + 1));
        degrees.cycle().zip(self.background(0, 0)..self.size())
    }

    /// Axis of the force and place of each of them.
    pub(crate) fn background_axes(&self) -> impl Iterator<Item = (usize, usize)> {
        let axes = (0..3).flat_map(|axis| std::iter::repeat_n(axis, self.terms));
        axes.cycle().zip(self.background(0, 0)..self.size())
    }

    /// What each module's displacement has of the mean of all, by its parameters' places: to contacts with labels that is the stage's.
    /// The mean counts a module by its prior's precision: one that is far off moves it little, or the two others would seem to be off.
    pub(crate) fn common_shift(&self, differences: &[f64], precisions: &[f64]) -> Vec<(usize, f64)> {
        // The parameter's direction: outwards, or counter-clockwise.
        let direction = |it: &Physical| {
            let (sin, cos) = self.module_angles_deg[it.parameter.module()?].to_radians().sin_cos();
            Some(if it.parameter.name().ends_with("radial_mm") { [cos, sin] } else { [-sin, cos] })
        };
        let is_shift = |(it, _): &(&Physical, usize)| it.kind() == ParameterKind::Shift;
        let shifts = self.physical.iter().zip(PHYSICAL..).filter(is_shift);
        let shifts: Vec<(usize, [f64; 2])> =
            shifts.filter_map(|(it, at)| Some((at, direction(it)?))).collect();
        let mean = [0, 1].map(|axis| {
            // Both parameters of a module have one precision, and two directions at right angles.
            let [sum, whole] = shifts.iter().fold([0.0; 2], |[sum, whole], (at, direction)| {
                let weight = precisions[*at];
                [sum + weight * direction[axis] * differences[*at], whole + weight * direction[axis].powi(2)]
            });
            sum / whole
        });
        shifts.iter().map(|(at, direction)| (*at, dot(direction, &mean))).collect()
    }

    /// The scale S of all that a load makes.
    fn scale_factor(values: &[f64]) -> f64 {
        libm::exp(values[LOG_SCALE])
    }

    /// A channel's gain S gₖ.
    pub(crate) fn gain(values: &[f64], channel: usize) -> f64 {
        Self::scale_factor(values) * values[GAINS + channel]
    }

    /// The hysteresis by these parameters. Thresholds are in strains before gains: rᵢₖ = thresholdᵢ |gₖ|.
    pub(crate) fn hysteresis(values: &[f64], thresholds_uv: &[f64; PLAYS]) -> Hysteresis {
        std::array::from_fn(|play| {
            std::array::from_fn(|k| PlayOperator {
                threshold: thresholds_uv[play] * Self::gain(values, k).abs(),
                share: Self::share(values, play, k).clamp(-SHARE_MAX, SHARE_MAX),
            })
        })
    }

    /// The creep by these parameters.
    pub(crate) fn creep(values: &[f64], time_s: f64) -> Relaxation {
        if time_s == 0.0 {
            return Relaxation::NONE;
        }
        Relaxation { time_s, share: values[CREEP].clamp(-SHARE_MAX, SHARE_MAX) }
    }

    fn share(values: &[f64], play: usize, channel: usize) -> f64 {
        values[SHARES + play] + values[OWN_SHARES + play * CHANNELS + channel]
    }

    /// Memory of earlier loads in a channel, µV: Σᵢ wᵢ lᵢ + c u, by lags l and creep states u.
    pub(crate) fn memory_uv(values: &[f64], channel: usize, lags: &Lags, crept_uv: &[f64; CHANNELS]) -> f64 {
        let of_play =
            |(play, lags): (usize, &[f64; CHANNELS])| Self::share(values, play, channel) * lags[channel];
        values[CREEP] * crept_uv[channel] + lags.iter().enumerate().map(of_play).sum::<f64>()
    }

    /// Its derivatives: ∂/∂wᵢₖ = lᵢₖ and ∂/∂c = uₖ.
    pub(crate) fn add_memory_slopes(
        channel: usize,
        lags: &Lags,
        crept_uv: &[f64; CHANNELS],
        derivatives: &mut [f64],
    ) {
        derivatives[CREEP] = crept_uv[channel];
        for (play, lags) in lags.iter().enumerate() {
            derivatives[SHARES + play] = lags[channel];
            derivatives[OWN_SHARES + play * CHANNELS + channel] = lags[channel];
        }
    }

    /// The zeros z.
    pub(crate) fn zeros(values: &[f64]) -> [f64; CHANNELS] {
        std::array::from_fn(|channel| values[ZEROS + channel])
    }

    /// The rig's parameters ρ.
    pub(crate) fn rig(values: &[f64]) -> [f64; RIG_NUMBERS] {
        std::array::from_fn(|at| values[RIG_AT + at])
    }

    /// ρ: what the reference writes of a newton.
    fn reference_gain(values: &[f64]) -> f64 {
        libm::exp(values[RIG_AT + REFERENCE_GAIN])
    }

    /// Place of the first parameter of the rig.
    pub(crate) const fn first_of_rig() -> usize {
        RIG_AT
    }

    /// Place of what ageing takes over the measurement.
    pub(crate) const fn ageing_at() -> usize {
        AGEING
    }

    /// Gain at a contact over the gain after the measurement, dimensionless: 1 + A b, with ageing A and the part b of it still to come.
    pub(crate) fn gain_before_ageing(values: &[f64], contact: &Measured) -> f64 {
        1.0 + values[AGEING] * contact.to_come
    }

    /// The force that would give now what a contact's gave then.
    fn force_now_n(values: &[f64], contact: &Measured) -> [f64; 3] {
        contact.force_n.map(|n| Self::gain_before_ageing(values, contact) * n)
    }

    /// Place of the first channel's temperature coefficient of gain, 1/°C.
    pub(crate) const fn first_gain_slope() -> usize {
        GAIN_SLOPES
    }

    /// Place of the first physical parameter.
    pub(crate) const fn first_physical() -> usize {
        PHYSICAL
    }

    /// Place of a channel's zero.
    pub(crate) const fn zero_at(channel: usize) -> usize {
        ZEROS + channel
    }

    /// 1 + X.
    fn coupling(values: &[f64]) -> [[f64; CHANNELS]; CHANNELS] {
        std::array::from_fn(|into| {
            std::array::from_fn(|from| {
                let own = f64::from(u8::from(into == from));
                own + values[CROSSTALKS + into * CHANNELS + from]
            })
        })
    }

    /// Crosstalk X, of which no decoder has more than a bound.
    pub(crate) fn crosstalk(values: &[f64]) -> [[f64; CHANNELS]; CHANNELS] {
        let most = f64::from(CROSSTALK_MAX);
        let share = |into: usize, from: usize| values[CROSSTALKS + into * CHANNELS + from].clamp(-most, most);
        std::array::from_fn(|into| {
            std::array::from_fn(|from| if into == from { 0.0 } else { share(into, from) })
        })
    }

    /// A channel's gain S gₖ as a sum of parameters, in linear order: ∂/∂gₖ = S, ∂/∂ln S = S gₖ.
    pub(crate) fn gain_terms(values: &[f64], channel: usize) -> [(usize, f64); 2] {
        [(GAINS + channel, Self::scale_factor(values)), (LOG_SCALE, Self::gain(values, channel))]
    }

    /// Place of the crosstalk into a channel from another one.
    pub(crate) const fn crosstalk_at(into: usize, from: usize) -> usize {
        CROSSTALKS + into * CHANNELS + from
    }

    /// Places of a channel's share of a play operator: that of all channels, and its own difference from it.
    pub(crate) const fn share_at(play: usize, channel: usize) -> [usize; 2] {
        [SHARES + play, OWN_SHARES + play * CHANNELS + channel]
    }

    /// Places of creep's share, and of the blur.
    pub(crate) const fn creep_and_blur_at() -> [usize; 2] {
        [CREEP, BLUR]
    }

    /// Places of what differs from play to play while the pad stays the same: the blur, the shares of all channels, creep.
    pub(crate) fn differing_at() -> [usize; 2 + PLAYS] {
        std::array::from_fn(|at| [BLUR, CREEP].get(at).copied().unwrap_or(SHARES + at.saturating_sub(2)))
    }

    /// Prior standard deviations of these.
    pub(crate) fn differing_deviations() -> [f64; 2 + PLAYS] {
        let first = [FINGER_BLUR_DEVIATION_MM2, CREEP_DEVIATION];
        std::array::from_fn(|at| first.get(at).copied().unwrap_or(SHARE_DEVIATION))
    }

    /// The weights w of the field's derivatives by the physical parameters, and ∂w/∂q.
    fn weights(&self, values: &[f64]) -> impl Iterator<Item = [f64; 2]> {
        self.physical.iter().zip(&values[PHYSICAL..]).map(|(it, q)| it.weight(*q))
    }

    /// The strain maps E at a place, µV/N before gains.
    fn strain_maps(&self, values: &[f64], place: &FieldAtPlace, knowledge: Knowledge) -> Maps {
        // E = G + b ∇²G …
        let mut maps = place.gains;
        for (map, laplacian) in maps.as_flattened_mut().iter_mut().zip(place.laplacian.as_flattened()) {
            *map += values[blur_at(knowledge)] * laplacian;
        }
        // … + Σⱼ wⱼ ∂G/∂pⱼ …
        for ([weight, _], slope) in self.weights(values).zip(&place.sensitivities) {
            for (map, slope) in maps.as_flattened_mut().iter_mut().zip(slope.as_flattened()) {
                *map += weight * slope;
            }
        }
        maps
    }

    /// Adds the background to maps: ρ scale Σₜ βₜ Uₜ(x, y), by its polynomials' coefficients β and their values U.
    fn add_background(&self, values: &[f64], scale: &Maps, terms: &[f64; TERMS], maps: &mut Maps) {
        let background = values[self.background(0, 0)..].chunks_exact(TERMS);
        let maps = maps.as_flattened_mut().iter_mut().zip(scale.as_flattened());
        let written = Self::reference_gain(values);
        for ((map, scale), coefficients) in maps.zip(background) {
            *map +=
                written * scale * coefficients.iter().zip(terms).map(|(beta, term)| beta * term).sum::<f64>();
        }
    }

    /// From maps of the strains to those of the channels: (1 + X)ₖₗ (S gₗ Eₗ + Dₗ), with D by these values of the polynomials.
    fn channel_maps(&self, values: &[f64], scale: &Maps, strains: &Maps, terms: &[f64; TERMS]) -> Maps {
        let mut signals: Maps =
            std::array::from_fn(|channel| strains[channel].map(|map| Self::gain(values, channel) * map));
        self.add_background(values, scale, terms, &mut signals);
        Self::coupling(values).map(|shares| {
            std::array::from_fn(|axis| {
                shares.iter().zip(&signals).map(|(share, from)| share * from[axis]).sum::<f64>()
            })
        })
    }

    /// The channels' maps at a place, µV/N.
    pub(crate) fn maps(
        &self,
        values: &[f64],
        scale: &Maps,
        place: &FieldAtPlace,
        knowledge: Knowledge,
    ) -> Maps {
        let strains = self.strain_maps(values, place, knowledge);
        self.channel_maps(values, scale, &strains, &place.terms)
    }

    /// The channels' signals under a contact's load alone: without zeros, hysteresis and creep.
    pub(crate) fn load_uv(&self, values: &[f64], scale: &Maps, contact: &Measured) -> [f64; CHANNELS] {
        self.maps(values, scale, &contact.place, contact.knowledge)
            .map(|map| response(&map, &Self::force_now_n(values, contact)))
    }

    /// ∇E along x or y at a place, µV/N per mm. The blur is left out.
    fn strain_gradient(&self, values: &[f64], place: &FieldAtPlace, axis: usize) -> Maps {
        // ∇G + Σⱼ wⱼ ∇∂G/∂pⱼ.
        let mut maps = place.gradient[axis];
        for ([weight, _], slope) in self.weights(values).zip(&place.sensitivity_gradients) {
            for (map, slope) in maps.as_flattened_mut().iter_mut().zip(slope[axis].as_flattened()) {
                *map += weight * slope;
            }
        }
        maps
    }

    /// The channels' derivatives by x, y (µV/mm), Fx, Fy, Fz (µV/N).
    pub(crate) fn label_jacobian(
        &self,
        values: &[f64],
        scale: &Maps,
        contact: &Measured,
    ) -> [[f64; UNKNOWNS]; CHANNELS] {
        let maps = self.maps(values, scale, &contact.place, contact.knowledge);
        let (gain, force_n) = (Self::gain_before_ageing(values, contact), Self::force_now_n(values, contact));
        // By the place Σₐ Fₐ ∇ of the maps, where the background stays; by the force the maps.
        let by_place = [0, 1].map(|axis| {
            let gradient = self.strain_gradient(values, &contact.place, axis);
            self.channel_maps(values, scale, &gradient, &[0.0; TERMS]).map(|map| response(&map, &force_n))
        });
        std::array::from_fn(|channel| {
            let [fx, fy, fz] = maps[channel].map(|uv_per_n| gain * uv_per_n);
            [by_place[0][channel], by_place[1][channel], fx, fy, fz]
        })
    }

    /// The signals at a contact, sₗ = (1 + αₗ ΔT) (S gₗ eₗ + dₗ).
    fn signals(&self, values: &[f64], scale: &Maps, contact: &Measured) -> Signals {
        let Measured { knowledge, place, above_c, .. } = contact;
        let force_n = Self::force_now_n(values, contact);
        let strains_uv = self.strain_maps(values, place, *knowledge).map(|map| response(&map, &force_n));
        let mut background = [[0.0; 3]; CHANNELS];
        self.add_background(values, scale, &place.terms, &mut background);
        let background_uv = background.map(|map| response(&map, &force_n));
        let warmth = std::array::from_fn(|k| 1.0 + values[GAIN_SLOPES + k] * above_c);
        let reference_uv = std::array::from_fn(|k| Self::gain(values, k) * strains_uv[k] + background_uv[k]);
        let uv = std::array::from_fn(|k| warmth[k] * reference_uv[k]);
        Signals { force_n, strains_uv, background_uv, reference_uv, warmth, uv }
    }

    /// The model f(θ) of the channels at a contact, µV: (1 + X) s + z + memory.
    pub(crate) fn readings(&self, values: &[f64], scale: &Maps, contact: &Measured) -> [f64; CHANNELS] {
        let (signals, coupling) = (self.signals(values, scale, contact), Self::coupling(values));
        std::array::from_fn(|channel| {
            let memory_uv = Self::memory_uv(values, channel, &contact.lags, &contact.crept_uv);
            dot(&coupling[channel], &signals.uv) + values[ZEROS + channel] + memory_uv
        })
    }

    /// ∂f/∂θ at a contact.
    pub(crate) fn slopes(&self, values: &[f64], scale: &Maps, contact: &Measured) -> ReadingSlopes {
        let Measured { knowledge, place, lags, crept_uv, above_c, to_come, .. } = contact;
        let gain_before_ageing = Self::gain_before_ageing(values, contact);
        let signals = self.signals(values, scale, contact);
        let force_n = &signals.force_n;
        let weights: Vec<[f64; 2]> = self.weights(values).collect();
        let (factor, written) = (Self::scale_factor(values), Self::reference_gain(values));
        let of_signal = |channel: usize| {
            let mut slopes = vec![0.0; self.size()];
            let warmth = signals.warmth[channel];
            let gain = warmth * Self::gain(values, channel);
            // ∂/∂gₖ = S (1 + αₖ ΔT) eₖ, ∂/∂αₖ = ΔT (S gₖ eₖ + dₖ), ∂/∂ln S = (1 + αₖ ΔT) S gₖ eₖ, ∂/∂A = b sₖ/(1 + A b).
            slopes[GAINS + channel] = factor * warmth * signals.strains_uv[channel];
            slopes[GAIN_SLOPES + channel] = above_c * signals.reference_uv[channel];
            slopes[LOG_SCALE] = gain * signals.strains_uv[channel];
            slopes[AGEING] = to_come * signals.uv[channel] / gain_before_ageing;
            // ∂/∂ln ρ where forces stay: the background's part.
            slopes[RIG_AT + REFERENCE_GAIN] = warmth * signals.background_uv[channel];
            // With h = S (1 + αₖ ΔT) gₖ: ∂/∂b = h F·∇²Gₖ, ∂/∂qⱼ = h ∂wⱼ/∂qⱼ F·∂Gₖ/∂pⱼ.
            slopes[blur_at(*knowledge)] = gain * response(&place.laplacian[channel], force_n);
            let physical = weights.iter().zip(&place.sensitivities);
            for (slope, ([_, by_parameter], maps)) in slopes[PHYSICAL..].iter_mut().zip(physical) {
                *slope = gain * by_parameter * response(&maps[channel], force_n);
            }
            // ∂/∂βₖₐₜ = ρ (1 + αₖ ΔT) Fₐ scaleₖₐ Uₜ.
            for axis in 0..3 {
                let factor = warmth * written * scale[channel][axis] * force_n[axis];
                let terms = slopes[self.background(channel, axis)..].iter_mut().zip(&place.terms);
                terms.for_each(|(slope, term)| *slope = factor * term);
            }
            slopes
        };
        let beside_signals = |channel: usize| {
            let mut slopes = vec![0.0; self.size()];
            // ∂/∂zₖ = 1, ∂/∂Xₖₗ = sₗ.
            slopes[ZEROS + channel] = 1.0;
            slopes[CROSSTALKS + channel * CHANNELS..][..CHANNELS].copy_from_slice(&signals.uv);
            slopes[CROSSTALKS + channel * CHANNELS + channel] = 0.0;
            Self::add_memory_slopes(channel, lags, crept_uv, &mut slopes);
            slopes
        };
        ReadingSlopes {
            coupling: Self::coupling(values),
            signals: (0..CHANNELS).map(of_signal).collect(),
            rest: (0..CHANNELS).map(beside_signals).collect(),
        }
    }
}

/// Signals at a contact, by channel, before crosstalk, zeros and memory.
struct Signals {
    force_n: [f64; 3],
    /// eₗ.
    strains_uv: [f64; CHANNELS],
    /// dₗ.
    background_uv: [f64; CHANNELS],
    /// S gₗ eₗ + dₗ.
    reference_uv: [f64; CHANNELS],
    /// 1 + αₗ ΔT.
    warmth: [f64; CHANNELS],
    /// sₗ.
    uv: [f64; CHANNELS],
}

/// Derivatives of the readings by the parameters, a row for each channel:
///
/// ```text
/// ∂y/∂θ = (1 + X) ∂s/∂θ + ∂y/∂θ where s stays
/// ```
///
/// Both parts have few entries, as most parameters are of one channel's signal alone; their sum has many.
pub(crate) struct ReadingSlopes {
    /// 1 + X.
    pub(crate) coupling: [[f64; CHANNELS]; CHANNELS],
    /// ∂s/∂θ.
    pub(crate) signals: Vec<Vec<f64>>,
    /// ∂y/∂θ where s stays.
    pub(crate) rest: Vec<Vec<f64>>,
}

impl ReadingSlopes {
    /// ∂y/∂θ.
    pub(crate) fn whole(&self) -> Vec<Vec<f64>> {
        let mut rows = combined(&self.coupling, &self.signals);
        for (row, rest) in rows.iter_mut().zip(&self.rest) {
            row.iter_mut().zip(rest).for_each(|(slope, rest)| *slope += rest);
        }
        rows
    }

    /// The same beside further parameters, whose derivatives stand at the ends of these rows.
    pub(crate) fn widened(mut self, rows: &[Vec<f64>]) -> Self {
        for ((signal, rest), row) in self.signals.iter_mut().zip(&mut self.rest).zip(rows) {
            rest.extend(&row[rest.len()..]);
            signal.resize(row.len(), 0.0);
        }
        self
    }
}

/// Place of the blur of what presses: a weight has its own.
const fn blur_at(knowledge: Knowledge) -> usize {
    match knowledge {
        Knowledge::Placed(_) => WEIGHT_BLUR,
        Knowledge::Written | Knowledge::Unlabelled => BLUR,
    }
}

#[cfg(test)]
mod tests;
