//! What the bridge is doing, in words: for the screen, for `ctl status`, and for the terminal.

use serde::Serialize;

use super::keeper::Absence;
use crate::contact::watch::Warning;
use crate::health::Health;
use crate::latency::Percentiles;
use crate::mapping::intent::Level;
use crate::pipeline::{Phase, Pipeline};
use crate::quantity::Contact;
use crate::time::HostInstant;

/// What the bridge is doing.
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
    /// Contacts become events.
    Playing,
    /// Frames are lost, repeated or damaged, so that no contact is believed.
    Doubtful,
    /// A channel cannot be trusted.
    Faulty,
    /// The player paused.
    Paused,
    /// The pad cannot be played with.
    Refused,
}

impl State {
    pub(super) fn of(pipeline: &Pipeline, absence: Option<Absence>) -> Self {
        match (pipeline.phase(), absence) {
            (Phase::Paused, _) => Self::Paused,
            (_, Some(Absence::Denied)) => Self::Denied,
            (_, Some(Absence::Unclear)) => Self::Unclear,
            (_, Some(Absence::Gone)) => Self::Waiting,
            (Phase::Refused, None) => Self::Refused,
            (Phase::Waiting, None) => Self::Silent,
            (Phase::Taring, None) => Self::Taring,
            (Phase::Playing, None) => Self::Playing,
            (Phase::Doubtful, None) => Self::Doubtful,
            (Phase::Faulty, None) => Self::Faulty,
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
            Self::Playing => "playing",
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
            Self::Taring => "measuring the zero: leave the pad untouched for half a second",
            Self::Playing => "playing",
            Self::Doubtful => "frames are lost, repeated or damaged, nothing is pressed: check the line",
            Self::Faulty => {
                "a channel is saturated, stuck or without supply, nothing is pressed: check the pad"
            }
            Self::Paused => "paused",
            Self::Refused => "this pad cannot be played with: update tactpad, or check the pad's firmware",
        }
    }
}

/// What the bridge is doing, for a screen; renewed every 40 ms.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// What it is doing.
    pub state: State,
    /// The contact that is being mapped.
    pub contact: Option<Contact>,
    /// What is held.
    pub held: Vec<Level>,
    /// What the player should know of the touches.
    pub warning: Option<Warning>,
    /// What went wrong so far.
    pub health: Health,
    /// From bytes readable to write returned.
    pub latency: Percentiles,
    /// Host time of the snapshot.
    pub at: HostInstant,
}

/// The answer to `ctl status`.
#[derive(Debug, Serialize)]
pub(super) struct Status<'a> {
    pub(super) state: State,
    pub(super) pad: Option<&'a str>,
    pub(super) profile: &'a str,
    pub(super) decoder: &'a str,
    pub(super) output: String,
    pub(super) contact: Option<Contact>,
    pub(super) held: Vec<String>,
    pub(super) warning: Option<Warning>,
    pub(super) health: Health,
    pub(super) latency_us: Percentiles,
}

/// Says a state when it has lasted, so that a flicker is not told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Herald {
    told: State,
    candidate: State,
    since: HostInstant,
}

/// A state that lasts this long is told.
const LASTING_US: u64 = 1_000_000;

impl Herald {
    /// Nothing needs to be told while all is well.
    pub(super) const fn new(now: HostInstant) -> Self {
        Self { told: State::Playing, candidate: State::Playing, since: now }
    }

    /// The state to tell now, if there is one.
    pub(super) fn hear(&mut self, now: HostInstant, state: State) -> Option<State> {
        if state != self.candidate {
            (self.candidate, self.since) = (state, now);
        }
        let lasts = now.us_since(self.since) >= LASTING_US;
        (lasts && state != self.told).then(|| {
            self.told = state;
            state
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_lasts_is_told_and_only_once() {
        let at = |ms: u64| HostInstant::default().plus_us(ms * 1_000);
        let mut herald = Herald::new(at(0));
        let mut told = Vec::new();
        for ms in (0..6_000).step_by(40) {
            let state = match ms {
                0..2_000 if ms % 80 == 0 => State::Doubtful,
                0..2_000 => State::Playing,
                2_000..4_000 => State::Waiting,
                _ => State::Playing,
            };
            told.extend(herald.hear(at(ms), state).map(|state| (ms, state)));
        }
        assert_eq!(told, [(3_000, State::Waiting), (5_000, State::Playing)]);
    }
}
