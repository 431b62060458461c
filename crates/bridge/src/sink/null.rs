//! A sink that keeps nothing: for dry runs, and where events are only shown.

use super::{Sink, SinkError};
use tactpad_core::pipeline::control::{OutputDevice, OutputEvent};

/// Takes every event and forgets it. The text says where events go, for people.
#[derive(Clone, Copy, Debug)]
pub struct NullSink(&'static str);

impl NullSink {
    /// Events go nowhere.
    pub const NOWHERE: Self = Self("no output");
    /// Events are shown by who records them on their way.
    pub const SHOWN: Self = Self("event log, here");
}

impl Sink for NullSink {
    fn prepare(&mut self, _device: OutputDevice) -> Result<(), SinkError> {
        Ok(())
    }

    fn write(&mut self, _group: &[OutputEvent]) -> Result<(), SinkError> {
        Ok(())
    }

    fn describe(&self) -> String {
        self.0.into()
    }
}
