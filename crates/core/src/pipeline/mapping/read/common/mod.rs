//! Outputs, names and ranges that several tables of a profile have, and conflicts between tables.

pub(crate) mod binding;
pub(crate) mod conflict;
pub(crate) mod labels;
pub(crate) mod limits;
pub(crate) mod named;
