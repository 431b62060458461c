//! How a pad's channels follow the temperature: zeros by so many microvolts, gains by such a share, per degree.

use std::ops::RangeInclusive;

use crate::quantity::CHANNELS;

/// Straight lines through a reference temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermal {
    /// Where nothing is to be corrected.
    pub reference_c: f64,
    /// Change of each channel's zero.
    pub zero_uv_per_c: [f64; CHANNELS],
    /// Relative change of each channel's gain.
    pub gain_per_c: [f64; CHANNELS],
}

/// Electronics of industrial grade work in this range.
pub const SENSIBLE_C: RangeInclusive<f64> = -40.0..=85.0;
/// What tables may hold.
const REFERENCES_C: RangeInclusive<f64> = -100.0..=200.0;
/// A bridge that is wholly out of balance is no larger.
const ZERO_MAX_UV_PER_C: f64 = 1e5;
/// No channel becomes weaker than this by its temperature.
const GAIN_MIN: f64 = 0.1;

impl Thermal {
    /// Whether a pad can be so, and be corrected wherever electronics work.
    pub fn is_sound(&self) -> bool {
        let ends = [*SENSIBLE_C.start(), *SENSIBLE_C.end()];
        REFERENCES_C.contains(&self.reference_c)
            && self.zero_uv_per_c.iter().all(|uv_per_c| uv_per_c.abs() <= ZERO_MAX_UV_PER_C)
            && ends.iter().all(|temp_c| self.gain(Some(*temp_c)).iter().all(|gain| *gain >= GAIN_MIN))
    }

    /// Shift of the zeros against those at the reference temperature, µV: α (T − T₀). Where the temperature is not known it is taken for the reference.
    pub fn zero_uv(&self, temp_c: Option<f64>) -> [f64; CHANNELS] {
        // β (T − T₀)
        let above_c = self.above_c(temp_c);
        self.zero_uv_per_c.map(|uv_per_c| uv_per_c * above_c)
    }

    /// Gain of the channels beyond their zeros, dimensionless.
    pub fn gain(&self, temp_c: Option<f64>) -> [f64; CHANNELS] {
        // 1 + γ (T − T₀)
        let above_c = self.above_c(temp_c);
        self.gain_per_c.map(|per_c| 1.0 + per_c * above_c)
    }

    fn above_c(&self, temp_c: Option<f64>) -> f64 {
        temp_c.map_or(0.0, |temp_c| temp_c - self.reference_c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_pad_does_is_not_sound() {
        let sound =
            Thermal { reference_c: 25.0, zero_uv_per_c: [60.0; CHANNELS], gain_per_c: [-1e-3; CHANNELS] };
        assert!(sound.is_sound());
        let mut weak = sound;
        weak.gain_per_c[3] = -0.05;
        let mut steep = sound;
        steep.zero_uv_per_c[8] = 1e308;
        let unsound = [weak, steep, Thermal { reference_c: f64::NAN, ..sound }];
        assert!(unsound.iter().all(|thermal| !thermal.is_sound()));
    }

    #[test]
    fn lines_go_through_the_reference() {
        let thermal =
            Thermal { reference_c: 25.0, zero_uv_per_c: [40.0; CHANNELS], gain_per_c: [-1e-3; CHANNELS] };
        assert_eq!(thermal.zero_uv(Some(30.0)), [200.0; CHANNELS]);
        assert_eq!(thermal.gain(Some(15.0)), [1.01; CHANNELS]);
        assert_eq!((thermal.zero_uv(None), thermal.gain(None)), ([0.0; CHANNELS], [1.0; CHANNELS]));
    }
}
