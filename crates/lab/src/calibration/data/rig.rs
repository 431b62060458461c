//! The rig among the parameters of a fit: what is systematically wrong with the labels.
//!
//! A written label L stands for the contact T(L; ρ) of [`RigErrors`]. What the channels read of it changes with an error ρⱼ by
//! J ∂T/∂ρⱼ, where J are their derivatives by x, y, Fx, Fy, Fz.
//!
//! Most rigs are right in most of this, and some are wrong in some of it. So the prior of a cause's numbers is a mixture of two
//! normal densities, a narrow one and a wide one, and the fit has the normal densities that leave the same posterior moments.
//!
//! Source: T. P. Minka, Expectation propagation for approximate Bayesian inference, UAI 2001; for such mixtures D.
//! Hernández-Lobato and others, Mach. Learn. 99 (2015) 437.

use crate::effect::Effect;
use crate::rig::errors::RigErrors;
use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;
use tactpad_core::tables::measured::Row;

/// A number of the rig. The diagnosis has the same causes, with the same parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigNumber {
    /// The cause in a diagnosis.
    pub effect: Effect,
    /// The cause and its parameter there.
    pub name: &'static str,
    /// In words.
    pub words: &'static str,
    /// Standard deviation of the prior's wide part, in the parameter's unit; of a factor, that of its logarithm.
    pub(crate) deviation: f64,
    /// Probability of that part.
    wide: f64,
    /// Whether it is a factor: the fit has its logarithm.
    pub(crate) is_factor: bool,
}

impl RigNumber {
    const fn of(effect: Effect, name: &'static str, words: &'static str, deviation: f64) -> Self {
        Self { effect, name, words, deviation, wide: WIDE, is_factor: false }
    }

    /// With another probability of the wide part.
    const fn wide_with(self, wide: f64) -> Self {
        Self { wide, ..self }
    }

    const fn factor(effect: Effect, name: &'static str, words: &'static str, deviation: f64) -> Self {
        Self { is_factor: true, ..Self::of(effect, name, words, deviation) }
    }
}

impl RigNumber {
    /// Standard deviation of the whole prior.
    pub(crate) fn deviation_of_prior(&self) -> f64 {
        // √(π σ² + (1 − π) (σ/10)²).
        self.deviation * (self.wide + (1.0 - self.wide) * NARROW * NARROW).sqrt()
    }
}

/// How many they are.
pub(crate) const RIG_NUMBERS: usize = 11;
/// Place of the reference's gain among them.
pub(crate) const REFERENCE_GAIN: usize = 6;
/// In the order of the parameters. Wide deviations are those of a laboratory that was not careful here: a pad is put against
/// stops by eye, and a six-axis sensor is calibrated to one or two percent and screwed on by hand.
pub(crate) static RIG: [RigNumber; RIG_NUMBERS] = [
    RigNumber::of(Effect::StageOffset, "stage_offset.x_mm", "offset of the stage along x", 0.4)
        .wide_with(WIDE_OF_STAGE),
    RigNumber::of(Effect::StageOffset, "stage_offset.y_mm", "offset of the stage along y", 0.4)
        .wide_with(WIDE_OF_STAGE),
    RigNumber::of(Effect::StageRotation, "stage_rotation.deg", "turn of the stage", 1.0)
        .wide_with(WIDE_OF_STAGE),
    RigNumber::factor(Effect::StageScale, "stage_scale.scale", "scale of the stage", 4e-3)
        .wide_with(WIDE_OF_SCALE),
    RigNumber::of(Effect::ReferenceTilt, "reference_tilt.x_deg", "tilt of the reference about x", 1.5),
    RigNumber::of(Effect::ReferenceTilt, "reference_tilt.y_deg", "tilt of the reference about y", 1.5),
    RigNumber::factor(Effect::ReferenceGain, "reference_gain.gain", "gain of the reference", 0.015),
    RigNumber::of(Effect::ReferenceZero, "reference_zero.fx_n", "zero of the reference along x", 0.02),
    RigNumber::of(Effect::ReferenceZero, "reference_zero.fy_n", "zero of the reference along y", 0.02),
    RigNumber::of(Effect::ReferenceZero, "reference_zero.fz_n", "zero of the reference along z", 0.02),
    RigNumber::of(Effect::TimeLag, "time_lag.ms", "lag of the labels", 10.0),
];
/// The narrow part's deviation over the wide one's, for a laboratory that was careful.
const NARROW: f64 = 0.1;
/// How likely the wide part is. Of a stage it is less so: an offset is seen by eye, and what the model lacks of the plate's rim
/// looks like a small one. A leadscrew or a linear scale is right to a ten-thousandth, unless it is told to be another.
const WIDE: f64 = 0.5;
const WIDE_OF_STAGE: f64 = 0.05;
const WIDE_OF_SCALE: f64 = 0.01;
/// Contacts say something of an error from so much of the wide part's precision on.
const LEAST_TOLD: f64 = 1e-3;
/// Steps of the central differences by which T is differentiated: the errors are small, and T is smooth.
const STEP: f64 = 1e-4;

/// The normal priors that stand for the mixtures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RigPrior {
    pub(crate) mean: [f64; RIG_NUMBERS],
    pub(crate) precision: [f64; RIG_NUMBERS],
    /// ln of how probable the mixtures make what the contacts say, over how probable these make it.
    pub(crate) log_odds: f64,
}

/// A normal prior that stands for a mixture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MatchedPrior {
    mean: f64,
    precision: f64,
}

/// What the contacts alone say of an error: its value and the variance of that.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Told {
    value: f64,
    variance: f64,
}

impl RigPrior {
    /// Before any measurement: the mixtures' own moments.
    pub(crate) fn new() -> Self {
        Self {
            mean: [0.0; RIG_NUMBERS],
            precision: std::array::from_fn(|at| 1.0 / RIG[at].deviation_of_prior().powi(2)),
            log_odds: 0.0,
        }
    }

    /// Those that leave the posterior moments of the mixtures, by the present posterior's means and variances.
    pub(crate) fn matched(&self, values: &[f64; RIG_NUMBERS], variances: &[f64]) -> Self {
        let told = |at: usize| {
            // The posterior less the present prior, 1/s² = 1/v − P, m = s² (θ/v − P μ).
            let precision = 1.0 / variances[at] - self.precision[at];
            let value = (values[at] / variances[at] - self.precision[at] * self.mean[at]) / precision;
            (precision >= LEAST_TOLD / RIG[at].deviation.powi(2))
                .then_some(Told { value, variance: precision.recip() })
        };
        let mut matched = Self { log_odds: 0.0, ..*self };
        let numbers: [usize; RIG_NUMBERS] = std::array::from_fn(|at| at);
        for group in numbers.chunk_by(|one, other| RIG[*one].effect == RIG[*other].effect) {
            let axes: Vec<(f64, Option<Told>)> =
                group.iter().map(|at| (RIG[*at].deviation, told(*at))).collect();
            let (priors, log_odds) = matched_together(&axes, RIG[group[0]].wide);
            matched.log_odds += log_odds;
            for (at, MatchedPrior { mean, precision }) in group.iter().zip(priors) {
                matched.mean[*at] = mean;
                matched.precision[*at] = precision;
            }
        }
        matched
    }
}

/// The normal priors that leave the posterior moments of a cause's mixture, where the contacts say m with the variance s² of each of
/// its numbers, and ln of how probable the mixture makes what the contacts say, over how probable these priors make it. A cause is
/// there or it is not: its numbers are all of the wide part or all of the narrow one.
///
/// ```text
/// part i: weight ∝ πᵢ Πⱼ N(mⱼ; 0, sⱼ² + σᵢⱼ²), means mⱼ σᵢⱼ²/(sⱼ² + σᵢⱼ²), variances sⱼ² σᵢⱼ²/(sⱼ² + σᵢⱼ²)
/// ```
fn matched_together(numbers: &[(f64, Option<Told>)], probability: f64) -> (Vec<MatchedPrior>, f64) {
    // ln N(m; μ, v), but for a constant.
    let log_density =
        |told: f64, mean: f64, whole: f64| -0.5 * ((told - mean).powi(2) / whole + libm::log(whole));
    let log_of_part = |narrower: f64| -> f64 {
        let all = numbers.iter().filter_map(|(wide, told)| Some((narrower * wide, (*told)?)));
        all.map(|(deviation, Told { value, variance })| {
            log_density(value, 0.0, variance + deviation * deviation)
        })
        .sum()
    };
    let [log_narrow, log_wide] = [NARROW, 1.0].map(log_of_part);
    let odds = (1.0 - probability) / probability;
    let of_wide = 1.0 / (1.0 + odds * libm::exp(log_narrow - log_wide));
    // ln Σᵢ πᵢ Πⱼ N(mⱼ; 0, sⱼ² + σᵢⱼ²), by the wide part and its weight.
    let mut log_odds = log_wide + libm::log(probability / of_wide);
    // None where the posterior's two parts are so far apart that it is wider than what the contacts say.
    let of_number = |(wide, told): &(f64, Option<Told>)| {
        let parts = [(1.0 - of_wide, NARROW * wide), (of_wide, *wide)];
        let Some(Told { value, variance }) = *told else {
            let square: f64 = parts.iter().map(|(weight, deviation)| weight * deviation * deviation).sum();
            return Some(MatchedPrior { mean: 0.0, precision: square.recip() });
        };
        // Σᵢ wᵢ mᵢ, and Σᵢ wᵢ (vᵢ + mᵢ²) less its square.
        let [mut mean, mut square] = [0.0; 2];
        for (weight, deviation) in parts {
            let share = deviation * deviation / (variance + deviation * deviation);
            mean += weight * value * share;
            square += weight * (variance * share + (value * share).powi(2));
        }
        let left = square - mean * mean;
        // The posterior's precision less that of the contacts.
        let precision = 1.0 / left - 1.0 / variance;
        let is_narrower = precision > 1.0 / (wide * wide);
        is_narrower.then_some(MatchedPrior { mean: (mean / left - value / variance) / precision, precision })
    };
    let matched: Option<Vec<MatchedPrior>> = numbers.iter().map(of_number).collect();
    // Where no normal prior stands for the mixture, the wide part does: for all numbers of the cause, which is there or is not.
    let wide = |(wide, _): &(f64, Option<Told>)| MatchedPrior { mean: 0.0, precision: 1.0 / (wide * wide) };
    let priors = matched.unwrap_or_else(|| numbers.iter().map(wide).collect());
    for ((_, told), prior) in numbers.iter().zip(&priors) {
        if let Some(Told { value, variance }) = *told {
            log_odds -= log_density(value, prior.mean, variance + prior.precision.recip());
        }
    }
    (priors, log_odds)
}

/// The rig's errors by these values of its parameters.
pub(crate) fn errors(values: &[f64; RIG_NUMBERS]) -> RigErrors {
    let [x_mm, y_mm, rotation_deg, log_scale, tilt_x, tilt_y, log_gain, fx_n, fy_n, fz_n, lag_ms] = *values;
    RigErrors {
        offset_mm: [x_mm, y_mm],
        rotation_deg,
        scale: libm::exp(log_scale),
        tilt_deg: [tilt_x, tilt_y],
        gain: libm::exp(log_gain),
        zero_n: [fx_n, fy_n, fz_n],
        lag_s: 1e-3 * lag_ms,
        turned_deg: 0.0,
    }
}

/// Label of a contact as it was written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WrittenLabel {
    /// x, y, Fx, Fy, Fz.
    numbers: [f64; UNKNOWNS],
    /// How fast these change, per second; zero for a static sample.
    per_s: [f64; UNKNOWNS],
    /// By how much the pad was turned on the stage.
    turned_deg: f64,
    /// Whether the force is a known weight's.
    is_weight: bool,
}

impl WrittenLabel {
    /// That of a row. In a time series it changes as from the row before to the row behind.
    pub(crate) fn of(rows: &[Row], at: usize) -> Option<Self> {
        let row = rows.get(at)?;
        let goes_on = |other: &&Row| row.trial.is_some() && other.trial == row.trial;
        let before = at.checked_sub(1).and_then(|at| rows.get(at)).filter(goes_on).unwrap_or(row);
        let behind = rows.get(at + 1).filter(goes_on).unwrap_or(row);
        let passed_s = behind.t_s.zip(before.t_s).map_or(0.0, |(behind_s, before_s)| behind_s - before_s);
        let (from, to) = (before.label.numbers(), behind.label.numbers());
        let rate = |k: usize| if passed_s > 0.0 { (to[k] - from[k]) / passed_s } else { 0.0 };
        Some(Self {
            numbers: row.label.numbers(),
            per_s: std::array::from_fn(rate),
            turned_deg: row.turned_deg.unwrap_or(0.0),
            is_weight: row.weight_g.is_some(),
        })
    }

    /// A label that stands still.
    pub(crate) const fn still(numbers: [f64; UNKNOWNS]) -> Self {
        Self { numbers, per_s: [0.0; UNKNOWNS], turned_deg: 0.0, is_weight: false }
    }

    /// T(L; ρ): the contact that it stands for.
    pub(crate) fn contact(&self, values: &[f64; RIG_NUMBERS]) -> [f64; UNKNOWNS] {
        let errors = errors(values).of_row(self.turned_deg, self.is_weight);
        // A label that is late by τ was true τ ago: what is true now will be written then, L + τ dL/dt.
        let [x_mm, y_mm, fx_n, fy_n, fz_n] =
            std::array::from_fn(|k| self.numbers[k] + errors.lag_s * self.per_s[k]);
        let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) =
            (errors.place_mm([x_mm, y_mm]), errors.force_n([fx_n, fy_n, fz_n]));
        [x_mm, y_mm, fx_n, fy_n, fz_n]
    }

    /// ∂T/∂ρ, one line for each parameter.
    pub(crate) fn slopes(&self, values: &[f64; RIG_NUMBERS]) -> [[f64; UNKNOWNS]; RIG_NUMBERS] {
        std::array::from_fn(|at| {
            // (T(ρ + h) − T(ρ − h))/2h.
            let [behind, ahead] = [-STEP, STEP].map(|step| {
                let mut values = *values;
                values[at] += step;
                self.contact(&values)
            });
            std::array::from_fn(|k| (ahead[k] - behind[k]) / (2.0 * STEP))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::tables::measured::Label;

    #[test]
    fn each_number_is_one_of_a_cause_of_the_diagnosis() {
        let known: Vec<Effect> = crate::diagnosis::effects().collect();
        assert!(RIG.iter().all(|it| known.contains(&it.effect)));
        assert_eq!(RIG[REFERENCE_GAIN].effect, Effect::ReferenceGain);
        assert!(
            RIG.iter()
                .all(|it| it.name.split_once('.').is_some_and(|(effect, _)| effect == it.effect.name()))
        );
    }

    #[test]
    fn a_prior_that_is_matched_leaves_the_moments_of_the_mixture() {
        // By summation over the mixture's density times the likelihood.
        for (told, variance) in [(0.02, 0.01_f64), (0.15, 0.01), (0.5, 0.01), (0.1, 0.2), (-0.3, 0.0025)] {
            let wide = 0.4;
            let density = |x: f64, deviation: f64| libm::exp(-0.5 * (x / deviation).powi(2)) / deviation;
            let posterior = |x: f64| {
                (0.7 * density(x, NARROW * wide) + 0.3 * density(x, wide))
                    * density(x - told, variance.sqrt())
            };
            let sums = (-40_000..40_000).map(|step| 1e-4 * f64::from(step)).fold([0.0; 3], |sums, x| {
                [sums[0] + posterior(x), sums[1] + x * posterior(x), sums[2] + x * x * posterior(x)]
            });
            let mean = sums[1] / sums[0];
            let left = sums[2] / sums[0] - mean * mean;
            let axis = (wide, Some(Told { value: told, variance }));
            let (priors, log_odds) = matched_together(&[axis], 0.3);
            let MatchedPrior { mean: of_prior, precision } = priors[0];
            let whole = precision + 1.0 / variance;
            // ln of the mixture's integral over that of the normal prior.
            let spread = variance + 1.0 / precision;
            let normal = -0.5 * ((told - of_prior).powi(2) / spread + spread.ln());
            let mixture = (1e-4 * sums[0] / std::f64::consts::TAU.sqrt()).ln();
            assert!((log_odds - (mixture - normal)).abs() < 1e-3, "{told}: {log_odds}");
            if precision > 1.01 / (wide * wide) {
                assert!((whole * left - 1.0).abs() < 1e-3, "{told}: {whole} {left}");
                let found = (precision * of_prior + told / variance) / whole;
                assert!((found - mean).abs() < 1e-3, "{told}: {found} {mean}");
            } else {
                assert!(left >= 0.9 / whole, "{told}: the wide part is no narrower than what is left");
            }
        }
    }

    #[test]
    fn a_cause_that_may_be_there_is_free_in_all_its_numbers() {
        // By itself the second number may well be of the narrow part, with a precision of 16.
        let told = [0.4, -0.13].map(|value| (0.4, Some(Told { value, variance: 0.0121 })));
        let (priors, _) = matched_together(&told, 0.05);
        assert!(priors.iter().all(|it| it.mean == 0.0 && (it.precision * 0.16 - 1.0).abs() < 1e-12));
    }

    #[test]
    fn a_lag_moves_only_what_moves() {
        let label = Label { x_mm: 3.0, fz_n: 2.0, ..Label::default() };
        let row = |trial, t_s, fz_n| Row { trial, t_s: Some(t_s), ..Row::of(Label { fz_n, ..label }) };
        let rows =
            [row(None, 0.0, 2.0), row(Some(0), 1.0, 2.0), row(Some(0), 1.5, 2.5), row(Some(0), 2.0, 4.0)];
        let mut late = [0.0; RIG_NUMBERS];
        late[RIG_NUMBERS - 1] = 100.0;
        let fz_n = |at| WrittenLabel::of(&rows, at).unwrap().contact(&late)[4];
        // Rates of 1, 2 and 3 N/s; a static sample stands still.
        for (at, wanted_n) in [2.0, 2.1, 2.7, 4.3].into_iter().enumerate() {
            assert!((fz_n(at) - wanted_n).abs() < 1e-12, "{at}: {}", fz_n(at));
        }
    }

    #[test]
    fn slopes_are_those_of_small_errors() {
        let written = WrittenLabel::still([10.0, -5.0, 0.4, -0.2, 3.0]);
        let slopes = written.slopes(&[0.0; RIG_NUMBERS]);
        let degree = 1.0_f64.to_radians();
        let wanted = [
            [1.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 0.0],
            [5.0 * degree, 10.0 * degree, 0.0, 0.0, 0.0],
            [10.0, -5.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, -3.0 * degree, -0.2 * degree],
            [0.0, 0.0, 3.0 * degree, 0.0, -0.4 * degree],
            [0.0, 0.0, -0.4, 0.2, -3.0],
            [0.0, 0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, -1.0],
            [0.0; UNKNOWNS],
        ];
        let pairs = slopes.as_flattened().iter().zip(wanted.as_flattened());
        pairs.for_each(|(found, wanted)| assert!((found - wanted).abs() < 1e-6, "{slopes:?}"));
    }
}
