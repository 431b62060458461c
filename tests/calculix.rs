//! The pad's mechanics beside those of CalculiX, a finite-element program that others wrote.
//!
//! Module by module on the same mesh: what differs is rounding.
#![cfg(feature = "simulator")]

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
#[path = "calculix/results.rs"]
mod results;
#[cfg(test)]
mod support;
