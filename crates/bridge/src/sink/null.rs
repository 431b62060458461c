//! A sink that keeps nothing: for dry runs.

use super::{Sink, SinkError};
use tactpad_core::pipeline::control::{OutputDevice, OutputEvent};

/// Takes every event and forgets it.
#[derive(Clone, Copy, Debug)]
pub struct NullSink;

impl Sink for NullSink {
    fn prepare(&mut self, _device: OutputDevice) -> Result<(), SinkError> {
        Ok(())
    }

    fn write(&mut self, _group: &[OutputEvent]) -> Result<(), SinkError> {
        Ok(())
    }

    fn describe(&self) -> String {
        "no output".into()
    }
}
