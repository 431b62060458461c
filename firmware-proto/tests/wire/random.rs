//! Messages and bytes from a seed, the same on every machine.

use std::array;

use firmware_proto::channels::ChannelSample;
use firmware_proto::command::{AckResult, Command};
use firmware_proto::contact::ContactSample;
use firmware_proto::frame::Message;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::sample::{Sample, Status};

/// SplitMix64. Source: G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", 2014.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }

    pub(crate) fn below(&mut self, limit: usize) -> usize {
        (self.bits() % limit as u64) as usize
    }

    pub(crate) fn byte(&mut self) -> u8 {
        self.bits() as u8
    }

    pub(crate) fn bytes(&mut self, len: usize) -> Vec<u8> {
        (0..len).map(|_| self.byte()).collect()
    }

    /// Small and large values alike, so that zero bytes come in every place.
    fn spread(&mut self) -> u64 {
        self.bits() >> self.below(64)
    }

    pub(crate) fn sample(&mut self) -> Sample {
        Sample {
            sequence: self.spread() as u32,
            time_us: self.spread(),
            counts: array::from_fn(|_| self.number()),
            temperature_centi_c: self.spread() as i16,
            status: Status(self.spread() as u16 & 0x0FFF),
        }
    }

    fn number(&mut self) -> i32 {
        (self.spread() as i32).wrapping_mul(if self.byte() & 1 == 0 { 1 } else { -1 })
    }

    fn few_channels(&mut self) -> ChannelSample {
        let counts: Vec<i32> = (0..1 + self.below(8)).map(|_| self.number()).collect();
        let status = Status(self.spread() as u16);
        let sample = ChannelSample::new(self.spread() as u32, self.spread(), &counts, status).unwrap();
        if self.byte() & 1 == 0 { sample } else { sample.with_temperature(self.spread() as i16) }
    }

    fn contact(&mut self) -> ContactSample {
        ContactSample {
            place_um: array::from_fn(|_| self.number()),
            force_mn: array::from_fn(|_| self.number()),
            place_deviation_um: self.spread() as u16,
            shear_deviation_mn: self.spread() as u16,
            normal_deviation_mn: self.spread() as u16,
            is_touched: self.byte() & 1 == 0,
            has_shear: self.byte() & 1 == 0,
            status: Status(self.spread() as u16 & 0x0C00),
            ..ContactSample::untouched(self.spread() as u32, self.spread())
        }
    }

    fn identity(&mut self) -> Identity {
        let letters: String = (0..self.below(17)).map(|_| char::from(b'!' + self.byte() % 94)).collect();
        Identity {
            serial_number: SerialNumber::from_ascii(&letters).unwrap(),
            channels: self.byte(),
            count_bits: self.byte(),
            rate_hz: self.spread() as u16,
            picovolts_per_count: self.spread() as u32,
        }
    }

    pub(crate) fn message(&mut self) -> Message {
        let results = [AckResult::Done, AckResult::Refused, AckResult::Unknown];
        match self.below(6) {
            0 => Message::Identity(self.identity()),
            1 => Message::Acknowledgement { command: self.byte(), result: results[self.below(3)] },
            2 => Message::Channels(self.few_channels()),
            3 => Message::Contact(self.contact()),
            _ => Message::Sample(self.sample()),
        }
    }

    pub(crate) fn command(&mut self) -> Command {
        match self.below(4) {
            0 => Command::Identify,
            1 => Command::SetRate { rate_hz: self.spread() as u16 },
            2 => Command::SetOutput { output: self.spread() as u16 },
            _ => Command::Blink { duration_ms: self.spread() as u16 },
        }
    }
}
