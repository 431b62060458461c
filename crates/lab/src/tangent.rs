//! A simulated pad that measured ones are held against: its field, the field's tangent, how far that reaches, and what lies beyond.

use tactpad_core::pad::changes::FieldChange;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;

/// The field of another pad, which may take seconds; none where it cannot be had.
pub type Solve<'s> = &'s (dyn Fn(&Device) -> Option<PadField> + Sync);

/// A simulated pad.
#[derive(Clone, Copy)]
pub struct SimulatedPad<'p> {
    /// Its device.
    pub device: &'p Device,
    /// Its field.
    pub field: &'p PadField,
    /// What flaws of its module 0 change; none, and nobody asks for them.
    pub flaws: &'p [FieldChange],
    /// Fields of pads that are not like it.
    pub solve: Solve<'p>,
}

impl<'p> SimulatedPad<'p> {
    /// Without a simulator: all other pads are on the field's tangent, and none has a flaw.
    pub fn known(device: &'p Device, field: &'p PadField) -> Self {
        Self { device, field, flaws: &[], solve: &|_| None }
    }
}

/// How far the logarithm of a stiffness k may go until the tangent is off by as much as it says: most of what gives way beside a
/// module's frame is not the frame. The simulator has 3.4 to 4.2 for a frame, 4 to 10 for a film or its material, and 1/k in
/// place of ln k.
pub(super) const STIFFNESS_REACH: f64 = 4.0;
/// The same of a turn, in degrees: a radian. The simulator has 100 to 190° on the nominal pad.
pub(super) const TURN_REACH_DEG: f64 = 180.0 / std::f64::consts::PI;

/// Fields are solved at whole multiples of this part of a reach: near enough, and soon known for most pads that come.
const GRID: f64 = 1.0 / 400.0;

/// How far a module may be displaced: its distance from the axis. The simulator has 20 to 46 mm on the nominal pad, where that is 20 mm.
pub(super) const fn shift_reach_mm(device: &Device) -> f64 {
    device.sites.centre_radius_mm
}

/// A coordinate on the grid of those at which fields are solved.
pub(super) fn on_grid(coordinate: f64, reach: f64) -> f64 {
    let step = reach * GRID;
    if step.is_finite() { libm::round(coordinate / step) * step } else { coordinate }
}
