//! The live bridge: reads the pad, stamps, drives the pipeline, writes events, records.
//!
//! One thread, one loop: poll, one clock read, one read, the pipeline, one write, one clock read. This is the only
//! file that reads the clock.

use std::io::{self, Write};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use firmware_proto::ENCODED_MAX;
use firmware_proto::command::Command;
use firmware_proto::link::encode_command;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::capture::{CallRef, CaptureWriter};
use crate::control::Device;
use crate::health::Health;
use crate::latency::{Durations, Percentiles};
use crate::mapping::intent::Level;
use crate::mapping::profile::Profile;
use crate::pipeline::{NoProbe, Phase, Pipeline, Refusal};
use crate::quantity::Contact;
use crate::replay::make_call;
use crate::signals::{Request, Signals};
use crate::sink::{Sink, SinkError};
use crate::time::HostInstant;
use crate::transport::Transport;

/// A pad that has not sent one sound frame by then is no pad, or not there.
const FIRST_FRAME_US: u64 = 3_000_000;

/// An unplugged pad is looked for this often.
const REOPEN_US: u64 = 250_000;

/// A pad that is still starting may miss a question: it is asked again after these times.
const IDENTIFY_US: [u64; 3] = [0, 250_000, 1_000_000];

/// The snapshot for screens is renewed this often.
const SNAPSHOT_US: u64 = 40_000;

/// The host's monotonic clock, counted from its making.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    origin: Instant,
}

impl Default for Clock {
    fn default() -> Self {
        Self::start()
    }
}

impl Clock {
    /// A clock that begins now.
    #[expect(clippy::disallowed_methods, reason = "the one place where time comes from")]
    pub fn start() -> Self {
        Self { origin: Instant::now() }
    }

    /// Time since the clock began.
    pub fn now(&self) -> HostInstant {
        HostInstant::from_ns(u64::try_from(self.origin.elapsed().as_nanos()).unwrap_or(u64::MAX))
    }
}

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

/// What the bridge is doing, for a screen; renewed every 40 ms.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// What the pipeline is doing.
    pub phase: Phase,
    /// The contact that is being mapped.
    pub contact: Option<Contact>,
    /// What is held.
    pub held: Vec<Level>,
    /// What went wrong so far.
    pub health: Health,
    /// From bytes readable to write returned.
    pub latency: Percentiles,
    /// Host time of the snapshot.
    pub at: HostInstant,
}

/// Opens the pad, again and again if need be.
pub type Opener = Box<dyn FnMut() -> io::Result<Box<dyn Transport>>>;

/// What a bridge is made of.
pub struct Parts {
    /// The pipeline, with its profile.
    pub pipeline: Pipeline,
    /// The pad, opened once already so that errors were told.
    pub pad: Option<Box<dyn Transport>>,
    /// Opens the pad again after it was unplugged; `None` for a pad that ends, as a capture does.
    pub opener: Option<Opener>,
    /// Where events go.
    pub sink: Box<dyn Sink>,
    /// Signals and what they ask for.
    pub signals: Signals,
    /// Where calls are recorded.
    pub recorder: Option<CaptureWriter<Box<dyn Write>>>,
    /// Reads the profile again when the player asks; tells people why not.
    pub reload: Box<dyn FnMut() -> Option<(String, Profile)>>,
    /// Ends the run at this time.
    pub end_at: Option<HostInstant>,
    /// Whether to go on waiting for a pad that sends no sound frame.
    pub patience: Patience,
    /// The clock that the bridge's time counts from.
    pub clock: Clock,
}

/// What to do about a pad that sends no sound frame at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// Give up after three seconds with a sentence.
    Limited,
    /// Wait.
    Endless,
}

/// Why a run ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// A signal asked for it.
    Asked,
    /// Its time was over.
    TimeOver,
    /// The pad was a capture, and it ended.
    CaptureEnded,
}

/// The running bridge.
pub struct Bridge {
    parts: Parts,
    latency: Durations,
    snapshot: Arc<Mutex<Snapshot>>,
    snapshot_at: HostInstant,
    opened_at: HostInstant,
    identify_asked: usize,
    reopen_at: HostInstant,
    bytes: [u8; 4096],
    bytes_heard: u64,
    held_at_end: usize,
}

/// What woke the loop.
struct Woken {
    pad: bool,
    signal: bool,
}

impl Bridge {
    /// A bridge that is ready to run.
    pub fn new(parts: Parts) -> Self {
        let now = parts.clock.now();
        let snapshot = Arc::new(Mutex::new(Snapshot {
            phase: parts.pipeline.phase(),
            contact: None,
            held: Vec::new(),
            health: Health::default(),
            latency: Percentiles::default(),
            at: now,
        }));
        Self {
            parts,
            latency: Durations::new(),
            snapshot,
            snapshot_at: now,
            opened_at: now,
            identify_asked: 0,
            reopen_at: now,
            bytes: [0; 4096],
            bytes_heard: 0,
            held_at_end: 0,
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
        self.parts.pipeline.health()
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
        self.held_at_end = self.parts.pipeline.held().count();
        let released = self.call(self.parts.clock.now(), CallRef::ReleaseAll);
        if let Some(recorder) = &mut self.parts.recorder {
            recorder.flush().map_err(BridgeError::Io)?;
        }
        released.and(ending)
    }

    fn play(&mut self) -> Result<Ending, BridgeError> {
        prepare(self.parts.sink.as_mut(), self.parts.pipeline.profile())?;
        let mut now = self.parts.clock.now();
        loop {
            // The deadline counts from the last wake-up: one clock read less, late by what the work took.
            let woken = self.wait(now).map_err(BridgeError::Io)?;
            now = self.parts.clock.now();
            if woken.signal && self.answer_signals(now)? {
                return Ok(Ending::Asked);
            }
            if woken.pad {
                if self.read_pad(now)? {
                    return Ok(Ending::CaptureEnded);
                }
            } else {
                self.call_if_due(now)?;
            }
            if self.parts.end_at.is_some_and(|end_at| end_at <= now) {
                return Ok(Ending::TimeOver);
            }
            self.attend_pad(now)?;
            self.publish(now);
        }
    }

    /// Sleeps until the pad, a signal or a deadline.
    fn wait(&self, now: HostInstant) -> io::Result<Woken> {
        let timeout = self.next_deadline().map(|deadline| until(now, deadline));
        let signal = PollFd::from_borrowed_fd(self.parts.signals.fd(), PollFlags::IN);
        let (pad_ready, signal_ready) = match &self.parts.pad {
            Some(pad) => {
                let mut fds = [PollFd::from_borrowed_fd(pad.fd(), PollFlags::IN), signal];
                poll_again(&mut fds, timeout.as_ref())?;
                let [pad, signal] = fds;
                (!pad.revents().is_empty(), !signal.revents().is_empty())
            }
            None => {
                let mut fds = [signal];
                poll_again(&mut fds, timeout.as_ref())?;
                let [signal] = fds;
                (false, !signal.revents().is_empty())
            }
        };
        Ok(Woken { pad: pad_ready, signal: signal_ready })
    }

    fn next_deadline(&self) -> Option<HostInstant> {
        let identify = self.identify_at();
        let reopen = self.parts.pad.is_none().then_some(self.reopen_at);
        let silence = self.is_unheard().then(|| self.opened_at.plus_us(FIRST_FRAME_US));
        let own = [self.parts.end_at, self.parts.pipeline.poll_timeout(), identify, reopen, silence];
        own.into_iter().flatten().min()
    }

    fn call_if_due(&mut self, now: HostInstant) -> Result<(), BridgeError> {
        match self.parts.pipeline.poll_timeout() {
            Some(due) if due <= now => self.call(now, CallRef::Timeout),
            _ => Ok(()),
        }
    }

    /// Reads once. True if the pad was a capture that ended.
    fn read_pad(&mut self, now: HostInstant) -> Result<bool, BridgeError> {
        let Some(pad) = &mut self.parts.pad else { return Ok(false) };
        let mut bytes = self.bytes;
        match pad.read(&mut bytes) {
            Ok(read) if read > 0 => {
                self.bytes_heard += read as u64;
                self.call(now, CallRef::Bytes(bytes.get(..read).unwrap_or_default()))?;
                Ok(false)
            }
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {
                self.call_if_due(now)?;
                Ok(false)
            }
            _ => self.lose_pad(now),
        }
    }

    fn lose_pad(&mut self, now: HostInstant) -> Result<bool, BridgeError> {
        self.parts.pad = None;
        self.call(now, CallRef::Unplugged)?;
        self.reopen_at = now.plus_us(REOPEN_US);
        Ok(self.parts.opener.is_none())
    }

    /// Makes one call on the pipeline, writes what comes of it, and records it.
    fn call(&mut self, now: HostInstant, call: CallRef<'_>) -> Result<(), BridgeError> {
        let Self { parts: Parts { pipeline, sink, clock, recorder, .. }, latency, .. } = self;
        make_call(pipeline, now, call, &mut NoProbe, |events| {
            sink.write(events)?;
            latency.record_ns(clock.now().as_ns().saturating_sub(now.as_ns()));
            Ok(())
        })
        .map_err(BridgeError::Sink)?;
        match recorder {
            Some(recorder) => recorder.write(now, call).map_err(BridgeError::Io),
            None => Ok(()),
        }
    }

    /// True if a signal asks to end.
    fn answer_signals(&mut self, now: HostInstant) -> Result<bool, BridgeError> {
        while let Some(request) = self.parts.signals.take() {
            match request {
                Request::End => return Ok(true),
                Request::ReleaseAll => self.call(now, CallRef::ReleaseAll)?,
                Request::TogglePause if self.parts.pipeline.phase() == Phase::Paused => {
                    self.call(now, CallRef::Resume)?;
                }
                Request::TogglePause => self.call(now, CallRef::Pause)?,
                Request::ReloadProfile => self.reload_profile(now)?,
            }
        }
        Ok(false)
    }

    fn reload_profile(&mut self, now: HostInstant) -> Result<(), BridgeError> {
        let Some((text, profile)) = (self.parts.reload)() else { return Ok(()) };
        prepare(self.parts.sink.as_mut(), &profile)?;
        let forced = profile.output == Device::Keyboard;
        let call = if forced { CallRef::KeyboardProfile(&text) } else { CallRef::Profile(&text) };
        self.call(now, call)
    }

    /// Asks the pad who it is, looks for an unplugged one, and gives up on what is no pad.
    fn attend_pad(&mut self, now: HostInstant) -> Result<(), BridgeError> {
        if let Some(refusal) = self.parts.pipeline.refusal() {
            return Err(BridgeError::Refused(*refusal));
        }
        if self.is_unheard() && now >= self.opened_at.plus_us(FIRST_FRAME_US) {
            return Err(BridgeError::NotAPad(self.why_not_a_pad()));
        }
        if self.parts.pad.is_none() && now >= self.reopen_at {
            self.reopen(now);
        }
        if self.identify_at().is_some_and(|due| due <= now) {
            self.ask_identity();
        }
        Ok(())
    }

    /// Whether the pad has yet to send its first sound frame and patience is limited.
    fn is_unheard(&self) -> bool {
        self.parts.patience == Patience::Limited && self.parts.pipeline.health().samples == 0
    }

    fn why_not_a_pad(&self) -> String {
        if self.bytes_heard == 0 {
            "sent nothing for 3 s: check that the pad is powered and this is its port, or wait for it with --wait"
                .into()
        } else {
            format!(
                "sent {} bytes in 3 s but not one tactpad frame: another device, or another baud rate \
                 (serial:PATH@BAUD)",
                self.bytes_heard
            )
        }
    }

    fn reopen(&mut self, now: HostInstant) {
        self.reopen_at = now.plus_us(REOPEN_US);
        if let Some(pad) = self.parts.opener.as_mut().and_then(|open| open().ok()) {
            self.parts.pad = Some(pad);
            self.opened_at = now;
            self.identify_asked = 0;
        }
    }

    fn identify_at(&self) -> Option<HostInstant> {
        let asking = self.parts.pad.is_some() && self.parts.pipeline.identity().is_none();
        let due = IDENTIFY_US.get(self.identify_asked).filter(|_| asking)?;
        Some(self.opened_at.plus_us(*due))
    }

    /// A pad that takes no commands is no error: it plays with the default scale.
    fn ask_identity(&mut self) {
        self.identify_asked += 1;
        let mut frame = [0; ENCODED_MAX];
        let length = encode_command(&Command::Identify, &mut frame);
        if let (Some(pad), Some(frame)) = (&mut self.parts.pad, frame.get(..length)) {
            let _ = pad.send(frame);
        }
    }

    fn publish(&mut self, now: HostInstant) {
        if now.us_since(self.snapshot_at) < SNAPSHOT_US {
            return;
        }
        self.snapshot_at = now;
        if let Ok(mut snapshot) = self.snapshot.try_lock() {
            let pipeline = &self.parts.pipeline;
            snapshot.phase = pipeline.phase();
            snapshot.contact = pipeline.contact().copied();
            snapshot.held.clear();
            snapshot.held.extend(pipeline.held());
            snapshot.health = *pipeline.health();
            snapshot.latency = self.latency.percentiles();
            snapshot.at = now;
        }
    }
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

/// Polls; a signal that interrupts it is seen through its own descriptor.
fn poll_again(fds: &mut [PollFd<'_>], timeout: Option<&Timespec>) -> io::Result<()> {
    match poll(fds, timeout) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
