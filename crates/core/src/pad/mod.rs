//! The pad: its device file, its influence field, its read-out, and a numerical twin that is imperfect.
//!
//! Contact → [`influence`] (µV per newton at each place) → [`readout`] (bridge law, gain, offset, converter) → channels.

pub mod changes;
pub mod device;
pub mod field;
pub mod influence;
pub mod marks;
pub mod readout;
pub mod twin;
pub mod weight;
pub mod wiring;
