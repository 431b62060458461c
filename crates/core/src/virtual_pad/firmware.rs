//! The emulated firmware: samples at its rate, answers to commands, frames on the wire.

use arrayvec::ArrayVec;
use firmware_proto::command::{AckResult, Command, OUTPUT_CHANNELS};
use firmware_proto::frame::{Message, WireError};
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::{CommandReceiver, encode_message};
use firmware_proto::sample::Sample;
use firmware_proto::{ENCODED_MAX, RATE_MAX_HZ, RATE_MIN_HZ};

use crate::pad::device::Device;
use crate::pad::device::behaviour::Behaviour;
use crate::pad::field::PadField;
use crate::pad::twin::hand::Hand;
use crate::pad::twin::life::Life;
use crate::pad::twin::pad::{Circumstances, TwinPad};
use crate::quantity::{CHANNELS, Contact};
use crate::virtual_pad::front_end::{self, CONVERTER};
use crate::virtual_pad::script::Script;

/// The serial number that the virtual pad tells.
pub const SERIAL_NUMBER: &str = "VIRTUAL-0001";

/// Samples per second until the host asks for another rate.
pub const RATE_DEFAULT_HZ: u16 = 1000;

/// One call of [`VirtualPad::emit`] sends no more samples than this: a second's worth at the highest rate.
pub const SAMPLES_PER_EMIT_MAX: usize = RATE_MAX_HZ as usize;

const REPLIES_MAX: usize = 16;

/// A pad in memory. Pad time starts at 0 with the script.
///
/// Bytes from the host go in by [`receive`](Self::receive); [`emit`](Self::emit) gives the bytes for the
/// host. Its board stays at the temperature at which its zeros are known.
#[derive(Clone, Debug)]
pub struct VirtualPad {
    script: Script,
    /// Pad time at which the script begins.
    begin_us: u64,
    hand: Hand,
    pad: TwinPad,
    around: Circumstances,
    /// What touched it at the last sample.
    contact: Contact,
    /// Pad time of the last sample.
    read_us: u64,
    identity: Identity,
    schedule: Schedule,
    sequence: u32,
    restarted: bool,
    commands: CommandReceiver,
    replies: ArrayVec<Message, REPLIES_MAX>,
}

/// Sample times without rounding drift: `start_us` plus whole sample periods.
#[derive(Clone, Copy, Debug)]
struct Schedule {
    start_us: u64,
    taken: u64,
    rate_hz: u16,
}

impl Schedule {
    fn due_us(self) -> u64 {
        let since_us = self.taken.saturating_mul(1_000_000) / u64::from(self.rate_hz).max(1);
        self.start_us.saturating_add(since_us)
    }
}

impl VirtualPad {
    /// The nominal pad, on which `script` is played. `seed` decides the channels' offsets and noise.
    pub fn new(script: Script, seed: u64) -> Self {
        Self::of(script, &front_end::ordinary(seed), &PadField::nominal(), seed)
    }

    /// The pad of `device`, whose field is `field`, on which `script` is played. `seed` decides what is random.
    pub fn of(script: Script, device: &Device, field: &PadField, seed: u64) -> Self {
        Self::going_on(script, device, field, Life::new(device, seed), seed)
    }

    /// The same of a pad that has a life behind it; `seed` decides the hand. Its board keeps the temperature that it has.
    #[expect(clippy::expect_used, reason = "the serial number is a constant and a test reads it")]
    pub fn going_on(script: Script, device: &Device, field: &PadField, life: Life, seed: u64) -> Self {
        Self {
            script,
            begin_us: 0,
            hand: Hand::new(device.behaviour.finger, seed),
            pad: TwinPad::going_on(device, field, life.state),
            around: life.around,
            contact: Contact::default(),
            read_us: 0,
            identity: Identity {
                serial_number: SerialNumber::from_ascii(SERIAL_NUMBER)
                    .expect("it is short and visible ASCII"),
                channels: CHANNELS as u8,
                count_bits: CONVERTER.count_bits,
                rate_hz: RATE_DEFAULT_HZ,
                picovolts_per_count: CONVERTER.picovolts_per_count,
            },
            schedule: Schedule { start_us: 0, taken: 0, rate_hz: RATE_DEFAULT_HZ },
            sequence: 0,
            restarted: true,
            commands: CommandReceiver::new(),
            replies: ArrayVec::new(),
        }
    }

    /// Plays `script` in place of what was played, from the next sample on, and says when that is, in pad time.
    pub fn play(&mut self, script: Script) -> u64 {
        self.script = script;
        self.begin_us = self.due_us();
        self.begin_us
    }

    /// The same with something that stays where it is put, as no finger does.
    pub fn lay(&mut self, script: Script) -> u64 {
        self.hand = Hand::new(Behaviour::IDEAL.finger, 0);
        self.play(script)
    }

    /// What touched it at the last sample: the true contact.
    pub const fn contact(&self) -> &Contact {
        &self.contact
    }

    /// The pad's life up to here. Each touch was a cycle of load.
    pub fn into_life(self) -> Life {
        Life { state: self.pad.into_state(), around: self.around }
    }

    /// Tells who it is with the next bytes, as if somebody had asked.
    pub fn introduce(&mut self) {
        // A full queue means that nobody listens.
        let _ = self.replies.try_push(Message::Identity(self.identity));
    }

    /// Takes bytes from the host, whole commands or parts of them. Damaged commands get no answer; of more
    /// than 16 commands between two calls of [`emit`](Self::emit) the later ones are done but not answered.
    pub fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let reply = match self.commands.push(byte) {
                Some(Ok(command)) => self.obey(command),
                Some(Err(WireError::UnknownKind(kind))) => {
                    Message::Acknowledgement { command: kind, result: AckResult::Unknown }
                }
                Some(Err(_)) | None => continue,
            };
            // A full queue means that nobody listens.
            let _ = self.replies.try_push(reply);
        }
    }

    /// Pad time of the next sample, in microseconds.
    pub fn due_us(&self) -> u64 {
        self.schedule.due_us()
    }

    /// Appends to `out` the answers that wait, then every sample due at `now_us` of pad time or before, as
    /// frames.
    ///
    /// After [`SAMPLES_PER_EMIT_MAX`] samples it stops; [`due_us`](Self::due_us) then still lies in the past.
    pub fn emit(&mut self, now_us: u64, out: &mut Vec<u8>) {
        for reply in std::mem::take(&mut self.replies) {
            append(&reply, out);
        }
        for _ in 0..SAMPLES_PER_EMIT_MAX {
            if self.due_us() > now_us {
                break;
            }
            append(&Message::Sample(self.take_sample()), out);
        }
    }

    fn obey(&mut self, command: Command) -> Message {
        let result = match command {
            Command::Identify => return Message::Identity(self.identity),
            Command::SetRate { rate_hz } => self.set_rate(rate_hz),
            // There is no light to see; the command counts as done.
            Command::Blink { .. } => AckResult::Done,
            Command::SetOutput { output: OUTPUT_CHANNELS } => AckResult::Done,
            // It does not decode on its own.
            Command::SetOutput { .. } => AckResult::Refused,
        };
        Message::Acknowledgement { command: command.kind(), result }
    }

    /// The next sample stays where it is; from there on the new period counts.
    fn set_rate(&mut self, rate_hz: u16) -> AckResult {
        if !(RATE_MIN_HZ..=RATE_MAX_HZ).contains(&rate_hz) {
            return AckResult::Refused;
        }
        self.identity.rate_hz = rate_hz;
        self.schedule = Schedule { start_us: self.due_us(), taken: 0, rate_hz };
        AckResult::Done
    }

    fn take_sample(&mut self) -> Sample {
        let time_us = self.due_us();
        let after_s = time_us.saturating_sub(self.read_us) as f64 * 1e-6;
        self.read_us = time_us;
        let contact = self.hand.hold(after_s, &self.script.contact_at(time_us.saturating_sub(self.begin_us)));
        let is_new = contact.fz_n > 0.0 && self.contact.fz_n <= 0.0;
        self.around.cycles += f64::from(u8::from(is_new));
        self.contact = contact;
        let (counts, mut status) = front_end::convert(&self.pad.read(after_s, &contact, &self.around));
        if std::mem::take(&mut self.restarted) {
            status = status.with_restarted();
        }
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        self.schedule.taken = self.schedule.taken.saturating_add(1);
        let temperature_centi_c = (100.0 * self.around.temperature_c).round() as i16;
        Sample { sequence, time_us, counts, temperature_centi_c, status }
    }
}

fn append(message: &Message, out: &mut Vec<u8>) {
    let mut frame = [0; ENCODED_MAX];
    let length = encode_message(message, &mut frame);
    out.extend(frame.iter().take(length));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Contact;
    use crate::virtual_pad::fixture::{messages, shipped_profiles};
    use crate::virtual_pad::script::Keyframe;
    use firmware_proto::link::encode_command;

    fn pad() -> VirtualPad {
        VirtualPad::new(Script::for_profile(&shipped_profiles()[0], 10_000_000), 1)
    }

    fn emitted(pad: &mut VirtualPad, now_us: u64) -> Vec<Message> {
        let mut bytes = Vec::new();
        pad.emit(now_us, &mut bytes);
        messages(&bytes)
    }

    fn samples(messages: &[Message]) -> Vec<Sample> {
        let sample =
            |message: &Message| if let Message::Sample(sample) = message { Some(*sample) } else { None };
        messages.iter().filter_map(sample).collect()
    }

    fn command(command: &Command) -> Vec<u8> {
        let mut frame = [0; ENCODED_MAX];
        let length = encode_command(command, &mut frame);
        frame[..length].to_vec()
    }

    #[test]
    fn another_script_begins_with_the_next_sample() {
        let press = Contact { fz_n: 3.0, ..Contact::default() };
        let pressing = Script::of(vec![
            Keyframe { at_us: 0, contact: Contact::default() },
            Keyframe { at_us: 50_000, contact: press },
        ]);
        let mut pad = VirtualPad::new(Script::of(Vec::new()), 1);
        let before = samples(&emitted(&mut pad, 100_000));
        assert_eq!(pad.play(pressing), 101_000);
        let after = samples(&emitted(&mut pad, 200_000));
        let span = |samples: &[Sample]| {
            let read = || samples.iter().map(|sample| sample.counts[2]);
            read().max().unwrap() - read().min().unwrap()
        };
        assert!(span(&after) > 20 * span(&before), "{} {}", span(&after), span(&before));
        assert_eq!(after[0].time_us, 101_000);
    }

    #[test]
    fn samples_come_at_the_default_rate_without_gaps() {
        let mut pad = pad();
        assert_eq!(pad.due_us(), 0);
        let mut all = Vec::new();
        for now_us in [0, 999, 1000, 1001, 7777, 500_000] {
            all.extend(samples(&emitted(&mut pad, now_us)));
            assert!(pad.due_us() > now_us && pad.due_us() <= now_us + 1000);
        }
        assert_eq!(all.len(), 501);
        for (index, sample) in all.iter().enumerate() {
            assert_eq!((sample.sequence, sample.time_us), (index as u32, 1000 * index as u64));
            assert_eq!(sample.status.restarted(), index == 0);
            assert_eq!(sample.temperature_centi_c, 2500);
        }
    }

    #[test]
    fn it_tells_who_it_is() {
        let mut pad = pad();
        for byte in command(&Command::Identify) {
            pad.receive(&[byte]);
        }
        let said = emitted(&mut pad, 0);
        let Message::Identity(identity) = said[0] else { panic!("{said:?}") };
        assert_eq!(identity.serial_number.as_str(), "VIRTUAL-0001");
        assert_eq!((identity.channels, identity.count_bits, identity.rate_hz), (9, 24, 1000));
        assert_eq!(identity.picovolts_per_count, 2384);
        assert!(matches!(said[1], Message::Sample(_)) && said.len() == 2);
    }

    fn answer(pad: &mut VirtualPad, bytes: &[u8]) -> Message {
        pad.receive(bytes);
        let before_us = pad.due_us().saturating_sub(1);
        let said = emitted(pad, before_us);
        assert_eq!(said.len(), 1, "{said:?}");
        said[0]
    }

    #[test]
    fn every_command_is_answered() {
        let mut pad = pad();
        emitted(&mut pad, 5000);
        let ack = |command, result| Message::Acknowledgement { command, result };
        let blink = command(&Command::Blink { duration_ms: 300 });
        assert_eq!(answer(&mut pad, &blink), ack(0x83, AckResult::Done));
        for (rate_hz, result) in [
            (99, AckResult::Refused),
            (100, AckResult::Done),
            (8000, AckResult::Done),
            (8001, AckResult::Refused),
            (0, AckResult::Refused),
        ] {
            let rate = command(&Command::SetRate { rate_hz });
            assert_eq!(answer(&mut pad, &rate), ack(0x82, result), "{rate_hz}");
        }
        let Message::Identity(identity) = answer(&mut pad, &command(&Command::Identify)) else { panic!() };
        assert_eq!(identity.rate_hz, 8000, "the last rate that was accepted");
    }

    #[test]
    fn an_unknown_command_is_answered_and_a_damaged_one_is_not() {
        let mut pad = pad();
        emitted(&mut pad, 0);
        // A message is a good frame of a kind that no command has.
        let mut frame = [0; ENCODED_MAX];
        let message = Message::Acknowledgement { command: 0x81, result: AckResult::Done };
        let length = encode_message(&message, &mut frame);
        let unknown = Message::Acknowledgement { command: 0x03, result: AckResult::Unknown };
        assert_eq!(answer(&mut pad, &frame[..length]), unknown);

        let mut damaged = command(&Command::Identify);
        damaged[2] ^= 0x10;
        pad.receive(&damaged);
        pad.receive(&[7; 500]);
        pad.receive(&[0]);
        assert_eq!(emitted(&mut pad, 0), []);
    }

    #[test]
    fn answers_to_a_flood_are_bounded() {
        let mut pad = pad();
        emitted(&mut pad, 0);
        for _ in 0..1000 {
            pad.receive(&command(&Command::Identify));
        }
        assert_eq!(emitted(&mut pad, 0).len(), 16);
    }

    #[test]
    fn a_new_rate_changes_the_period_and_nothing_else() {
        for (rate_hz, first_us, second_us) in [(100, 10_000, 20_000), (300, 3333, 6666), (8000, 125, 250)] {
            let mut pad = pad();
            emitted(&mut pad, 4000);
            pad.receive(&command(&Command::SetRate { rate_hz }));
            let after = samples(&emitted(&mut pad, 1_004_999));
            assert_eq!((after[0].sequence, after[0].time_us), (5, 5000));
            assert_eq!((after[1].time_us - 5000, after[2].time_us - 5000), (first_us, second_us));
            assert_eq!(after.len(), usize::from(rate_hz), "one second");
            let steps = after.windows(2).map(|pair| pair[1].sequence - pair[0].sequence);
            assert!(steps.into_iter().all(|step| step == 1));
        }
    }

    #[test]
    fn a_jump_of_the_clock_is_sent_in_bounded_parts() {
        let mut pad = pad();
        let first = samples(&emitted(&mut pad, u64::MAX));
        assert_eq!(first.len(), SAMPLES_PER_EMIT_MAX);
        assert_eq!(pad.due_us(), 8_000_000);
        let second = samples(&emitted(&mut pad, u64::MAX));
        assert_eq!(second[0].sequence, 8000);
    }

    #[test]
    fn the_script_reaches_the_channels_and_rest_is_rest() {
        let mut pad = pad();
        let all = [4_999_000, 9_999_000].map(|now_us| samples(&emitted(&mut pad, now_us))).concat();
        let range = |from: usize, until: usize, channel: usize| {
            let values = || all[from..until].iter().map(|sample| sample.counts[channel]);
            (values().max().unwrap() - values().min().unwrap()) as f32 * 2384e-6
        };
        for channel in 0..CHANNELS {
            // Twelve standard deviations of 6 µV hold all of the noise.
            assert!(range(0, 600, channel) < 72.0, "rest before the first contact");
            assert!(range(9_750, all.len(), channel) < 72.0, "rest after the last contact");
        }
        assert!(range(0, all.len(), 2) > 500.0, "the player presses on module 0");
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes() {
        let script = Script::for_profile(&shipped_profiles()[3], 10_000_000);
        let bytes = |seed| {
            let mut bytes = Vec::new();
            VirtualPad::new(script.clone(), seed).emit(2_000_000, &mut bytes);
            bytes
        };
        assert_eq!(bytes(9), bytes(9));
        assert_ne!(bytes(9), bytes(10));
    }
}
