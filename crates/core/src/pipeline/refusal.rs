//! Why a pad cannot be played with.

use std::fmt;

use firmware_proto::identity::Identity;

/// Why a pad cannot be played with. The text goes on after the pad's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// It speaks a newer version of the protocol.
    NewerVersion(u8),
    /// It identifies itself with numbers that no pad of ours has: channels, bits or scale.
    Unsuitable(Identity),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NewerVersion(version) => write!(
                f,
                "speaks protocol version {version}; this tactpad knows up to {}: update tactpad",
                firmware_proto::PROTOCOL_VERSION
            ),
            Self::Unsuitable(identity) => write!(
                f,
                "says that it has {} channels of {} bits and {} pV per count; a pad has {} channels of 24 to 32 bits: \
                 check its firmware",
                identity.channels,
                identity.count_bits,
                identity.picovolts_per_count,
                firmware_proto::CHANNELS
            ),
        }
    }
}

impl std::error::Error for Refusal {}
