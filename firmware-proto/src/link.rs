//! The serial line: whole frames out, single bytes in.

use crate::command::Command;
use crate::cursor::{Reader, Writer};
use crate::frame::{BODY_MAX, Body, Message, WireError, read_body, write_body};
use crate::{ENCODED_MAX, cobs, crc};

/// Writes `message` as one frame with its closing zero; returns how many bytes of `out` it takes.
pub fn encode_message(message: &Message, out: &mut [u8; ENCODED_MAX]) -> usize {
    encode(message, out)
}

/// Writes `command` as one frame with its closing zero; returns how many bytes of `out` it takes.
pub fn encode_command(command: &Command, out: &mut [u8; ENCODED_MAX]) -> usize {
    encode(command, out)
}

fn encode(body: &impl Body, out: &mut [u8; ENCODED_MAX]) -> usize {
    let mut plain = [0; BODY_MAX];
    let mut written = Writer::new(&mut plain);
    write_body(body, &mut written);
    seal(written.written(), out)
}

/// Adds checksum, stuffing and the closing zero to a body of at most [`BODY_MAX`] bytes.
pub(crate) fn seal(body: &[u8], out: &mut [u8; ENCODED_MAX]) -> usize {
    let mut plain = [0; BODY_MAX + crc::LEN];
    let mut frame = Writer::new(&mut plain);
    frame.put(body);
    let checksum = crc::crc32(frame.written());
    frame.put(&checksum.to_le_bytes());

    let mut out = Writer::new(out);
    cobs::stuff(frame.written(), &mut out);
    out.put(&[0]);
    out.len()
}

/// A host's end of the serial line: takes what the pad sends, byte by byte.
///
/// Every frame on the line yields exactly one message or error. After any damage the next zero byte sets the
/// receiver right. A host that starts to listen in the middle of a frame gets one error first.
#[derive(Clone, Debug)]
pub struct MessageReceiver(FrameReceiver);

impl Default for MessageReceiver {
    fn default() -> Self {
        Self::new()
    }
}

impl MessageReceiver {
    /// A receiver that takes the next byte for a frame's first.
    #[must_use]
    pub const fn new() -> Self {
        Self(FrameReceiver::new())
    }

    /// Takes the next byte. `Some` when it completes a frame, good or bad, or makes it too long.
    pub fn push(&mut self, byte: u8) -> Option<Result<Message, WireError>> {
        Some(self.0.push(byte)?.and_then(read_whole))
    }
}

/// A pad's end of the serial line: takes what the host sends, byte by byte.
///
/// It behaves like [`MessageReceiver`].
#[derive(Clone, Debug)]
pub struct CommandReceiver(FrameReceiver);

impl Default for CommandReceiver {
    fn default() -> Self {
        Self::new()
    }
}

impl CommandReceiver {
    /// A receiver that takes the next byte for a frame's first.
    #[must_use]
    pub const fn new() -> Self {
        Self(FrameReceiver::new())
    }

    /// Takes the next byte. `Some` when it completes a frame, good or bad, or makes it too long.
    pub fn push(&mut self, byte: u8) -> Option<Result<Command, WireError>> {
        Some(self.0.push(byte)?.and_then(read_whole))
    }
}

/// Reads a body that ends where its payload ends.
fn read_whole<B: Body>(bytes: &[u8]) -> Result<B, WireError> {
    let mut reader = Reader::new(bytes);
    let body = read_body(&mut reader)?;
    if reader.is_empty() { Ok(body) } else { Err(WireError::Damaged) }
}

/// Collects one frame at a time, unstuffed. It keeps room for the longest frame that any version may send, so
/// that strangers are told from damage.
#[derive(Clone, Debug)]
struct FrameReceiver {
    frame: [u8; cobs::UNSTUFFED_MAX],
    len: usize,
    unstuffer: cobs::Unstuffer,
    overlong: bool,
}

impl FrameReceiver {
    const fn new() -> Self {
        Self { frame: [0; cobs::UNSTUFFED_MAX], len: 0, unstuffer: cobs::Unstuffer::Start, overlong: false }
    }

    /// Takes the next byte; yields a body whose checksum is right, or what is wrong.
    fn push(&mut self, byte: u8) -> Option<Result<&[u8], WireError>> {
        match byte {
            0 => self.end(),
            _ if self.overlong => None,
            _ => self.extend(byte).err().map(Err),
        }
    }

    fn extend(&mut self, byte: u8) -> Result<(), WireError> {
        let Some(decoded) = self.unstuffer.feed(byte) else { return Ok(()) };
        let Some(slot) = self.frame.get_mut(self.len) else {
            self.overlong = true;
            return Err(WireError::TooLong);
        };
        *slot = decoded;
        self.len += 1;
        Ok(())
    }

    /// Ends the frame and starts the next. Nothing between two zeros is no frame, and an overlong one is told
    /// already.
    fn end(&mut self) -> Option<Result<&[u8], WireError>> {
        let Self { len, unstuffer, overlong, .. } = *self;
        self.len = 0;
        self.unstuffer = cobs::Unstuffer::Start;
        self.overlong = false;
        if overlong || unstuffer.is_at_start() {
            return None;
        }
        let frame = self.frame.get(..len).filter(|_| unstuffer.may_end());
        Some(frame.and_then(checked_body).ok_or(WireError::Damaged))
    }
}

/// The frame without its checksum; `None` if that is missing or wrong.
fn checked_body(frame: &[u8]) -> Option<&[u8]> {
    let (body, checksum) = frame.split_last_chunk::<{ crc::LEN }>()?;
    (crc::crc32(body) == u32::from_le_bytes(*checksum)).then_some(body)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLINK: Command = Command::Blink { duration_ms: 500 };

    /// The last frame that `bytes` complete.
    fn receive(receiver: &mut CommandReceiver, bytes: &[u8]) -> Option<Result<Command, WireError>> {
        bytes.iter().filter_map(|byte| receiver.push(*byte)).last()
    }

    fn blink_frame() -> ([u8; ENCODED_MAX], usize) {
        let mut frame = [0; ENCODED_MAX];
        let len = encode_command(&BLINK, &mut frame);
        (frame, len)
    }

    #[test]
    fn zeros_alone_are_no_frames() {
        let (frame, len) = blink_frame();
        let mut receiver = CommandReceiver::new();
        assert_eq!(receive(&mut receiver, &[0; 300]), None);
        assert_eq!(receive(&mut receiver, &frame[..len]), Some(Ok(BLINK)));
        assert_eq!(receive(&mut receiver, &[0; 3]), None);
    }

    #[test]
    fn a_receiver_gives_up_just_above_the_longest_frame() {
        let longest = cobs::UNSTUFFED_MAX + cobs::OVERHEAD;
        let mut receiver = CommandReceiver::new();
        let filled = (0..longest).filter_map(|_| receiver.push(0xFE)).count();
        assert_eq!(filled, 0, "a code and 253 bytes may still be a frame");
        assert_eq!(receiver.clone().push(0), Some(Err(WireError::Damaged)));
        assert_eq!(receiver.push(0xFE), Some(Err(WireError::TooLong)));
        assert_eq!(receive(&mut receiver, &[0xFE; 1000]), None, "told once");
        assert_eq!(receiver.push(0), None, "told already");
        let (frame, len) = blink_frame();
        assert_eq!(receive(&mut receiver, &frame[..len]), Some(Ok(BLINK)));
    }
}
