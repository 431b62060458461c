//! Where the time goes between bytes readable and event written.
//!
//! Read and write are timed live, around the system calls. What happens between them comes from making the same calls
//! again with a clock as the probe, so that the live figures carry no instruments.

use std::io::{self, Write};
use std::os::fd::BorrowedFd;
use std::sync::{Arc, Mutex};

use firmware_proto::command::Command;
use serde::Serialize;

use crate::clock::Clock;
use crate::latency::{Durations, Percentiles};
use crate::opening::{OpenedPad, Reopen};
use crate::queue::OnWritten;
use crate::sink::{Sink, SinkError};
use crate::transport::Transport;
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::capture::reader::{CaptureError, CaptureReader};
use tactpad_core::pipeline::control::{OutputDevice, OutputEvent};
use tactpad_core::pipeline::mapping::profile::{Action, Profile, Skip};
use tactpad_core::pipeline::{Pipeline, PipelineStage, Probe};
use tactpad_core::time::HostInstant;

/// One value for each stage: read and write are the system calls; decode ends with the contact, map with the events.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Stages<T> {
    /// Taking the bytes from the system.
    pub read: T,
    /// From bytes to contact.
    pub decode: T,
    /// From contact to events.
    pub map: T,
    /// Giving the events to the system.
    pub write: T,
}

/// The times of the stages in one run.
#[derive(Clone, Debug)]
pub struct StageTimes {
    /// How long each stage takes.
    pub stages_us: Stages<Percentiles>,
    /// Mean time between samples; 0 if there were none.
    pub period_us: u64,
}

/// Delays that a profile asks for; no part of the processing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProfileDelays {
    /// The mean filter's: half of its window, or a sample where it adapts.
    pub filter: f64,
    /// Until a press is long, or can no longer become a double or a hard one.
    pub hold: f64,
    /// Until a press counts at all: Slow Keys, and the longest dwell.
    pub slow: f64,
    /// The tremor filter's at rest; a finger that moves is followed faster.
    pub tremor: f64,
}

impl ProfileDelays {
    /// Delays in milliseconds of a profile whose samples are `period_us` apart.
    pub fn of(profile: &Profile, period_us: u64) -> Self {
        let hold_us = profile.buttons.iter().map(|button| match button.action {
            Action::ByTime { double, hold, .. } => [double, hold].into_iter().flatten().map(|it| it.us).max(),
            Action::ByForce { skip: Skip::May { us } | Skip::Must { us }, .. } => Some(us),
            Action::ByForce { skip: Skip::No, .. } | Action::Hold(_) => None,
        });
        let dwell_us = profile.buttons.iter().filter_map(|button| Some(button.dwell?.us));
        let slow_us = dwell_us.chain([profile.access.slow_us]).max().unwrap_or(0);
        Self {
            filter: profile.filter_delay_samples() * period_us as f64 * 1e-3,
            hold: hold_us.flatten().max().unwrap_or(0) as f64 * 1e-3,
            slow: slow_us as f64 * 1e-3,
            tremor: profile.access.tremor.map_or(0.0, |tremor| f64::from(tremor.delay_s()) * 1e3),
        }
    }
}

/// Times the pad and the sink of a run that records into it.
#[derive(Clone, Default)]
pub struct Timing {
    live: SharedStages,
    calls: MemoryCapture,
}

impl Timing {
    /// The same pad; its reads are timed, also after it was opened again.
    #[must_use]
    pub fn pad(&self, mut opened: OpenedPad) -> OpenedPad {
        let live = self.live.clone();
        let timed = move |pad| Box::new(TimedPad { pad, live: live.clone() }) as Box<dyn Transport>;
        opened.pad = opened.pad.take().map(&timed);
        let opener = opened.opener.take();
        opened.opener = opener.map(|mut open| -> Reopen { Box::new(move || open().map(&timed)) });
        opened
    }

    /// The same sink; its writes are timed.
    #[must_use]
    pub fn sink(&self, sink: Box<dyn Sink>) -> Box<dyn Sink> {
        Box::new(TimedSink { sink, live: self.live.clone() })
    }

    /// The durations of reading and of writing so far.
    pub fn live(&self) -> Stages<Durations> {
        self.live.0.lock().map(|stages| stages.clone()).unwrap_or_default()
    }

    /// Where the run has to be recorded.
    pub fn record(&self) -> Box<dyn Write + Send> {
        Box::new(self.calls.clone())
    }

    /// How long the stages took. Makes the calls of the run again, so it takes as long as all of its decoding.
    ///
    /// # Errors
    /// The run was not recorded here.
    pub fn finish(&self, pipeline: Pipeline) -> Result<StageTimes, CaptureError> {
        let mut stages = self.live.0.lock().map(|stages| stages.clone()).unwrap_or_default();
        let calls = self.calls.0.lock().map(|calls| calls.clone()).unwrap_or_default();
        let period_us = replay_timed(&calls, pipeline, &mut stages)?;
        Ok(StageTimes { stages_us: stages.percentiles(), period_us })
    }
}

/// Makes the recorded calls again with a clock inside. Returns the samples' period.
fn replay_timed(
    calls: &[u8],
    mut pipeline: Pipeline,
    stages: &mut Stages<Durations>,
) -> Result<u64, CaptureError> {
    let clock = Clock::start();
    let mut capture = CaptureReader::new(calls)?;
    let (mut first, mut last) = (None, HostInstant::default());
    while let Some(call) = capture.next_call() {
        let (now, call) = call?;
        first.get_or_insert(now);
        last = now;
        let mut probe = Stopwatch::start(clock, stages);
        let mut left: Option<Call<'_>> = Some(call);
        while let Some(call) = left {
            left = pipeline.apply(now, call, &mut probe);
        }
    }
    let samples = pipeline.health().samples.max(1);
    Ok(last.us_since(first.unwrap_or_default()) / samples)
}

/// A probe that reads the clock at each stage.
#[derive(Debug)]
pub struct Stopwatch<'a> {
    clock: Clock,
    last: HostInstant,
    stages: &'a mut Stages<Durations>,
}

impl<'a> Stopwatch<'a> {
    /// One that adds to the durations of decoding and of mapping. Its first stage begins now.
    pub fn start(clock: Clock, stages: &'a mut Stages<Durations>) -> Self {
        Self { clock, last: clock.now(), stages }
    }
}

impl Probe for Stopwatch<'_> {
    fn mark(&mut self, stage: PipelineStage) {
        let now = self.clock.now();
        let elapsed_ns = now.as_ns().saturating_sub(self.last.as_ns());
        match stage {
            // Unpacking is part of decoding: the time runs on.
            PipelineStage::Sample => return,
            PipelineStage::Contact => self.stages.decode.record_ns(elapsed_ns),
            PipelineStage::Events => self.stages.map.record_ns(elapsed_ns),
        }
        self.last = now;
    }
}

impl<T> Stages<T> {
    /// The same for each stage.
    pub fn map<U>(&self, of: impl Fn(&T) -> U) -> Stages<U> {
        Stages { read: of(&self.read), decode: of(&self.decode), map: of(&self.map), write: of(&self.write) }
    }
}

impl Stages<Durations> {
    /// The percentiles of each stage.
    pub fn percentiles(&self) -> Stages<Percentiles> {
        self.map(Durations::percentiles)
    }
}

/// Durations of the system calls, shared by the timed pad and the timed sink.
#[derive(Clone, Default)]
struct SharedStages(Arc<Mutex<Stages<Durations>>>);

impl SharedStages {
    fn record(&self, stage: fn(&mut Stages<Durations>) -> &mut Durations, clock: &Clock) {
        if let Ok(mut stages) = self.0.lock() {
            stage(&mut stages).record_ns(clock.now().as_ns());
        }
    }
}

struct TimedPad {
    pad: Box<dyn Transport>,
    live: SharedStages,
}

impl Transport for TimedPad {
    fn fd(&self) -> BorrowedFd<'_> {
        self.pad.fd()
    }

    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let clock = Clock::start();
        let read = self.pad.read(bytes);
        self.live.record(|stages| &mut stages.read, &clock);
        read
    }

    fn send(&mut self, command: &Command) -> io::Result<()> {
        self.pad.send(command)
    }
}

struct TimedSink {
    sink: Box<dyn Sink>,
    live: SharedStages,
}

impl Sink for TimedSink {
    fn prepare(&mut self, device: OutputDevice) -> Result<(), SinkError> {
        self.sink.prepare(device)
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        self.write_then(group, Box::new(|| ()))
    }

    fn write_then(&mut self, group: &[OutputEvent], written: OnWritten) -> Result<(), SinkError> {
        let (clock, live) = (Clock::start(), self.live.clone());
        let timed = move || {
            live.record(|stages| &mut stages.write, &clock);
            written();
        };
        self.sink.write_then(group, Box::new(timed))
    }

    fn settle(&mut self) -> Result<(), SinkError> {
        self.sink.settle()
    }

    fn dropped(&self) -> u64 {
        self.sink.dropped()
    }

    fn waiting(&self) -> u64 {
        self.sink.waiting()
    }

    fn describe(&self) -> String {
        self.sink.describe()
    }
}

/// A capture in memory.
#[derive(Clone, Default)]
struct MemoryCapture(Arc<Mutex<Vec<u8>>>);

impl Write for MemoryCapture {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.lock() {
            Ok(mut all) => all.write(bytes),
            Err(_) => Err(io::ErrorKind::Other.into()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};

    #[test]
    fn a_profile_says_how_much_later_it_wants_everything() {
        let text = "schema = 1\nname = \"Slow\"\noutput = \"keyboard\"\nfilter_samples = 5\n[access]\nslow_ms = 150\n\
                    tremor_hz = 2\n[[button]]\nforce = \"fz\"\npress_n = 1\ndwell_ms = 800\n\
                    tap = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_A\" }\n\
                    hold = { gamepad = \"BTN_EAST\", keyboard = \"KEY_B\" }\n";
        let profile = read(text, OutputChoice::AsWritten).0.unwrap();
        let ProfileDelays { filter, hold, slow, tremor } = ProfileDelays::of(&profile, 1_000);
        assert_eq!((filter, hold, slow), (2.0, 400.0, 800.0));
        assert!((tremor - 79.58).abs() < 0.01, "{tremor}");
    }
}
