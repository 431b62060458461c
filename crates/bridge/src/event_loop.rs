//! The event loop of a running bridge.

use std::io;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::answer::{done, page, refused, weighing};
use crate::bridge_parts::BridgeParts;
use crate::clock::Clock;
use crate::driver::{Driver, prepare};
use crate::error::BridgeError;
use crate::host::Host;
use crate::latency::Durations;
use crate::notifier::Notifier;
use crate::pad_connection::PadConnection;
use crate::profile_update::{ProfileStatus, ProfileUpdate, unchanged_message};
use crate::recorder::Recorder;
use crate::request::{PendingRequest, Request};
use crate::requests::Requests;
use crate::signals;
use crate::snapshot::{Drops, Snapshot};
use crate::snapshot_builder::{DecoderInfo, snapshot, state};
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::capture::head::Head;
use tactpad_core::pipeline::health::Health;
use tactpad_core::pipeline::mapping::live::stated::Commands;
use tactpad_core::pipeline::mapping::profile::Command;
use tactpad_core::pipeline::mapping::read::ReadProfile;
use tactpad_core::pipeline::{Phase, Pipeline};
use tactpad_core::time::HostInstant;

/// The snapshot for screens is renewed this often while a pad is there; without one whenever the bridge wakes.
const SNAPSHOT_US: u64 = 40_000;

/// Why a run ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// Somebody asked for it.
    Requested,
    /// Its time was over.
    TimeOver,
    /// The pad was a capture, and it ended.
    CaptureEnded,
}

/// The running bridge.
pub struct Bridge {
    driver: Driver,
    decoder: DecoderInfo,
    profile_status: ProfileStatus,
    connection: PadConnection,
    requests: Requests,
    host: Box<dyn Host>,
    end_at: Option<HostInstant>,
    notifier: Notifier,
    snapshot: Arc<Mutex<Snapshot>>,
    snapshot_at: HostInstant,
    held_when_over: usize,
    drops: Drops,
    /// The bytes that the pad sent last.
    bytes: [u8; 4096],
}

/// The sources that woke the loop.
#[derive(Clone, Copy, Debug)]
struct Woken {
    pad: bool,
    request: bool,
}

impl Bridge {
    /// A bridge that is ready to run. Its clock, and its capture if it records one, begin now.
    ///
    /// # Errors
    /// The beginning of the capture cannot be written.
    pub fn new(parts: BridgeParts) -> io::Result<Self> {
        let clock = Clock::start();
        let now = clock.now();
        let BridgeParts {
            pad,
            patience,
            decoder,
            profile,
            sink,
            requests,
            host,
            record,
            mut observers,
            changes,
            duration_us,
        } = parts;
        let pipeline = Pipeline::new(decoder.decoder, profile.profile().clone());
        let head = Head { decoder: decoder.file, profile: Some(profile) };
        let decoder = DecoderInfo { name: decoder.name, place: decoder.place, changes };
        let recorder = record.map(|to| Recorder::begin(to, now, &head)).transpose()?;
        let (latency, watchers) = (Arc::default(), requests.watchers());
        let commands = Commands::new();
        observers.iter_mut().for_each(|observer| observer.begin(clock, now, &pipeline));
        let driver = Driver { pipeline, sink, recorder, clock, latency, commands, watchers, observers };
        let connection = PadConnection::new(pad, patience, now);
        let profile_status = ProfileStatus::new();
        let first_snapshot =
            Arc::new(Mutex::new(snapshot(now, &driver, &connection, &decoder, &profile_status)));
        Ok(Self {
            driver,
            decoder,
            profile_status,
            connection,
            requests,
            host,
            end_at: duration_us.map(|duration_us| now.plus_us(duration_us)),
            notifier: Notifier::new(now),
            snapshot: first_snapshot,
            snapshot_at: now,
            held_when_over: 0,
            drops: Drops::default(),
            bytes: [0; 4096],
        })
    }

    /// The snapshot that screens read; it is renewed as long as somebody has it.
    pub fn snapshot(&self) -> Arc<Mutex<Snapshot>> {
        Arc::clone(&self.snapshot)
    }

    /// Durations from bytes readable to events written, one per group.
    pub fn latency(&self) -> Durations {
        self.driver.latency().clone()
    }

    /// The same, as they grow.
    pub fn shared_latency(&self) -> Arc<Mutex<Durations>> {
        Arc::clone(&self.driver.latency)
    }

    /// Counts of lost and damaged frames so far.
    pub const fn health(&self) -> &Health {
        self.driver.pipeline.health()
    }

    /// How many controls were held when the run ended, before they were released.
    pub const fn held_when_over(&self) -> usize {
        self.held_when_over
    }

    /// Events and calls that had not been written when the run ended.
    pub const fn drops(&self) -> Drops {
        self.drops
    }

    /// Plays until it is asked to end. Whatever the ending, everything held is released first. Logs and captures that take
    /// nothing are waited for only a little.
    ///
    /// # Errors
    /// See [`BridgeError`].
    pub fn run(&mut self) -> Result<Ending, BridgeError> {
        let ending = self.play();
        self.held_when_over = self.driver.pipeline.held().count();
        let released = self.driver.call(self.driver.clock.now(), Call::ReleaseAll);
        // Before anything that takes time: a pad that nobody reads any more has to count what is not taken.
        self.connection.close();
        let settled = self.driver.settle();
        self.drops = self.driver.drops_at_end();
        released.and(settled).and(ending)
    }

    fn play(&mut self) -> Result<Ending, BridgeError> {
        prepare(self.driver.sink.as_mut(), self.driver.pipeline.profile())?;
        let mut now = self.driver.clock.now();
        loop {
            // The deadline counts from the last wake-up: one clock read less, late by what the work took.
            let woken = self.wait(now).map_err(BridgeError::Io)?;
            now = self.driver.clock.now();
            if let Some(ending) = self.turn(now, woken)? {
                return Ok(ending);
            }
        }
    }

    /// Does what there is to do at `now`. The ending, if this was the last turn.
    fn turn(&mut self, now: HostInstant, woken: Woken) -> Result<Option<Ending>, BridgeError> {
        if woken.request
            && let ControlFlow::Break(ending) = self.answer_requests(now)?
        {
            return Ok(ending);
        }
        if woken.pad {
            if self.read_pad(now)? {
                return Ok(Some(Ending::CaptureEnded));
            }
            self.run_commands(now)?;
        } else {
            self.driver.call_if_due(now)?;
        }
        if self.end_at.is_some_and(|end_at| end_at <= now) {
            return Ok(Some(Ending::TimeOver));
        }
        self.connection.maintain(now, &self.driver.pipeline)?;
        self.publish(now);
        Ok(None)
    }

    /// Sleeps until the pad, a request or a deadline.
    fn wait(&self, now: HostInstant) -> io::Result<Woken> {
        let timeout = self.next_deadline().map(|deadline| until(now, deadline));
        let request = PollFd::from_borrowed_fd(self.requests.fd(), PollFlags::IN);
        let Some(pad) = self.connection.pad() else {
            let mut fds = [request];
            poll_once(&mut fds, timeout.as_ref())?;
            return Ok(Woken { pad: false, request: is_woken(&fds[0]) });
        };
        let mut fds = [PollFd::from_borrowed_fd(pad.fd(), PollFlags::IN), request];
        poll_once(&mut fds, timeout.as_ref())?;
        Ok(Woken { pad: is_woken(&fds[0]), request: is_woken(&fds[1]) })
    }

    /// When there is something to do though nobody asks and no pad speaks.
    fn next_deadline(&self) -> Option<HostInstant> {
        let pipeline = &self.driver.pipeline;
        // Without a pad the picture stands still but for what the connection finds, and that wakes the loop anyway.
        let publish = self.connection.pad().map(|_| self.snapshot_at.plus_us(SNAPSHOT_US));
        let deadlines =
            [self.end_at, pipeline.poll_timeout(), self.connection.next_deadline(pipeline), publish];
        deadlines.into_iter().flatten().min()
    }

    /// Reads once. True if the pad was a capture that ended.
    fn read_pad(&mut self, now: HostInstant) -> Result<bool, BridgeError> {
        match self.connection.read(&mut self.bytes) {
            Ok(Some(read)) => {
                self.driver.call(now, Call::Bytes(self.bytes.get(..read).unwrap_or_default()))?;
            }
            Ok(None) => self.driver.call_if_due(now)?,
            Err(_) => {
                // Release first: closing a port can take time.
                self.driver.call(now, Call::Unplugged)?;
                self.connection.on_unplugged(now);
                return Ok(!self.connection.can_return());
            }
        }
        Ok(false)
    }

    /// Breaks off the turn if somebody asks to end, or if the process was stopped: then `now` is long past.
    fn answer_requests(&mut self, now: HostInstant) -> Result<ControlFlow<Option<Ending>>, BridgeError> {
        while let Some(pending) = self.requests.take() {
            match pending.request {
                Request::End => {
                    pending.reply(done());
                    return Ok(ControlFlow::Break(Some(Ending::Requested)));
                }
                Request::Stop => {
                    self.stop(now)?;
                    return Ok(ControlFlow::Break(None));
                }
                _ => self.answer(now, &pending)?,
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Releases everything and stops the process. Once that is continued, takes up the line again where it then is: what
    /// the pad said meanwhile is old.
    fn stop(&mut self, now: HostInstant) -> Result<(), BridgeError> {
        self.driver.call(now, Call::ReleaseAll)?;
        // Threads that write stop with the process.
        self.driver.sink.settle().map_err(BridgeError::Sink)?;
        signals::stop_process().map_err(BridgeError::Io)?;
        let now = self.driver.clock.now();
        self.driver.call_if_due(now)?;
        self.connection.discard_input(now, &mut self.bytes);
        Ok(())
    }

    fn answer(&mut self, now: HostInstant, pending: &PendingRequest) -> Result<(), BridgeError> {
        let answer = match &pending.request {
            Request::Status => self.status(now),
            Request::Page => page(self.host.page()),
            Request::Preview(read) => self.preview(now, read)?,
            Request::Profile(name) => {
                let read = self.host.read_profile(name.as_deref());
                self.change_profile(now, read, name.is_some())?
            }
            Request::NextProfile => {
                let read = self.host.next_profile();
                self.change_profile(now, read, true)?
            }
            Request::UpdateProfile(update) => self.update_profile(now, update)?,
            Request::Weigh(weight) => {
                self.driver.call(now, Call::Weigh(*weight))?;
                weighing(self.driver.pipeline.weighing().map_or(0, |it| it.number))
            }
            request => {
                let call = match request {
                    Request::ReleaseAll => Call::ReleaseAll,
                    Request::Retare => Call::Retare,
                    Request::Resume => Call::Resume,
                    Request::TogglePause if self.driver.pipeline.phase() == Phase::Paused => Call::Resume,
                    _ => Call::Pause,
                };
                self.driver.call(now, call)?;
                done()
            }
        };
        pending.reply(answer);
        Ok(())
    }

    /// Runs the commands that presses have triggered.
    fn run_commands(&mut self, now: HostInstant) -> Result<(), BridgeError> {
        for command in std::mem::take(&mut self.driver.commands) {
            let request = match command {
                Command::NextProfile => Request::NextProfile,
                Command::Profile(name) => Request::Profile(Some(name.to_string())),
                Command::TogglePause => Request::TogglePause,
                Command::Panic => Request::ReleaseAll,
                Command::Tare => Request::Retare,
            };
            self.answer(now, &PendingRequest::unanswered(request))?;
        }
        Ok(())
    }

    /// Goes over to another profile; one that cannot be used changes nothing.
    fn change_profile(
        &mut self,
        now: HostInstant,
        read: Result<ReadProfile, String>,
        is_named: bool,
    ) -> Result<String, BridgeError> {
        match read.and_then(|read| self.prepared(read)) {
            Ok(read) => {
                self.host.tell(&format!("profile {}", read.profile().name));
                self.profile_status.on_request(is_named);
                self.driver.call(now, Call::Profile(&read))?;
                Ok(done())
            }
            Err(error) => {
                self.host.tell(&unchanged_message(&error));
                Ok(refused(&error))
            }
        }
    }

    /// Plays a profile that is not kept yet. One that cannot be used changes nothing.
    fn preview(&mut self, now: HostInstant, read: &ReadProfile) -> Result<String, BridgeError> {
        match prepare(self.driver.sink.as_mut(), read.profile()) {
            Ok(()) => {
                self.profile_status.on_preview();
                self.driver.call(now, Call::Profile(read))?;
                Ok(done())
            }
            Err(error) => Ok(refused(&error.to_string())),
        }
    }

    /// Switches to a profile that another thread has read, unless somebody has asked for another one meanwhile. A profile that equals the
    /// one in play, or cannot be used, changes nothing.
    fn update_profile(&mut self, now: HostInstant, update: &ProfileUpdate) -> Result<String, BridgeError> {
        if !self.host.wants(update) {
            return Ok(done());
        }
        let read = update.read.clone().and_then(|read| self.prepared(read));
        let is_same = read.as_ref().is_ok_and(|read| read.profile() == self.driver.pipeline.profile());
        if let Some(line) =
            self.profile_status.apply(update, read.as_ref().map(|read| (read.profile(), is_same)))
        {
            self.host.tell(&line);
        }
        match &read {
            Ok(read) if !is_same => self.driver.call(now, Call::Profile(read))?,
            _ => {}
        }
        Ok(done())
    }

    /// A profile whose devices are there; the error is for people.
    fn prepared(&mut self, read: ReadProfile) -> Result<ReadProfile, String> {
        match prepare(self.driver.sink.as_mut(), read.profile()) {
            Ok(()) => Ok(read),
            Err(error) => Err(error.to_string()),
        }
    }

    fn take_snapshot(&self, now: HostInstant) -> Snapshot {
        snapshot(now, &self.driver, &self.connection, &self.decoder, &self.profile_status)
    }

    fn status(&self, now: HostInstant) -> String {
        serde_json::to_string(&self.take_snapshot(now).status).unwrap_or_else(|error| error.to_string())
    }

    /// Renews the snapshot, and tells a state that lasts.
    fn publish(&mut self, now: HostInstant) {
        if now.us_since(self.snapshot_at) < SNAPSHOT_US {
            return;
        }
        self.snapshot_at = now;
        if let Some(state) = self.notifier.state_to_report(now, state(&self.driver, &self.connection)) {
            self.host.tell(state.sentence());
        }
        if let Some(warning) = self.notifier.warning_to_report(self.driver.pipeline.warning()) {
            self.host.tell(&warning.to_string());
        }
        if let Some(line) = self.notifier.weighing_to_report(self.driver.pipeline.weighing()) {
            self.host.tell(&line);
        }
        for line in self.notifier.drops_to_report(self.driver.drops()).into_iter().flatten() {
            self.host.tell(line);
        }
        let is_shown = Arc::strong_count(&self.snapshot) > 1;
        if is_shown && let Ok(mut snapshot) = self.snapshot.try_lock() {
            *snapshot = self.take_snapshot(now);
        }
    }
}

fn is_woken(fd: &PollFd<'_>) -> bool {
    !fd.revents().is_empty()
}

fn until(now: HostInstant, deadline: HostInstant) -> Timespec {
    let wait_ns = deadline.as_ns().saturating_sub(now.as_ns()).min(i64::MAX as u64);
    Timespec { tv_sec: (wait_ns / 1_000_000_000) as i64, tv_nsec: (wait_ns % 1_000_000_000) as i64 }
}

/// Polls; a signal that interrupts it is seen through the requests' descriptor.
fn poll_once(fds: &mut [PollFd<'_>], timeout: Option<&Timespec>) -> io::Result<()> {
    match poll(fds, timeout) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use std::os::fd::{AsFd, BorrowedFd};
    use std::sync::atomic::{AtomicUsize, Ordering};

    use firmware_proto::ENCODED_MAX;
    use firmware_proto::frame::Message;
    use firmware_proto::link::encode_message;
    use firmware_proto::sample::{Sample, Status};

    use super::*;
    use crate::bridge_parts::PlayingDecoder;
    use crate::changes::ChangesSlot;
    use crate::opening::{OpenedPad, Patience};
    use crate::sink::null::NullSink;
    use crate::sink::{Sink, SinkError};
    use crate::transport::Transport;
    use crate::transport::pads::PadError;
    use tactpad_core::pad::field::PadField;
    use tactpad_core::pipeline::control::{OutputDevice, OutputEvent};
    use tactpad_core::pipeline::mapping::read::check::OutputChoice;
    use tactpad_core::pipeline::mapping::read::shipped as profiles;
    use tactpad_core::pipeline::shipped;
    use tactpad_core::quantity::Contact;

    /// Keeps the messages that it was given.
    #[derive(Clone, Default)]
    struct MessageLog(Arc<Mutex<Vec<String>>>);

    impl Host for MessageLog {
        fn read_profile(&mut self, name: Option<&str>) -> Result<ReadProfile, String> {
            let text = name.and_then(profiles::text).ok_or("there is none")?;
            ReadProfile::read(text, OutputChoice::AsWritten).0.ok_or("it has errors".into())
        }

        fn next_profile(&mut self) -> Result<ReadProfile, String> {
            Err("there is no next one".into())
        }

        fn tell(&mut self, line: &str) {
            self.0.lock().unwrap().push(line.into());
        }
    }

    /// A bridge whose pad never comes, what it tells, and how often it looked for the pad.
    fn without_pad() -> (Bridge, MessageLog, Arc<AtomicUsize>) {
        let (messages, looked) = (MessageLog::default(), Arc::new(AtomicUsize::new(0)));
        let looking = Arc::clone(&looked);
        let pad = OpenedPad::absent(Box::new(move || {
            looking.fetch_add(1, Ordering::Relaxed);
            Err(PadError::NotThere("no".into()))
        }));
        (bridge(pad, Box::new(NullSink), &messages), messages, looked)
    }

    /// A bridge that plays Contra on this pad.
    fn bridge(pad: OpenedPad, sink: Box<dyn Sink>, messages: &MessageLog) -> Bridge {
        let bridge = Bridge::new(BridgeParts {
            pad,
            patience: Patience::Endless,
            decoder: PlayingDecoder {
                decoder: shipped::decoder(),
                name: "inverse".into(),
                place: None,
                file: None,
            },
            profile: messages.clone().read_profile(Some("contra")).unwrap(),
            sink,
            requests: Requests::new().unwrap(),
            host: Box::new(messages.clone()),
            record: None,
            observers: Vec::new(),
            changes: ChangesSlot::default(),
            duration_us: None,
        });
        bridge.unwrap()
    }

    const ASLEEP: Woken = Woken { pad: false, request: false };

    /// Lets the bridge wake when it wants to until `end`; how often it did.
    fn wake_ups(bridge: &mut Bridge, end: HostInstant) -> usize {
        let mut count = 0;
        while let Some(now) = bridge.next_deadline().filter(|now| *now < end) {
            assert_eq!(bridge.turn(now, ASLEEP).unwrap(), None);
            count += 1;
        }
        count
    }

    #[test]
    fn without_a_pad_it_wakes_at_most_five_times_a_second_and_still_looks_and_tells() {
        let (mut bridge, messages, looked) = without_pad();
        let snapshot = bridge.snapshot();
        let begin = bridge.snapshot_at;
        let count = wake_ups(&mut bridge, begin.plus_us(10_000_000));
        assert!(count <= 50, "{count} times in ten seconds");
        let looked = looked.load(Ordering::Relaxed);
        assert!(looked >= 35, "it looked {looked} times");
        assert_eq!(*messages.0.lock().unwrap(), ["waiting for the pad: plug it in"]);
        assert!(snapshot.lock().unwrap().at >= begin.plus_us(9_000_000), "the picture is old");
    }

    #[test]
    fn another_profile_is_taken_and_one_that_cannot_be_read_is_told() {
        let (mut bridge, messages, _) = without_pad();
        let now = bridge.snapshot_at;
        let read = bridge.host.read_profile(Some("tetris"));
        assert_eq!(bridge.change_profile(now, read, true).unwrap(), done());
        assert_eq!(bridge.take_snapshot(now).status.profile, "Tetris");
        let read = bridge.host.read_profile(None);
        let answer = bridge.change_profile(now, read, false).unwrap();
        assert_eq!(answer, r#"{"error":"there is none","ok":false}"#);
        assert_eq!(
            *messages.0.lock().unwrap(),
            ["profile Tetris", "there is none\nthe profile in use stays"]
        );
    }

    #[test]
    fn what_a_press_asks_for_is_done() {
        let (mut bridge, messages, _) = without_pad();
        let now = bridge.snapshot_at;
        let mut ask = |command| {
            bridge.driver.commands.push(command);
            bridge.run_commands(now).unwrap();
            (bridge.driver.pipeline.phase(), bridge.take_snapshot(now).status.profile)
        };
        assert_eq!(ask(Command::TogglePause).0, Phase::Paused);
        assert_eq!(ask(Command::TogglePause).0, Phase::Waiting);
        assert_eq!(ask(Command::Profile("tetris".try_into().unwrap())).1, "Tetris");
        assert_eq!(ask(Command::NextProfile).1, "Tetris");
        let told = messages.0.lock().unwrap();
        assert_eq!(*told, ["profile Tetris", "there is no next one\nthe profile in use stays"]);
    }

    /// What a pad has sent and nobody has read; nothing when it is pulled out.
    type Line = Arc<Mutex<Option<Vec<u8>>>>;

    /// A pad that speaks when a test says so.
    struct Told {
        line: Line,
        nothing: std::fs::File,
    }

    impl Transport for Told {
        fn fd(&self) -> BorrowedFd<'_> {
            self.nothing.as_fd()
        }

        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            let mut line = self.line.lock().unwrap();
            let unread = line.as_mut().ok_or(io::ErrorKind::BrokenPipe)?;
            let count = unread.len().min(bytes.len());
            bytes[..count].copy_from_slice(&unread[..count]);
            unread.drain(..count);
            if count == 0 { Err(io::ErrorKind::WouldBlock.into()) } else { Ok(count) }
        }

        fn send(&mut self, _command: &firmware_proto::command::Command) -> io::Result<()> {
            Ok(())
        }
    }

    /// Writes down the groups that go out.
    #[derive(Clone, Default)]
    struct Written(Arc<Mutex<Vec<OutputEvent>>>);

    impl Sink for Written {
        fn prepare(&mut self, _device: OutputDevice) -> Result<(), SinkError> {
            Ok(())
        }

        fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
            self.0.lock().unwrap().extend_from_slice(group);
            Ok(())
        }

        fn describe(&self) -> String {
            "a test".into()
        }
    }

    /// A bridge and its pad in virtual time: whatever is to happen happens at the moment when it is due.
    struct Play {
        bridge: Bridge,
        line: Line,
        written: Written,
        now: HostInstant,
        sequence: u32,
        uv_per_n: [f32; 9],
    }

    /// What goes out, with its value, and how long after the last change of the finger, in microseconds.
    type Edge = (String, i32, u64);

    impl Play {
        /// A pad at 1 kHz whose zero is known.
        fn start() -> Self {
            let (line, written) = (Line::new(Mutex::new(Some(Vec::new()))), Written::default());
            let nothing = std::fs::File::open("/dev/null").unwrap();
            let mut first: Option<Box<dyn Transport>> =
                Some(Box::new(Told { line: Arc::clone(&line), nothing }));
            let pad =
                OpenedPad::absent(Box::new(move || first.take().ok_or(PadError::NotThere("no".into()))));
            let bridge = bridge(pad, Box::new(written.clone()), &MessageLog::default());
            let now = bridge.snapshot_at;
            let press = Contact { fz_n: 1.0, ..Contact::default() };
            let uv_per_n = PadField::nominal().signals.strain_uv(&press).uv;
            let mut play = Self { bridge, line, written, now, sequence: 0, uv_per_n };
            play.wait(1_000);
            assert_eq!(play.press(0.0, 1_000), []);
            play
        }

        /// Lets time pass in which the pad says nothing; what goes out.
        fn wait(&mut self, ms: u64) -> Vec<Edge> {
            let (begin, end) = (self.now, self.now.plus_us(1_000 * ms));
            let mut edges = Vec::new();
            while let Some(due) = self.bridge.next_deadline().filter(|due| *due < end) {
                self.now = due.max(self.now);
                assert_eq!(self.bridge.turn(self.now, ASLEEP).unwrap(), None);
                edges.extend(self.take(begin));
            }
            self.now = end;
            edges
        }

        /// The finger presses with this force for so long; what goes out.
        fn press(&mut self, fz_n: f32, ms: u64) -> Vec<Edge> {
            let begin = self.now;
            let mut edges = Vec::new();
            for _ in 0..ms {
                self.send(fz_n);
                edges.extend(self.heard(begin));
                let waited_us = self.now.us_since(begin);
                let late = self.wait(1).into_iter();
                edges.extend(late.map(|(code, value, after_us)| (code, value, waited_us + after_us)));
            }
            edges
        }

        /// The pad sends a frame.
        fn send(&mut self, fz_n: f32) {
            self.sequence += 1;
            // A channel that stands still for long is a fault: the last digit moves.
            let jitter = (self.sequence % 2) as i32;
            let sample = Sample {
                sequence: self.sequence,
                time_us: 1_000 * u64::from(self.sequence),
                counts: self.uv_per_n.map(|uv| (100.0 * uv * fz_n) as i32 + jitter),
                temperature_centi_c: 2_500,
                status: Status::OK,
            };
            let mut frame = [0; ENCODED_MAX];
            let length = encode_message(&Message::Sample(sample), &mut frame);
            self.line.lock().unwrap().as_mut().unwrap().extend_from_slice(&frame[..length]);
        }

        /// The bridge hears its pad now.
        fn heard(&mut self, begin: HostInstant) -> Vec<Edge> {
            let woken = Woken { pad: true, request: false };
            assert_eq!(self.bridge.turn(self.now, woken).unwrap(), None);
            self.take(begin)
        }

        fn take(&self, begin: HostInstant) -> Vec<Edge> {
            let after_us = self.now.us_since(begin);
            let written = std::mem::take(&mut *self.written.0.lock().unwrap());
            written.iter().map(|event| (event.code.to_string(), event.value, after_us)).collect()
        }
    }

    /// From where the finger comes or goes: the filter's six samples.
    const EDGE_MAX_US: u64 = 6_000;

    /// What a press must come to, and when at the latest.
    fn is_edge(edges: &[Edge], value: i32, after_max_us: u64) -> bool {
        matches!(edges, [(code, is, after_us)] if code == "BTN_SOUTH" && *is == value && *after_us <= after_max_us)
    }

    #[test]
    fn every_press_goes_out_and_comes_back_in_time() {
        let mut play = Play::start();
        for number in 0..200 {
            let down = play.press(3.0, 50 + number % 7);
            let up = play.press(0.0, 60 + number % 11);
            assert!(
                is_edge(&down, 1, EDGE_MAX_US) && is_edge(&up, 0, EDGE_MAX_US),
                "{number}: {down:?} {up:?}"
            );
        }
    }

    #[test]
    fn silence_releases_after_80_ms_and_not_before() {
        let mut play = Play::start();
        assert!(is_edge(&play.press(3.0, 100), 1, EDGE_MAX_US));
        // The last frame is a millisecond old.
        assert_eq!(play.wait(79), []);
        assert!(is_edge(&play.wait(100), 0, 0), "as soon as 80 ms are over");
    }

    #[test]
    fn a_pad_that_is_pulled_out_holds_nothing_any_more() {
        let mut play = Play::start();
        assert!(is_edge(&play.press(3.0, 100), 1, EDGE_MAX_US));
        *play.line.lock().unwrap() = None;
        let begin = play.now;
        assert!(is_edge(&play.heard(begin), 0, 0), "at once");
    }

    #[test]
    fn a_program_ends_its_own_bridge_without_signals() {
        let (mut bridge, ..) = without_pad();
        bridge.requests.sender().unwrap().send(Request::End).unwrap();
        assert_eq!(bridge.run().unwrap(), Ending::Requested);
    }
}
