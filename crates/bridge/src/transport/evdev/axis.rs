//! Axes of input devices.

/// The range of an axis, by the kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct AxisRange {
    pub(super) value: i32,
    pub(super) minimum: i32,
    pub(super) maximum: i32,
    /// Units per millimetre; of a pressure per gram; 0 where it is not told.
    pub(super) resolution: i32,
}

impl AxisRange {
    /// The share of the range at which a value is; the middle where there is no range.
    pub(super) fn share(&self, value: i32) -> f64 {
        let (minimum, range) = (f64::from(self.minimum), f64::from(self.maximum) - f64::from(self.minimum));
        if range > 0.0 { ((f64::from(value) - minimum) / range).clamp(0.0, 1.0) } else { 0.5 }
    }
}
