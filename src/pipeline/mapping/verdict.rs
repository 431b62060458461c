//! What became of each press: for people who want to hear or see it.

use arrayvec::ArrayVec;
use serde::Serialize;

use crate::time::StreamInstant;

/// So many are kept until somebody takes them: more than a read of the pad's bytes brings.
const KEPT_MAX: usize = 64;

/// Why a press did not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Reason {
    /// It was shorter than Slow Keys ask for.
    Slow,
    /// It came too soon after the last one of its button, for Bounce Keys.
    Bounce,
    /// The finger did not rest for long enough.
    Dwell,
}

/// What became of a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Stream time at which it was clear.
    pub t: StreamInstant,
    /// The button, counted from 1 in the file's order.
    pub button: usize,
    /// Why it did not count; `None` if it did.
    pub rejected: Option<Reason>,
}

/// What became of the presses since somebody looked.
#[derive(Clone, Debug, Default)]
pub(super) struct Verdicts {
    kept: ArrayVec<Verdict, KEPT_MAX>,
}

impl Verdicts {
    /// Keeps one more, as long as there is room.
    pub(super) fn keep(&mut self, verdict: Verdict) {
        // Who never looks misses those that came late.
        let _ = self.kept.try_push(verdict);
    }

    /// The oldest first.
    pub(super) fn all(&self) -> &[Verdict] {
        &self.kept
    }

    /// Forgets them.
    pub(super) fn clear(&mut self) {
        self.kept.clear();
    }
}
