//! The place and the force of the contact: whether it is a touch, which direction and zone it holds, and where it moves pointer, sticks and
//! triggers.

pub(crate) mod axes;
mod curve;
pub(crate) mod heading;
pub(crate) mod pointer;
pub(crate) mod rest;
pub(crate) mod tremor;
pub(crate) mod zone;
