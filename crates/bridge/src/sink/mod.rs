//! Where output events go.

mod held_controls;
pub mod identity;
pub mod log;
pub mod null;
mod queued;
pub mod recording;
pub mod uinput;
pub mod x11;

use std::fmt;

use crate::queue::OnWritten;
use tactpad_core::pipeline::control::{OutputDevice, OutputEvent};
use tactpad_core::pipeline::mapping::profile::Binding;

/// A place for output events.
pub trait Sink {
    /// Makes what `device` needs, so that the next write to it reaches readers. Does nothing if it is there
    /// already.
    ///
    /// # Errors
    /// The device cannot be made; the text says what would help.
    fn prepare(&mut self, device: OutputDevice) -> Result<(), SinkError>;

    /// Says whether all of these controls can be played, before one is pressed. `prepare` comes first.
    ///
    /// # Errors
    /// Some cannot; the text names them all.
    fn accepts(&self, _bindings: &[Binding]) -> Result<(), SinkError> {
        Ok(())
    }

    /// Writes one group of simultaneous events: one system call per device, ended by one report.
    ///
    /// # Errors
    /// The events did not get out.
    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError>;

    /// The same, and calls `written` as soon as the events are out. Never, if they do not get out.
    ///
    /// # Errors
    /// The events did not get out.
    fn write_then(&mut self, group: &[OutputEvent], written: OnWritten) -> Result<(), SinkError> {
        self.write(group)?;
        written();
        Ok(())
    }

    /// Waits a little, half a second at most, until everything is out.
    ///
    /// # Errors
    /// Events did not get out.
    fn settle(&mut self) -> Result<(), SinkError> {
        Ok(())
    }

    /// How many groups were dropped so far because nobody took them in time.
    fn dropped(&self) -> u64 {
        0
    }

    /// How many groups still wait to be taken.
    fn waiting(&self) -> u64 {
        0
    }

    /// One line for people: what this is and where its events arrive.
    fn describe(&self) -> String;
}

/// Why a sink cannot take events.
#[derive(Debug)]
pub struct SinkError {
    /// One sentence: what failed, where, and the way out.
    pub message: String,
}

impl fmt::Display for SinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for SinkError {}
