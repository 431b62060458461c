//! What is told to the player.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::quantity::CHANNEL_NAMES;

/// Warning to the player.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
#[non_exhaustive]
pub enum Warning {
    /// It is not one finger: a second one, or something else on the pad.
    SecondFinger,
    /// A channel does not answer to the load.
    SilentChannel {
        /// Its index.
        #[serde(serialize_with = "by_name")]
        channel: usize,
    },
    /// Most touches are not one finger on the calibrated pad.
    OtherPad,
    /// A channel reads what no finger makes it read; nothing is pressed by that.
    StrayChannel {
        /// Its index.
        #[serde(serialize_with = "by_name")]
        channel: usize,
    },
}

fn by_name<S: Serializer>(channel: &usize, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(name(*channel))
}

fn name(channel: usize) -> &'static str {
    CHANNEL_NAMES.get(channel).copied().unwrap_or("unknown")
}

impl Warning {
    /// Whether it is of the pad, not of a touch.
    pub const fn lasts(self) -> bool {
        !matches!(self, Self::SecondFinger)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SecondFinger => {
                f.write_str(
                    "this is not one finger, or a channel is off and it does not show which: lift the other fingers, and what lies \
                     on the pad",
                )
            }
            Self::SilentChannel { channel } => {
                write!(f, "channel {} does not answer to the load: check its wires", name(*channel))
            }
            Self::StrayChannel { channel } => write!(
                f,
                "channel {} reads what no finger makes it read: it drifts, or its wires are loose",
                name(*channel)
            ),
            Self::OtherPad => f.write_str(
                "most touches do not fit the decoder: is it this pad's? `tactpad adapt` makes one from measured contacts",
            ),
        }
    }
}
