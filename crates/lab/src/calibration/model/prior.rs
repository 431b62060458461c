//! The prior of a pad: centred on the simulated pad, or on another pad of its kind.

use crate::calibration::data::contacts::Maps;
use crate::calibration::data::earlier::EarlierCalibration;
use crate::calibration::data::plate::{PLACES, places};
use crate::calibration::noise::NoisePrior;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::influence::{InfluenceField, MAPS};
use tactpad_core::pipeline::compensation::hysteresis::{Hysteresis, NO_HYSTERESIS, PLAYS};
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::memory::Relaxation;

/// A channel with a smaller gain than this is dead and says nothing of other pads.
const GAIN_MIN: f64 = 0.05;

/// Mean of the prior, and the prior of the noise.
#[derive(Clone, Debug)]
pub(crate) struct Prior {
    /// µV/N before gains, and its sensitivities to the physical parameters.
    pub(crate) field: PadField,
    /// The pad that this field was solved for, where it is not the one that measured pads are held against.
    pub(crate) solved: Option<Device>,
    pub(crate) gain: [f64; CHANNELS],
    /// Crosstalk: share of each other channel's strain.
    pub(crate) crosstalk: [[f64; CHANNELS]; CHANNELS],
    /// Thresholds of the play operators, in strains before gains; an operator with zero does nothing.
    pub(crate) thresholds_uv: [f64; PLAYS],
    /// Shares of each play operator in each channel.
    pub(crate) shares: [[f64; CHANNELS]; PLAYS],
    pub(crate) creep: Relaxation,
    /// Prior of the channels' noise.
    pub(crate) noise: NoisePrior,
}

impl Prior {
    /// Centred on the simulated pad.
    pub(crate) fn simulated(field: &PadField) -> Self {
        Self::with_hysteresis(field.clone(), [1.0; CHANNELS], &NO_HYSTERESIS, NoisePrior::SIMULATED)
    }

    /// Centred on the simulated field, with the gains, hysteresis, creep and noise of another pad of its kind.
    pub(crate) fn of_kind(field: &PadField, earlier: &EarlierCalibration<'_>) -> Self {
        let EarlierCalibration { inverse, compensation } = earlier;
        let gain = gains(&field.signals, inverse.field());
        let noise = NoisePrior::of_kind(inverse.noise());
        let prior = Self::with_hysteresis(field.clone(), gain, &compensation.hysteresis, noise);
        Self { creep: compensation.creep, ..prior }
    }

    /// Centred on another pad's field as well. That field is factorised into gains and the strains before them.
    pub(crate) fn centred_on(field: &PadField, earlier: &EarlierCalibration<'_>) -> Self {
        let prior = Self::of_kind(field, earlier);
        // G′ = g E: the strains before gains are E = G′/g.
        let strain = |place_mm: [f64; 2]| {
            let gains = gains_at(earlier.inverse.field(), place_mm);
            std::array::from_fn::<f64, MAPS, _>(|map| gains[map / 3][map % 3] / prior.gain[map / 3])
        };
        let signals = resampled(field, strain);
        Self { field: PadField { signals, ..prior.field }, ..prior }
    }

    /// The same prior, with the field about another pad.
    pub(crate) fn about(self, device: Device, field: PadField) -> Self {
        Self { field, solved: Some(device), ..self }
    }

    /// At a decoder: all of its field, in which no number of the device may differ from what it has, taken apart into crosstalk, gains
    /// and strains.
    pub(crate) fn at(field: &PadField, earlier: &EarlierCalibration<'_>) -> Self {
        let mut prior = Self::of_kind(field, earlier);
        // G′ = (1 + X) g E.
        let inverse = earlier.inverse;
        let gain = prior.gain;
        let strain = |place_mm: [f64; 2]| {
            let maps = gains_at(inverse.field(), place_mm);
            let by_axis: [[f64; CHANNELS]; 3] =
                std::array::from_fn(|axis| inverse.own_uv(&maps.map(|map| map[axis])));
            std::array::from_fn::<f64, MAPS, _>(|map| by_axis[map % 3][map / 3] / gain[map / 3])
        };
        prior.field.signals = resampled(field, strain);
        prior.field.sensitivities.clear();
        prior.crosstalk = inverse.crosstalk().map(|line| line.map(f64::from));
        prior
    }

    /// Thresholds before gains are means over the channels of threshold/|gₖ|.
    fn with_hysteresis(
        field: PadField,
        gain: [f64; CHANNELS],
        hysteresis: &Hysteresis,
        noise: NoisePrior,
    ) -> Self {
        // The decoder's thresholds are in readings: r/|g| in strains.
        let threshold_uv = |play: usize| {
            let before_gains = (0..CHANNELS).map(|k| hysteresis[play][k].threshold / gain[k].abs());
            before_gains.sum::<f64>() / CHANNELS as f64
        };
        Self {
            thresholds_uv: std::array::from_fn(threshold_uv),
            shares: hysteresis.map(|plays| plays.map(|play| play.share)),
            creep: Relaxation::NONE,
            field,
            solved: None,
            gain,
            crosstalk: [[0.0; CHANNELS]; CHANNELS],
            noise,
        }
    }
}

/// Maps on the grid of a field.
fn resampled(field: &PadField, maps: impl Fn([f64; 2]) -> [f64; MAPS] + Sync) -> InfluenceField {
    let [spacing_mm, reach_mm] = [field.signals.spacing_mm(), field.signals.radius_mm()].map(f64::from);
    InfluenceField::sampled(spacing_mm, reach_mm, reach_mm, maps)
}

fn gains_at(field: &InfluenceField, [x_mm, y_mm]: [f64; 2]) -> Maps {
    field.gains(x_mm as f32, y_mm as f32).value
}

/// Gains of another pad's channels beside the simulated ones, by least squares over the plate:
/// gₖ = Σ G·G′/Σ G·G, with the sums over places and forces.
fn gains(simulated: &InfluenceField, earlier: &InfluenceField) -> [f64; CHANNELS] {
    let mut sums = [[0.0; 2]; CHANNELS];
    for place_mm in places(f64::from(simulated.radius_mm()), PLACES) {
        let (one, other) = (gains_at(simulated, place_mm), gains_at(earlier, place_mm));
        for ((sums, one), other) in sums.iter_mut().zip(&one).zip(&other) {
            for (one, other) in one.iter().zip(other) {
                // Σ G·G′ and Σ G·G.
                sums[0] += one * other;
                sums[1] += one * one;
            }
        }
    }
    sums.map(|[product, square]| if product > GAIN_MIN * square { product / square } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::compensation::Compensation;
    use tactpad_core::pipeline::contact::Decoder;
    use tactpad_core::pipeline::contact::inverse::Inverse;
    use tactpad_core::pipeline::contact::uncertainty::Noise;
    use tactpad_numeric::memory::PlayOperator;

    #[test]
    fn another_pad_is_factorised_into_strains_and_gains() {
        let field = PadField::nominal();
        let gain: [f64; CHANNELS] = std::array::from_fn(|k| 0.8 + 0.1 * k as f64);
        let reach_mm = f64::from(field.signals.radius_mm());
        let spacing_mm = f64::from(field.signals.spacing_mm());
        let amplified = |place_mm: [f64; 2]| {
            let gains = gains_at(&field.signals, place_mm);
            std::array::from_fn::<f64, MAPS, _>(|map| gain[map / 3] * gains[map / 3][map % 3])
        };
        let signals = InfluenceField::sampled(spacing_mm, reach_mm, reach_mm, amplified);
        let plays = gain.map(|gain| PlayOperator { threshold: 700.0 * gain, share: 0.05 });
        let hysteresis = [plays, [PlayOperator::NONE; CHANNELS]];
        let noise = Noise::of_channels([3.0; CHANNELS], [0.01; CHANNELS]);
        let compensation = Compensation { hysteresis, ..Compensation::NONE };
        let decoder = Decoder::from(Inverse::new(signals, noise)).compensated_by(compensation);
        let prior = Prior::centred_on(&field, &EarlierCalibration::of(&decoder).unwrap());
        assert!(prior.gain.iter().zip(gain).all(|(found, gain)| (found / gain - 1.0).abs() < 1e-3));
        assert!((prior.thresholds_uv[0] - 700.0).abs() < 1.0 && prior.thresholds_uv[1] == 0.0);
        for place_mm in places(reach_mm, PLACES) {
            let (found, wanted) =
                (gains_at(&prior.field.signals, place_mm), gains_at(&field.signals, place_mm));
            let pairs = found.as_flattened().iter().zip(wanted.as_flattened());
            assert!(pairs.into_iter().all(|(found, wanted)| (found - wanted).abs() < 0.5), "{place_mm:?}");
        }
    }
}
