//! A bridge and its pad in virtual time: what is due happens at the moment when it is due.

use std::collections::VecDeque;
use std::os::fd::{AsFd, BorrowedFd};
use std::sync::atomic::{AtomicU64, Ordering};

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};

use super::*;
use crate::bridge_parts::PlayingDecoder;
use crate::changes::ChangesSlot;
use crate::clock::Clock;
use crate::observer::Observer;
use crate::opening::{OpenedPad, Patience};
use crate::sink::{Sink, SinkError};
use crate::transport::Transport;
use crate::transport::opener::PadError;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::pipeline::control::{OutputDevice, OutputEvent};
use tactpad_core::pipeline::mapping::read::check::OutputChoice;
use tactpad_core::pipeline::mapping::read::shipped as profiles;
use tactpad_core::pipeline::shipped;
use tactpad_core::quantity::Contact;

/// Keeps the messages that it was given, and who reads profiles is asked with it.
#[derive(Clone, Default)]
pub(super) struct MessageLog(pub(super) Arc<Mutex<Vec<String>>>, pub(super) Reading);

/// Profiles that are being read, if that takes time.
pub(super) type Reading = Arc<Mutex<Option<Vec<(ProfileRequest, ProfileReply)>>>>;

impl Host for MessageLog {
    fn read_profile(&mut self, request: ProfileRequest, reply: ProfileReply) {
        if let Some(reading) = &mut *self.1.lock().unwrap() {
            return reading.push((request, reply));
        }
        reply.hand_in(match request {
            ProfileRequest::Named(name) => profile(&name),
            ProfileRequest::Same => Err("there is none".into()),
            ProfileRequest::Next => Err("there is no next one".into()),
        });
    }

    fn tell(&mut self, line: &str) {
        self.0.lock().unwrap().push(line.into());
    }
}

pub(super) fn profile(name: &str) -> Result<ReadProfile, String> {
    let text = profiles::text(name).ok_or("there is none")?;
    ReadProfile::read(text, OutputChoice::AsWritten).0.ok_or("it has errors".into())
}

/// A bridge that plays Contra on this pad, by the clock of these nanoseconds.
pub(super) fn bridge(
    now_ns: &'static AtomicU64,
    pad: OpenedPad,
    sink: Box<dyn Sink>,
    messages: &MessageLog,
    observers: Vec<Observer>,
) -> Bridge {
    let bridge = Bridge::new(BridgeParts {
        clock: Clock::virtual_time(now_ns),
        pad,
        patience: Patience::Endless,
        decoder: PlayingDecoder {
            decoder: shipped::decoder(),
            name: "inverse".into(),
            place: None,
            file: None,
        },
        profile: profile("contra").unwrap(),
        sink,
        requests: Requests::new().unwrap(),
        host: Box::new(messages.clone()),
        record: None,
        observers,
        changes: ChangesSlot::default(),
        duration_us: None,
    });
    bridge.unwrap()
}

/// Nothing woke the loop but its own deadline.
pub(super) const ASLEEP: Woken = Woken { pad: false, request: false };

/// Somebody asked for something.
pub(super) const ASKED: Woken = Woken { pad: false, request: true };

/// So many samples are remembered.
const SENT_MAX: usize = 2_000;

/// So many bytes wait in a terminal.
const TERMINAL_BYTES: usize = 4096;

/// What a pad has sent and nobody has read; nothing once it was pulled out.
type Line = Arc<Mutex<Option<Vec<u8>>>>;

/// Where a pad is plugged in: its line, and why it may not be opened.
#[derive(Clone, Default)]
pub(super) struct Plug {
    line: Arc<Mutex<Option<Line>>>,
    /// The line that the bridge opened last.
    opened: Arc<Mutex<Line>>,
    pub(super) refusal: Arc<Mutex<Option<PadError>>>,
}

impl Plug {
    fn open(&self) -> Result<Box<dyn Transport>, PadError> {
        let line = self.line.lock().unwrap().clone().ok_or(PadError::NotThere("no".into()))?;
        if let Some(refusal) = self.refusal.lock().unwrap().clone() {
            return Err(refusal);
        }
        *self.opened.lock().unwrap() = Arc::clone(&line);
        Ok(Box::new(Port { line, nothing: std::fs::File::open("/dev/null").unwrap() }))
    }

    /// Does something with what nobody has read; `None` without a pad.
    pub(super) fn unread<T>(&self, look: impl FnOnce(&mut Vec<u8>) -> T) -> Option<T> {
        let line = self.line.lock().unwrap().clone()?;
        let mut unread = line.lock().unwrap();
        unread.as_mut().map(look)
    }
}

/// The bridge's end of a pad's line.
struct Port {
    line: Line,
    nothing: std::fs::File,
}

impl Transport for Port {
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

/// Writes down the groups that go out. Those that nobody takes it counts.
#[derive(Clone, Default)]
pub(super) struct Written(pub(super) Arc<Mutex<Outside>>);

/// Who takes events.
#[derive(Default)]
pub(super) struct Outside {
    events: Vec<OutputEvent>,
    pub(super) is_stalled: bool,
    dropped: u64,
}

impl Sink for Written {
    fn prepare(&mut self, _device: OutputDevice) -> Result<(), SinkError> {
        Ok(())
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        let mut outside = self.0.lock().unwrap();
        outside.events.extend_from_slice(group);
        outside.dropped += u64::from(outside.is_stalled);
        Ok(())
    }

    fn dropped(&self) -> u64 {
        self.0.lock().unwrap().dropped
    }

    fn describe(&self) -> String {
        "a test".into()
    }
}

/// Changes the channels (counts) of the sample with this number.
pub(super) type Wiring = Box<dyn Fn(u32, &mut [i32; 9])>;

/// A bridge and its pad, which sends 1,000 samples a second.
pub(super) struct Play {
    pub(super) bridge: Bridge,
    pub(super) plug: Plug,
    pub(super) written: Written,
    pub(super) messages: MessageLog,
    pub(super) now: HostInstant,
    /// The bridge's clock.
    now_ns: &'static AtomicU64,
    /// The number and the time (µs) that the pad's next sample has.
    pub(super) sequence: u32,
    pub(super) time_us: u64,
    /// The samples that it has sent, as far as they are remembered.
    pub(super) sent: VecDeque<Sample>,
    /// By so much its clock goes on in a millisecond, µs.
    pub(super) us_per_ms: u64,
    /// Status of the next sample.
    pub(super) status: Status,
    /// Added to each channel, in counts.
    pub(super) offset: [i32; 9],
    /// What becomes of the channels of a sample with this number, in counts.
    pub(super) wiring: Wiring,
    field: InfluenceField,
    /// The contact that was read last, and the channels of it, µV.
    read: (Contact, [f32; 9]),
}

/// What goes out, with its value, and how long after the last change of the finger, in microseconds.
pub(super) type Edge = (String, i32, u64);

impl Play {
    /// A bridge that waits for a pad: none is plugged in.
    pub(super) fn waiting() -> Self {
        Self::watched(Vec::new())
    }

    /// The same, with these who are told each call.
    pub(super) fn watched(observers: Vec<Observer>) -> Self {
        let (plug, written) = (Plug::default(), Written::default());
        let opened = plug.clone();
        let pad = OpenedPad::absent(Box::new(move || opened.open()));
        let messages = MessageLog::default();
        let now_ns: &AtomicU64 = Box::leak(Box::default());
        let bridge = bridge(now_ns, pad, Box::new(written.clone()), &messages, observers);
        let field = PadField::nominal().signals;
        let away = Contact::default();
        let read = (away, field.strain_uv(&away).uv);
        Self {
            bridge,
            plug,
            written,
            messages,
            now: HostInstant::default(),
            now_ns,
            sequence: 1,
            time_us: 0,
            us_per_ms: 1_000,
            sent: VecDeque::new(),
            status: Status::OK,
            offset: [0; 9],
            wiring: Box::new(|_, _| ()),
            field,
            read,
        }
    }

    /// A pad whose zero is known.
    pub(super) fn start() -> Self {
        let mut play = Self::waiting();
        play.plug_in();
        play.wait(1_000);
        assert_eq!(play.press(0.0, 1_000), []);
        play
    }

    pub(super) fn plug_in(&mut self) {
        self.plug.line.lock().unwrap().get_or_insert_with(|| Arc::new(Mutex::new(Some(Vec::new()))));
    }

    /// Pulls the pad out; what goes out.
    pub(super) fn pull_out(&mut self) -> Vec<Edge> {
        self.unplug();
        self.read(self.now)
    }

    /// The same, while the bridge does not come to run.
    pub(super) fn unplug(&mut self) {
        if let Some(line) = self.plug.line.lock().unwrap().take() {
            *line.lock().unwrap() = None;
        }
    }

    /// Lets time pass in which the pad says nothing; what goes out.
    pub(super) fn wait(&mut self, ms: u64) -> Vec<Edge> {
        let begin = self.now;
        let mut edges = Vec::new();
        self.wait_until(begin.plus_us(1_000 * ms), |play| edges.extend(play.take(begin)));
        self.time_us = self.time_us.wrapping_add(self.us_per_ms * ms);
        edges
    }

    /// Lets time pass until `end`, without a word of the pad, and has each turn of the loop looked at.
    pub(super) fn wait_until(&mut self, end: HostInstant, mut look: impl FnMut(&mut Self)) {
        while let Some(due) = self.bridge.next_deadline().filter(|due| *due < end) {
            self.now = due.max(self.now);
            self.turn(ASLEEP);
            look(self);
        }
        self.now = end;
    }

    /// Presses the middle with this force (N) for so long; what goes out.
    pub(super) fn press(&mut self, fz_n: f32, ms: u64) -> Vec<Edge> {
        self.touch(&Contact { fz_n, ..Contact::default() }, ms)
    }

    /// Keeps this contact for so long, while the bridge does not come to run, and somebody asks it for something; what goes out then.
    /// Of what the pad sends as much waits as a terminal holds; the rest is lost.
    pub(super) fn starve(&mut self, contact: &Contact, ms: u64, request: Option<Request>) -> Vec<Edge> {
        let begin = self.now;
        for _ in 0..ms {
            let message = Message::Sample(self.sample(contact));
            let mut frame = [0; ENCODED_MAX];
            let length = encode_message(&message, &mut frame);
            self.buffer(&frame[..length]);
            self.now = self.now.plus_us(1_000);
            self.time_us = self.time_us.wrapping_add(self.us_per_ms);
        }
        let mut edges = Vec::new();
        if let Some(request) = request {
            self.bridge.requests.sender().unwrap().send(request).unwrap();
            self.turn(Woken { pad: self.bridge.connection.pad().is_some(), request: true });
            edges.extend(self.take(begin));
        }
        while self.is_readable() {
            edges.extend(self.read(begin));
        }
        edges
    }

    /// Keeps this contact for so long, while a hub keeps what the pad sends, and then hands on all of it.
    pub(super) fn stall(&mut self, contact: &Contact, ms: u64) {
        let time_us = self.time_us;
        self.wait(ms);
        self.time_us = time_us;
        for _ in 0..ms {
            let sample = self.sample(contact);
            self.send(self.now, &Message::Sample(sample));
            self.time_us = self.time_us.wrapping_add(self.us_per_ms);
        }
    }

    /// Puts bytes on the line, and says whether a terminal holds that many.
    pub(super) fn buffer(&mut self, bytes: &[u8]) -> bool {
        let put = self.plug.unread(|unread| {
            let fits = unread.len() + bytes.len() <= TERMINAL_BYTES;
            if fits {
                unread.extend_from_slice(bytes);
            }
            fits
        });
        put.unwrap_or(false)
    }

    /// Whether the bridge has a pad open that has sent something.
    pub(super) fn is_readable(&self) -> bool {
        self.bridge.connection.pad().is_some()
            && self.plug.unread(|unread| !unread.is_empty()).unwrap_or(false)
    }

    /// Keeps this contact for so long; what goes out.
    pub(super) fn touch(&mut self, contact: &Contact, ms: u64) -> Vec<Edge> {
        let begin = self.now;
        let mut edges = Vec::new();
        for _ in 0..ms {
            let sample = self.sample(contact);
            edges.extend(self.send(begin, &Message::Sample(sample)));
            let waited_us = self.now.us_since(begin);
            let late = self.wait(1).into_iter();
            edges.extend(late.map(|(code, value, after_us)| (code, value, waited_us + after_us)));
        }
        edges
    }

    /// The pad's next sample.
    pub(super) fn sample(&mut self, contact: &Contact) -> Sample {
        // A channel that stands still for long is a fault: the last digit moves.
        let jitter = (self.sequence % 2) as i32;
        if self.read.0 != *contact {
            self.read = (*contact, self.field.strain_uv(contact).uv);
        }
        let uv = self.read.1;
        let mut counts = std::array::from_fn(|k| (100.0 * uv[k]) as i32 + self.offset[k] + jitter);
        (self.wiring)(self.sequence, &mut counts);
        let sample = Sample {
            sequence: self.sequence,
            time_us: self.time_us,
            counts,
            temperature_centi_c: 2_500,
            status: std::mem::replace(&mut self.status, Status::OK),
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.sent.push_back(sample);
        if self.sent.len() > SENT_MAX {
            self.sent.pop_front();
        }
        sample
    }

    /// The pad sends a message; what goes out, with its time since `begin`.
    pub(super) fn send(&mut self, begin: HostInstant, message: &Message) -> Vec<Edge> {
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(message, &mut frame);
        self.send_bytes(begin, &frame[..length])
    }

    /// The pad sends bytes. Those that nobody reads are lost.
    pub(super) fn send_bytes(&mut self, begin: HostInstant, bytes: &[u8]) -> Vec<Edge> {
        if self.bridge.connection.pad().is_none() {
            return Vec::new();
        }
        self.plug.unread(|unread| unread.extend_from_slice(bytes));
        self.read(begin)
    }

    /// The pad sends bytes to a bridge that has it open; to another one they are lost.
    pub(super) fn send_to(&mut self, bytes: &[u8]) {
        if self.bridge.connection.pad().is_some() {
            self.plug.unread(|unread| unread.extend_from_slice(bytes));
        }
    }

    /// Whether the bridge has a pad open that has sent something, or one that is gone.
    pub(super) fn is_hung_up_or_readable(&self) -> bool {
        let opened = Arc::clone(&self.plug.opened.lock().unwrap());
        let line = opened.lock().unwrap();
        self.bridge.connection.pad().is_some() && line.as_ref().is_none_or(|unread| !unread.is_empty())
    }

    /// The bridge wakes now.
    pub(super) fn turn(&mut self, woken: Woken) {
        self.now_ns.store(self.now.as_ns(), Ordering::Relaxed);
        assert_eq!(self.bridge.turn(self.now, woken).unwrap(), None);
    }

    /// The bridge hears its pad now.
    fn read(&mut self, begin: HostInstant) -> Vec<Edge> {
        let woken = Woken { pad: self.bridge.connection.pad().is_some(), request: false };
        self.turn(woken);
        self.take(begin)
    }

    fn take(&self, begin: HostInstant) -> Vec<Edge> {
        let after_us = self.now.us_since(begin);
        self.taken().iter().map(|event| (event.code.to_string(), event.value, after_us)).collect()
    }

    /// The events that went out since they were taken last.
    pub(super) fn taken(&self) -> Vec<OutputEvent> {
        std::mem::take(&mut self.written.0.lock().unwrap().events)
    }
}
