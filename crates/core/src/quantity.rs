//! The physical quantities that stages pass to each other.
//!
//! Pad frame: origin at the centre of the plate's top surface, +x right, +y up seen from above, +z out of the plate.

/// Number of strain channels: three modules, three axes each.
pub const CHANNELS: usize = 9;

/// Weight of a gram, N: standard gravity, 9.80665 m/s² (CGPM 1901).
pub const WEIGHT_N_PER_G: f64 = 9.806_65e-3;

/// Number of strain modules under the plate, at 0°, 120° and 240° counter-clockwise from +x.
pub const MODULES: usize = 3;

/// Channel names in wire order; everything that holds nine values holds them in this order.
pub const CHANNEL_NAMES: [&str; CHANNELS] = ["m0x", "m0y", "m0z", "m1x", "m1y", "m1z", "m2x", "m2y", "m2z"];

/// The nine bridge signals in microvolts, zero for an untouched pad.
///
/// Per module: x, positive where the post is pushed counter-clockwise (tangentially); y, **negative** where it is
/// pushed outwards (radially); z, positive where the module is pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strain {
    /// Microvolts at the bridge, in the order of [`CHANNEL_NAMES`].
    pub uv: [f32; CHANNELS],
}

/// One contact: where the finger acts on the plate and with what force (the finger's action on the plate).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Contact {
    /// Contact point along +x (right), in millimetres from the centre.
    pub x_mm: f32,
    /// Contact point along +y (up), in millimetres from the centre.
    pub y_mm: f32,
    /// Force along +x, in newtons.
    pub fx_n: f32,
    /// Force along +y, in newtons.
    pub fy_n: f32,
    /// Normal force in newtons, **positive pressing into the plate**.
    pub fz_n: f32,
}
