//! The same messages and commands as USB HID reports.
//!
//! One report carries one body. The bus frames and checks it, so there is no stuffing and no checksum.

use crate::command::Command;
use crate::cursor::{Reader, Writer};
use crate::frame::{BODY_MAX, Body, Message, WireError, read_body, write_body};
use crate::{ENCODED_MAX, PROTOCOL_VERSION, link};

/// The USB vendor number: a block of numbers shared by open hardware.
pub const VENDOR_ID: u16 = 0x1209;

/// The USB product number: one that is set aside for tests, until the project has its own.
pub const PRODUCT_ID: u16 = 0x0001;

/// Bytes of a report with its report id, as hosts read and write it.
pub const REPORT_LEN: usize = 64;

/// The report id of messages, pad to host.
pub const MESSAGE_REPORT_ID: u8 = 1;

/// The report id of commands, host to pad.
pub const COMMAND_REPORT_ID: u8 = 2;

const _: () = assert!(BODY_MAX < REPORT_LEN, "a report holds its id and any body");

/// The report descriptor that a pad hands to the USB host.
pub const REPORT_DESCRIPTOR: &[u8] = &[
    0x06, 0x00, 0xFF, // usage page: vendor-defined 0xFF00
    0x09, 0x01, // usage 1: a pad
    0xA1, 0x01, // collection: application
    0x15, 0x00, // logical minimum 0
    0x26, 0xFF, 0x00, // logical maximum 255
    0x75, 0x08, // report size: 8 bits
    0x95, 0x3F, // report count: 63
    0x85, 0x01, // report id 1
    0x09, 0x02, // usage 2: a message
    0x81, 0x02, // input: data, variable, absolute
    0x85, 0x02, // report id 2
    0x09, 0x03, // usage 3: a command
    0x91, 0x02, // output: data, variable, absolute
    0xC0, // end of collection
];

/// The report that carries `message`.
#[must_use]
pub fn encode_message(message: &Message) -> [u8; REPORT_LEN] {
    encode(MESSAGE_REPORT_ID, message)
}

/// The report that carries `command`.
#[must_use]
pub fn encode_command(command: &Command) -> [u8; REPORT_LEN] {
    encode(COMMAND_REPORT_ID, command)
}

/// The message in a report of [`REPORT_LEN`] bytes that begins with its report id.
///
/// # Errors
/// `Damaged` if the length, the report id or a field is wrong; `UnknownKind` and `NewerVersion` as on the
/// serial line.
pub fn decode_message(report: &[u8]) -> Result<Message, WireError> {
    decode(MESSAGE_REPORT_ID, report)
}

/// The command in a report of [`REPORT_LEN`] bytes that begins with its report id.
///
/// # Errors
/// `Damaged` if the length, the report id or a field is wrong; `UnknownKind` and `NewerVersion` as on the
/// serial line.
pub fn decode_command(report: &[u8]) -> Result<Command, WireError> {
    decode(COMMAND_REPORT_ID, report)
}

/// Writes what a message report carries as one serial frame with its closing zero; returns how many bytes of `out`
/// it takes.
///
/// For hosts: whatever way a message came, one receiver hears the same of it. What is no message stays what it is: an
/// unknown kind, a newer version, or damage.
pub fn to_serial_frame(report: &[u8], out: &mut [u8; ENCODED_MAX]) -> usize {
    match decode_message(report) {
        Ok(message) => link::encode_message(&message, out),
        Err(WireError::UnknownKind(kind)) => link::seal(&[PROTOCOL_VERSION, kind], out),
        Err(WireError::NewerVersion(version)) => link::seal(&[version, 0], out),
        // No body has version 0.
        Err(WireError::Damaged | WireError::TooLong) => link::seal(&[0, 0], out),
    }
}

fn encode(report_id: u8, body: &impl Body) -> [u8; REPORT_LEN] {
    let mut report = [0; REPORT_LEN];
    let mut out = Writer::new(&mut report);
    out.put(&[report_id]);
    write_body(body, &mut out);
    report
}

/// What follows the payload is padding and not looked at.
fn decode<B: Body>(report_id: u8, report: &[u8]) -> Result<B, WireError> {
    let report: &[u8; REPORT_LEN] = report.try_into().map_err(|_| WireError::Damaged)?;
    let mut reader = Reader::new(report);
    if reader.u8() != Some(report_id) {
        return Err(WireError::Damaged);
    }
    read_body(&mut reader)
}
