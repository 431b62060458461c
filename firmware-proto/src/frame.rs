//! The body that serial frames and HID reports share: version, kind, payload.

use core::fmt;

use crate::PROTOCOL_VERSION;
use crate::channels::{ChannelSample, FEW_CHANNELS_MAX};
use crate::command::{AckResult, Command};
use crate::contact::ContactSample;
use crate::cursor::{Reader, Writer};
use crate::identity::Identity;
use crate::sample::Sample;

/// Bytes before the payload: version and kind.
const HEADER_LEN: usize = 2;

/// The longest body of version 1, that of a sample.
pub(crate) const BODY_MAX: usize = HEADER_LEN + Sample::PAYLOAD_LEN;

const _: () = assert!(Identity::PAYLOAD_LEN <= Sample::PAYLOAD_LEN);
const _: () = assert!(ChannelSample::payload_len(FEW_CHANNELS_MAX) <= Sample::PAYLOAD_LEN);
const _: () = assert!(ContactSample::PAYLOAD_LEN <= Sample::PAYLOAD_LEN);

/// What a pad tells its host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    /// One conversion of all nine channels, sent unasked at the pad's rate.
    Sample(Sample),
    /// The same of a pad that has fewer channels.
    Channels(ChannelSample),
    /// The same of a pad that decodes on its own.
    Contact(ContactSample),
    /// The answer to [`Command::Identify`].
    Identity(Identity),
    /// The answer to any other command.
    Acknowledgement {
        /// The kind byte of the command that is answered.
        command: u8,
        /// What became of it.
        result: AckResult,
    },
}

impl Message {
    const ACKNOWLEDGEMENT: u8 = 0x03;
}

/// Why a frame or report is no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WireError {
    /// Bytes were lost, added or changed: stuffing, checksum or length is wrong, or a field that version 1
    /// does not allow to vary holds something else.
    Damaged,
    /// More bytes without a zero than any frame has. The rest, up to the next zero, is skipped.
    TooLong,
    /// A good frame of a kind this side does not know. It may be skipped.
    UnknownKind(u8),
    /// A good frame of a protocol version this side does not speak.
    NewerVersion(u8),
}

impl fmt::Display for WireError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Damaged => write!(f, "damaged frame"),
            Self::TooLong => write!(f, "more bytes without a zero than any frame has"),
            Self::UnknownKind(kind) => write!(f, "frame of unknown kind {kind:#04x}"),
            Self::NewerVersion(version) => {
                write!(f, "frame of protocol version {version}; this side speaks version {PROTOCOL_VERSION}")
            }
        }
    }
}

impl core::error::Error for WireError {}

/// One direction of the protocol: [`Message`] or [`Command`].
pub(crate) trait Body: Sized {
    fn kind(&self) -> u8;

    fn write_payload(&self, out: &mut Writer);

    /// Takes the payload of a body of `kind` and leaves what follows it.
    fn read_payload(kind: u8, payload: &mut Reader) -> Result<Self, WireError>;
}

/// Appends version, kind and payload: at most [`BODY_MAX`] bytes.
pub(crate) fn write_body(body: &impl Body, out: &mut Writer) {
    out.put(&[PROTOCOL_VERSION, body.kind()]);
    body.write_payload(out);
}

/// Takes version, kind and payload and leaves what follows them.
///
/// The version is judged first and the kind second, because a stranger's payload may have any length.
pub(crate) fn read_body<B: Body>(bytes: &mut Reader) -> Result<B, WireError> {
    let [version, kind] = bytes.take::<HEADER_LEN>().ok_or(WireError::Damaged)?;
    match version {
        // There never was a version 0, but a report or a line of zeros is a common fault.
        0 => Err(WireError::Damaged),
        PROTOCOL_VERSION => B::read_payload(kind, bytes),
        _ => Err(WireError::NewerVersion(version)),
    }
}

impl Body for Message {
    fn kind(&self) -> u8 {
        match self {
            Self::Sample(_) => Sample::KIND,
            Self::Channels(_) => ChannelSample::KIND,
            Self::Contact(_) => ContactSample::KIND,
            Self::Identity(_) => Identity::KIND,
            Self::Acknowledgement { .. } => Self::ACKNOWLEDGEMENT,
        }
    }

    fn write_payload(&self, out: &mut Writer) {
        match self {
            Self::Sample(sample) => sample.write(out),
            Self::Channels(sample) => sample.write(out),
            Self::Contact(sample) => sample.write(out),
            Self::Identity(identity) => identity.write(out),
            Self::Acknowledgement { command, result } => out.put(&[*command, result.byte()]),
        }
    }

    fn read_payload(kind: u8, payload: &mut Reader) -> Result<Self, WireError> {
        let message = match kind {
            Sample::KIND => Sample::read(payload).map(Self::Sample),
            ChannelSample::KIND => ChannelSample::read(payload).map(Self::Channels),
            ContactSample::KIND => ContactSample::read(payload).map(Self::Contact),
            Identity::KIND => Identity::read(payload).map(Self::Identity),
            Self::ACKNOWLEDGEMENT => read_acknowledgement(payload),
            _ => return Err(WireError::UnknownKind(kind)),
        };
        message.ok_or(WireError::Damaged)
    }
}

fn read_acknowledgement(payload: &mut Reader) -> Option<Message> {
    let command = payload.u8()?;
    let result = AckResult::from_byte(payload.u8()?)?;
    Some(Message::Acknowledgement { command, result })
}

impl Body for Command {
    fn kind(&self) -> u8 {
        Self::kind(self)
    }

    fn write_payload(&self, out: &mut Writer) {
        match self {
            Self::Identify => {}
            Self::SetRate { rate_hz } => out.put(&rate_hz.to_le_bytes()),
            Self::Blink { duration_ms } => out.put(&duration_ms.to_le_bytes()),
            Self::SetOutput { output } => out.put(&output.to_le_bytes()),
        }
    }

    fn read_payload(kind: u8, payload: &mut Reader) -> Result<Self, WireError> {
        let command = match kind {
            Self::IDENTIFY => Some(Self::Identify),
            Self::SET_RATE => payload.u16().map(|rate_hz| Self::SetRate { rate_hz }),
            Self::BLINK => payload.u16().map(|duration_ms| Self::Blink { duration_ms }),
            Self::SET_OUTPUT => payload.u16().map(|output| Self::SetOutput { output }),
            _ => return Err(WireError::UnknownKind(kind)),
        };
        command.ok_or(WireError::Damaged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Message, WireError> {
        read_body(&mut Reader::new(bytes))
    }

    #[test]
    fn version_is_judged_before_kind_and_kind_before_length() {
        assert_eq!(read(&[]), Err(WireError::Damaged));
        assert_eq!(read(&[1]), Err(WireError::Damaged));
        assert_eq!(read(&[0, 0x7E]), Err(WireError::Damaged));
        assert_eq!(read(&[2, 0x01]), Err(WireError::NewerVersion(2)));
        assert_eq!(read(&[255, 0x7E]), Err(WireError::NewerVersion(255)));
        assert_eq!(read(&[1, 0x7E, 1, 2, 3]), Err(WireError::UnknownKind(0x7E)));
        assert_eq!(read(&[1, 0x01, 1, 2, 3]), Err(WireError::Damaged));
    }

    #[test]
    fn a_command_is_no_message() {
        for kind in [0x81, 0x82, 0x83, 0x84] {
            assert_eq!(read(&[1, kind, 0, 0]), Err(WireError::UnknownKind(kind)));
        }
    }

    #[test]
    fn an_acknowledgement_knows_three_results() {
        let done = Message::Acknowledgement { command: 0x82, result: AckResult::Done };
        assert_eq!(read(&[1, 3, 0x82, 0]), Ok(done));
        assert_eq!(read(&[1, 3, 0x82, 3]), Err(WireError::Damaged));
    }
}
