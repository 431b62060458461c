//! Why a pad cannot be played with.

use std::fmt;

use crate::counted::counted;
use firmware_proto::identity::Identity;

/// Why a pad cannot be played with. The text goes on after the pad's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// It speaks a newer version of the protocol.
    NewerVersion(u8),
    /// It identifies itself with numbers that no pad of ours has: channels, bits or scale.
    Unsuitable(Identity),
    /// It has another number of channels than its decoder is for.
    OtherChannels {
        /// How many it has.
        channels: usize,
        /// How many the decoder takes; none if it takes contacts only.
        wanted: usize,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NewerVersion(version) => write!(
                f,
                "speaks protocol version {version}; this tactpad knows up to {}: update tactpad",
                firmware_proto::PROTOCOL_VERSION
            ),
            Self::OtherChannels { channels, wanted: firmware_proto::CHANNELS } => write!(
                f,
                "sends {}, and its decoder takes nine: describe what it has in a file, and name that with --source",
                counted(channels, "channel")
            ),
            Self::OtherChannels { channels, wanted } => {
                let of = if *wanted == 0 { "contacts only".into() } else { counted(wanted, "channel") };
                write!(
                    f,
                    "sends {}, and its description is of {of}: name another one with --source",
                    counted(channels, "channel")
                )
            }
            Self::Unsuitable(identity) => write!(
                f,
                "says that it has {} of {} bits and {} pV per count; a pad has {} channels of 24 to 32 bits: \
                 check its firmware",
                counted(identity.channels, "channel"),
                identity.count_bits,
                identity.picovolts_per_count,
                firmware_proto::CHANNELS
            ),
        }
    }
}

impl std::error::Error for Refusal {}
