//! The bridge on real ports: every part starts the program and plays on it from outside.
//!
//! What depends on the pace of a pad runs in a guest kernel, in virtual time: on a machine that does other work a pad made of
//! software falls silent, and a bridge rightly lets go. The others wait for states.
#![cfg(target_os = "linux")]

#[cfg(test)]
#[path = "../support/c_compiler.rs"]
mod c_compiler;
#[cfg(feature = "live")]
#[path = "../support/clock.rs"]
mod clock;
#[cfg(feature = "live")]
mod control;
#[cfg(feature = "live")]
#[path = "../support/decoders.rs"]
mod decoders;
#[cfg(feature = "live")]
mod firmware;
#[cfg(feature = "live")]
#[path = "../kernel/guest.rs"]
mod guest;
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
