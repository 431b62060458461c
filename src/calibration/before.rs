//! What is known of a pad before it is measured: that it is like the simulated one, or like another pad of its kind.

use super::contacts::Maps;
use super::noise::Known;
use super::plate::places;
use crate::contact::creep::{Creep, NO_CREEP};
use crate::contact::friction::{Friction, NO_FRICTION, PLAYS};
use crate::contact::inverse::Inverse;
use crate::field::PadField;
use crate::influence::{InfluenceField, MAPS};
use crate::quantity::CHANNELS;

/// A channel that is weaker than this beside the simulated one says nothing of other pads.
const GAIN_MIN: f64 = 0.05;

/// Where the numbers are most probable before any contact.
#[derive(Clone, Debug)]
pub(super) struct Before {
    /// µV/N before gains, and how they change with the numbers that have a sensitivity.
    pub(super) field: PadField,
    pub(super) gain: [f64; CHANNELS],
    /// Of the play operators, in strains before gains; one of zero does nothing.
    pub(super) thresholds_uv: [f64; PLAYS],
    /// Of each play operator in each channel.
    pub(super) shares: [[f64; CHANNELS]; PLAYS],
    pub(super) creep: Creep,
    /// How the channels scatter.
    pub(super) noise: Known,
}

impl Before {
    /// The simulated pad.
    pub(super) fn simulated(field: &PadField) -> Self {
        Self::with_friction(field.clone(), [1.0; CHANNELS], &NO_FRICTION, Known::SIMULATED)
    }

    /// A pad with the simulated field, and with the gains, the friction and the noise of another pad of its kind.
    pub(super) fn made_like(field: &PadField, earlier: &Inverse) -> Self {
        let gain = gains(&field.signals, earlier.field());
        let noise = Known::of_kin(earlier.noise());
        let before = Self::with_friction(field.clone(), gain, earlier.friction(), noise);
        Self { creep: *earlier.creep(), ..before }
    }

    /// A pad with the field of another one as well. That field is taken apart: its gains, and the strains before them.
    pub(super) fn like(field: &PadField, earlier: &Inverse) -> Self {
        let before = Self::made_like(field, earlier);
        let (spacing_mm, reach_mm) = (field.signals.spacing_mm(), field.signals.radius_mm());
        let strain = |place_mm: [f64; 2]| {
            let gains = gains_at(earlier.field(), place_mm);
            std::array::from_fn::<f64, MAPS, _>(|map| gains[map / 3][map % 3] / before.gain[map / 3])
        };
        let (spacing_mm, reach_mm) = (f64::from(spacing_mm), f64::from(reach_mm));
        let signals = InfluenceField::sampled(spacing_mm, reach_mm, reach_mm, strain);
        Self { field: PadField { signals, ..before.field }, ..before }
    }

    fn with_friction(field: PadField, gain: [f64; CHANNELS], friction: &Friction, noise: Known) -> Self {
        let threshold_uv = |play: usize| {
            let before_gains = (0..CHANNELS).map(|k| friction[play].threshold_uv[k] / gain[k].abs());
            before_gains.sum::<f64>() / CHANNELS as f64
        };
        Self {
            thresholds_uv: std::array::from_fn(threshold_uv),
            shares: friction.map(|play| play.share),
            creep: NO_CREEP,
            field,
            gain,
            noise,
        }
    }
}

fn gains_at(field: &InfluenceField, [x_mm, y_mm]: [f64; 2]) -> Maps {
    field.gains(x_mm as f32, y_mm as f32).value
}

/// How many times the simulated strain each channel of another pad reads, by least squares over the plate.
fn gains(simulated: &InfluenceField, earlier: &InfluenceField) -> [f64; CHANNELS] {
    let mut sums = [[0.0; 2]; CHANNELS];
    for place_mm in places(f64::from(simulated.radius_mm())) {
        let (one, other) = (gains_at(simulated, place_mm), gains_at(earlier, place_mm));
        for ((sums, one), other) in sums.iter_mut().zip(&one).zip(&other) {
            for (one, other) in one.iter().zip(other) {
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
    use crate::contact::friction::Play;
    use crate::contact::uncertainty::Noise;

    #[test]
    fn another_pad_is_taken_apart_into_strains_and_gains() {
        let field = PadField::nominal();
        let gain: [f64; CHANNELS] = std::array::from_fn(|k| 0.8 + 0.1 * k as f64);
        let reach_mm = f64::from(field.signals.radius_mm());
        let spacing_mm = f64::from(field.signals.spacing_mm());
        let amplified = |place_mm: [f64; 2]| {
            let gains = gains_at(&field.signals, place_mm);
            std::array::from_fn::<f64, MAPS, _>(|map| gain[map / 3] * gains[map / 3][map % 3])
        };
        let signals = InfluenceField::sampled(spacing_mm, reach_mm, reach_mm, amplified);
        let threshold_uv = gain.map(|gain| 700.0 * gain);
        let friction = [Play { threshold_uv, share: [0.05; CHANNELS] }, Play::NONE];
        let noise = Noise::of_channels([3.0; CHANNELS], [0.01; CHANNELS]);
        let before = Before::like(&field, &Inverse::new(signals, noise, friction));
        assert!(before.gain.iter().zip(gain).all(|(found, gain)| (found / gain - 1.0).abs() < 1e-3));
        assert!((before.thresholds_uv[0] - 700.0).abs() < 1.0 && before.thresholds_uv[1] == 0.0);
        for place_mm in places(reach_mm) {
            let (found, wanted) =
                (gains_at(&before.field.signals, place_mm), gains_at(&field.signals, place_mm));
            let pairs = found.as_flattened().iter().zip(wanted.as_flattened());
            assert!(pairs.into_iter().all(|(found, wanted)| (found - wanted).abs() < 0.5), "{place_mm:?}");
        }
    }
}
