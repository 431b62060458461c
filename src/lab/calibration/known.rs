//! How well a calibration knows the pad, place by place: what its field's posterior covariance does to a decoded contact.

use super::noise::{FieldCovariance, form, square};
use crate::pipeline::contact::inverse::Inverse;
use crate::quantity::Contact;

/// A press, and how exactly it would be decoded by channels without noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Where.
    pub place_mm: [f64; 2],
    /// Standard deviation of the place, as a mean over x and y.
    pub deviation_mm: f64,
    /// Standard deviation of a force component, as a share of the whole force and a mean over Fx, Fy, Fz.
    pub force_share: f64,
}

impl Known {
    /// `None` where the field does not tell a contact.
    pub(super) fn of(decoder: &Inverse, covariance: &FieldCovariance) -> Option<Self> {
        let FieldCovariance { place_mm, force_n, uv2 } = covariance;
        let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) = (place_mm.map(|mm| mm as f32), force_n.map(|n| n as f32));
        let response = decoder.response(&Contact { x_mm, y_mm, fx_n, fy_n, fz_n })?;
        // The diagonal of R Σ Rᵀ.
        let [x, y, fx, fy, fz] = response.map(|row| form(&row, uv2, &row));
        Some(Self {
            place_mm: *place_mm,
            deviation_mm: (0.5 * (x + y)).sqrt(),
            force_share: ((fx + fy + fz) / 3.0).sqrt() / square(force_n).sqrt(),
        })
    }
}
