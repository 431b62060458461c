//! The live bridge: reads the pad, stamps, drives the pipeline, writes events, records, answers.
//!
//! One thread, one loop: poll, one clock read, one read, the pipeline, one write, one clock read.

pub mod clock;
pub mod keeper;
pub mod state;

use std::io::{self, Write};
use std::sync::{Arc, Mutex};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::capture::{CallRef, CaptureWriter};
use crate::contact::watch::Warning;
use crate::control::Device;
use crate::health::Health;
use crate::latency::{Durations, Percentiles};
use crate::mapping::profile::Profile;
use crate::pipeline::{NoProbe, Phase, Pipeline, Refusal};
use crate::replay::make_call;
use crate::requests::{Asked, Request, Requests};
use crate::sink::{Sink, SinkError};
use crate::time::HostInstant;
use crate::transport::Transport;
use clock::Clock;
use keeper::{Keeper, Patience, Reopen};
use state::{Herald, Snapshot, State, Status};

/// The snapshot for screens is renewed this often.
const SNAPSHOT_US: u64 = 40_000;

/// Why the bridge stopped before it was asked to.
#[derive(Debug)]
pub enum BridgeError {
    /// The port speaks, but not the pad's language; the sentence says what to do.
    NotAPad(String),
    /// The pad cannot be played with.
    Refused(Refusal),
    /// Events do not get out.
    Sink(SinkError),
    /// The machine refused something else.
    Io(io::Error),
}

/// A profile as it was read: its text, and what it means.
pub type ReadProfile = (String, Profile);

/// Reads a profile: the named one, or the one in use again. The error is for people.
pub type ProfileReader = Box<dyn FnMut(Option<&str>) -> Result<ReadProfile, String>>;

/// What a bridge is made of.
pub struct Parts {
    /// The pipeline, with its profile.
    pub pipeline: Pipeline,
    /// What people call its decoder.
    pub decoder: String,
    /// The pad, opened once already so that errors were told.
    pub pad: Option<Box<dyn Transport>>,
    /// Opens the pad again after it was unplugged; `None` for a pad that ends, as a capture does.
    pub opener: Option<Reopen>,
    /// Where events go.
    pub sink: Box<dyn Sink>,
    /// What people ask for.
    pub requests: Requests,
    /// Where calls are recorded.
    pub recorder: Option<CaptureWriter<Box<dyn Write>>>,
    /// Reads the profiles that people ask for.
    pub read_profile: ProfileReader,
    /// Tells people what the bridge is doing, when that changed.
    pub tell: Box<dyn FnMut(&str)>,
    /// Ends the run at this time.
    pub end_at: Option<HostInstant>,
    /// Whether to go on waiting for a pad that sends no sound frame.
    pub patience: Patience,
    /// The clock that the bridge's time counts from.
    pub clock: Clock,
}

/// Why a run ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// Somebody asked for it.
    Asked,
    /// Its time was over.
    TimeOver,
    /// The pad was a capture, and it ended.
    CaptureEnded,
}

/// The running bridge.
pub struct Bridge {
    pipeline: Pipeline,
    decoder: String,
    keeper: Keeper,
    sink: Box<dyn Sink>,
    requests: Requests,
    recorder: Option<CaptureWriter<Box<dyn Write>>>,
    read_profile: ProfileReader,
    tell: Box<dyn FnMut(&str)>,
    end_at: Option<HostInstant>,
    clock: Clock,
    latency: Durations,
    herald: Herald,
    /// The lasting warning that was told last.
    warned: Option<Warning>,
    snapshot: Arc<Mutex<Snapshot>>,
    snapshot_at: HostInstant,
    held_at_end: usize,
    bytes: [u8; 4096],
}

/// What woke the loop.
struct Woken {
    pad: bool,
    request: bool,
}

impl Bridge {
    /// A bridge that is ready to run.
    pub fn new(parts: Parts) -> Self {
        let now = parts.clock.now();
        let keeper = Keeper::new(parts.pad, parts.opener, parts.patience, now);
        let snapshot = Snapshot {
            state: State::of(&parts.pipeline, keeper.absence()),
            contact: None,
            held: Vec::new(),
            warning: None,
            health: Health::default(),
            latency: Percentiles::default(),
            at: now,
        };
        Self {
            pipeline: parts.pipeline,
            decoder: parts.decoder,
            keeper,
            sink: parts.sink,
            requests: parts.requests,
            recorder: parts.recorder,
            read_profile: parts.read_profile,
            tell: parts.tell,
            end_at: parts.end_at,
            clock: parts.clock,
            latency: Durations::new(),
            herald: Herald::new(now),
            warned: None,
            snapshot: Arc::new(Mutex::new(snapshot)),
            snapshot_at: now,
            held_at_end: 0,
            bytes: [0; 4096],
        }
    }

    /// The snapshot that screens read.
    pub fn snapshot(&self) -> Arc<Mutex<Snapshot>> {
        Arc::clone(&self.snapshot)
    }

    /// Durations from bytes readable to write returned, one per write.
    pub const fn latency(&self) -> &Durations {
        &self.latency
    }

    /// What went wrong so far.
    pub const fn health(&self) -> &Health {
        self.pipeline.health()
    }

    /// How many controls were held when the run ended, before they were released.
    pub const fn held_at_end(&self) -> usize {
        self.held_at_end
    }

    /// Plays until it is asked to end. Whatever the ending, everything held is released first.
    ///
    /// # Errors
    /// See [`BridgeError`].
    pub fn run(&mut self) -> Result<Ending, BridgeError> {
        let ending = self.play();
        self.held_at_end = self.pipeline.held().count();
        let released = self.call(self.clock.now(), CallRef::ReleaseAll);
        // Before anything that takes time: a pad that nobody reads any more has to count what is not taken.
        self.keeper.close();
        if let Some(recorder) = &mut self.recorder {
            recorder.flush().map_err(BridgeError::Io)?;
        }
        released.and(ending)
    }

    fn play(&mut self) -> Result<Ending, BridgeError> {
        prepare(self.sink.as_mut(), self.pipeline.profile())?;
        let mut now = self.clock.now();
        loop {
            // The deadline counts from the last wake-up: one clock read less, late by what the work took.
            let woken = self.wait(now).map_err(BridgeError::Io)?;
            now = self.clock.now();
            if woken.request && self.answer_requests(now)? {
                return Ok(Ending::Asked);
            }
            if woken.pad {
                if self.read_pad(now)? {
                    return Ok(Ending::CaptureEnded);
                }
            } else {
                self.call_if_due(now)?;
            }
            if self.end_at.is_some_and(|end_at| end_at <= now) {
                return Ok(Ending::TimeOver);
            }
            self.keeper.attend(now, &self.pipeline)?;
            self.publish(now);
        }
    }

    /// Sleeps until the pad, a request or a deadline.
    fn wait(&self, now: HostInstant) -> io::Result<Woken> {
        let timeout = until(now, self.next_deadline());
        let request = PollFd::from_borrowed_fd(self.requests.fd(), PollFlags::IN);
        let Some(pad) = self.keeper.pad() else {
            let mut fds = [request];
            poll_once(&mut fds, &timeout)?;
            return Ok(Woken { pad: false, request: is_woken(&fds[0]) });
        };
        let mut fds = [PollFd::from_borrowed_fd(pad.fd(), PollFlags::IN), request];
        poll_once(&mut fds, &timeout)?;
        Ok(Woken { pad: is_woken(&fds[0]), request: is_woken(&fds[1]) })
    }

    fn next_deadline(&self) -> HostInstant {
        let pad = self.keeper.next_deadline(&self.pipeline);
        let publish = self.snapshot_at.plus_us(SNAPSHOT_US);
        [self.end_at, self.pipeline.poll_timeout(), pad].into_iter().flatten().fold(publish, HostInstant::min)
    }

    fn call_if_due(&mut self, now: HostInstant) -> Result<(), BridgeError> {
        match self.pipeline.poll_timeout() {
            Some(due) if due <= now => self.call(now, CallRef::Timeout),
            _ => Ok(()),
        }
    }

    /// Reads once. True if the pad was a capture that ended.
    fn read_pad(&mut self, now: HostInstant) -> Result<bool, BridgeError> {
        let mut bytes = self.bytes;
        match self.keeper.read(&mut bytes) {
            Ok(Some(read)) => self.call(now, CallRef::Bytes(bytes.get(..read).unwrap_or_default()))?,
            Ok(None) => self.call_if_due(now)?,
            Err(_) => {
                // Release first: closing a port can take time.
                self.call(now, CallRef::Unplugged)?;
                self.keeper.lose(now);
                return Ok(!self.keeper.can_return());
            }
        }
        Ok(false)
    }

    /// Makes one call on the pipeline, writes what comes of it, and records it.
    fn call(&mut self, now: HostInstant, call: CallRef<'_>) -> Result<(), BridgeError> {
        let Self { pipeline, sink, clock, latency, .. } = self;
        make_call(pipeline, now, call, &mut NoProbe, |events| {
            sink.write(events)?;
            if matches!(call, CallRef::Bytes(_)) {
                latency.record_ns(clock.now().as_ns().saturating_sub(now.as_ns()));
            }
            Ok(())
        })
        .map_err(BridgeError::Sink)?;
        match &mut self.recorder {
            Some(recorder) => recorder.write(now, call).map_err(BridgeError::Io),
            None => Ok(()),
        }
    }

    /// True if somebody asks to end.
    fn answer_requests(&mut self, now: HostInstant) -> Result<bool, BridgeError> {
        while let Some(asked) = self.requests.take() {
            if asked.request == Request::End {
                asked.answer(done());
                return Ok(true);
            }
            self.answer(now, &asked)?;
        }
        Ok(false)
    }

    fn answer(&mut self, now: HostInstant, asked: &Asked) -> Result<(), BridgeError> {
        let answer = match &asked.request {
            Request::Status => self.status(),
            Request::Profile(name) => self.change_profile(now, name.as_deref())?,
            request => {
                let call = match request {
                    Request::ReleaseAll => CallRef::ReleaseAll,
                    Request::Retare => CallRef::Retare,
                    Request::Resume => CallRef::Resume,
                    Request::TogglePause if self.pipeline.phase() == Phase::Paused => CallRef::Resume,
                    _ => CallRef::Pause,
                };
                self.call(now, call)?;
                done()
            }
        };
        asked.answer(answer);
        Ok(())
    }

    /// Goes over to another profile; one that cannot be used changes nothing.
    fn change_profile(&mut self, now: HostInstant, name: Option<&str>) -> Result<String, BridgeError> {
        let read = (self.read_profile)(name);
        let ready = read.and_then(|(text, profile)| match prepare(self.sink.as_mut(), &profile) {
            Ok(()) => Ok((text, profile)),
            Err(BridgeError::Sink(error)) => Err(error.message),
            Err(_) => Err("its devices cannot be made".into()),
        });
        let (text, profile) = match ready {
            Ok(ready) => ready,
            Err(error) => {
                (self.tell)(&format!("{error}\nthe profile in use stays"));
                return Ok(serde_json::json!({"ok": false, "error": error}).to_string());
            }
        };
        (self.tell)(&format!("profile {}", profile.name));
        let call = match profile.output {
            Device::Keyboard => CallRef::KeyboardProfile(&text),
            Device::Gamepad | Device::Pointer => CallRef::Profile(&text),
        };
        self.call(now, call)?;
        Ok(done())
    }

    fn state(&self) -> State {
        State::of(&self.pipeline, self.keeper.absence())
    }

    fn status(&self) -> String {
        let status = Status {
            state: self.state(),
            pad: self.pipeline.identity().map(|identity| identity.serial_number.as_str()),
            profile: &self.pipeline.profile().name,
            decoder: &self.decoder,
            output: self.sink.describe(),
            contact: self.pipeline.contact().copied(),
            held: self.pipeline.held().map(|level| level.code.to_string()).collect(),
            warning: self.pipeline.warning(),
            health: *self.pipeline.health(),
            latency_us: self.latency.percentiles(),
        };
        serde_json::to_string(&status).unwrap_or_else(|error| error.to_string())
    }

    /// Renews the snapshot, and tells a state that lasts.
    fn publish(&mut self, now: HostInstant) {
        if now.us_since(self.snapshot_at) < SNAPSHOT_US {
            return;
        }
        self.snapshot_at = now;
        let state = self.state();
        if let Some(state) = self.herald.hear(now, state) {
            (self.tell)(state.sentence());
        }
        let warning = self.pipeline.warning();
        if let Some(lasting) = warning.filter(|warning| warning.lasts() && self.warned != Some(*warning)) {
            self.warned = warning;
            (self.tell)(&lasting.to_string());
        }
        if let Ok(mut snapshot) = self.snapshot.try_lock() {
            snapshot.state = state;
            snapshot.contact = self.pipeline.contact().copied();
            snapshot.held.clear();
            snapshot.held.extend(self.pipeline.held());
            snapshot.warning = warning;
            snapshot.health = *self.pipeline.health();
            snapshot.latency = self.latency.percentiles();
            snapshot.at = now;
        }
    }
}

fn done() -> String {
    r#"{"ok":true}"#.into()
}

fn is_woken(fd: &PollFd<'_>) -> bool {
    !fd.revents().is_empty()
}

/// Makes the devices that `profile` plays on.
fn prepare(sink: &mut dyn Sink, profile: &Profile) -> Result<(), BridgeError> {
    let devices = [Device::Gamepad, Device::Keyboard, Device::Pointer];
    let mut used = devices.into_iter().filter(|device| profile.uses(*device));
    used.try_for_each(|device| sink.prepare(device)).map_err(BridgeError::Sink)
}

fn until(now: HostInstant, deadline: HostInstant) -> Timespec {
    let wait_ns = deadline.as_ns().saturating_sub(now.as_ns()).min(i64::MAX as u64);
    Timespec { tv_sec: (wait_ns / 1_000_000_000) as i64, tv_nsec: (wait_ns % 1_000_000_000) as i64 }
}

/// Polls; a signal that interrupts it is seen through the requests' descriptor.
fn poll_once(fds: &mut [PollFd<'_>], timeout: &Timespec) -> io::Result<()> {
    match poll(fds, Some(timeout)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
