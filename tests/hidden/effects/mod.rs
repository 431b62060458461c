//! The generator's own formula for every cause, by the stage at which it acts.
//!
//! Each stage takes all hidden causes and does what those of its own do: the rig moves the contact, the mechanics change
//! the field, memory works on the strain, electronics on the signal, and the reference writes the labels.

pub(crate) mod electrical;
pub(crate) mod mechanical;
pub(crate) mod memory;
pub(crate) mod rig;
pub(crate) mod taken;
pub(crate) mod warmth;
