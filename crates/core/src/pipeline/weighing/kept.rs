//! Result of a weighing, kept for good: the decoder of the pad as it is now.

use crate::pipeline::compensation::Compensation;
use crate::pipeline::contact::Decoder;
use crate::pipeline::contact::uncertainty::Noise;
use tactpad_numeric::memory::PlayOperator;

/// The decoder of a pad that reads `factor` times what it read at the calibration, where that is known but for `deviation`, a
/// share. `None` for a decoder that does not know what its channels should read.
///
/// What belongs to a signal is multiplied: the field, what it does not know, the thresholds of the play operators. What belongs
/// to the bridges stays: their noise, and zeros that follow the temperature. So do shares. Of the common gain nothing is open
/// any more but what this weighing leaves open.
pub fn kept(decoder: &Decoder, factor: f64, deviation: f64) -> Option<Decoder> {
    let inverse = decoder.inverse()?;
    let noise = *inverse.noise();
    let noise = Noise {
        force_uv_per_n: noise.force_uv_per_n.map(|uv_per_n| factor * uv_per_n),
        field_uv_per_n: noise.field_uv_per_n.map(|uv_per_n| factor * uv_per_n),
        gain: deviation,
        ..noise
    };
    let hysteresis = decoder
        .compensation
        .hysteresis
        .map(|plays| plays.map(|play| PlayOperator { threshold: factor * play.threshold, ..play }));
    let compensation = Compensation { hysteresis, ..decoder.compensation };
    Some(Decoder::from(inverse.scaled(factor, noise)).compensated_by(compensation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::influence::MAPS;
    use crate::pipeline::contact::field_error::{ErrorMode, FieldError, TERMS};
    use crate::pipeline::shipped;
    use crate::quantity::{CHANNELS, Contact, Strain};

    #[test]
    fn a_pad_that_reads_less_is_read_as_before() {
        let decoder = shipped::decoder();
        let contact = Contact { x_mm: 8.0, y_mm: -5.0, fx_n: 0.3, fy_n: -0.2, fz_n: 2.0 };
        let Strain { uv } = decoder.inverse().unwrap().field().strain_uv(&contact);
        let found = kept(&decoder, 0.81, 0.006).unwrap();
        let aged = found.decode(&Strain { uv: uv.map(|uv| 0.81 * uv) });
        let before = decoder.decode(&Strain { uv });
        assert!((aged.fz_n - before.fz_n).abs() < 1e-3 && (aged.x_mm - before.x_mm).abs() < 0.01, "{aged:?}");
        assert_eq!(found.inverse().unwrap().noise().gain, 0.006);
        assert!(kept(&shipped::statics(), 0.81, 0.006).is_none());
    }

    #[test]
    fn what_is_not_known_of_the_field_is_not_forgotten() {
        let mode = ErrorMode { mixture: [[0.01; CHANNELS]; CHANNELS], maps: [[2.0; MAPS]; TERMS] };
        let error = FieldError::of(vec![mode]).unwrap();
        let inverse = shipped::decoder().inverse().unwrap().clone().with_field_error(error);
        let found = kept(&Decoder::from(inverse), 0.5, 0.006).unwrap();
        let [found] = found.inverse().unwrap().field_error().modes() else { panic!("{found:?}") };
        assert_eq!((found.mixture, found.maps), (mode.mixture, [[1.0; MAPS]; TERMS]));
    }

    #[test]
    fn thresholds_follow_the_gain_and_shares_stay() {
        let plays =
            |threshold| [[PlayOperator { threshold, share: 0.05 }; CHANNELS], [PlayOperator::NONE; CHANNELS]];
        let compensation =
            Compensation { hysteresis: plays(800.0), zero_uv: Some([70.0; CHANNELS]), ..Compensation::NONE };
        let found = kept(&shipped::decoder().compensated_by(compensation), 0.75, 0.006).unwrap().compensation;
        assert_eq!(found, Compensation { hysteresis: plays(600.0), ..compensation });
    }
}
