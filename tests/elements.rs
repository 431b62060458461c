//! The finite elements against what must hold whatever they are used for: exact solutions, closed forms, balance,
//! symmetry, and finer meshes.
#![cfg(feature = "simulator")]

#[cfg(test)]
#[path = "elements/body.rs"]
mod body;
#[cfg(test)]
#[path = "elements/clamped_plate.rs"]
mod clamped_plate;
#[cfg(test)]
#[path = "elements/convergence.rs"]
mod convergence;
#[cfg(test)]
#[path = "elements/debonding.rs"]
mod debonding;
#[cfg(test)]
#[path = "elements/manufactured.rs"]
mod manufactured;
#[cfg(test)]
#[path = "elements/module.rs"]
mod module;
#[cfg(test)]
#[path = "elements/patch.rs"]
mod patch;
#[cfg(test)]
#[path = "elements/variation.rs"]
mod variation;
