//! The pad's mechanics beside those of CalculiX, a finite-element program that others wrote.
//!
//! Module by module on the same mesh, with the other tests: what differs is rounding. The whole pad in 3-D is a long
//! proof: `TACTPAD_ASSEMBLY=1 cargo test --release --test calculix assembly -- --nocapture`.
#![cfg(feature = "simulator")]

#[cfg(test)]
#[path = "calculix/assembly.rs"]
mod assembly;
#[cfg(test)]
#[path = "calculix/deck.rs"]
mod deck;
#[cfg(test)]
#[path = "calculix/face.rs"]
mod face;
#[cfg(test)]
#[path = "calculix/gauges.rs"]
mod gauges;
#[cfg(test)]
#[path = "calculix/module.rs"]
mod module;
#[cfg(test)]
#[path = "calculix/plate.rs"]
mod plate;
#[cfg(test)]
#[path = "support/proof.rs"]
mod proof;
#[cfg(test)]
#[path = "calculix/results.rs"]
mod results;
#[cfg(test)]
mod support;
