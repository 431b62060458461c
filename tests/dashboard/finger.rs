//! A pad on a terminal whose finger a test moves.

use std::sync::{Arc, Mutex};

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use tactpad::bridge::transport::virtual_pad::{PadFirmware, VirtualPad};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::twin::pad::{Circumstances, TwinPad};
use tactpad::quantity::Contact;

/// Microvolts per count of a pad that does not identify itself.
const UV_PER_COUNT: f64 = 0.01;

/// The pad's noise is the same each time.
const SEED: u64 = 1;

/// The pad; it is pulled out when this is dropped.
pub(crate) struct Finger {
    pad: VirtualPad,
    contact: Arc<Mutex<Option<Contact>>>,
}

struct Firmware {
    pad: TwinPad,
    temperature_c: f64,
    contact: Arc<Mutex<Option<Contact>>>,
    period_us: u64,
    sequence: u32,
}

impl Finger {
    /// A pad at 1 kHz that nothing touches.
    pub(crate) fn start() -> Self {
        let contact = Arc::default();
        let firmware = Firmware {
            pad: TwinPad::new(&Device::nominal(), &PadField::nominal(), SEED),
            temperature_c: Device::nominal().behaviour.thermal.reference_c,
            contact: Arc::clone(&contact),
            period_us: 1_000,
            sequence: 0,
        };
        Self { pad: VirtualPad::start(firmware).unwrap(), contact }
    }

    /// The pad as `--pad` names it.
    pub(crate) fn address(&self) -> String {
        format!("serial:{}", self.pad.path())
    }

    /// Presses so from now on.
    pub(crate) fn press(&self, x_mm: f32, y_mm: f32, fz_n: f32) {
        *self.contact.lock().unwrap() = Some(Contact { x_mm, y_mm, fz_n, ..Contact::default() });
    }

    /// Lifts the finger.
    pub(crate) fn lift(&self) {
        *self.contact.lock().unwrap() = None;
    }
}

impl PadFirmware for Firmware {
    fn receive(&mut self, _bytes: &[u8]) {}

    fn due_us(&self) -> u64 {
        u64::from(self.sequence + 1) * self.period_us
    }

    fn emit(&mut self, now_us: u64, bytes: &mut Vec<u8>) {
        while self.due_us() <= now_us {
            let time_us = self.due_us();
            self.sequence += 1;
            let held: Vec<Contact> = self.contact.lock().unwrap().iter().copied().collect();
            let around = Circumstances { temperature_c: self.temperature_c, cycles: 0.0 };
            let uv = self.pad.read_all(self.period_us as f64 * 1e-6, &held, &around);
            let sample = Sample {
                sequence: self.sequence,
                time_us,
                counts: uv.map(|uv| (uv / UV_PER_COUNT).round() as i32),
                temperature_centi_c: 0,
                status: Status::OK.with_temperature_invalid(),
            };
            let mut frame = [0; ENCODED_MAX];
            let length = encode_message(&Message::Sample(sample), &mut frame);
            bytes.extend_from_slice(&frame[..length]);
        }
    }
}
