//! The twin played in virtual time: its readings as wire frames into a pipeline.

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::twin::hand::Hand;
use tactpad::pad::twin::pad::{Circumstances, TwinPad};
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;

/// Microvolts per count of a pad that does not identify itself.
const UV_PER_COUNT: f64 = 0.01;
/// A finger takes so long to come, and to leave.
const RAMP_MS: u64 = 40;

/// A pipeline and the pad that it hears, at 1 kHz.
pub(crate) struct Played {
    pub(crate) pipeline: Pipeline,
    pad: TwinPad,
    hands: [Hand; 2],
    pub(crate) around: Circumstances,
    /// What the pad tells of its temperature; nothing if it does not know.
    pub(crate) told_c: fn(f64) -> Option<f64>,
    pub(crate) now_ms: u64,
    sequence: u32,
}

impl Played {
    pub(crate) fn new(decoder: Decoder, device: &Device, field: &PadField, seed: u64) -> Self {
        let read = shipped::text("super-mario").and_then(|text| check::read(text, OutputChoice::AsWritten).0);
        let Some(profile) = read else { panic!("the profile is in order") };
        Self {
            pipeline: Pipeline::new(decoder, profile),
            pad: TwinPad::new(device, field, seed),
            hands: [seed, seed + 1_000].map(|seed| Hand::new(device.behaviour.finger, seed)),
            around: Circumstances { temperature_c: device.behaviour.thermal.reference_c, cycles: 0.0 },
            told_c: Some,
            now_ms: 0,
            sequence: 0,
        }
    }

    /// Fingers press so for a millisecond.
    pub(crate) fn millisecond(&mut self, contacts: &[Contact]) {
        let frame = self.frame(contacts);
        let now = HostInstant::default().plus_us(1_000 * self.now_ms);
        let mut rest = &frame[..];
        while !rest.is_empty() {
            rest = &rest[self.pipeline.handle_bytes(now, rest, &mut NoProbe)..];
        }
    }

    /// The same; what the pad sends is not heard yet.
    pub(crate) fn frame(&mut self, contacts: &[Contact]) -> Vec<u8> {
        let hands = self.hands.iter_mut().zip(contacts);
        let held: Vec<Contact> = hands.map(|(hand, contact)| hand.hold(1e-3, contact)).collect();
        let uv = self.pad.read_all(1e-3, &held, &self.around);
        self.now_ms += 1;
        self.sequence = self.sequence.wrapping_add(1);
        let told_c = (self.told_c)(self.around.temperature_c);
        let sample = Sample {
            sequence: self.sequence,
            time_us: 1_000 * self.now_ms,
            counts: uv.map(|uv| (uv / UV_PER_COUNT).round() as i32),
            temperature_centi_c: (100.0 * told_c.unwrap_or_default()).round() as i16,
            status: told_c.map_or(Status::OK.with_temperature_invalid(), |_| Status::OK),
        };
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&Message::Sample(sample), &mut frame);
        frame[..length].to_vec()
    }

    pub(crate) fn rest(&mut self, ms: u64) {
        (0..ms).for_each(|_| self.millisecond(&[]));
    }

    /// A press with its ramps, which are part of `ms`; the decoded contact in its middle.
    pub(crate) fn press(&mut self, contacts: &[Contact], ms: u64) -> Option<Contact> {
        let mut found = None;
        for at_ms in 0..ms {
            let level = (at_ms.min(ms - at_ms) as f32 / RAMP_MS as f32).min(1.0);
            let pressed: Vec<Contact> = contacts.iter().map(|contact| scaled(contact, level)).collect();
            self.millisecond(&pressed);
            found = if at_ms == ms / 2 { self.pipeline.contact().copied() } else { found };
        }
        found
    }
}

fn scaled(contact: &Contact, level: f32) -> Contact {
    let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
    Contact { x_mm, y_mm, fx_n: level * fx_n, fy_n: level * fy_n, fz_n: level * fz_n }
}
