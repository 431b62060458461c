//! The pad's mechanics: exact solutions, laws, other programs, and what was derived from them.

mod calculix;
mod changes;
mod elements;
mod field;
mod laws;
#[cfg(test)]
#[path = "../../../../tests/support/proof.rs"]
mod proof;
mod reference;
mod standard;
mod statics;
#[path = "../../../../tests/support/mod.rs"]
mod support;
#[cfg(test)]
mod vibration;
