//! Drives the pipeline: makes a call, writes what comes of it, measures how long that took, records the call.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::clock::Clock;
use crate::error::BridgeError;
use crate::latency::Durations;
use crate::observer::Observer;
use crate::queue::OnWritten;
use crate::recorder::Recorder;
use crate::sink::Sink;
use crate::snapshot::Drops;
use crate::watchers::Watchers;
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::control::OutputDevice;
use tactpad_core::pipeline::mapping::live::stated::Commands;
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::{NoProbe, Pipeline};
use tactpad_core::time::HostInstant;

/// The pipeline and all that follows its events.
pub(super) struct Driver {
    pub(super) pipeline: Pipeline,
    pub(super) sink: Box<dyn Sink>,
    pub(super) recorder: Option<Recorder>,
    pub(super) clock: Clock,
    /// From bytes readable to events written, one per group. Some sinks write in a thread of their own.
    pub(super) latency: Arc<Mutex<Durations>>,
    /// Commands of presses that are not carried out yet.
    pub(super) commands: Commands,
    /// Told what becomes of each press.
    pub(super) watchers: Watchers,
    /// Told of each call.
    pub(super) observers: Vec<Observer>,
}

impl Driver {
    /// Makes one call on the pipeline, writes what comes of it, and records it.
    pub(super) fn call(&mut self, now: HostInstant, call: Call<'_>) -> Result<(), BridgeError> {
        let mut left = Some(call);
        while let Some(call) = left {
            left = self.pipeline.apply(now, call, &mut NoProbe);
            self.deliver(now, call)?;
            for command in self.pipeline.commands() {
                // More in one read than there is room for: nobody presses so fast.
                let _ = self.commands.try_push(*command);
            }
            self.watchers.tell(self.pipeline.verdicts(), self.pipeline.profile());
            self.pipeline.forget_verdicts();
        }
        for observer in &mut self.observers {
            observer.tell(self.clock, now, call, &self.pipeline);
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
        match call {
            Call::Bytes(_) => self.sink.write_then(events, timed(&self.latency, self.clock, now)),
            _ => self.sink.write(events),
        }
        .map_err(BridgeError::Sink)
    }

    /// Makes the call that is due at `now`, if one is.
    pub(super) fn call_if_due(&mut self, now: HostInstant) -> Result<(), BridgeError> {
        match self.pipeline.poll_timeout() {
            Some(due) if due <= now => self.call(now, Call::Timeout),
            _ => Ok(()),
        }
    }

    /// Waits a little until all events and calls are where they belong.
    pub(super) fn settle(&mut self) -> Result<(), BridgeError> {
        let sink = self.sink.settle().map_err(BridgeError::Sink);
        let recorder = self.recorder.as_mut().map_or(Ok(()), Recorder::settle).map_err(BridgeError::Io);
        sink.and(recorder)
    }

    /// The durations from bytes readable to events written so far.
    pub(super) fn latency(&self) -> MutexGuard<'_, Durations> {
        self.latency.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts of dropped groups and unrecorded calls so far.
    pub(super) fn drops(&self) -> Drops {
        let calls_unrecorded = self.recorder.as_ref().map_or(0, Recorder::missed);
        Drops { groups_dropped: self.sink.dropped(), calls_unrecorded }
    }

    /// The same counts, if nothing more is written.
    pub(super) fn drops_at_end(&self) -> Drops {
        let Drops { groups_dropped, calls_unrecorded } = self.drops();
        let calls_waiting = self.recorder.as_ref().map_or(0, Recorder::waiting);
        Drops {
            groups_dropped: groups_dropped + self.sink.waiting(),
            calls_unrecorded: calls_unrecorded + calls_waiting,
        }
    }
}

/// Records, when the events of the bytes that were readable at `since` are out, how long that took.
fn timed(latency: &Arc<Mutex<Durations>>, clock: Clock, since: HostInstant) -> OnWritten {
    let latency = Arc::clone(latency);
    Box::new(move || {
        let took_ns = clock.now().as_ns().saturating_sub(since.as_ns());
        latency.lock().unwrap_or_else(PoisonError::into_inner).record_ns(took_ns);
    })
}

/// Makes the devices that `profile` plays on, and sees that they have all of its controls.
pub(super) fn prepare(sink: &mut dyn Sink, profile: &Profile) -> Result<(), BridgeError> {
    let devices =
        [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Pointer, OutputDevice::Tablet];
    let mut used = devices.into_iter().filter(|device| profile.uses(*device));
    used.try_for_each(|device| sink.prepare(device)).map_err(BridgeError::Sink)?;
    let bindings: Vec<_> = profile.bindings().collect();
    sink.accepts(&bindings).map_err(BridgeError::Sink)
}
