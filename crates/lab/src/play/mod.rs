//! Play as a calibration takes it: presses that nobody wrote down, and weights on marked places.
//!
//! A press of a finger has no label. But nine channels against five unknowns leave four equations, and a minute of play is sixty
//! thousand samples. They are taken as means of a tenth of a second, whole periods of the mains.

pub mod change;
pub mod guide;
pub mod home;
pub mod kept;
pub mod reader;
pub mod sheet;
pub mod summary;
pub mod weighing;
pub mod weights;
pub mod windows;
pub mod words;
