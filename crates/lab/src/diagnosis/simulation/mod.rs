//! The simulated pad as a model of its nine channels, and as it would read contacts that nobody wrote.

pub(crate) mod atlas;
pub(crate) mod bench;
pub(crate) mod own;
mod row;
pub(crate) mod simulated;
