//! What was measured, and the rows, channels and quantities that it is about.

pub(crate) mod noise;
pub mod observations;
pub mod target;
