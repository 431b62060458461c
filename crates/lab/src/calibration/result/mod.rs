//! The result of a fit: its numbers, how well they are known, and checks against the contacts.

pub(crate) mod field_error;
pub mod known;
pub mod numbers;
pub mod open;
pub mod predictive;
