//! Observations of the pad, and where on it causes act.

pub(crate) mod observed;
pub mod target;
