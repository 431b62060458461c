//! One record of everything that went wrong on the way from the pad.

use serde::Serialize;

/// Counts since the pipeline was made. Every count but `samples`, `contacts`, `frames_damaged`, `frames_newer`, `frames_unknown`,
/// `second_fingers` and `channels_silent` ends a contact; `frames_lost` does if a finger could have come or gone meanwhile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Health {
    /// Samples decoded.
    pub samples: u64,
    /// Contacts begun.
    pub contacts: u64,
    /// Frames whose stuffing, length or checksum was wrong.
    pub frames_damaged: u64,
    /// Frames missing by sequence number.
    pub frames_lost: u64,
    /// Frames that came again, too late, or from another time; dropped.
    pub frames_repeated: u64,
    /// Sound frames of a newer protocol version; skipped, and the pad is refused if it sends nothing else.
    pub frames_newer: u64,
    /// Sound frames of a kind this version does not know; skipped.
    pub frames_unknown: u64,
    /// Pad clock steps backwards or by more than 100 ms.
    pub time_jumps: u64,
    /// Pad restarts: a restart flag, or several frames that go on from one another and not from what was before.
    pub restarts: u64,
    /// Times the link fell silent or the pad was unplugged.
    pub links_lost: u64,
    /// Times a channel reached the end of its range.
    pub channels_saturated: u64,
    /// Times a channel stopped changing while the others went on.
    pub channels_stuck: u64,
    /// Samples flagged with a supply fault.
    pub supply_faults: u64,
    /// Times the zero turned out to have been measured with something on the pad.
    pub zeros_loaded: u64,
    /// Touches that are not one finger on the calibrated pad; they are played all the same, those that are far from it for 10 s
    /// at most.
    pub second_fingers: u64,
    /// Times a channel did not answer to the load.
    pub channels_silent: u64,
    /// Times a channel began to read what no finger makes it read.
    pub channels_stray: u64,
}
