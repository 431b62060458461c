//! From contacts to readings: the chain that a model of the pad's channels computes, and how it may be decoded backwards.

pub(crate) mod chain;
pub(crate) mod inverse;
pub(crate) mod mechanics;
pub(crate) mod memory;
pub(crate) mod reading;
pub(crate) mod setting;
