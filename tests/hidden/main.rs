//! Effects that are hidden in measured data, and what the program finds of them.
//!
//! The measured data come from a generator that shares no code with the program: its influence fields are tables of
//! another program's solution, and each effect has a formula of its own. Pads are calibrated by such data, too.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot go on has failed, and says what it saw"
)]

mod background;
mod bench;
mod calibrated;
mod campaign;
mod case;
mod conventions;
mod dense;
mod effects;
mod fields;
mod files;
mod foreign;
mod found;
mod further;
mod generator;
mod limits;
mod measured;
mod plan;
mod precision;
mod program;
mod random;
mod score;
mod simulator;
mod sizes;
mod truth;
mod two;
