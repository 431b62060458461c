//! Standard deviations of the prior, by kind of parameter: how carefully pads are built.
//!
//! They begin with what hands and parts are known to do. A pad that was built better shows it, as its parameters lie closer to
//! the prior's mean: the deviations are found by the evidence (D. J. C. MacKay, Neural Computation 4 (1992) 415).
//!
//! Most modules are put down where they belong, and some are not. So the prior of a module's displacement is a mixture of two
//! normal densities, as a scale mixture: a number λ scales the precision of both its coordinates, and is 1 or 1/WIDE².

use super::background_deviations::{BackgroundDeviations, Coefficient};
use tactpad_core::quantity::{CHANNELS, MODULES};

/// Kinds of parameters that share a prior standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ParameterKind {
    /// Of a module, mm.
    Shift,
    /// Of a module, degrees.
    Turn,
    /// Of a module, a factor's logarithm.
    Stiffness,
    /// Of the plate, a factor's logarithm.
    PlateThickness,
    /// Of a material of all modules, a factor's logarithm.
    CommonModulus,
    /// Of another module's microvolts.
    Crosstalk,
    /// Of the microvolts of another channel of the same module.
    CrosstalkWithin,
    /// Of another channel's microvolts, where no contact has a label.
    CrosstalkUnlabelled,
    /// Remainder of a zero that was taken off, µV.
    Zero,
    /// Difference of a channel's hysteresis share from the mean of all channels.
    OwnHysteresis,
}

impl ParameterKind {
    /// Of the crosstalk at this place of the matrix, row by row; a channel has none with itself.
    pub(crate) const fn of_crosstalk(index: usize) -> Option<Self> {
        let (into, from) = (index / CHANNELS, index % CHANNELS);
        if into == from {
            None
        } else if into * MODULES / CHANNELS == from * MODULES / CHANNELS {
            Some(Self::CrosstalkWithin)
        } else {
            Some(Self::Crosstalk)
        }
    }
}

const KINDS: usize = 10;
/// Standard deviations that the search begins with. Modules are assembled by hand; stiffness is that of a modulus.
const SHIFT_MM: f64 = 0.15;
const TURN_DEG: f64 = 2.0;
const STIFFNESS: f64 = 0.3;
/// Sheets are rolled to some percent, and another sheet may have been at hand; glues and laminates cure as they do.
const PLATE_THICKNESS: f64 = 0.08;
const COMMON_MODULUS: f64 = 0.2;
const CROSSTALK: f64 = 0.02;
/// Channels of one module that share more than this times that have more in common than a leak.
const SHARED_WITHIN: f64 = 1.5;
const ZERO_UV: f64 = 20.0;
/// Of unbalanced bridges: some tenths of a percent of a gauge.
const RAW_ZERO_UV: f64 = 2000.0;
const HYSTERESIS_OWN: f64 = 0.02;
/// Deviations of the wide part of a module's displacement over those of the narrow one, and the probability of the wide one.
const WIDE: f64 = 5.0;
const WIDE_PROBABILITY: f64 = 0.1;
/// λ of the wide part.
const FAR_OFF: f64 = 1.0 / (WIDE * WIDE);
/// Prior standard deviations. Of gains: the authors' earlier pad has 0.83 to 1.33.
pub(crate) const GAIN_DEVIATION: f64 = 0.3;
/// Of ln S, the scale of all that a load makes, where no label tells newtons. Presses alone say nothing of it: with S twice as
/// large all forces are half as large.
pub(crate) const LOG_SCALE_DEVIATION: f64 = 0.5;
/// Half the mean square of the distance at which a contact's force acts from its place, along each axis: an indenter of
/// another size, or a finger that is not still. A disc of radius a has a²/8: fingertips have some 5 mm, weights 10 mm.
pub(crate) const BLUR_DEVIATION_MM2: f64 = 0.5;
pub(crate) const FINGER_BLUR_DEVIATION_MM2: f64 = 3.0;
pub(crate) const WEIGHT_BLUR_DEVIATION_MM2: f64 = 8.0;
/// Of a play operator in all channels.
pub(crate) const SHARE_DEVIATION: f64 = 0.05;
/// Of creep's share of a load in the end: adhesive and polyimide.
pub(crate) const CREEP_DEVIATION: f64 = 0.01;
/// Of a gain, per degree: adhesive and polyimide soften by a thousandth.
pub(crate) const GAIN_SLOPE_DEVIATION: f64 = 1e-3;
/// Of what ageing takes over a measurement.
pub(crate) const AGEING_DEVIATION: f64 = 0.05;
/// Parameters of its kind that each initial deviation counts as.
const PSEUDO_COUNT: f64 = 4.0;

/// A parameter beside the mean m of its prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Deviating {
    pub(crate) kind: ParameterKind,
    /// The module that it is of.
    pub(crate) module: Option<usize>,
    /// θ − m.
    pub(crate) difference: f64,
    /// Its posterior variance.
    pub(crate) variance: f64,
}

/// Prior standard deviations, by kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PriorDeviations {
    deviations: [f64; KINDS],
    /// E[λ] of each module's displacement.
    displaced: [f64; MODULES],
    /// Those that the search began with.
    initial: [f64; KINDS],
    /// Of the background's polynomials.
    pub(crate) background: BackgroundDeviations,
}

impl PriorDeviations {
    /// At the beginning: where zeros are taken off, and where they are not.
    pub(crate) fn first(is_tared: bool) -> Self {
        let initial = [
            SHIFT_MM,
            TURN_DEG,
            STIFFNESS,
            PLATE_THICKNESS,
            COMMON_MODULUS,
            CROSSTALK,
            CROSSTALK,
            CROSSTALK,
            if is_tared { ZERO_UV } else { RAW_ZERO_UV },
            HYSTERESIS_OWN,
        ];
        let background = BackgroundDeviations::first();
        Self { deviations: initial, displaced: [1.0; MODULES], initial, background }
    }

    /// The same where those of stiffnesses, moduli and the plate's thickness begin with this share of what pads of all kinds have.
    pub(crate) fn scaled(mut self, elastic_scale: f64) -> Self {
        for kind in [ParameterKind::Stiffness, ParameterKind::PlateThickness, ParameterKind::CommonModulus]
            .map(|kind| kind as usize)
        {
            let initial = elastic_scale * Self::first(true).initial[kind];
            self.deviations[kind] *= initial / self.initial[kind];
            self.initial[kind] = initial;
        }
        self
    }

    /// The standard deviation of a kind.
    pub(crate) const fn of(&self, kind: ParameterKind) -> f64 {
        self.deviations[kind as usize]
    }

    /// At the beginning, where this module is taken to be far off.
    pub(crate) fn displaced(self, module: usize) -> Self {
        let mut displaced = [1.0; MODULES];
        displaced[module] = FAR_OFF;
        Self { deviations: self.initial, displaced, background: BackgroundDeviations::first(), ..self }
    }

    /// Whether modules seem to be put down less carefully than pads are built.
    pub(crate) fn are_displaced(&self) -> bool {
        self.of(ParameterKind::Shift) > SHIFT_MM
    }

    /// Whether channels of one module share more than leaks do.
    pub(crate) fn is_shared_within(&self) -> bool {
        self.of(ParameterKind::CrosstalkWithin) > SHARED_WITHIN * CROSSTALK
    }

    /// The standard deviation of a parameter of a kind, of this module if it is one's: σ/√λ.
    pub(crate) fn of_one(&self, kind: ParameterKind, module: Option<usize>) -> f64 {
        self.of(kind) / self.precision_factor(kind, module).sqrt()
    }

    /// ln of the density of ln σ², but for a constant: σ² are scaled inverse χ² with κ degrees of freedom about σ₀², so
    ///
    /// ```text
    /// ln p(ln σ²) = κ ln (σ₀/σ) − ½ κ (σ₀/σ)²
    /// ```
    ///
    /// which is the same whatever σ₀ is, if σ is as many times that. With it, for each module that is far off with the probability r, what
    /// the evidence with E[λ] lacks of the mixture's (the variational bound; both coordinates have one λ):
    ///
    /// ```text
    /// r ln (p/r) + (1 − r) ln ((1 − p)/(1 − r)) + E[ln λ] − ln E[λ]
    /// ```
    pub(crate) fn log_density(&self) -> f64 {
        let of = |(deviation, initial): (&f64, &f64)| {
            let ratio = initial / deviation;
            PSEUDO_COUNT * (libm::log(ratio) - 0.5 * ratio * ratio)
        };
        let by_size: f64 = self.deviations.iter().zip(&self.initial).map(of).sum();
        by_size + self.displaced.iter().map(|factor| log_mixture(*factor)).sum::<f64>()
    }

    /// λ.
    const fn precision_factor(&self, kind: ParameterKind, module: Option<usize>) -> f64 {
        match (kind, module) {
            (ParameterKind::Shift, Some(module)) => self.displaced[module],
            _ => 1.0,
        }
    }

    /// The deviations by the evidence. Of parameters with posterior variances v, and with κ pseudo-observations of the
    /// initial σ₀
    ///
    /// ```text
    /// σ² = (κ σ₀² + Σ λ (θ − m)²)/(κ + Σ γ),    γ = 1 − λ v/σ²
    /// ```
    ///
    /// where γ is how far the contacts determine a parameter (MacKay 1992). Channels of one pad do not differ in hysteresis by more
    /// than pads do: without that bound two play operators of nearly the same small threshold, with opposite shares beyond any
    /// pad's, explain what is no hysteresis. And presses without labels do not show that a pad has less crosstalk than pads have:
    /// moduli, thickness and gains imitate a part of it, so that the parameters come out too small, and the deviation by them.
    pub(crate) fn reestimated(
        &self,
        numbers: impl Iterator<Item = Deviating>,
        background: impl Iterator<Item = Coefficient>,
    ) -> Self {
        let mut squares = self.initial.map(|deviation| PSEUDO_COUNT * deviation * deviation);
        let mut counts = [PSEUDO_COUNT; KINDS];
        let mut displaced_mm2 = [0.0; MODULES];
        for Deviating { kind, module, difference, variance } in numbers {
            let factor = self.precision_factor(kind, module);
            squares[kind as usize] += factor * difference * difference;
            counts[kind as usize] += (1.0 - factor * variance / self.of(kind).powi(2)).clamp(0.0, 1.0);
            if let (ParameterKind::Shift, Some(module)) = (kind, module) {
                displaced_mm2[module] += difference * difference + variance;
            }
        }
        let displaced = displaced_mm2.map(|mm2| expected_factor(mm2 / self.of(ParameterKind::Shift).powi(2)));
        // σ² = Σ λ (θ − m)²/Σ γ, both with the pseudo-observations.
        let mut deviations: [f64; KINDS] = std::array::from_fn(|kind| (squares[kind] / counts[kind]).sqrt());
        let own_hysteresis = &mut deviations[ParameterKind::OwnHysteresis as usize];
        *own_hysteresis = own_hysteresis.min(SHARE_DEVIATION);
        let crosstalk = &mut deviations[ParameterKind::CrosstalkUnlabelled as usize];
        *crosstalk = crosstalk.max(CROSSTALK);
        Self { deviations, displaced, background: self.background.reestimated(background), ..*self }
    }
}

/// E[λ] of a module, where q = E[(θ − m)²]/σ² is summed over both coordinates of its displacement: with the probability p of
/// the wide part and its deviation W
///
/// ```text
/// odds = p/(1 − p) W⁻² exp(½ q (1 − W⁻²)),    E[λ] = (1 + odds W⁻²)/(1 + odds)
/// ```
fn expected_factor(square: f64) -> f64 {
    let odds = WIDE_PROBABILITY / (1.0 - WIDE_PROBABILITY)
        * FAR_OFF
        * libm::exp(0.5 * square.min(1e3) * (1.0 - FAR_OFF));
    (1.0 + odds * FAR_OFF) / (1.0 + odds)
}

/// What the evidence with a module's E[λ] lacks of the mixture's.
fn log_mixture(expected: f64) -> f64 {
    let far_off = ((1.0 - expected) / (1.0 - FAR_OFF)).clamp(0.0, 1.0);
    let part = |share: f64, probability: f64| {
        if share > 0.0 { share * libm::log(probability / share) } else { 0.0 }
    };
    part(far_off, WIDE_PROBABILITY)
        + part(1.0 - far_off, 1.0 - WIDE_PROBABILITY)
        + far_off * libm::log(FAR_OFF)
        - libm::log(expected)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::iter::empty;

    #[test]
    fn a_module_that_is_far_off_is_of_the_wide_part_and_the_others_are_not() {
        let both = |module: usize, mm: f64| {
            [mm, -mm].map(|difference| Deviating {
                kind: ParameterKind::Shift,
                module: Some(module),
                difference,
                variance: 1e-3,
            })
        };
        let numbers = || [both(0, 1.1), both(1, 0.2), both(2, 0.1)].into_iter().flatten();
        let found =
            (0..20).fold(PriorDeviations::first(true), |found, _| found.reestimated(numbers(), empty()));
        let of = |module| found.of_one(ParameterKind::Shift, Some(module));
        assert!(of(0) > 3.0 * found.of(ParameterKind::Shift), "{found:?}");
        assert!([1, 2].iter().all(|module| of(*module) < 1.1 * found.of(ParameterKind::Shift)), "{found:?}");
        // One module that is far off does not say that the others are.
        assert!(found.of(ParameterKind::Shift) < 1.2 * SHIFT_MM, "{found:?}");
        assert_eq!(found.of_one(ParameterKind::Turn, Some(0)), TURN_DEG);
    }

    #[test]
    fn channels_do_not_differ_in_hysteresis_by_more_than_pads_do() {
        let shares = |share: f64| {
            (0..18).map(move |at| Deviating {
                kind: ParameterKind::OwnHysteresis,
                module: None,
                difference: if at % 2 == 0 { share } else { -share },
                variance: 1e-6,
            })
        };
        let found = |share| {
            let of = (0..20)
                .fold(PriorDeviations::first(true), |found, _| found.reestimated(shares(share), empty()));
            of.of(ParameterKind::OwnHysteresis)
        };
        assert!((found(0.03) - 0.03).abs() < 0.005, "{}", found(0.03));
        assert_eq!(found(15.0), SHARE_DEVIATION);
    }

    #[test]
    fn presses_without_labels_show_more_crosstalk_but_not_less() {
        let found = |kind, share: f64| {
            let numbers = || {
                let one = Deviating { kind, module: None, difference: share, variance: 1e-6 };
                std::iter::repeat_n(one, 72)
            };
            (0..20)
                .fold(PriorDeviations::first(true), |found, _| found.reestimated(numbers(), empty()))
                .of(kind)
        };
        assert_eq!(found(ParameterKind::CrosstalkUnlabelled, 0.005), CROSSTALK);
        assert!(found(ParameterKind::Crosstalk, 0.005) < 0.5 * CROSSTALK);
        assert!((found(ParameterKind::CrosstalkUnlabelled, 0.05) - 0.05).abs() < 0.002);
    }

    #[test]
    fn a_scale_of_the_deviations_is_neither_for_nor_against_a_pad() {
        let wide = PriorDeviations::first(true);
        let alike = wide.scaled(0.25);
        assert_eq!(
            [ParameterKind::Stiffness, ParameterKind::Turn].map(|kind| alike.of(kind)),
            [0.25 * STIFFNESS, TURN_DEG]
        );
        assert!((alike.scaled(1.0).of(ParameterKind::Stiffness) - STIFFNESS).abs() < 1e-12);
        assert!((alike.log_density() - wide.log_density()).abs() < 1e-9);
        // What was found is in proportion.
        let stiff = (0..9).map(|_| Deviating {
            kind: ParameterKind::Stiffness,
            module: None,
            difference: 0.6,
            variance: 1e-3,
        });
        let found = wide.reestimated(stiff, empty());
        assert!(
            (found.scaled(0.25).of(ParameterKind::Stiffness) / found.of(ParameterKind::Stiffness) - 0.25)
                .abs()
                < 1e-12
        );
        assert!(found.log_density() < wide.log_density() - 0.5, "{found:?}");
    }

    #[test]
    fn with_what_it_lacks_the_evidence_is_that_of_the_mixture() {
        for square in [0.0, 3.0, 7.0, 12.0, 80.0_f64] {
            let mixture: f64 = [(1.0 - WIDE_PROBABILITY, 1.0), (WIDE_PROBABILITY, FAR_OFF)]
                .map(|(probability, factor)| probability * factor * (-0.5 * factor * square).exp())
                .iter()
                .sum();
            let expected = expected_factor(square);
            let normal = expected.ln() - 0.5 * expected * square;
            assert!((normal + log_mixture(expected) - mixture.ln()).abs() < 1e-9, "{square}");
        }
    }

    #[test]
    fn what_the_parts_have_in_common_is_between_them() {
        assert!((expected_factor(0.0) - 1.0).abs() < 0.01);
        assert!((expected_factor(1e9) - FAR_OFF).abs() < 1e-12);
    }
}
