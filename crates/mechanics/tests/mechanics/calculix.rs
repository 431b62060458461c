//! The pad's mechanics beside those of CalculiX, a finite-element program that others wrote.
//!
//! Module by module on the same mesh, with the other tests: what differs is rounding. The whole pad in 3-D is a proof.

#[cfg(test)]
mod assembly;
#[cfg(test)]
mod deck;
#[cfg(test)]
mod face;
#[cfg(test)]
mod gauges;
#[cfg(test)]
mod module;
#[cfg(test)]
mod plate;
#[cfg(test)]
mod results;
