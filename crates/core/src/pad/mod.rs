//! The pad: its device file, its influence field, its read-out, and a numerical twin that is imperfect.
//!
//! Contact → [`influence`] (µV per newton at each place) → [`readout`] (bridge law, converter) and [`channels`] (gain, temperature,
//! crosstalk, offset) → readings.

pub mod changes;
pub mod channels;
pub mod device;
pub mod field;
pub mod influence;
pub mod marks;
pub mod readout;
pub mod twin;
pub mod weight;
pub mod wiring;
