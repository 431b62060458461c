//! What the fuzz targets share: a pad that does anything, and what must hold whatever it does.

pub mod body;
pub mod captured;
pub mod decoded;
pub mod rig;
pub mod step;
