//! Observations, and the rows, channels and quantities that they are about.

pub(crate) mod noise;
pub mod observations;
pub mod target;
