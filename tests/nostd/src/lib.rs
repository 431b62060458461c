//! C entry points to `firmware-proto`. The encoders are those of `c/tactpad_proto.h`. Decoders have names of their
//! own: a receiver's size is the crate's affair, and a report must be whole to be borrowed.
//!
//! The only unsafe thing here is that each entry point claims a name of the whole program. Pointers come in as
//! references: C must hand over valid ones, as the header asks.
#![no_std]

use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use firmware_proto::command::{AckResult, Command};
use firmware_proto::frame::{Message, WireError};
use firmware_proto::hid::{self, REPORT_LEN};
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::{CommandReceiver, encode_message};
use firmware_proto::sample::{Sample, Status};
use firmware_proto::{CHANNELS, ENCODED_MAX};

unsafe extern "C" {
    /// Does not exist. A library in which nothing can panic does not ask for it.
    safe fn tactpad_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    tactpad_panic_is_reachable()
}

/// `struct tactpad_sample`.
#[repr(C)]
pub struct SampleC {
    sequence: u32,
    time_us: u64,
    counts: [i32; CHANNELS],
    temperature_centi_c: i16,
    status: u16,
}

impl SampleC {
    fn message(&self) -> Message {
        Message::Sample(Sample {
            sequence: self.sequence,
            time_us: self.time_us,
            counts: self.counts,
            temperature_centi_c: self.temperature_centi_c,
            status: Status(self.status),
        })
    }
}

/// `struct tactpad_identity`.
#[repr(C)]
pub struct IdentityC {
    serial_number: [u8; SerialNumber::LEN],
    channels: u8,
    count_bits: u8,
    rate_hz: u16,
    picovolts_per_count: u32,
}

impl IdentityC {
    /// `None` if the serial number is not visible ASCII.
    fn message(&self) -> Option<Message> {
        let characters = self.serial_number.split(|byte| *byte == 0).next()?;
        let serial_number = SerialNumber::from_ascii(core::str::from_utf8(characters).ok()?)?;
        let Self { channels, count_bits, rate_hz, picovolts_per_count, .. } = *self;
        Some(Message::Identity(Identity {
            serial_number,
            channels,
            count_bits,
            rate_hz,
            picovolts_per_count,
        }))
    }
}

/// `enum tactpad_result` as a message; `None` if it is none of the three.
fn acknowledgement(command: u8, result: u32) -> Option<Message> {
    let result =
        [AckResult::Done, AckResult::Refused, AckResult::Unknown].get(usize::try_from(result).ok()?)?;
    Some(Message::Acknowledgement { command, result: *result })
}

/// Writes a frame; its length.
// SAFETY: the name is the header's, and nothing else in the program has it. So it is for all names below.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_encode_sample(sample: &SampleC, out: &mut [u8; ENCODED_MAX]) -> usize {
    encode_message(&sample.message(), out)
}

/// Writes a frame; its length, 0 if the serial number is not visible ASCII.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_encode_identity(identity: &IdentityC, out: &mut [u8; ENCODED_MAX]) -> usize {
    identity.message().map_or(0, |message| encode_message(&message, out))
}

/// Writes a frame; its length, 0 if there is no such result.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_encode_acknowledgement(
    command: u8,
    result: u32,
    out: &mut [u8; ENCODED_MAX],
) -> usize {
    acknowledgement(command, result).map_or(0, |message| encode_message(&message, out))
}

/// Writes an input report.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_report_sample(sample: &SampleC, out: &mut [u8; REPORT_LEN]) {
    *out = hid::encode_message(&sample.message());
}

/// Writes an input report; untouched if the serial number is not visible ASCII.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_report_identity(identity: &IdentityC, out: &mut [u8; REPORT_LEN]) {
    if let Some(message) = identity.message() {
        *out = hid::encode_message(&message);
    }
}

/// Writes an input report; untouched if there is no such result.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_report_acknowledgement(command: u8, result: u32, out: &mut [u8; REPORT_LEN]) {
    if let Some(message) = acknowledgement(command, result) {
        *out = hid::encode_message(&message);
    }
}

/// `struct tactpad_command`.
#[repr(C)]
pub struct CommandC {
    kind: u8,
    value: u16,
}

/// `enum tactpad_event`; sets `command` where there is one.
fn event(received: Option<Result<Command, WireError>>, out: &mut CommandC) -> u32 {
    let (event, command) = match received {
        None => (0, None),
        Some(Ok(command)) => (1, Some((command.kind(), value(&command)))),
        Some(Err(WireError::Damaged)) => (2, None),
        Some(Err(WireError::TooLong)) => (3, None),
        Some(Err(WireError::UnknownKind(kind))) => (4, Some((kind, 0))),
        Some(Err(WireError::NewerVersion(_))) => (5, None),
    };
    if let Some((kind, value)) = command {
        *out = CommandC { kind, value };
    }
    event
}

const fn value(command: &Command) -> u16 {
    match *command {
        Command::Identify => 0,
        Command::SetRate { rate_hz } => rate_hz,
        Command::Blink { duration_ms } => duration_ms,
        Command::SetOutput { output } => output,
    }
}

/// Understands an output report.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_crate_decode_report(report: &[u8; REPORT_LEN], out: &mut CommandC) -> u32 {
    event(Some(hid::decode_command(report)), out)
}

/// Bytes that a receiver takes, at an address that any object may have.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_crate_receiver_len() -> usize {
    size_of::<CommandReceiver>()
}

/// Makes a receiver of memory that holds anything.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_crate_receiver_reset(receiver: &mut MaybeUninit<CommandReceiver>) {
    receiver.write(CommandReceiver::new());
}

/// Takes the next byte from the host.
#[unsafe(no_mangle)]
pub extern "C" fn tactpad_crate_receive(receiver: &mut CommandReceiver, byte: u8, out: &mut CommandC) -> u32 {
    event(receiver.push(byte), out)
}
