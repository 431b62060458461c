//! The state of the bridge, in words: for the screen, for `ctl status`, and for the terminal.

use serde::Serialize;

use crate::pad_connection::NoPadReason;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::pipeline::{Phase, Pipeline};

/// The state of the bridge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// No pad is there.
    Waiting,
    /// The pad is there but may not be opened.
    Denied,
    /// Several pads are there, or something that cannot be used.
    Unclear,
    /// The pad is open and sends nothing sound.
    Silent,
    /// The zero is being measured.
    Taring,
    /// The zero cannot be measured: something lies on the pad.
    Loaded,
    /// Who is to stand on the pad was not weighed yet.
    Unweighed,
    /// Contacts become events.
    Playing,
    /// A known weight is weighed, or lies there still.
    Weighing,
    /// Frames are lost, repeated or damaged, so that no contact is believed.
    Doubtful,
    /// A channel cannot be trusted.
    Faulty,
    /// The player paused.
    Paused,
    /// The pad cannot be played with.
    Refused,
}

/// Where a larger share of frames is lost a zero is hardly ever measured, in percent.
const LOSS_WITHOUT_ZERO_PERCENT: f32 = 25.0;

impl State {
    pub(super) fn of(pipeline: &Pipeline, no_pad_reason: Option<NoPadReason>) -> Self {
        match (pipeline.phase(), no_pad_reason) {
            (Phase::Paused, _) => Self::Paused,
            (_, Some(NoPadReason::Denied)) => Self::Denied,
            (_, Some(NoPadReason::Ambiguous)) => Self::Unclear,
            (_, Some(NoPadReason::Gone)) => Self::Waiting,
            (Phase::Refused, None) => Self::Refused,
            (Phase::Waiting, None) => Self::Silent,
            (Phase::Taring, None) => Self::Taring,
            (Phase::Loaded, None) => Self::Loaded,
            (Phase::Playing, None) if pipeline.awaits_weight() => Self::Unweighed,
            (Phase::Playing, None) => Self::Playing,
            (Phase::Weighing, None) => Self::Weighing,
            (Phase::Doubtful, None) => Self::Doubtful,
            (Phase::Faulty, None) => Self::Faulty,
        }
    }

    /// Whether this may be why. A few lost frames do not keep a zero from being measured; and of a pad that says nothing at all neither
    /// lost frames nor a channel that stood is the reason.
    pub(super) const fn may_come_of(self, finding: &LineFinding) -> bool {
        match finding {
            LineFinding::Loss { percent } => {
                matches!(self, Self::Doubtful)
                    || matches!(self, Self::Taring) && *percent >= LOSS_WITHOUT_ZERO_PERCENT
            }
            LineFinding::ChannelStands { .. } => {
                matches!(self, Self::Taring | Self::Loaded | Self::Doubtful | Self::Faulty)
            }
            _ => matches!(self, Self::Taring | Self::Loaded | Self::Silent | Self::Doubtful | Self::Faulty),
        }
    }

    /// One word.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Denied => "denied",
            Self::Unclear => "unclear",
            Self::Silent => "silent",
            Self::Taring => "taring",
            Self::Loaded => "loaded",
            Self::Unweighed => "unweighed",
            Self::Playing => "playing",
            Self::Weighing => "weighing",
            Self::Doubtful => "doubtful",
            Self::Faulty => "faulty",
            Self::Paused => "paused",
            Self::Refused => "refused",
        }
    }

    /// A sentence with the way out.
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Waiting => "waiting for the pad: plug it in",
            Self::Denied => {
                "the pad is there but may not be opened, or is in use: `tactpad doctor` says how to mend it"
            }
            Self::Unclear => {
                "several pads are attached, or what cannot be used: `tactpad devices` lists them"
            }
            Self::Silent => "the pad sends nothing that can be read: check its power and its line",
            Self::Taring => "measuring the zero: leave the pad untouched for a moment",
            Self::Loaded => "lift the finger: the zero is measured when nothing lies on the pad",
            Self::Unweighed => {
                "stand still on the board: a second of that tells your weight, and nothing is pressed before"
            }
            Self::Playing => "playing",
            Self::Weighing => {
                "weighing: nothing is pressed before the weight was put down and taken away again"
            }
            Self::Doubtful => "frames are lost, repeated or damaged, nothing is pressed: check the line",
            Self::Faulty => {
                "a channel is saturated, stuck, without supply or unlike the others, nothing is pressed: check the pad"
            }
            Self::Paused => "paused",
            Self::Refused => "this pad cannot be played with: update tactpad, or check the pad's firmware",
        }
    }
}
