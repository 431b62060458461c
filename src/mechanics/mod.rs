//! The pad's mechanics by finite elements: from a device to its influence field.

mod brick;
mod dissection;
pub mod grams;
pub mod grid;
pub mod mesh;
pub mod pad;
pub mod plate;
pub mod superelement;
pub mod system;
