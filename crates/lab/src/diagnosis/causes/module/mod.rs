//! Causes in the mechanics of modules and plate.

pub(crate) mod module_crosstalk;
pub(crate) mod module_debonded;
pub(crate) mod module_displaced;
pub(crate) mod module_frame_open;
pub(crate) mod module_rotated;
pub(crate) mod module_stiffness;
pub(crate) mod module_tilted;
pub(crate) mod plate_stiffness;
