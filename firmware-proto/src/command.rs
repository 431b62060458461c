//! What a host asks of a pad, and how the pad answers.

/// What a host asks of a pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Tell who you are; answered by an identity.
    Identify,
    /// Send this many samples per second from now on; answered by an acknowledgement.
    SetRate {
        /// Hertz. Whether the pad can do it is for the pad to say: any value arrives.
        rate_hz: u16,
    },
    /// Show yourself by a light; answered by an acknowledgement.
    Blink {
        /// How long, in milliseconds; 0 stops it.
        duration_ms: u16,
    },
    /// Send channels or contacts from now on; answered by an acknowledgement.
    SetOutput {
        /// [`OUTPUT_CHANNELS`] or [`OUTPUT_CONTACTS`]. Whether the pad can do it is for the pad to say: any value arrives.
        output: u16,
    },
}

/// The pad sends its channels.
pub const OUTPUT_CHANNELS: u16 = 0;

/// The pad decodes on its own and sends contacts.
pub const OUTPUT_CONTACTS: u16 = 1;

impl Command {
    pub(crate) const IDENTIFY: u8 = 0x81;
    pub(crate) const SET_RATE: u8 = 0x82;
    pub(crate) const BLINK: u8 = 0x83;
    pub(crate) const SET_OUTPUT: u8 = 0x84;

    /// The command's kind byte, which its acknowledgement names.
    #[must_use]
    pub const fn kind(&self) -> u8 {
        match self {
            Self::Identify => Self::IDENTIFY,
            Self::SetRate { .. } => Self::SET_RATE,
            Self::Blink { .. } => Self::BLINK,
            Self::SetOutput { .. } => Self::SET_OUTPUT,
        }
    }
}

/// What became of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AckResult {
    /// It is done, or under way.
    Done,
    /// The pad knows the command and cannot do it, such as a rate outside its range.
    Refused,
    /// The pad does not know the command.
    Unknown,
}

impl AckResult {
    pub(crate) const fn byte(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Refused => 1,
            Self::Unknown => 2,
        }
    }

    pub(crate) const fn from_byte(byte: u8) -> Option<Self> {
        match byte {
            0 => Some(Self::Done),
            1 => Some(Self::Refused),
            2 => Some(Self::Unknown),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_three_bytes_and_no_more() {
        for byte in 0..=u8::MAX {
            assert_eq!(AckResult::from_byte(byte).map(AckResult::byte), (byte < 3).then_some(byte));
        }
    }
}
