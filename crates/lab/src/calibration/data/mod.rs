//! Measured contacts, the rig that measured them, and other pads of the kind.

pub mod contacts;
pub mod earlier;
pub(crate) mod plate;
pub mod rig;
pub mod thermal_fit;
