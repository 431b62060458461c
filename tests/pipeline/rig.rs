//! A pipeline with a pad that the test plays by hand, in virtual time.

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use tactpad::pad::field::PadField;
use tactpad::pad::influence::InfluenceField;
use tactpad::pipeline::control::{Code, OutputDevice};
use tactpad::pipeline::mapping::profile::{Command, Profile};
use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;

/// Microvolts per count of a pad that does not identify itself.
const UV_PER_COUNT: f32 = 0.01;

/// An event as tests write it: stream time in ms, kernel name, value.
pub(crate) type Event = (f64, String, i32);

pub(crate) fn profile(name: &str) -> Profile {
    let read = shipped::text(name).map(|text| check::read(text, OutputChoice::AsWritten));
    let Some((Some(profile), _)) = read else { panic!("{name} is no shipped profile in order") };
    profile
}

pub(crate) struct Rig {
    pub(crate) pipeline: Pipeline,
    field: InfluenceField,
    /// Time of the pad and of the host, in µs: the pad's clock began at zero with the rig.
    pub(crate) now_us: u64,
    pub(crate) sequence: u32,
    /// Added to each channel, in counts.
    pub(crate) offset: [i32; 9],
    /// What all channels are multiplied by: what an old pad has left.
    pub(crate) gain: f32,
    /// Noise amplitude, in counts.
    pub(crate) noise: i32,
    random: u64,
    pub(crate) events: Vec<Event>,
    /// What the pointer has moved: to the right, down.
    pub(crate) moved: [i32; 2],
    /// What presses have asked of the bridge.
    pub(crate) commands: Vec<Command>,
}

impl Rig {
    /// A rig whose pad has no noise and has just been plugged in.
    pub(crate) fn new(profile: Profile) -> Self {
        Self {
            pipeline: Pipeline::new(tactpad::pipeline::shipped::decoder(), profile),
            field: PadField::nominal().signals,
            now_us: 0,
            sequence: 0,
            offset: [120_000, -40_000, 7, 0, 999_999, -1, 35_000, -250_000, 66],
            gain: 1.0,
            noise: 0,
            random: 88_172_645_463_325_252,
            events: Vec::new(),
            moved: [0; 2],
            commands: Vec::new(),
        }
    }

    /// A rig whose zero is known.
    pub(crate) fn rested(profile: Profile) -> Self {
        let mut rig = Self::new(profile);
        rig.rest(500);
        rig
    }

    pub(crate) fn rest(&mut self, ms: u64) {
        self.press(0.0, 0.0, 0.0, ms);
    }

    /// Normal force at a place for a time, sampled at 1 kHz.
    pub(crate) fn press(&mut self, x_mm: f32, y_mm: f32, fz_n: f32, ms: u64) {
        self.hold(Contact { x_mm, y_mm, fz_n, ..Contact::default() }, ms);
    }

    pub(crate) fn hold(&mut self, contact: Contact, ms: u64) {
        for _ in 0..ms {
            let sample = self.sample(&contact);
            self.send(&sample);
        }
    }

    /// The next sample, 1 ms after the last.
    pub(crate) fn sample(&mut self, contact: &Contact) -> Sample {
        self.now_us += 1_000;
        self.sequence = self.sequence.wrapping_add(1);
        let mut counts =
            self.field.strain_uv(contact).uv.map(|uv| (self.gain * uv / UV_PER_COUNT).round() as i32);
        for (k, count) in counts.iter_mut().enumerate() {
            *count += self.offset[k];
            if self.noise > 0 {
                *count += (self.random() % (2 * self.noise as u64 + 1)) as i32 - self.noise;
            }
        }
        Sample {
            sequence: self.sequence,
            time_us: self.now_us,
            counts,
            temperature_centi_c: 2_300,
            status: Status::OK,
        }
    }

    /// Frames are lost for longer than a finger needs to lift and press again.
    pub(crate) fn lose(&mut self) {
        (0..25).for_each(|_| {
            self.sample(&Contact::default());
        });
    }

    pub(crate) fn send(&mut self, sample: &Sample) {
        self.bytes(&frame(sample));
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        let mut rest = bytes;
        while !rest.is_empty() {
            let taken = self.pipeline.handle_bytes(self.host(), rest, &mut NoProbe);
            rest = &rest[taken..];
            self.collect();
        }
    }

    /// Lets host time pass without a byte; calls what is due.
    pub(crate) fn silence(&mut self, ms: u64) {
        let end = self.host().plus_us(ms * 1_000);
        while let Some(due) = self.pipeline.poll_timeout().filter(|&due| due <= end) {
            self.pipeline.handle_timeout(due);
            self.collect();
        }
        self.now_us += ms * 1_000;
    }

    pub(crate) fn host(&self) -> HostInstant {
        HostInstant::default().plus_us(self.now_us)
    }

    /// Takes the events of the last call.
    pub(crate) fn collect(&mut self) {
        self.commands.extend(self.pipeline.commands());
        for event in self.pipeline.events() {
            if let Code::Relative(axis) = event.code {
                assert_eq!(event.device, OutputDevice::Pointer);
                self.moved[usize::from(axis)] += event.value;
                continue;
            }
            let is_pointers = matches!(event.code, Code::Key(0x110..=0x112));
            assert_eq!(event.device, if is_pointers { OutputDevice::Pointer } else { OutputDevice::Gamepad });
            self.events.push((event.at.as_us() as f64 * 1e-3, event.code.to_string(), event.value));
        }
    }

    /// The events so far without their times, as `CODE=value`; forgets them.
    pub(crate) fn take_events(&mut self) -> Vec<String> {
        self.events.drain(..).map(|(_, code, value)| format!("{code}={value}")).collect()
    }

    pub(crate) fn random(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random
    }

    pub(crate) fn is_neutral(&self) -> bool {
        self.pipeline.held().next().is_none()
    }
}

pub(crate) fn frame(sample: &Sample) -> Vec<u8> {
    let mut frame = [0; ENCODED_MAX];
    let length = encode_message(&Message::Sample(*sample), &mut frame);
    frame[..length].to_vec()
}
