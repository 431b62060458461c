//! A host of the crate's own asks, and the firmware answers.

use std::collections::VecDeque;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::OpenOptionsExt;

use firmware_proto::command::{AckResult, Command};
use firmware_proto::frame::Message;
use firmware_proto::link::{MessageReceiver, encode_command, encode_message};
use firmware_proto::sample::Sample;
use firmware_proto::{CHANNELS, ENCODED_MAX};
use rustix::fs::OFlags;

use super::host_pad::{HostPad, in_guest_with_firmware, is_readable};

/// The host's end of the line.
struct Host {
    line: File,
    receiver: MessageReceiver,
    heard: VecDeque<Message>,
}

impl Host {
    fn open(path: &str) -> Self {
        let flags = i32::try_from(OFlags::NOCTTY.bits()).unwrap();
        let line = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path).unwrap();
        Self { line, receiver: MessageReceiver::new(), heard: VecDeque::new() }
    }

    /// The next message. Nothing on this line is ever damaged.
    fn message(&mut self) -> Message {
        while self.heard.is_empty() {
            let mut bytes = [0; 4096];
            assert!(is_readable(self.line.as_fd()), "the firmware is silent");
            let count = self.line.read(&mut bytes).unwrap();
            let receiver = &mut self.receiver;
            let messages = bytes[..count].iter().filter_map(|byte| receiver.push(*byte)).map(Result::unwrap);
            self.heard.extend(messages);
        }
        self.heard.pop_front().unwrap()
    }

    fn sample(&mut self) -> Sample {
        match self.message() {
            Message::Sample(sample) => sample,
            other => panic!("nobody asked for {other:?}"),
        }
    }

    /// The next message that is no sample.
    fn reply(&mut self) -> Message {
        loop {
            match self.message() {
                Message::Sample(_) => {}
                reply => return reply,
            }
        }
    }

    fn ask(&mut self, command: &Command) -> Message {
        let mut frame = [0; ENCODED_MAX];
        let length = encode_command(command, &mut frame);
        self.line.write_all(&frame[..length]).unwrap();
        self.reply()
    }

    /// Device time that the next `count` periods take, in microseconds.
    fn periods_us(&mut self, count: u32) -> u64 {
        let first = self.sample();
        let last = (1..=count).map(|_| self.sample()).last().unwrap();
        assert_eq!(last.sequence - first.sequence, count, "none is lost");
        last.time_us - first.time_us
    }
}

fn acknowledged(command: &Command, result: AckResult) -> Message {
    Message::Acknowledgement { command: command.kind(), result }
}

#[test]
fn the_first_sample_tells_of_the_start_and_no_other_does() {
    in_guest_with_firmware(
        "firmware::conversation::the_first_sample_tells_of_the_start_and_no_other_does",
        first_sample,
    );
}

fn first_sample() {
    let Some(pad) = HostPad::start(1_000) else { return };
    let mut host = Host::open(&pad.path);
    for sequence in 0..500 {
        let sample = host.sample();
        assert_eq!((sample.sequence, sample.status.restarted()), (sequence, sequence == 0));
    }
}

#[test]
fn every_command_is_answered() {
    in_guest_with_firmware("firmware::conversation::every_command_is_answered", commands);
}

fn commands() {
    let Some(mut pad) = HostPad::start(1_000) else { return };
    let mut host = Host::open(&pad.path);
    let Message::Identity(identity) = host.ask(&Command::Identify) else { panic!("no identity") };
    assert_eq!(identity.serial_number.as_str(), "HOST-0001");
    assert_eq!((identity.channels, identity.count_bits), (CHANNELS as u8, 24));
    assert_eq!((identity.rate_hz, identity.picovolts_per_count), (1000, 10_000));

    for (duration_ms, lines) in [(50, &["light off", "light on", "light off"][..]), (60_000, &["light on"])] {
        let blink = Command::Blink { duration_ms };
        assert_eq!(host.ask(&blink), acknowledged(&blink, AckResult::Done));
        assert!(lines.iter().all(|line| pad.line() == *line));
    }
    let dark = Command::Blink { duration_ms: 0 };
    assert_eq!(host.ask(&dark), acknowledged(&dark, AckResult::Done));
    assert_eq!(pad.line(), "light off");
}

#[test]
fn a_rate_is_set_or_refused() {
    in_guest_with_firmware("firmware::conversation::a_rate_is_set_or_refused", rates);
}

fn rates() {
    let Some(pad) = HostPad::start(1_000) else { return };
    let mut host = Host::open(&pad.path);
    for rate_hz in [99, 8001, 0, u16::MAX] {
        let set = Command::SetRate { rate_hz };
        assert_eq!(host.ask(&set), acknowledged(&set, AckResult::Refused), "{rate_hz}");
    }
    for (rate_hz, periods) in [(8000, 4000), (100, 20), (1000, 500)] {
        let set = Command::SetRate { rate_hz };
        assert_eq!(host.ask(&set), acknowledged(&set, AckResult::Done));
        let Message::Identity(identity) = host.ask(&Command::Identify) else { panic!("no identity") };
        assert_eq!(identity.rate_hz, rate_hz);
        let expected_us = u64::from(periods) * 1_000_000 / u64::from(rate_hz);
        let took_us = host.periods_us(periods);
        assert!(took_us.abs_diff(expected_us) <= expected_us / 100, "{took_us} at {rate_hz} Hz");
    }
    assert_eq!(pad.end().bytes_not_taken, 0);
}

#[test]
fn damage_is_passed_over_and_a_stranger_is_answered() {
    in_guest_with_firmware(
        "firmware::conversation::damage_is_passed_over_and_a_stranger_is_answered",
        damage,
    );
}

fn damage() {
    let Some(pad) = HostPad::start(1_000) else { return };
    let mut host = Host::open(&pad.path);
    let mut frame = [0; ENCODED_MAX];
    let length = encode_command(&Command::SetRate { rate_hz: 100 }, &mut frame);
    frame[2] ^= 1;
    host.line.write_all(&frame[..length]).unwrap();
    host.line.write_all(&[0xFE; 600]).unwrap();
    // The zero ends the noise.
    host.line.write_all(&[0]).unwrap();
    let stranger = Message::Acknowledgement { command: 0x81, result: AckResult::Done };
    let length = encode_message(&stranger, &mut frame);
    host.line.write_all(&frame[..length]).unwrap();
    let unknown = Message::Acknowledgement { command: 0x03, result: AckResult::Unknown };
    assert_eq!(host.reply(), unknown);
    assert!(matches!(host.ask(&Command::Identify), Message::Identity(identity) if identity.rate_hz == 1000));
}
