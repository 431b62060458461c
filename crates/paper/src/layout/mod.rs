//! Where the modules stand under the plate: the paper's rule, and what the pad's mechanics say.
//!
//! The paper gives every module a circular effective region ([`region`]) and spreads the regions as far as each still
//! reaches its neighbours ([`spacing`], solved by [`swarm`] and confirmed by [`grid`]; the covered area is [`disc`]'s).
//! Beyond the paper, [`precision`] bounds the error of a located contact for given channel noise, and [`placement`]
//! looks for the radius and the turn of the modules that make the worst of it smallest. [`module_count`] does the same
//! for fewer modules and for more, with [`conditioning`]. [`published`] holds the
//! paper's tables for comparison.
//!
//! [`study`] does all of it for a device, and [`drawing`] shows it. [`sizes`] asks how large and how thick the plate should be.
//!
//! Everything here is pure. Millimetres, newtons, microvolts, degrees, pad frame.
//!
//! Source: Y. Wu et al., "High-Resolution Contact Localization and Three-Axis Force Estimation with a Sparse
//! Strain-Node Tactile Interface Device", Sensors 2026, 26(4), 1378, section 2.1; called "the paper" below.

pub mod conditioning;
pub mod disc;
pub mod drawing;
pub mod grid;
pub mod module_count;
pub mod placement;
pub mod precision;
pub mod published;
pub mod region;
mod ringed;
mod scan;
pub mod size_drawing;
pub mod sizes;
mod sizing;
pub mod spacing;
pub mod study;
pub mod swarm;
