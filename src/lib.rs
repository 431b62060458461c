//! Turns a tactile disc with nine strain channels into a game controller.
//!
//! The way of the data is one line: bytes → sample → raw channels → strain → contact → intents → output events.
//! `ARCHITECTURE.md` tells where each step lives and which rules hold between them.

pub mod ablation;
mod bytes;
pub mod calibration;
pub mod capture;
pub mod cli;
pub mod contact;
pub mod control;
pub mod dataset;
pub mod device;
pub mod evaluation;
pub mod field;
pub mod health;
pub mod influence;
pub mod latency;
pub mod layout;
pub mod linear;
pub mod link;
pub mod mapping;
pub mod measured;
#[cfg(feature = "simulator")]
pub mod mechanics;
pub mod metrology;
pub mod network;
pub mod output;
pub mod pipeline;
pub mod plot;
pub mod protocol;
pub mod quantity;
mod random;
pub mod readout;
pub mod replay;
pub mod scdf;
pub mod shipped;
pub mod signal;
pub mod spelling;
pub mod time;
pub mod toml_text;
pub mod twin;
pub mod virtual_pad;
pub mod vtk;
pub mod zernike;

#[cfg(all(feature = "live", target_os = "linux"))]
pub mod bridge;
#[cfg(all(feature = "live", target_os = "linux"))]
pub mod requests;
#[cfg(all(feature = "live", target_os = "linux"))]
pub mod sink;
#[cfg(all(feature = "live", target_os = "linux"))]
pub mod transport;
