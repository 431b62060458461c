//! What the pad's firmware decides, without the chip it runs on: so it is tested where it is built.

#![no_std]

pub mod contact;
pub mod excitation;
pub mod frames;
pub mod light;
pub mod outbox;
pub mod pad;
pub mod rate;
pub mod zero;

/// Converters on the bus, one for each module of the pad.
pub const CONVERTERS: usize = 3;

/// Channels of a converter.
pub const CHANNELS_EACH: usize = 3;

const _: () = assert!(CONVERTERS * CHANNELS_EACH == firmware_proto::CHANNELS);
