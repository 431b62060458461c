//! The bridge on real ports: every part starts the program and plays on it from outside.
//!
//! What depends on the pace of a pad runs in a guest kernel, in virtual time: on a machine that does other work a pad made of
//! software falls silent, and a bridge rightly lets go. The others wait for states.
#![cfg(target_os = "linux")]

mod arduino;
mod bench;
#[cfg(test)]
#[path = "../support/c_compiler.rs"]
mod c_compiler;
#[path = "../support/clock.rs"]
mod clock;
mod control;
#[path = "../support/decoders.rs"]
mod decoders;
mod firmware;
#[path = "../kernel/guest.rs"]
mod guest;
mod hanging_folder;
mod kept_play;
mod killed;
mod load_cells;
mod nostd;
mod presses;
mod programs;
#[cfg(test)]
#[path = "../support/proof.rs"]
mod proof;
#[path = "../support/pseudo_terminal.rs"]
mod pseudo_terminal;
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
mod wayland;
mod weighing;
mod x11;
