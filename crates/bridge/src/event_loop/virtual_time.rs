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

/// Keeps the messages that it was given.
#[derive(Clone, Default)]
pub(super) struct MessageLog(pub(super) Arc<Mutex<Vec<String>>>);

impl Host for MessageLog {
    fn read_profile(&mut self, request: ProfileRequest, reply: ProfileReply) {
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

fn profile(name: &str) -> Result<ReadProfile, String> {
    let text = profiles::text(name).ok_or("there is none")?;
    ReadProfile::read(text, OutputChoice::AsWritten).0.ok_or("it has errors".into())
}

/// A bridge that plays Contra on this pad, by the clock of these nanoseconds.
pub(super) fn bridge(
    now_ns: &'static AtomicU64,
    pad: OpenedPad,
    sink: Box<dyn Sink>,
    messages: &MessageLog,
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
        observers: Vec::new(),
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

/// What a pad has sent and nobody has read; nothing when it is pulled out.
type Line = Arc<Mutex<Option<Vec<u8>>>>;

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

/// Changes the channels (counts) of the sample with this number.
pub(super) type Wiring = Box<dyn Fn(u32, &mut [i32; 9])>;

/// A bridge and its pad, which sends 1,000 samples a second.
pub(super) struct Play {
    pub(super) bridge: Bridge,
    line: Line,
    written: Written,
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
}

/// What goes out, with its value, and how long after the last change of the finger, in microseconds.
pub(super) type Edge = (String, i32, u64);

impl Play {
    /// A bridge that waits for a pad: none is plugged in.
    pub(super) fn waiting() -> Self {
        let (line, written) = (Line::default(), Written::default());
        let plug = Arc::clone(&line);
        let pad = OpenedPad::absent(Box::new(move || {
            if plug.lock().unwrap().is_none() {
                return Err(PadError::NotThere("no".into()));
            }
            let nothing = std::fs::File::open("/dev/null").unwrap();
            Ok(Box::new(Port { line: Arc::clone(&plug), nothing }))
        }));
        let messages = MessageLog::default();
        let now_ns: &AtomicU64 = Box::leak(Box::default());
        let bridge = bridge(now_ns, pad, Box::new(written.clone()), &messages);
        Self {
            bridge,
            line,
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
            field: PadField::nominal().signals,
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
        self.line.lock().unwrap().get_or_insert_default();
    }

    /// Pulls the pad out; what goes out.
    pub(super) fn pull_out(&mut self) -> Vec<Edge> {
        *self.line.lock().unwrap() = None;
        self.read(self.now)
    }

    /// Lets time pass in which the pad says nothing; what goes out.
    pub(super) fn wait(&mut self, ms: u64) -> Vec<Edge> {
        let (begin, end) = (self.now, self.now.plus_us(1_000 * ms));
        let mut edges = Vec::new();
        while let Some(due) = self.bridge.next_deadline().filter(|due| *due < end) {
            self.now = due.max(self.now);
            self.turn(ASLEEP);
            edges.extend(self.take(begin));
        }
        self.now = end;
        self.time_us = self.time_us.wrapping_add(self.us_per_ms * ms);
        edges
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
            let mut line = self.line.lock().unwrap();
            if let Some(line) = line.as_mut().filter(|line| line.len() + length <= TERMINAL_BYTES) {
                line.extend_from_slice(&frame[..length]);
            }
            self.now = self.now.plus_us(1_000);
            self.time_us = self.time_us.wrapping_add(self.us_per_ms);
        }
        let is_waiting = |line: &Line| line.lock().unwrap().as_ref().is_some_and(|line| !line.is_empty());
        let mut edges = Vec::new();
        if let Some(request) = request {
            self.bridge.requests.sender().unwrap().send(request).unwrap();
            self.turn(Woken { pad: self.bridge.connection.pad().is_some(), request: true });
            edges.extend(self.take(begin));
        }
        while self.bridge.connection.pad().is_some() && is_waiting(&self.line) {
            edges.extend(self.read(begin));
        }
        edges
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
        let uv = self.field.strain_uv(contact).uv;
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
        if let Some(line) = self.line.lock().unwrap().as_mut() {
            line.extend_from_slice(bytes);
        }
        self.read(begin)
    }

    /// The bridge wakes now.
    fn turn(&mut self, woken: Woken) {
        self.now_ns.store(self.now.as_ns(), Ordering::Relaxed);
        assert_eq!(self.bridge.turn(self.now, woken).unwrap(), None);
    }

    /// The bridge hears its pad now.
    fn read(&mut self, begin: HostInstant) -> Vec<Edge> {
        let woken = Woken { pad: self.bridge.connection.pad().is_some(), request: false };
        self.turn(woken);
        self.take(begin)
    }

    /// Somebody asks the bridge for something now.
    pub(super) fn ask(&mut self, request: Request) -> Vec<Edge> {
        self.bridge.requests.sender().unwrap().send(request).unwrap();
        self.turn(ASKED);
        self.take(self.now)
    }

    fn take(&self, begin: HostInstant) -> Vec<Edge> {
        let after_us = self.now.us_since(begin);
        let written = std::mem::take(&mut *self.written.0.lock().unwrap());
        written.iter().map(|event| (event.code.to_string(), event.value, after_us)).collect()
    }
}
