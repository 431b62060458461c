//! How well a calibration knows the pad, place by place: what its field's errors do to a decoded contact.

use crate::calibration::data::plate::loads;
use crate::calibration::noise::{contact, square};
use tactpad_core::pipeline::contact::inverse::Inverse;
use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;

/// A press, and how exactly it would be decoded by channels without noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressPrecision {
    /// Where.
    pub place_mm: [f64; 2],
    /// Standard deviation of the place, as a mean over x and y.
    pub deviation_mm: f64,
    /// Standard deviation of a force component, as a share of the whole force and a mean over Fx, Fy, Fz.
    pub force_share: f64,
}

impl PressPrecision {
    /// At loads all over the plate; without those where the field does not tell a contact.
    pub(crate) fn map(decoder: &Inverse) -> Vec<Self> {
        let loads = loads(f64::from(decoder.field().radius_mm()));
        loads.filter_map(|(place_mm, force_n)| Self::of(decoder, place_mm, &force_n)).collect()
    }

    fn of(decoder: &Inverse, place_mm: [f64; 2], force_n: &[f64; 3]) -> Option<Self> {
        let by_field = decoder.expected(&contact(&place_mm, force_n))?.by_field;
        let [x, y, fx, fy, fz]: [f64; UNKNOWNS] = std::array::from_fn(|k| by_field[k][k]);
        Some(Self {
            place_mm,
            deviation_mm: (0.5 * (x + y)).sqrt(),
            force_share: ((fx + fy + fz) / 3.0).sqrt() / square(force_n).sqrt(),
        })
    }
}
