//! The states of the icon, also in words.

use tactpad_bridge::snapshot::Status;
use tactpad_bridge::state::State;

/// The state that the icon shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum IconState {
    /// No pad speaks.
    NoPad,
    /// Nothing lies on the pad, or the zero is being measured.
    Idle,
    /// Something touches it, and nothing is held.
    Contact,
    /// Something is held.
    Pressed,
    /// The player paused.
    Paused,
    /// Somebody has to do something.
    Fault,
}

impl IconState {
    pub(super) fn of(status: &Status) -> Self {
        match status.state {
            State::Waiting | State::Silent => Self::NoPad,
            State::Denied
            | State::Unclear
            | State::Loaded
            | State::Doubtful
            | State::Faulty
            | State::Refused => Self::Fault,
            State::Paused => Self::Paused,
            State::Taring | State::Unweighed | State::Weighing => Self::Idle,
            State::Playing if !status.held.is_empty() => Self::Pressed,
            State::Playing if status.contact.is_some() => Self::Contact,
            State::Playing => Self::Idle,
        }
    }

    /// The same in words, with the way out where something is wrong.
    pub(super) const fn words(self, state: State) -> &'static str {
        match (state, self) {
            (State::Playing, Self::Pressed) => "pressed",
            (State::Playing, Self::Contact) => "touched",
            (State::Playing, _) => "ready",
            _ => state.sentence(),
        }
    }
}
