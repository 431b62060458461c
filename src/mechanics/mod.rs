//! The pad's mechanics by finite elements: from a device to its influence field.

mod brick;
mod dissection;
pub mod grid;
pub mod mesh;
pub mod superelement;
pub mod system;
