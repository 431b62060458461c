//! The twin on a measuring rig: a plan is carried out, and what the noise would allow at best is known.

pub mod bound;
pub mod errors;
pub mod measurement;
mod stage;
