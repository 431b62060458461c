//! The event loop of a running bridge.

use std::io;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::answer::{done, page, refused, weighing};
use crate::bridge_parts::BridgeParts;
use crate::driver::{Driver, prepare};
use crate::error::BridgeError;
use crate::host::{Host, ProfileReply, ProfileRequest};
use crate::latency::Durations;
use crate::notifier::Notifier;
use crate::pad_connection::PadConnection;
use crate::profile_update::{ProfileStatus, ProfileUpdate, unchanged_message};
use crate::recorder::Recorder;
use crate::request::{PendingRequest, Request, RequestSender};
use crate::requests::Requests;
use crate::signals;
use crate::snapshot::{Drops, Snapshot};
use crate::snapshot_builder::{DecoderInfo, snapshot, state};
use crate::transport::evdev::leave;
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
    /// Hands in profiles that were read: made at the start, when there are descriptors.
    sender: Arc<RequestSender>,
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
    /// A bridge that is ready to run. Its run, and its capture if it records one, begin now.
    ///
    /// # Errors
    /// The beginning of the capture cannot be written, or the system has no descriptor to give.
    pub fn new(parts: BridgeParts) -> io::Result<Self> {
        let BridgeParts {
            clock,
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
        let now = clock.now();
        let pipeline = Pipeline::new(decoder.decoder, profile.profile().clone());
        let head = Head { decoder: decoder.file, profile: Some(profile) };
        let decoder = DecoderInfo { name: decoder.name, place: decoder.place, changes };
        let recorder = record.map(|to| Recorder::begin(to, now, &head)).transpose()?;
        let (latency, watchers) = (Arc::default(), requests.watchers());
        let commands = Commands::new();
        observers.iter_mut().for_each(|observer| observer.begin(clock, now, &pipeline));
        let driver = Driver { pipeline, sink, recorder, clock, latency, commands, watchers, observers };
        let connection = PadConnection::new(pad, patience, now);
        let sender = Arc::new(requests.sender()?);
        let profile_status = ProfileStatus::new();
        let first_snapshot =
            Arc::new(Mutex::new(snapshot(now, &driver, &connection, &decoder, &profile_status)));
        Ok(Self {
            driver,
            decoder,
            profile_status,
            connection,
            requests,
            sender,
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
        self.connection.pause(self.driver.pipeline.phase() == Phase::Paused);
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
        if self.connection.asks_pause() && self.driver.pipeline.phase() != Phase::Paused {
            self.driver.call(now, Call::Pause)?;
            self.host.tell(leave::PAUSED);
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
        self.connection.pause(true);
        signals::stop_process().map_err(BridgeError::Io)?;
        let now = self.driver.clock.now();
        self.driver.call_if_due(now)?;
        self.connection.discard_input(now, &mut self.bytes);
        Ok(())
    }

    fn answer(&mut self, now: HostInstant, pending: &PendingRequest) -> Result<(), BridgeError> {
        let asked = match &pending.request {
            Request::Profile(None) => Some(ProfileRequest::Same),
            Request::Profile(Some(name)) => Some(ProfileRequest::Named(name.clone())),
            Request::NextProfile => Some(ProfileRequest::Next),
            _ => None,
        };
        if let Some(request) = asked {
            self.read_profile(request, pending);
            return Ok(());
        }
        let answer = match &pending.request {
            Request::Status => self.status(now),
            Request::Page => page(self.host.page()),
            Request::Preview(read) => self.preview(now, read)?,
            Request::Play(read, is_named) => self.change_profile(now, (**read).clone(), *is_named)?,
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

    /// Has the host read a profile; who asked gets the answer when it is in play.
    fn read_profile(&mut self, request: ProfileRequest, pending: &PendingRequest) {
        let is_named = request != ProfileRequest::Same;
        let reply =
            ProfileReply { sender: Arc::clone(&self.sender), reply_to: pending.reply_to.clone(), is_named };
        self.host.read_profile(request, reply);
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
        if now.us_since(self.snapshot_at) < SNAPSHOT_US && !self.notifier.begins() {
            return;
        }
        self.snapshot_at = now;
        let pipeline = &self.driver.pipeline;
        let unreadable = self.connection.finding();
        // What was wrong with a stream that has ended explains nothing.
        let is_over = unreadable.is_none() && pipeline.is_quiet(now);
        let finding = unreadable.or_else(|| pipeline.line_finding().copied());
        if !is_over && let Some(line) = self.notifier.line_to_report(now, finding.as_ref()) {
            self.host.tell(&line);
        }
        let state = state(&self.driver, &self.connection);
        // What is wrong with the stream says more than what comes of it.
        if !finding.is_some_and(|finding| !is_over && state.may_come_of(&finding))
            && let Some(state) = self.notifier.state_to_report(now, state)
        {
            self.host.tell(state.sentence());
        }
        if let Some(warning) = self.notifier.warning_to_report(now, self.driver.pipeline.warning()) {
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
mod doubt;
#[cfg(test)]
mod histories;
#[cfg(test)]
mod memory;
#[cfg(test)]
mod stories;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod virtual_time;
