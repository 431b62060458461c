//! A pad on a terminal whose finger a test moves.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use tactpad::bridge::transport::virtual_pad::{PadFirmware, VirtualPadPort};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::twin::pad::{Circumstances, TwinPad};
use tactpad::quantity::Contact;

use crate::running::comes_true;

/// Microvolts per count of a pad that does not identify itself.
const UV_PER_COUNT: f64 = 0.01;

/// Half of the time from one press of [`Finger::pulse`] to the next.
const HALF_PULSE_MS: u64 = 20;
/// From one press of [`Finger::pulse`] to the next.
pub(crate) const PULSE_MS: u64 = 2 * HALF_PULSE_MS;

/// The pad's noise is the same each time.
const SEED: u64 = 1;

/// The pad; it is pulled out when this is dropped.
pub(crate) struct Finger {
    pad: VirtualPadPort,
    does: Arc<Mutex<Does>>,
    /// The pad's own time.
    time_us: Arc<AtomicU64>,
}

/// What the finger does.
#[derive(Clone, Copy, Default)]
enum Does {
    /// It is away.
    #[default]
    Nothing,
    /// It stays.
    Press(Contact),
    /// It presses, and hardly presses, 25 times a second.
    Pulse(Contact),
}

impl Does {
    fn contact(self, time_us: u64) -> Option<Contact> {
        match self {
            Self::Nothing => None,
            Self::Press(contact) => Some(contact),
            Self::Pulse(contact) if (time_us / (1_000 * HALF_PULSE_MS)).is_multiple_of(2) => Some(contact),
            Self::Pulse(contact) => Some(Contact { fz_n: 0.4, ..contact }),
        }
    }
}

struct Firmware {
    pad: TwinPad,
    temperature_c: f64,
    does: Arc<Mutex<Does>>,
    time_us: Arc<AtomicU64>,
    period_us: u64,
    sequence: u32,
}

impl Finger {
    /// A pad at 1 kHz that nothing touches.
    pub(crate) fn start() -> Self {
        let (does, time_us) = (Arc::default(), Arc::default());
        let firmware = Firmware {
            pad: TwinPad::new(&Device::nominal(), &PadField::nominal(), SEED),
            temperature_c: Device::nominal().behaviour.thermal.reference_c,
            does: Arc::clone(&does),
            time_us: Arc::clone(&time_us),
            period_us: 1_000,
            sequence: 0,
        };
        Self { pad: VirtualPadPort::start(firmware).unwrap(), does, time_us }
    }

    /// The pad as `--pad` names it.
    pub(crate) fn address(&self) -> String {
        format!("serial:{}", self.pad.path())
    }

    /// Presses so from now on.
    pub(crate) fn press(&self, x_mm: f32, y_mm: f32, fz_n: f32) {
        *self.does.lock().unwrap() = Does::Press(Contact { x_mm, y_mm, fz_n, ..Contact::default() });
    }

    /// Presses again and again so hard from now on: a force that is on when a profile changes counts only once it was off.
    pub(crate) fn pulse(&self, x_mm: f32, y_mm: f32, fz_n: f32) {
        *self.does.lock().unwrap() = Does::Pulse(Contact { x_mm, y_mm, fz_n, ..Contact::default() });
    }

    /// Goes on like this for so long by the pad's own time: a machine that is late does not shorten it.
    pub(crate) fn stays(&self, for_ms: u64) {
        let until_us = self.time_us.load(Ordering::SeqCst) + 1_000 * for_ms;
        assert!(comes_true(|| self.time_us.load(Ordering::SeqCst) >= until_us), "the pad stands still");
    }

    /// Lifts the finger.
    pub(crate) fn lift(&self) {
        *self.does.lock().unwrap() = Does::Nothing;
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
            self.time_us.store(time_us, Ordering::SeqCst);
            self.sequence += 1;
            let held: Vec<Contact> = self.does.lock().unwrap().contact(time_us).into_iter().collect();
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
