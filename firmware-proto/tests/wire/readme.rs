//! The README's numbers are the crate's.

use firmware_proto::channels::ChannelSample;
use firmware_proto::command::{AckResult, Command};
use firmware_proto::contact::ContactSample;
use firmware_proto::frame::Message;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::{encode_command, encode_message};
use firmware_proto::sample::{Sample, Status};
use firmware_proto::{
    DEFAULT_BAUD, DEFAULT_COUNT_BITS, DEFAULT_PICOVOLTS_PER_COUNT, ENCODED_MAX, RATE_MAX_HZ, RATE_MIN_HZ, hid,
};

use crate::vectors::hex;

const README: &str = include_str!("../../README.md");

/// The bytes of each `text` block of the README, without the words that end its lines.
fn blocks() -> Vec<Vec<u8>> {
    let blocks = README.split("```text\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    blocks.map(|block| block.lines().flat_map(leading_bytes).collect()).collect()
}

fn leading_bytes(line: &str) -> Vec<u8> {
    let is_byte = |word: &&str| word.len() == 2 && word.bytes().all(|byte| byte.is_ascii_hexdigit());
    line.split_whitespace().take_while(is_byte).flat_map(hex).collect()
}

fn sample() -> Message {
    Message::Sample(Sample {
        sequence: 1000,
        time_us: 12_345_678,
        counts: [152, -1203, 20480, -77, 64, 18250, 256, -1, 16384],
        temperature_centi_c: 2315,
        status: Status::OK,
    })
}

fn message_frame(message: &Message) -> Vec<u8> {
    let mut frame = [0; ENCODED_MAX];
    let len = encode_message(message, &mut frame);
    frame[..len].to_vec()
}

fn command_frame(command: &Command) -> Vec<u8> {
    let mut frame = [0; ENCODED_MAX];
    let len = encode_command(command, &mut frame);
    frame[..len].to_vec()
}

/// Version, kind and payload, as a report carries them, and then the frame.
fn body_and_frame(report: [u8; hid::REPORT_LEN], frame: Vec<u8>) -> Vec<u8> {
    // A frame is two bytes longer than body and checksum.
    let body_len = frame.len() - 4 - 2;
    [&report[1..=body_len], &frame].concat()
}

#[test]
fn worked_examples_are_what_the_encoders_write() {
    let identify = Command::Identify;
    let set_rate = Command::SetRate { rate_hz: 1000 };
    let identity = Message::Identity(Identity {
        serial_number: SerialNumber::from_ascii("TP-0042").unwrap(),
        channels: 9,
        count_bits: 24,
        rate_hz: 1000,
        picovolts_per_count: 10_000,
    });
    let few = ChannelSample::new(1000, 12_345_678, &[1520, -35, 20480, 18250], Status::OK).unwrap();
    let contact = ContactSample {
        place_um: [12_500, -3_000],
        force_mn: [0, 0, 1_250],
        place_deviation_um: 400,
        normal_deviation_mn: 50,
        is_touched: true,
        ..ContactSample::untouched(1000, 12_345_678)
    };
    let (few, contact) = (Message::Channels(few), Message::Contact(contact));
    let done = Message::Acknowledgement { command: set_rate.kind(), result: AckResult::Done };
    let command = |command: &Command| body_and_frame(hid::encode_command(command), command_frame(command));
    let message = |message: &Message| body_and_frame(hid::encode_message(message), message_frame(message));
    let expected = [
        [&hid::encode_message(&sample())[1..55]].concat(),
        message_frame(&sample()),
        [&hid::encode_message(&few)[1..37]].concat(),
        message_frame(&few),
        [&hid::encode_message(&contact)[1..45]].concat(),
        message_frame(&contact),
        command(&identify),
        message(&identity),
        command(&set_rate),
        message(&done),
        hid::REPORT_DESCRIPTOR.to_vec(),
    ];
    assert_eq!(blocks(), expected);
}

#[test]
fn the_checksum_of_the_example_is_spelled_out() {
    let frame = message_frame(&sample());
    let checksum = u32::from_le_bytes(frame[frame.len() - 5..frame.len() - 1].try_into().unwrap());
    assert!(README.contains(&format!("Its checksum is 0x{checksum:08X}")));
}

#[test]
fn the_python_pad_sends_the_example() {
    let python = README.split("```python\n").nth(1).unwrap().split("```").next().unwrap();
    assert!(python.contains("counts = [152, -1203, 20480, -77, 64, 18250, 256, -1, 16384]"));
    assert!(python.contains("sample(1000, 12_345_678, counts, 2315)"));
}

#[test]
fn lengths_defaults_and_limits_are_spelled_out() {
    for row in [
        "| `01` | pad to host | sample | 52 | 60 |",
        "| `02` | pad to host | identity | 24 | 32 |",
        "| `04` | pad to host | sample of *n* channels, 1 to 8 | 18 + 4 *n* | 26 + 4 *n* |",
        "| `05` | pad to host | contact | 42 | 50 |",
        "2,000,000 baud",
        "100 to 8,000 samples per second",
        "10,000 pV (0.01 µV)",
        "24 bits and 10,000 pV per count",
        "1209:0001",
    ] {
        assert!(README.contains(row), "{row}");
    }
    assert_eq!((Sample::PAYLOAD_LEN, Identity::PAYLOAD_LEN, ENCODED_MAX), (52, 24, 60));
    assert_eq!((ChannelSample::payload_len(3), ContactSample::PAYLOAD_LEN), (30, 42));
    assert_eq!((DEFAULT_BAUD, RATE_MIN_HZ, RATE_MAX_HZ), (2_000_000, 100, 8_000));
    assert_eq!((DEFAULT_COUNT_BITS, DEFAULT_PICOVOLTS_PER_COUNT), (24, 10_000));
    assert_eq!((hid::VENDOR_ID, hid::PRODUCT_ID), (0x1209, 0x0001));
}
