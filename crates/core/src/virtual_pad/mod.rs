//! A pad that is not there: the nominal pad's mechanics, an emulated firmware and a scripted player.
//!
//! Its bytes are those of a real pad, so everything behind the port can be tried without one. It has no clock
//! and no I/O: the caller says what time it is and carries the bytes. The same script and seed give the same
//! bytes.

pub mod firmware;
#[cfg(test)]
mod fixture;
pub mod freehand;
pub mod front_end;
mod gesture;
mod player;
pub mod recording;
mod repertoire;
pub mod script;
