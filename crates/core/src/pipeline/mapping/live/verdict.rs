//! What became of each press, and when a hand began to rest: for people who want to hear or see it.

use arrayvec::ArrayVec;
use serde::Serialize;

use crate::pipeline::mapping::profile::Direction;
use crate::time::StreamInstant;

/// So many are kept until somebody takes them: more than a read of the pad's bytes brings.
const KEPT_MAX: usize = 64;

/// Why a press did not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Reason {
    /// It was shorter than Slow Keys ask for.
    Slow,
    /// It came too soon after the last one of its button or direction, for Bounce Keys.
    Bounce,
    /// The finger did not rest for long enough.
    Dwell,
}

/// What became of a press, or of a hand that lies on the pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Stream time at which it was clear.
    pub t: StreamInstant,
    /// What is told.
    pub told: VerdictEvent,
}

/// What a verdict tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VerdictEvent {
    /// A press of a button.
    Button {
        /// Counted from 1 in the file's order.
        number: usize,
        /// Why it did not count; `None` if it did.
        rejected: Option<Reason>,
    },
    /// A direction that Slow Keys or Bounce Keys may reject; without them every one counts, and none is told.
    Direction {
        /// Which one.
        direction: Direction,
        /// Why it did not count; `None` if it did.
        rejected: Option<Reason>,
    },
    /// A load that would be a touch is taken for a hand that rests. Told once after a lift or a touch, when it has lasted as long as the
    /// profile gives a load to settle.
    Rest,
}

/// What became of the presses since somebody looked.
#[derive(Clone, Debug, Default)]
pub(crate) struct Verdicts {
    kept: ArrayVec<Verdict, KEPT_MAX>,
}

impl Verdicts {
    /// Keeps one more, as long as there is room.
    pub(crate) fn keep(&mut self, verdict: Verdict) {
        // Who never looks misses those that came late.
        let _ = self.kept.try_push(verdict);
    }

    /// The oldest first.
    pub(crate) fn all(&self) -> &[Verdict] {
        &self.kept
    }

    /// Forgets them.
    pub(crate) fn clear(&mut self) {
        self.kept.clear();
    }
}
