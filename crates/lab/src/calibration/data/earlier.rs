//! A pad of the same kind that was calibrated before.

use tactpad_core::pipeline::compensation::Compensation;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::pipeline::contact::inverse::Inverse;

/// Decoder of an earlier calibration.
#[derive(Clone, Copy, Debug)]
pub struct EarlierCalibration<'d> {
    /// Its field, and how its channels scatter.
    pub inverse: &'d Inverse,
    /// What it remembers of loads, and how it creeps. Zeros and temperature are each pad's own.
    pub compensation: &'d Compensation,
}

impl<'d> EarlierCalibration<'d> {
    /// `None` for a decoder that knows no field.
    pub const fn of(decoder: &'d Decoder) -> Option<Self> {
        match decoder.inverse() {
            Some(inverse) => Some(Self { inverse, compensation: &decoder.compensation }),
            None => None,
        }
    }
}
