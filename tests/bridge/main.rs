//! The bridge on real ports, in real time: every part starts the program and plays on it from outside.
//!
//! What computes for long is in other programs, so that it takes no time from these.
#![cfg(target_os = "linux")]

#[cfg(test)]
#[path = "../support/c_compiler.rs"]
mod c_compiler;
mod control;
#[path = "../support/decoders.rs"]
mod decoders;
mod firmware;
mod kept_play;
mod nostd;
mod presses;
mod programs;
#[cfg(test)]
#[path = "../support/proof.rs"]
mod proof;
mod reload;
mod replay;
mod running;
mod signals;
mod soak;
mod stalled;
mod stranger;
#[path = "../support/mod.rs"]
mod support;
mod tray;
mod weighing;
mod x11;
