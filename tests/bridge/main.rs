//! The bridge on real ports, in real time: every part starts the program and plays on it from outside.
//!
//! What computes for long is in other programs, so that it takes no time from these.
#![cfg(target_os = "linux")]

#[cfg(test)]
#[path = "../support/c_compiler.rs"]
mod c_compiler;
#[cfg(feature = "live")]
mod control;
#[cfg(feature = "live")]
#[path = "../support/decoders.rs"]
mod decoders;
#[cfg(feature = "live")]
mod firmware;
#[cfg(feature = "live")]
mod kept_play;
mod nostd;
#[cfg(feature = "live")]
mod presses;
#[cfg(feature = "live")]
mod programs;
#[cfg(all(test, feature = "live"))]
#[path = "../support/proof.rs"]
mod proof;
#[cfg(feature = "live")]
mod reload;
#[cfg(feature = "live")]
mod replay;
#[cfg(feature = "live")]
mod running;
#[cfg(feature = "live")]
mod signals;
#[cfg(feature = "live")]
mod soak;
#[cfg(feature = "live")]
mod stalled;
#[cfg(feature = "live")]
mod stranger;
#[path = "../support/mod.rs"]
mod support;
#[cfg(feature = "tray")]
mod tray;
#[cfg(feature = "live")]
mod weighing;
#[cfg(feature = "live")]
mod x11;
