//! What a pad measured at one moment, in any of the forms that the wire has.

use firmware_proto::channels::ChannelSample;
use firmware_proto::contact::ContactSample;
use firmware_proto::sample::{Sample, Status};

use crate::quantity::CHANNELS;

/// Without a sample for this long the link counts as lost. Everything is released then, well inside 100 ms.
pub const SILENCE_MAX_US: u64 = 80_000;

/// One measurement of a pad: when by its own account, what is wrong with it, and what was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// One more than the reading before.
    pub sequence: u32,
    /// Microseconds of the pad's own clock.
    pub time_us: u64,
    /// What the pad knows to be wrong.
    pub status: Status,
    /// What it measured.
    pub measured: Measured,
}

/// What a pad measured, by the kind of its message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// Nine channels.
    Nine(Sample),
    /// One to eight channels.
    Few(ChannelSample),
    /// The contact itself.
    Contact(ContactSample),
}

impl Reading {
    /// The counts of nine channels, if it has them.
    pub const fn nine_counts(&self) -> Option<&[i32; CHANNELS]> {
        match &self.measured {
            Measured::Nine(sample) => Some(&sample.counts),
            Measured::Few(_) | Measured::Contact(_) => None,
        }
    }
}

impl From<Sample> for Reading {
    fn from(sample: Sample) -> Self {
        let Sample { sequence, time_us, status, .. } = sample;
        Self { sequence, time_us, status, measured: Measured::Nine(sample) }
    }
}

impl From<ChannelSample> for Reading {
    fn from(sample: ChannelSample) -> Self {
        let ChannelSample { sequence, time_us, .. } = sample;
        Self { sequence, time_us, status: sample.status(), measured: Measured::Few(sample) }
    }
}

impl From<ContactSample> for Reading {
    fn from(sample: ContactSample) -> Self {
        let ContactSample { sequence, time_us, status, .. } = sample;
        Self { sequence, time_us, status, measured: Measured::Contact(sample) }
    }
}
