//! A hand's way through time: touches and pauses, one after the other.

use crate::quantity::Contact;
use crate::virtual_pad::script::{Keyframe, Script};

/// Places lie within so far of the centre unless somebody wants them nearer.
pub const WITHIN_MM: f32 = 26.0;

/// The hardest press.
pub const FORCE_MAX_N: f32 = 5.0;

/// Shorter play would have no room for a touch.
pub const LEAST_US: u64 = 5_000_000;

/// Nothing touches the pad for at least so long in the beginning, so that its zero is found.
const REST_FIRST_US: u64 = 1_000_000;
/// Nor in the end.
const REST_LAST_US: u64 = 500_000;

/// The finger goes to a contact smoothly, and stays there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Move {
    pub(super) to: Contact,
    pub(super) ramp_us: u64,
    pub(super) stay_us: u64,
}

/// What was done so far.
#[derive(Clone, Debug)]
pub(super) struct GestureHistory {
    keyframes: Vec<Keyframe>,
    now_us: u64,
    end_us: u64,
}

impl GestureHistory {
    /// A course that takes so long with its rests.
    pub(super) const fn new(duration_us: u64) -> Self {
        let end_us = duration_us.saturating_sub(REST_LAST_US);
        Self { keyframes: Vec::new(), now_us: REST_FIRST_US, end_us }
    }

    /// Adds a touch after a pause; `false` where it takes longer than there is time, and nothing is added.
    pub(super) fn touch(&mut self, pause_us: u64, moves: &[Move], lift_us: u64) -> bool {
        let lasts_us: u64 = moves.iter().map(|step| step.ramp_us + step.stay_us).sum();
        let [Some(first), Some(last)] = [moves.first(), moves.last()] else { return false };
        if self.now_us + pause_us + lasts_us + lift_us > self.end_us {
            return false;
        }
        self.reach(pause_us, lifted(&first.to));
        for Move { to, ramp_us, stay_us } in moves {
            self.reach(*ramp_us, *to);
            self.reach(*stay_us, *to);
        }
        self.reach(lift_us, lifted(&last.to));
        true
    }

    fn reach(&mut self, after_us: u64, contact: Contact) {
        self.now_us += after_us;
        self.keyframes.push(Keyframe { at_us: self.now_us, contact });
    }

    pub(super) fn script(self) -> Script {
        Script::of(self.keyframes)
    }
}

/// The place alone.
fn lifted(contact: &Contact) -> Contact {
    Contact { x_mm: contact.x_mm, y_mm: contact.y_mm, ..Contact::default() }
}
