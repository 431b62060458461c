#![doc = include_str!("../README.md")]
#![no_std]

pub mod channels;
pub mod command;
pub mod contact;
pub mod crc;
pub mod frame;
pub mod hid;
pub mod identity;
pub mod link;
pub mod sample;

mod cobs;
mod cursor;

/// The version this crate speaks; the first byte of every frame and report body.
pub const PROTOCOL_VERSION: u8 = 1;

/// Number of strain channels in a sample: three modules, three axes each.
pub const CHANNELS: usize = 9;

/// Bits of a count when the pad answers no `identify`.
pub const DEFAULT_COUNT_BITS: u8 = 24;

/// Picovolts at the bridge per count when the pad answers no `identify`: 0.01 µV.
pub const DEFAULT_PICOVOLTS_PER_COUNT: u32 = 10_000;

/// Speed of the serial link in baud, 8 data bits, no parity, 1 stop bit, when nobody says otherwise.
pub const DEFAULT_BAUD: u32 = 2_000_000;

/// The slowest sample rate a host may ask for, in hertz.
pub const RATE_MIN_HZ: u16 = 100;

/// The fastest sample rate a host may ask for, in hertz. A link too slow for it lets the pad refuse.
pub const RATE_MAX_HZ: u16 = 8_000;

/// The longest version 1 frame on the serial line, in bytes: a sample, stuffed, with its closing zero.
pub const ENCODED_MAX: usize = frame::BODY_MAX + crc::LEN + cobs::OVERHEAD + 1;

const _: () = assert!(ENCODED_MAX == 60);
