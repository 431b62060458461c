//! The catalogue of causes: one row of [`CATALOGUE`](catalogue::CATALOGUE) each, with its physics, numbers, bounds, and what data it needs.
//!
//! A cause says how it changes the [`Chain`](super::model::chain::Chain); derivatives and refits follow from that.

pub(crate) mod catalogue;
pub(crate) mod cause;
pub(crate) mod memory;
