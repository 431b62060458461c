//! Why a bridge stops.

use std::fmt;
use std::io;

use crate::sink::SinkError;
use tactpad_core::pipeline::refusal::Refusal;

/// Why the bridge stopped before it was asked to.
#[derive(Debug)]
#[non_exhaustive]
pub enum BridgeError {
    /// The port speaks, but not the pad's language. The text goes on after the pad's address and says what to do.
    NotAPad(String),
    /// The pad cannot be played with. The text goes on after the pad's address.
    Refused(Refusal),
    /// Events do not get out.
    Sink(SinkError),
    /// The machine refused something else.
    Io(io::Error),
}

impl fmt::Display for BridgeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAPad(why) => f.write_str(why),
            Self::Refused(refusal) => refusal.fmt(f),
            Self::Sink(error) => error.fmt(f),
            Self::Io(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for BridgeError {}
