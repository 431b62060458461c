//! The pad, its tables and the live core of tactpad: pad bytes in, output events out.
//!
//! The way of the data is one line: bytes → sample → raw channels → strain → contact → intents → output events.
//! [`pipeline`] is that way, as a state machine. Nothing in this crate does I/O, reads a clock, logs or panics; the
//! caller says what happened and when.

pub mod bytes;
pub mod counted;
pub mod network;
pub mod pad;
pub mod pipeline;
pub mod quantity;
pub mod source;
pub mod tables;
pub mod time;
pub mod toml_text;
pub mod virtual_pad;

pub use firmware_proto;
