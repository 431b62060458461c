//! An event log where people are: the newest events in the live picture, or lines on standard output.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex};

use super::output::log_to;
use crate::cli::failure::Failure;
use tactpad::bridge::sink::{Sink, SinkError};
use tactpad::pipeline::control::{OutputDevice, OutputEvent};

/// More have no room beside the plate.
const NEWEST: usize = 8;

/// Display name.
const PLACE: &str = "event log, here";

/// The newest events, which a sink writes and a picture shows.
#[derive(Clone, Default)]
pub(super) struct Newest(Arc<Mutex<VecDeque<OutputEvent>>>);

impl Newest {
    /// A sink for them, where a picture shows them; else one that prints every event.
    pub(super) fn sink(&self, is_shown: bool) -> Result<Box<dyn Sink>, Failure> {
        if is_shown { Ok(Box::new(self.clone())) } else { log_to(io::stdout()) }
    }

    /// The events, the newest last.
    pub(super) fn events(&self) -> Vec<OutputEvent> {
        self.0.lock().map(|events| events.iter().copied().collect()).unwrap_or_default()
    }
}

impl Sink for Newest {
    fn prepare(&mut self, _device: OutputDevice) -> Result<(), SinkError> {
        Ok(())
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        if let Ok(mut events) = self.0.lock() {
            events.extend(group);
            let old = events.len().saturating_sub(NEWEST);
            events.drain(..old);
        }
        Ok(())
    }

    fn describe(&self) -> String {
        PLACE.into()
    }
}
