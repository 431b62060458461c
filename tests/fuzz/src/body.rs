//! Any bytes as a frame that is sound on the line: no mutation of bytes would guess a checksum.

use firmware_proto::command::Command;
use firmware_proto::link::encode_command;
use firmware_proto::{ENCODED_MAX, PROTOCOL_VERSION};

/// No frame is longer before stuffing, so a run of stuffing never is, either; 4 bytes of it are the checksum.
const BODY_MAX: usize = 253 - 4;

/// The first 249 bytes of `body` with their checksum, stuffed, with the closing zero.
pub fn framed(body: &[u8]) -> Vec<u8> {
    let body = &body[..body.len().min(BODY_MAX)];
    let plain = [body, &crc32(body).to_le_bytes()].concat();
    let runs = plain.split(|byte| *byte == 0).map(|run| [&[run.len() as u8 + 1], run].concat());
    [runs.collect::<Vec<_>>().concat(), vec![0]].concat()
}

/// CRC-32 as IEEE 802.3 has it, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1));
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

/// Panics unless frames are those of the protocol: the sound bodies of a fuzz run would not be sound.
pub fn check() {
    let mut frame = [0; ENCODED_MAX];
    let length = encode_command(&Command::Identify, &mut frame);
    assert_eq!(framed(&[PROTOCOL_VERSION, Command::Identify.kind()]), frame[..length]);
}
