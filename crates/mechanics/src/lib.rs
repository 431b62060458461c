//! The pad's mechanics by finite elements: from a device to its influence field.

mod assembly;
pub mod brick;
pub mod deformed;
mod dissection;
pub mod field_cache;
mod foot;
pub mod gauges;
pub mod grid;
pub mod mesh;
pub mod meshes;
pub mod pad;
pub mod plate;
pub mod pressed;
mod readings;
pub mod ring;
pub mod sensitivity;
pub mod simulator;
pub mod superelement;
pub mod system;
pub mod vibration;
