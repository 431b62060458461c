//! The pad's mechanics: exact solutions, laws, other programs, and what was derived from them.

#[cfg(feature = "simulator")]
mod calculix;
#[cfg(feature = "simulator")]
mod changes;
#[cfg(feature = "simulator")]
mod elements;
#[cfg(feature = "simulator")]
mod field;
#[cfg(feature = "simulator")]
mod laws;
#[cfg(all(test, feature = "simulator"))]
#[path = "../support/proof.rs"]
mod proof;
#[cfg(feature = "simulator")]
mod reference;
#[cfg(feature = "simulator")]
mod standard;
mod statics;
#[cfg(feature = "simulator")]
#[path = "../support/mod.rs"]
mod support;
#[cfg(all(test, feature = "simulator", feature = "lab"))]
mod vibration;
