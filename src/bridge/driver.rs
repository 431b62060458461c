//! Drives the pipeline: makes a call, writes what comes of it, measures how long that took, records the call.

use std::io::{self, Write};

use crate::bridge::clock::Clock;
use crate::bridge::error::BridgeError;
use crate::bridge::latency::Durations;
use crate::bridge::sink::Sink;
use crate::pipeline::call::Call;
use crate::pipeline::capture::writer::CaptureWriter;
use crate::pipeline::control::OutputDevice;
use crate::pipeline::mapping::profile::Profile;
use crate::pipeline::{NoProbe, Pipeline};
use crate::time::HostInstant;

/// Where calls are recorded.
pub(super) type Recorder = CaptureWriter<Box<dyn Write>>;

/// The pipeline and all that follows its events.
pub(super) struct Driver {
    pub(super) pipeline: Pipeline,
    pub(super) sink: Box<dyn Sink>,
    pub(super) recorder: Option<Recorder>,
    pub(super) clock: Clock,
    /// From bytes readable to write returned, one per write.
    pub(super) latency: Durations,
}

impl Driver {
    /// Makes one call on the pipeline, writes what comes of it, and records it.
    pub(super) fn call(&mut self, now: HostInstant, call: Call<'_>) -> Result<(), BridgeError> {
        let mut left = Some(call);
        while let Some(call) = left {
            left = self.pipeline.apply(now, call, &mut NoProbe);
            self.deliver(now, call)?;
        }
        match &mut self.recorder {
            Some(recorder) => recorder.write(now, call).map_err(BridgeError::Io),
            None => Ok(()),
        }
    }

    /// Writes the events of `call`, if there are any.
    fn deliver(&mut self, now: HostInstant, call: Call<'_>) -> Result<(), BridgeError> {
        let events = self.pipeline.events();
        if events.is_empty() {
            return Ok(());
        }
        self.sink.write(events).map_err(BridgeError::Sink)?;
        if matches!(call, Call::Bytes(_)) {
            self.latency.record_ns(self.clock.now().as_ns().saturating_sub(now.as_ns()));
        }
        Ok(())
    }

    /// Makes the call that is due at `now`, if one is.
    pub(super) fn call_if_due(&mut self, now: HostInstant) -> Result<(), BridgeError> {
        match self.pipeline.poll_timeout() {
            Some(due) if due <= now => self.call(now, Call::Timeout),
            _ => Ok(()),
        }
    }

    /// Hands everything recorded so far to the file.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.recorder.as_mut().map_or(Ok(()), CaptureWriter::flush)
    }
}

/// Makes the devices that `profile` plays on.
pub(super) fn prepare(sink: &mut dyn Sink, profile: &Profile) -> Result<(), BridgeError> {
    let devices = [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Pointer];
    let mut used = devices.into_iter().filter(|device| profile.uses(*device));
    used.try_for_each(|device| sink.prepare(device)).map_err(BridgeError::Sink)
}
