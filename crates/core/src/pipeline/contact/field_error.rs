//! How far a calibrated field may be off, place by place: what the calibration left open of it.
//!
//! The error of the field is a sum of modes, each with a weight of its own,
//!
//! ```text
//! δG(x, y) = Σᵣ aᵣ Mᵣ(x, y),    aᵣ ∼ N(0, 1), independent,
//! ```
//!
//! and a mode is a change of all 27 maps. With the decoder's response K to the channels it moves a contact with the force F by
//! K Mᵣ F, so their covariance is Σᵣ (K Mᵣ F)(K Mᵣ F)ᵀ: exact for each place and each direction of the force. A mode's maps are
//!
//! ```text
//! Mᵣ = Qᵣ G + Pᵣ(x, y)
//! ```
//!
//! with the pad's own field G: a mixture Q of its channels, as errors of gains and crosstalk are, and polynomials P over the disc that
//! the field covers, for all that is smooth.

use super::uncertainty::{Covariance, UNKNOWNS};
use crate::pad::influence::MAPS;
use crate::quantity::CHANNELS;
use tactpad_numeric::zernike;

/// Degree of the polynomials: that of the background of a calibration. With the mixture beside them it holds displaced modules, too.
pub const DEGREE: usize = 5;
/// Number of polynomials.
pub const TERMS: usize = zernike::count(DEGREE);
/// Most modes.
pub const MODES_MAX: usize = 64;
/// Numbers of a mode.
pub(super) const NUMBERS: usize = CHANNELS * CHANNELS + TERMS * MAPS;

/// One mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorMode {
    /// Q: for each channel what it has of all nine.
    pub mixture: [[f32; CHANNELS]; CHANNELS],
    /// P: of each polynomial its coefficients in the maps, µV/N, for Fx, Fy, Fz of the first channel, then of the next one.
    pub maps: [[f32; MAPS]; TERMS],
}

/// The modes of a field's error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldError {
    modes: Vec<ErrorMode>,
}

/// Where a field is asked, and what it says there.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldPoint<'f> {
    /// In units of the radius that the field covers.
    pub(super) place: [f64; 2],
    pub(super) force_n: &'f [f64; 3],
    /// G F.
    pub(super) signals_uv: &'f [f64; CHANNELS],
}

impl ErrorMode {
    /// From its numbers, mixture first; `None` if one is not finite.
    pub(super) fn of(numbers: &[f32; NUMBERS]) -> Option<Self> {
        let (mixture, maps) = numbers.split_at(CHANNELS * CHANNELS);
        let mode =
            Self { mixture: *mixture.as_chunks().0.first_chunk()?, maps: *maps.as_chunks().0.first_chunk()? };
        numbers.iter().all(|number| number.is_finite()).then_some(mode)
    }

    /// Its numbers, in the order of [`Self::of`].
    pub(super) fn numbers(&self) -> impl Iterator<Item = f32> {
        self.mixture.as_flattened().iter().chain(self.maps.as_flattened()).copied()
    }

    /// Addition to the channels, µV, by the values of the polynomials.
    fn read(&self, values: &[f32; TERMS], asked: &FieldPoint<'_>) -> [f64; CHANNELS] {
        // Q (G F) + P F
        let mut maps = [0.0_f32; MAPS];
        for (coefficients, value) in self.maps.iter().zip(values) {
            maps.iter_mut().zip(coefficients).for_each(|(map, coefficient)| *map += value * coefficient);
        }
        std::array::from_fn(|channel| {
            let mixed = self.mixture[channel].iter().zip(asked.signals_uv);
            let smooth = maps[3 * channel..].iter().zip(asked.force_n);
            mixed.chain(smooth).map(|(own, other)| f64::from(*own) * other).sum()
        })
    }
}

impl FieldError {
    /// Of a field that is certain.
    pub const NONE: Self = Self { modes: Vec::new() };

    /// With these modes; `None` if there are more than [`MODES_MAX`].
    pub fn of(modes: Vec<ErrorMode>) -> Option<Self> {
        (modes.len() <= MODES_MAX).then_some(Self { modes })
    }

    /// The modes.
    pub fn modes(&self) -> &[ErrorMode] {
        &self.modes
    }

    /// That of a field which is `factor` times as large.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        // M = Q G + P, of which G is.
        let smooth = scaled.modes.iter_mut().flat_map(|mode| mode.maps.as_flattened_mut());
        smooth.for_each(|coefficient| *coefficient *= factor as f32);
        scaled
    }

    /// Addition of each mode to the channels, µV.
    pub(super) fn channels_uv<'a>(
        &'a self,
        asked: &'a FieldPoint<'_>,
    ) -> impl Iterator<Item = [f64; CHANNELS]> + 'a {
        let values = zernike::values(asked.place).map(|value| value as f32);
        self.modes.iter().map(move |mode| mode.read(&values, asked))
    }

    /// Covariance of a decoded contact by the field's error: Σᵣ (K Mᵣ F)(K Mᵣ F)ᵀ, where `response` is K.
    pub(super) fn covariance(
        &self,
        asked: &FieldPoint<'_>,
        response: &[[f64; CHANNELS]; UNKNOWNS],
    ) -> Covariance {
        let mut covariance = [[0.0; UNKNOWNS]; UNKNOWNS];
        if self.modes.is_empty() {
            return covariance;
        }
        for channels_uv in self.channels_uv(asked) {
            let moved = response.map(|row| row.iter().zip(channels_uv).map(|(k, uv)| k * uv).sum::<f64>());
            for (line, left) in covariance.iter_mut().zip(moved) {
                line.iter_mut().zip(moved).for_each(|(entry, right)| *entry += left * right);
            }
        }
        covariance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each channel answers to one unknown, or to none.
    fn response() -> [[f64; CHANNELS]; UNKNOWNS] {
        std::array::from_fn(|i| std::array::from_fn(|k| if i == k { 0.01 } else { 0.0 }))
    }

    const SMOOTH: ErrorMode = ErrorMode { mixture: [[0.0; CHANNELS]; CHANNELS], maps: [[0.0; MAPS]; TERMS] };
    const ASKED: FieldPoint<'_> =
        FieldPoint { place: [0.1, 0.5], force_n: &[0.5, 0.0, 2.0], signals_uv: &[100.0; CHANNELS] };

    #[test]
    fn a_mode_moves_a_contact_as_the_maps_are_changed() {
        // By Fz, channel 0 by 3 µV/N everywhere, channel 1 by −2 µV/N times y; by Fx, channel 2 by 5 µV/N. And channel 3 has 2 % of
        // channel 8.
        let mut mode = SMOOTH;
        (mode.maps[0][2], mode.maps[1][5], mode.maps[0][6], mode.mixture[3][8]) = (3.0, -2.0, 5.0, 0.02);
        let covariance = FieldError::of(vec![mode, mode]).unwrap().covariance(&ASKED, &response());
        // In units of 0.01: 6, −2, 2.5 and 2, twice.
        let moved = [0.06, -0.02, 0.025, 0.02, 0.0];
        for (line, left) in covariance.iter().zip(moved) {
            let pairs = line.iter().zip(moved);
            assert!(pairs.into_iter().all(|(entry, right)| (entry - 2.0 * left * right).abs() < 1e-9));
        }
    }

    #[test]
    fn a_certain_field_moves_nothing_and_nonsense_is_refused() {
        let covariance = FieldError::NONE.covariance(&ASKED, &response());
        assert_eq!(covariance, [[0.0; UNKNOWNS]; UNKNOWNS]);
        assert!(FieldError::of(vec![SMOOTH; MODES_MAX]).is_some());
        assert!(FieldError::of(vec![SMOOTH; MODES_MAX + 1]).is_none());
        let mut numbers = std::array::from_fn(|at| at as f32);
        assert!(ErrorMode::of(&numbers).unwrap().numbers().eq(numbers));
        numbers[77] = f32::NAN;
        assert_eq!(ErrorMode::of(&numbers), None);
    }
}
