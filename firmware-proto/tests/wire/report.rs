//! HID reports and their descriptor.

use std::collections::BTreeMap;

use firmware_proto::command::Command;
use firmware_proto::frame::{Message, WireError};
use firmware_proto::link::MessageReceiver;
use firmware_proto::{ENCODED_MAX, hid};

use crate::random::Random;

/// What a HID host learns from a report descriptor.
#[derive(Default, Debug, PartialEq)]
struct Layout {
    usage_page: u32,
    /// Bits of the input report of each id.
    input_bits: BTreeMap<u32, u32>,
    /// Bits of the output report of each id.
    output_bits: BTreeMap<u32, u32>,
    /// Collections opened and not closed.
    depth: i32,
}

/// Reads a descriptor of short items. Source: USB HID 1.11, section 6.2.2.
fn layout(mut descriptor: &[u8]) -> Layout {
    let mut layout = Layout::default();
    let (mut size, mut count, mut id) = (0, 0, 0);
    while let Some((prefix, rest)) = descriptor.split_first() {
        let len = [0, 1, 2, 4][usize::from(prefix & 3)];
        let (bytes, rest) = rest.split_at(len);
        let value = bytes.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte));
        match prefix & 0xFC {
            0x04 => layout.usage_page = value,
            0x74 => size = value,
            0x84 => id = value,
            0x94 => count = value,
            0x80 => *layout.input_bits.entry(id).or_default() += size * count,
            0x90 => *layout.output_bits.entry(id).or_default() += size * count,
            0xA0 => layout.depth += 1,
            0xC0 => layout.depth -= 1,
            // Logical minimum and maximum, usage.
            0x14 | 0x24 | 0x08 => {}
            other => panic!("item {other:#04x}"),
        }
        descriptor = rest;
    }
    layout
}

#[test]
fn the_descriptor_declares_63_bytes_each_way() {
    let payload_bits = 8 * (hid::REPORT_LEN as u32 - 1);
    assert_eq!(payload_bits, 8 * 63);
    let expected = Layout {
        usage_page: 0xFF00,
        input_bits: [(u32::from(hid::MESSAGE_REPORT_ID), payload_bits)].into(),
        output_bits: [(u32::from(hid::COMMAND_REPORT_ID), payload_bits)].into(),
        depth: 0,
    };
    assert_eq!(layout(hid::REPORT_DESCRIPTOR), expected);
}

#[test]
fn random_messages_and_commands_survive() {
    let mut random = Random(10);
    for _ in 0..20_000 {
        let message = random.message();
        assert_eq!(hid::decode_message(&hid::encode_message(&message)), Ok(message));
        let command = random.command();
        assert_eq!(hid::decode_command(&hid::encode_command(&command)), Ok(command));
    }
}

#[test]
fn a_report_has_one_length() {
    let mut report = hid::encode_message(&Random(11).message()).to_vec();
    report.push(0);
    for len in (0..=report.len()).filter(|len| *len != hid::REPORT_LEN) {
        assert_eq!(hid::decode_message(&report[..len]), Err(WireError::Damaged), "{len} bytes");
    }
}

#[test]
fn a_report_of_the_other_direction_is_refused() {
    let message = hid::encode_message(&Random(12).message());
    let command = hid::encode_command(&Command::Identify);
    assert_eq!(hid::decode_message(&command), Err(WireError::Damaged));
    assert_eq!(hid::decode_command(&message), Err(WireError::Damaged));
    let mut mislabelled = command;
    mislabelled[0] = hid::MESSAGE_REPORT_ID;
    assert_eq!(hid::decode_message(&mislabelled), Err(WireError::UnknownKind(0x81)));
}

#[test]
fn strangers_are_told_from_damage() {
    let mut report = [0; hid::REPORT_LEN];
    report[0] = hid::MESSAGE_REPORT_ID;
    assert_eq!(hid::decode_message(&report), Err(WireError::Damaged), "a report of zeros");
    report[1] = 2;
    assert_eq!(hid::decode_message(&report), Err(WireError::NewerVersion(2)));
    report[1] = 1;
    report[2] = 0x55;
    assert_eq!(hid::decode_message(&report), Err(WireError::UnknownKind(0x55)));
}

#[test]
fn padding_is_not_looked_at() {
    let mut report = hid::encode_command(&Command::Blink { duration_ms: 500 });
    report[5..].fill(0xEE);
    assert_eq!(hid::decode_command(&report), Ok(Command::Blink { duration_ms: 500 }));
}

#[test]
fn no_report_makes_a_decoder_panic() {
    let mut random = Random(13);
    let mut readable = 0;
    for _ in 0..200_000 {
        let mut report = random.bytes(hid::REPORT_LEN);
        // Most bytes are noise, but the first few often say something.
        for byte in &mut report[..3] {
            *byte %= 5;
        }
        report[2] |= random.byte() & 0x80;
        readable += usize::from(hid::decode_message(&report).is_ok());
        readable += usize::from(hid::decode_command(&report).is_ok());
    }
    assert!(readable > 1_000, "the noise reached the payloads: {readable}");
}

/// What the host's receiver says of a report that was turned into a serial frame.
fn through_the_line(report: &[u8]) -> Vec<Result<Message, WireError>> {
    let mut frame = [0; ENCODED_MAX];
    let length = hid::to_serial_frame(report, &mut frame);
    let mut receiver = MessageReceiver::new();
    frame[..length].iter().filter_map(|&byte| receiver.push(byte)).collect()
}

#[test]
fn a_report_as_a_serial_frame_means_the_same() {
    let mut random = Random(7);
    for _ in 0..1_000 {
        let message = random.message();
        assert_eq!(through_the_line(&hid::encode_message(&message)), [Ok(message)]);
    }
    let report = |start: &[u8]| {
        let mut report = [0; hid::REPORT_LEN];
        report[..start.len()].copy_from_slice(start);
        report
    };
    for (start, error) in [
        (&[1, 1, 0x7E][..], WireError::UnknownKind(0x7E)),
        (&[1, 9, 1], WireError::NewerVersion(9)),
        (&[2, 1, 1], WireError::Damaged),
        (&[0, 0, 0], WireError::Damaged),
    ] {
        assert_eq!(through_the_line(&report(start)), [Err(error)]);
    }
    assert_eq!(through_the_line(&[1, 1, 1]), [Err(WireError::Damaged)]);
}
