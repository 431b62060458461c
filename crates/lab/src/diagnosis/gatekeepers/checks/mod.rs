//! The checks, one file for each kind of fault.

pub(crate) mod clipping;
pub(crate) mod clock;
pub(crate) mod dead;
pub(crate) mod excess;
pub(crate) mod intermittent;
pub(crate) mod line;
pub(crate) mod mains;
pub(crate) mod missing;
pub(crate) mod steps;
pub(crate) mod stuck;
pub(crate) mod wiring;
