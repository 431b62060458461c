//! The numbers of a fit in one form: value, deviation, and whether the contacts tell it or only the prior does.
//!
//! They serve the decoder. None of them is a cause: what no parameter stands for is taken up by those that there are.

use crate::calibration::data::rig::{RIG, RigNumber, RigPrior};
use crate::calibration::model::ParameterLayout;
use crate::calibration::model::physical::Physical;
use crate::calibration::problem::PosteriorFit;
use crate::diagnosis::data::target::Target;
use crate::effect::Effect;
use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::products::dot;

/// The contacts tell a number whose posterior variance is at most this part of the prior's.
///
/// Precisions add: 1/v = 1/v₀ + J, with the information J of the contacts beside all other parameters. So v ≤ v₀/4 is
/// J ≥ 3/v₀: the contacts count at least three times what the prior does, and the prior pulls the value by at most a quarter
/// of its way.
const TOLD_VARIANCE_SHARE: f64 = 0.25;
/// Magnitude of the posterior correlation from which on two numbers are not told apart: to know one of them would bring the
/// other's deviation down to √(1 − 0.9²) = 0.44 of what it is.
const CORRELATION_MIN: f64 = 0.9;

/// Quantity that a number is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// A channel's gain.
    Gain,
    /// Crosstalk of a channel from another one, dimensionless.
    Crosstalk,
    /// The share of a play operator: the mean over the channels, or a channel's own.
    Friction {
        /// Its threshold in strains before gains, by the evidence.
        threshold_uv: f64,
    },
    /// Creep's share of a load.
    Creep,
    /// Half the mean square of the distance at which a force acts from its place, mm².
    Blur,
    /// A gain's temperature coefficient, 1/°C.
    GainSlope,
    /// Zero of a channel, µV.
    Zero,
    /// A module's pose, as a change; a stiffness; the plate's thickness.
    Physical(Physical),
    /// Loss by ageing over the measurement, as a share of what there was before.
    Ageing,
    /// An error of the rig.
    Rig(&'static RigNumber),
}

/// Who tells a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToldBy {
    /// The contacts.
    Data,
    /// The prior holds it where it is.
    Prior,
}

/// A number of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// What it is.
    pub quantity: Quantity,
    /// Of which part.
    pub target: Target,
    /// The posterior's maximum.
    pub value: f64,
    /// Value of a pad that does not differ from the device.
    pub expected: f64,
    /// Posterior standard deviation.
    pub deviation: f64,
    /// That of the prior. Where kinds of parameters share one, it is found from the contacts, too.
    pub prior_deviation: f64,
}

/// Two numbers that the contacts do not tell apart, by their places in the list of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Which.
    pub places: [usize; 2],
    /// Their posterior correlation.
    pub correlation: f64,
}

/// Of what a fit has numbers beside those that it always has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OptionalNumbers {
    /// Zeros, where no row reads the untouched pad.
    pub(crate) zero_uv: Option<[f64; CHANNELS]>,
    pub(crate) gains_follow_temperature: bool,
}

/// A number, and the parameters that it is the sum of, each with its factor.
type ParameterSum = (Quantity, Target, Vec<(usize, f64)>);

impl Quantity {
    /// Its name; that of a module's number is the device's.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gain => "gain",
            Self::Crosstalk => "crosstalk",
            Self::Friction { .. } => "friction",
            Self::Creep => "creep",
            Self::Blur => "blur_mm2",
            Self::GainSlope => "gain_per_c",
            Self::Zero => "zero_uv",
            Self::Physical(it) => it.parameter.name(),
            Self::Ageing => "ageing.share_at_end",
            Self::Rig(number) => number.name,
        }
    }

    /// The cause in a diagnosis that it is the number of; none, and nothing gives it a name.
    pub fn effect(self) -> Option<Effect> {
        match self {
            Self::Gain => Some(Effect::ChannelGain),
            Self::Crosstalk => Some(Effect::ChannelCrosstalk),
            Self::Friction { .. } => Some(Effect::Hysteresis),
            Self::Creep => Some(Effect::Creep),
            Self::Blur => Some(Effect::ContactSize),
            Self::GainSlope => Some(Effect::ThermalGain),
            Self::Zero => Some(Effect::ChannelOffset),
            Self::Ageing => Some(Effect::Ageing),
            Self::Rig(number) => Some(number.effect),
            Self::Physical(_) => match self.key() {
                "radial_mm" | "tangential_mm" => Some(Effect::ModuleDisplaced),
                "rotation_deg" => Some(Effect::ModuleRotated),
                "tilt_tangential_deg" | "tilt_radial_deg" => Some(Effect::ModuleTilted),
                "frame_e_factor" => Some(Effect::ModuleStiffness),
                "thickness_mm" => Some(Effect::PlateStiffness),
                _ => None,
            },
        }
    }

    /// Value of a pad, or a rig, that does not differ.
    fn expected(self) -> f64 {
        match self {
            Self::Gain | Self::Rig(RigNumber { is_factor: true, .. }) => 1.0,
            Self::Physical(it) => it.value(0.0),
            _ => 0.0,
        }
    }

    /// Scale from a deviation of the parameters to its unit, at this value.
    const fn unit(self, value: f64) -> f64 {
        match self {
            Self::Physical(it) if it.is_factor() => value,
            Self::Rig(RigNumber { is_factor: true, .. }) => value,
            _ => 1.0,
        }
    }

    /// In words.
    pub fn words(self) -> String {
        let what = match self {
            Self::Friction { threshold_uv } => return format!("friction beyond {threshold_uv:.0} µV"),
            Self::Blur => "blur",
            Self::GainSlope => "gain by temperature",
            Self::Zero => "zero",
            Self::Gain | Self::Crosstalk | Self::Creep => self.name(),
            Self::Ageing => "loss by ageing",
            Self::Rig(number) => number.words,
            Self::Physical(_) => match self.key() {
                "radial_mm" => "displacement outwards",
                "tangential_mm" => "displacement counter-clockwise",
                "rotation_deg" => "turn",
                "tilt_tangential_deg" => "tilt about its tangential axis",
                "tilt_radial_deg" => "tilt about its radial axis",
                "frame_e_factor" => "frame stiffness",
                "bond_e_factor" => "bond stiffness",
                "film_e_factor" => "film stiffness",
                "thickness_mm" => "thickness",
                "e_mpa" => return format!("modulus of {}", self.material()),
                other => other,
            },
        };
        what.to_owned()
    }

    /// The material of `material.…`.
    fn material(self) -> &'static str {
        self.name().split('.').nth(1).unwrap_or_default()
    }

    /// The key of a module's number in the device file.
    fn key(self) -> &'static str {
        self.name().rsplit('.').next().unwrap_or_default()
    }
}

impl Number {
    /// Whether the contacts tell it.
    pub fn told_by(&self) -> ToldBy {
        let is_told = self.deviation.powi(2) <= TOLD_VARIANCE_SHARE * self.prior_deviation.powi(2);
        if is_told { ToldBy::Data } else { ToldBy::Prior }
    }

    /// All numbers of a fit, and the pairs that are not told apart.
    pub(crate) fn all(
        layout: &ParameterLayout,
        fit: &PosteriorFit,
        asked: &OptionalNumbers,
    ) -> (Vec<Self>, Vec<Pair>) {
        let precisions = layout.precisions(&fit.estimates.prior_deviations, &RigPrior::new());
        let combined = combined(layout, fit, asked);
        // A triangular solve for each, some 100 in all: nothing beside one step of the fit.
        let halves: Vec<Vec<f64>> = combined.iter().map(|(.., sum)| fit.halved(sum)).collect();
        let number = |((quantity, target, sum), half): (&ParameterSum, &Vec<f64>)| {
            let value = value(*quantity, *target, sum, fit, asked);
            let unit = quantity.unit(value);
            // Var cᵀθ = Σ c²/P, as the prior's parameters are independent.
            let prior_variance: f64 = sum.iter().map(|(at, c)| c * c / precisions[*at]).sum();
            Self {
                quantity: *quantity,
                target: *target,
                value,
                expected: quantity.expected(),
                deviation: unit * dot(half, half).sqrt(),
                prior_deviation: unit * prior_variance.sqrt(),
            }
        };
        let numbers: Vec<Self> = combined.iter().zip(&halves).map(number).collect();
        let pairs = pairs(&numbers, &halves);
        (numbers, pairs)
    }

    /// A channel's own friction goes with the mean of all by construction: that they correlate tells nothing.
    const fn is_compared(&self) -> bool {
        !matches!((self.quantity, self.target), (Quantity::Friction { .. }, Target::Channel(_)))
    }
}

fn value(
    quantity: Quantity,
    target: Target,
    sum: &[(usize, f64)],
    fit: &PosteriorFit,
    asked: &OptionalNumbers,
) -> f64 {
    match (quantity, target, asked.zero_uv) {
        (Quantity::Zero, Target::Channel(channel), Some(zero_uv)) => zero_uv[channel],
        (Quantity::Gain, Target::Channel(channel), _) => ParameterLayout::gain(&fit.values, channel),
        (Quantity::Physical(it), ..) => it.value(sum_of(sum, fit)),
        (Quantity::Rig(RigNumber { is_factor: true, .. }), ..) => libm::exp(sum_of(sum, fit)),
        // Of 1 + A nothing but 1 is left: A/(1 + A) was lost.
        (Quantity::Ageing, ..) => sum_of(sum, fit) / (1.0 + sum_of(sum, fit)),
        _ => sum_of(sum, fit),
    }
}

/// cᵀθ.
fn sum_of(sum: &[(usize, f64)], fit: &PosteriorFit) -> f64 {
    sum.iter().map(|(at, factor)| factor * fit.values[*at]).sum()
}

/// What the numbers are of, and of which parameters.
fn combined(layout: &ParameterLayout, fit: &PosteriorFit, asked: &OptionalNumbers) -> Vec<ParameterSum> {
    let channels = |quantity, is_asked: bool, at: fn(usize) -> usize| {
        let channels = (0..CHANNELS).filter(move |_| is_asked);
        channels.map(move |channel| (quantity, Target::Channel(channel), vec![(at(channel), 1.0)]))
    };
    let gains = (0..CHANNELS).map(|channel| {
        (Quantity::Gain, Target::Channel(channel), ParameterLayout::gain_terms(&fit.values, channel).to_vec())
    });
    let pairs = (0..CHANNELS).flat_map(|into| (0..CHANNELS).map(move |from| (into, from)));
    let crosstalks = pairs.filter(|(into, from)| into != from).map(|(into, from)| {
        let target = Target::Channels { into, from };
        (Quantity::Crosstalk, target, vec![(ParameterLayout::crosstalk_at(into, from), 1.0)])
    });
    let physical = layout.physical.iter().zip(ParameterLayout::first_physical()..).map(|(it, at)| {
        let target = it.parameter.module().map_or(Target::Pad, Target::Module);
        (Quantity::Physical(*it), target, vec![(at, 1.0)])
    });
    let [creep, blur] = ParameterLayout::creep_and_blur_at();
    let creep = (fit.settings.creep_time_s > 0.0).then(|| (Quantity::Creep, Target::Pad, vec![(creep, 1.0)]));
    let slope = |channel| ParameterLayout::first_gain_slope() + channel;
    gains
        .chain(physical)
        .chain(crosstalks)
        .chain((0..PLAYS).flat_map(|play| frictions(play, fit.settings.thresholds_uv[play])))
        .chain(creep)
        .chain([(Quantity::Blur, Target::Rig, vec![(blur, 1.0)])])
        .chain(by_reference(layout))
        .chain(channels(Quantity::GainSlope, asked.gains_follow_temperature, slope))
        .chain(channels(Quantity::Zero, asked.zero_uv.is_some(), ParameterLayout::zero_at))
        .collect()
}

/// Numbers that only a reference tells: ageing, and its own errors.
fn by_reference(layout: &ParameterLayout) -> Vec<ParameterSum> {
    if layout.is_play {
        return Vec::new();
    }
    let ageing = (Quantity::Ageing, Target::Pad, vec![(ParameterLayout::ageing_at(), 1.0)]);
    let rig = RIG.iter().zip(ParameterLayout::first_of_rig()..);
    let rig = rig.map(|(number, at)| (Quantity::Rig(number), Target::Rig, vec![(at, 1.0)]));
    std::iter::once(ageing).chain(rig).collect()
}

/// The shares of a play operator: the mean over the channels, then each channel's.
fn frictions(play: usize, threshold_uv: f64) -> Vec<ParameterSum> {
    if threshold_uv == 0.0 {
        return Vec::new();
    }
    let quantity = Quantity::Friction { threshold_uv };
    // w̄ᵢ + Σₖ δᵢₖ/9 of all, and wᵢₖ = w̄ᵢ + δᵢₖ of a channel.
    let of_all = |channel: usize| (ParameterLayout::share_at(play, channel)[1], 1.0 / CHANNELS as f64);
    let [share, _] = ParameterLayout::share_at(play, 0);
    let mean = std::iter::once((share, 1.0)).chain((0..CHANNELS).map(of_all)).collect();
    let own = (0..CHANNELS).map(|channel| {
        (
            quantity,
            Target::Channel(channel),
            ParameterLayout::share_at(play, channel).map(|at| (at, 1.0)).to_vec(),
        )
    });
    std::iter::once((quantity, Target::Pad, mean)).chain(own).collect()
}

/// The pairs that are not told apart, the strongest first. `halves` are L⁻¹c of each number.
fn pairs(numbers: &[Number], halves: &[Vec<f64>]) -> Vec<Pair> {
    let compared: Vec<usize> = (0..numbers.len()).filter(|at| numbers[*at].is_compared()).collect();
    let mut found = Vec::new();
    for (index, one) in compared.iter().enumerate() {
        for other in &compared[..index] {
            let covariance = dot(&halves[*one], &halves[*other]);
            let correlation = covariance / (numbers[*one].deviation * numbers[*other].deviation);
            if correlation.abs() > CORRELATION_MIN {
                found.push(Pair { places: [*other, *one], correlation });
            }
        }
    }
    found.sort_by(|one, other| other.correlation.abs().total_cmp(&one.correlation.abs()));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::model::physical::free;
    use tactpad_core::pad::device::Device;
    use tactpad_core::pad::field::PadField;

    fn number(deviation: f64, prior_deviation: f64) -> Number {
        let (quantity, target) = (Quantity::Gain, Target::Channel(0));
        Number { quantity, target, value: 1.2, expected: 1.0, deviation, prior_deviation }
    }

    /// A number that is measured beside a prior, by hand: 1/v = 1/v₀ + J.
    fn measured(prior_deviation: f64, information_over_priors: f64) -> Number {
        let precision = (1.0 + information_over_priors) / prior_deviation.powi(2);
        number(precision.sqrt().recip(), prior_deviation)
    }

    #[test]
    fn data_that_count_three_times_the_prior_tell_a_number() {
        assert_eq!(measured(0.3, 3.01).told_by(), ToldBy::Data);
        assert_eq!(measured(0.3, 2.99).told_by(), ToldBy::Prior);
        assert_eq!(measured(0.3, 0.0).told_by(), ToldBy::Prior);
        // Whatever the unit.
        assert_eq!(measured(2000.0, 3.01).told_by(), ToldBy::Data);
        assert_eq!(measured(2000.0, 2.99).told_by(), ToldBy::Prior);
        assert_eq!(number(f64::NAN, 0.3).told_by(), ToldBy::Prior);
    }

    #[test]
    fn what_moves_together_is_not_told_apart() {
        // L⁻¹c of three numbers: the first two nearly along one line, but opposite; the third across.
        let halves = vec![vec![0.3, 0.1], vec![-0.6, -0.1], vec![-0.1, 0.3]];
        let numbers: Vec<Number> =
            halves.iter().map(|half: &Vec<f64>| number(dot(half, half).sqrt(), 1.0)).collect();
        let found = pairs(&numbers, &halves);
        let [Pair { places, correlation }] = found.as_slice() else { panic!("{found:?}") };
        // −0.19/√(0.10 · 0.37).
        assert!(*places == [0, 1] && (correlation + 0.19 / 0.037_f64.sqrt()).abs() < 1e-12, "{correlation}");
    }

    #[test]
    fn a_channels_friction_beside_that_of_all_is_no_pair() {
        let quantity = Quantity::Friction { threshold_uv: 300.0 };
        let of = |target| Number { quantity, target, ..number(1.0, 1.0) };
        let halves = vec![vec![1.0, 0.0], vec![1.0, 0.01]];
        assert!(pairs(&[of(Target::Pad), of(Target::Channel(3))], &halves).is_empty());
    }

    #[test]
    fn each_number_has_a_name_and_only_what_a_diagnosis_knows_has_an_effect() {
        let (device, field) = (Device::nominal(), PadField::nominal());
        let (physical, _) = free(&field, &device, &device);
        let parameter =
            |name: &str| Quantity::Physical(*physical.iter().find(|it| it.parameter.name() == name).unwrap());
        let effect = |name: &str| parameter(name).effect();
        assert_eq!(effect("module.1.tangential_mm"), Some(Effect::ModuleDisplaced));
        assert_eq!(effect("module.2.frame_e_factor"), Some(Effect::ModuleStiffness));
        // The glue's modulus is no cause of the catalogue, so nothing may name it.
        assert_eq!((effect("module.0.bond_e_factor"), effect("module.0.film_e_factor")), (None, None));
        assert_eq!(parameter("module.0.bond_e_factor").words(), "bond stiffness");
        let known: Vec<Effect> = crate::diagnosis::effects().collect();
        let all = [Quantity::Gain, Quantity::Crosstalk, Quantity::Creep, Quantity::Blur, Quantity::GainSlope];
        assert!(all.iter().all(|it| known.contains(&it.effect().unwrap())));
    }
}
