//! The pad as its host sees it: samples in order, an identity, answers to commands.

use firmware_proto::CHANNELS;
use firmware_proto::command::{AckResult, Command, OUTPUT_CHANNELS, OUTPUT_CONTACTS};
use firmware_proto::contact::ContactSample;
use firmware_proto::frame::{Message, WireError};
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::sample::{Sample, Status};

use crate::contact::{Decoder, FORCE_DEVIATION_MN, PLACE_DEVIATION_UM};
use crate::excitation::{Excitation, PICOVOLTS_PER_COUNT};
use crate::frames::Codes;
use crate::rate::Rate;

/// Bits of a converter's code.
const COUNT_BITS: u8 = 24;

/// What the board measures of itself.
#[derive(Clone, Copy, Debug)]
pub struct Board {
    /// The bridges' supply.
    pub excitation: Excitation,
    /// In hundredths of a degree.
    pub temperature_centi_c: i16,
}

/// What the pad sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Output {
    /// What its channels read.
    Channels = OUTPUT_CHANNELS,
    /// What it makes of that itself.
    Contacts = OUTPUT_CONTACTS,
}

impl Output {
    /// The output that the wire's number means; `None` if it is none.
    #[must_use]
    pub const fn of(number: u16) -> Option<Self> {
        match number {
            OUTPUT_CHANNELS => Some(Self::Channels),
            OUTPUT_CONTACTS => Some(Self::Contacts),
            _ => None,
        }
    }
}

/// The pad.
#[derive(Clone, Debug)]
pub struct Pad {
    serial_number: SerialNumber,
    rate: Rate,
    output: Output,
    decoder: Decoder,
    sequence: u32,
    shown_until_us: u64,
}

impl Pad {
    /// A pad that has just started.
    #[must_use]
    pub fn new(serial_number: SerialNumber, rate: Rate, output: Output) -> Self {
        Self { serial_number, rate, output, decoder: Decoder::default(), sequence: 0, shown_until_us: 0 }
    }

    /// What it sends.
    #[must_use]
    pub const fn output(&self) -> Output {
        self.output
    }

    /// How fast it samples.
    #[must_use]
    pub const fn rate(&self) -> Rate {
        self.rate
    }

    /// Whether it was asked to show itself until later than this.
    #[must_use]
    pub const fn is_shown(&self, time_us: u64) -> bool {
        time_us < self.shown_until_us
    }

    /// Leaves out samples that were converted and not read, so that the host sees them missing.
    pub fn skip(&mut self, samples: u32) {
        self.sequence = self.sequence.wrapping_add(samples);
    }

    /// The next sample, as what the pad sends.
    pub fn message(&mut self, codes: &Codes, time_us: u64, board: &Board) -> Message {
        let sample = self.sample(codes, time_us, board);
        let rate_hz = self.rate.hz();
        match self.output {
            Output::Channels => Message::Sample(sample),
            Output::Contacts => Message::Contact(contact(&mut self.decoder, &sample, rate_hz)),
        }
    }

    fn sample(&mut self, codes: &Codes, time_us: u64, board: &Board) -> Sample {
        let mut status = codes.status;
        if board.excitation.is_out_of_tolerance() {
            status = status.with_supply_fault();
        }
        let sequence = self.sequence;
        self.sequence = self.sequence.wrapping_add(1);
        let counts = codes.codes.map(|code| board.excitation.at_nominal(code));
        Sample { sequence, time_us, counts, temperature_centi_c: board.temperature_centi_c, status }
    }

    /// The answer to a command; `None` to what is none. Another rate holds from here on.
    pub fn answer(&mut self, command: Result<Command, WireError>, time_us: u64) -> Option<Message> {
        let (command, result) = match command {
            Ok(Command::Identify) => return Some(Message::Identity(self.identity())),
            Ok(Command::SetRate { rate_hz }) => match Rate::near(rate_hz) {
                Some(rate) => {
                    self.rate = rate;
                    (Command::SetRate { rate_hz }.kind(), AckResult::Done)
                }
                None => (Command::SetRate { rate_hz }.kind(), AckResult::Refused),
            },
            Ok(Command::Blink { duration_ms }) => {
                self.shown_until_us = time_us + u64::from(duration_ms) * 1_000;
                (Command::Blink { duration_ms }.kind(), AckResult::Done)
            }
            Ok(Command::SetOutput { output }) => match Output::of(output) {
                Some(output) => {
                    // What is sent already goes on, with its zero.
                    if output != self.output {
                        (self.output, self.decoder) = (output, Decoder::default());
                    }
                    (Command::SetOutput { output: 0 }.kind(), AckResult::Done)
                }
                None => (Command::SetOutput { output }.kind(), AckResult::Refused),
            },
            Err(WireError::UnknownKind(kind)) => (kind, AckResult::Unknown),
            Err(_) => return None,
        };
        Some(Message::Acknowledgement { command, result })
    }

    fn identity(&self) -> Identity {
        Identity {
            serial_number: self.serial_number,
            channels: if self.output == Output::Channels { CHANNELS as u8 } else { 0 },
            count_bits: COUNT_BITS,
            rate_hz: self.rate.hz(),
            picovolts_per_count: PICOVOLTS_PER_COUNT,
        }
    }
}

/// What the decoder makes of a sample. One of which something is wrong says that it cannot be trusted, whatever it is.
fn contact(decoder: &mut Decoder, sample: &Sample, rate_hz: u16) -> ContactSample {
    let is_sound = sample.status == Status::OK;
    let touch = decoder.decode(is_sound.then_some(&sample.counts), rate_hz);
    let nothing = ContactSample {
        status: if is_sound { Status::OK } else { Status::OK.with_supply_fault() },
        ..ContactSample::untouched(sample.sequence, sample.time_us)
    };
    touch.map_or(nothing, |touch| ContactSample {
        place_um: touch.place_um,
        force_mn: touch.force_mn,
        place_deviation_um: PLACE_DEVIATION_UM,
        shear_deviation_mn: FORCE_DEVIATION_MN,
        normal_deviation_mn: FORCE_DEVIATION_MN,
        is_touched: true,
        has_shear: true,
        ..nothing
    })
}

/// The flash chip's unique number in sixteen digits of base 16: the pad's serial number.
#[must_use]
pub fn digits(unique: [u8; 8]) -> [u8; SerialNumber::LEN] {
    const DIGITS: &[u8; 16] = b"0123456789ABCDEF";
    let mut text = [0; SerialNumber::LEN];
    for (pair, byte) in text.chunks_exact_mut(2).zip(unique) {
        pair[0] = DIGITS[usize::from(byte >> 4)];
        pair[1] = DIGITS[usize::from(byte & 0xF)];
    }
    text
}

#[cfg(test)]
mod tests {
    use firmware_proto::sample::Status;

    use super::*;

    const BOARD: Board = Board { excitation: Excitation::new(2_500_000), temperature_centi_c: 2_150 };

    fn pad() -> Pad {
        let digits = digits([0xE6, 0x60, 0x58, 0x38, 0x83, 0x0A, 0xBC, 0x01]);
        let serial_number = SerialNumber::from_ascii(core::str::from_utf8(&digits).unwrap()).unwrap();
        Pad::new(serial_number, Rate::near(1_000).unwrap(), Output::Channels)
    }

    fn sample(pad: &mut Pad, status: Status, board: &Board) -> Sample {
        pad.sample(&Codes { codes: [7; CHANNELS], status, restart: false }, 5, board)
    }

    #[test]
    fn samples_are_numbered_and_those_that_were_not_read_leave_gaps() {
        let mut pad = pad();
        for sequence in 0..3 {
            let next = sample(&mut pad, Status::OK, &BOARD);
            assert_eq!((next.sequence, next.status, next.counts[8]), (sequence, Status::OK, 7));
        }
        pad.skip(4);
        assert_eq!(sample(&mut pad, Status::OK, &BOARD).sequence, 7);
        pad.sequence = u32::MAX;
        sample(&mut pad, Status::OK, &BOARD);
        assert_eq!(sample(&mut pad, Status::OK, &BOARD).sequence, 0);
    }

    #[test]
    fn a_wrong_supply_is_told_beside_what_else_is_wrong() {
        let mut pad = pad();
        let low = Board { excitation: Excitation::new(2_000_000), ..BOARD };
        let told = sample(&mut pad, Status::OK.with_out_of_range(4), &low);
        assert_eq!(told.status, Status::OK.with_out_of_range(4).with_supply_fault());
    }

    #[test]
    fn it_sends_contacts_when_it_is_asked_to_and_says_which_cannot_be_trusted() {
        let mut pad = pad();
        let ask = |pad: &mut Pad, output| pad.answer(Ok(Command::SetOutput { output }), 0);
        let ack = |result| Some(Message::Acknowledgement { command: 0x84, result });
        assert_eq!([ask(&mut pad, 2), ask(&mut pad, 1)], [ack(AckResult::Refused), ack(AckResult::Done)]);
        let Some(Message::Identity(identity)) = pad.answer(Ok(Command::Identify), 0) else {
            panic!("an identity")
        };
        assert_eq!(identity.channels, 0);
        let message = |pad: &mut Pad, status| {
            let codes = Codes { codes: [7; CHANNELS], status, restart: false };
            pad.message(&codes, 5, &BOARD)
        };
        let untouched = ContactSample::untouched(0, 5);
        assert_eq!(message(&mut pad, Status::OK), Message::Contact(untouched));
        let faulty = ContactSample { sequence: 1, status: Status::OK.with_supply_fault(), ..untouched };
        assert_eq!(message(&mut pad, Status::OK.with_out_of_range(8)), Message::Contact(faulty));
        assert_eq!(ask(&mut pad, 0), ack(AckResult::Done));
        assert!(matches!(message(&mut pad, Status::OK), Message::Sample(Sample { sequence: 2, .. })));
    }

    #[test]
    fn commands_are_answered() {
        let mut pad = pad();
        let ack = |command, result| Some(Message::Acknowledgement { command, result });
        assert_eq!(pad.answer(Ok(Command::SetRate { rate_hz: 4_001 }), 0), ack(0x82, AckResult::Refused));
        assert_eq!(pad.answer(Ok(Command::SetRate { rate_hz: 99 }), 0), ack(0x82, AckResult::Refused));
        assert_eq!(pad.answer(Ok(Command::SetRate { rate_hz: 250 }), 0), ack(0x82, AckResult::Done));
        assert_eq!(pad.answer(Ok(Command::Blink { duration_ms: 500 }), 1_000), ack(0x83, AckResult::Done));
        assert!(pad.is_shown(500_999) && !pad.is_shown(501_000));
        assert_eq!(pad.answer(Ok(Command::Blink { duration_ms: 0 }), 2_000), ack(0x83, AckResult::Done));
        assert!(!pad.is_shown(2_000));
        assert_eq!(pad.answer(Err(WireError::UnknownKind(0x9C)), 0), ack(0x9C, AckResult::Unknown));
        for silent in [WireError::Damaged, WireError::TooLong, WireError::NewerVersion(2)] {
            assert_eq!(pad.answer(Err(silent), 0), None);
        }
        let Some(Message::Identity(identity)) = pad.answer(Ok(Command::Identify), 0) else {
            panic!("an identity")
        };
        assert_eq!(identity.serial_number.as_str(), "E6605838830ABC01");
        assert_eq!((identity.channels, identity.count_bits, identity.rate_hz), (9, 24, 250));
    }
}
