//! The form of an entry: what writer and reader have to agree on.

use firmware_proto::crc::crc32;

use crate::pad::weight::Weight;
use crate::pipeline::mapping::read::check::OutputChoice;

pub(super) const MAGIC: &[u8] = b"tactpad capture 1\n";

/// Longer payloads are not written by any recorder.
pub(super) const PAYLOAD_BYTES_MAX: u32 = 1 << 24;

/// Kind, host time and length.
pub(super) const FIELDS_BYTES: usize = 13;
pub(super) const CHECKSUM_BYTES: usize = 4;
pub(super) const HEAD_BYTES: usize = FIELDS_BYTES + CHECKSUM_BYTES;

/// Kind of an entry; the number is its first byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum EntryKind {
    /// The payload is the pad's bytes.
    Bytes = 0,
    Timeout = 1,
    Unplugged = 2,
    Pause = 3,
    Resume = 4,
    ReleaseAll = 5,
    Retare = 6,
    /// The payload is a profile's TOML text, for the output that it names; a capture's first one is what it begins with.
    Profile = 7,
    /// The same, for the keyboard whatever output it names.
    KeyboardProfile = 8,
    /// The payload is the decoder that plays, as its file has it; stands before everything else or nowhere.
    Decoder = 9,
    /// The recording went on, but what follows is missing. Nothing stands behind it.
    Missing = 10,
    /// The payload is the weight in grams, a number of eight bytes.
    Weigh = 11,
}

/// All kinds, each at the place of its number.
const KINDS: [EntryKind; 12] = [
    EntryKind::Bytes,
    EntryKind::Timeout,
    EntryKind::Unplugged,
    EntryKind::Pause,
    EntryKind::Resume,
    EntryKind::ReleaseAll,
    EntryKind::Retare,
    EntryKind::Profile,
    EntryKind::KeyboardProfile,
    EntryKind::Decoder,
    EntryKind::Missing,
    EntryKind::Weigh,
];

impl EntryKind {
    /// The kind of this number, if it is one.
    pub(super) fn of(number: u8) -> Option<Self> {
        KINDS.get(usize::from(number)).copied()
    }

    /// The kind of a profile that was read so.
    pub(super) const fn of_profile(output: OutputChoice) -> Self {
        match output {
            OutputChoice::AsWritten => Self::Profile,
            OutputChoice::Keyboard => Self::KeyboardProfile,
        }
    }

    /// How the payload is to be read, if it is a profile.
    pub(super) const fn output(self) -> Option<OutputChoice> {
        match self {
            Self::Profile => Some(OutputChoice::AsWritten),
            Self::KeyboardProfile => Some(OutputChoice::Keyboard),
            _ => None,
        }
    }

    /// Whether it is more than what a capture begins with.
    pub(super) const fn is_play(self) -> bool {
        !matches!(self, Self::Profile | Self::KeyboardProfile | Self::Decoder | Self::Missing)
    }

    /// Whether `payload` may stand in it.
    pub(super) fn takes(self, payload: &[u8]) -> bool {
        match self {
            Self::Bytes | Self::Decoder => true,
            Self::Weigh => weight(payload).is_some(),
            Self::Profile | Self::KeyboardProfile => std::str::from_utf8(payload).is_ok(),
            _ => payload.is_empty(),
        }
    }
}

/// The weight that a payload tells, if it is one.
pub(super) fn weight(payload: &[u8]) -> Option<Weight> {
    Weight::of_g(f64::from_le_bytes(payload.try_into().ok()?)).ok()
}

/// The checksum of `bytes` behind the checksum of what came before them.
pub(super) fn chained(before: u32, bytes: &[u8]) -> u32 {
    crc32(&[&before.to_le_bytes(), bytes].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_found_by_its_number() {
        for (number, kind) in KINDS.into_iter().enumerate() {
            assert_eq!((kind as usize, EntryKind::of(kind as u8)), (number, Some(kind)));
        }
        assert_eq!(EntryKind::of(12), None);
    }
}
