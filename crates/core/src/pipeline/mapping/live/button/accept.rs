//! Whether a force that is on counts as a press: Slow Keys, Bounce Keys, dwell.

use serde::Serialize;

use super::gate::Touch;
use crate::pipeline::mapping::live::verdict::Reason;
use crate::pipeline::mapping::profile::{Access, Dwell};
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// How many presses counted, and how many did not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Presses {
    /// Those that did.
    pub accepted: u64,
    /// Those that were too short, too soon, or moved about.
    pub rejected: u64,
}

impl Presses {
    /// What was added since `before`: nothing, or a press, and whether it was rejected.
    pub(crate) fn since(self, before: Self) -> Option<bool> {
        (self != before).then_some(self.rejected > before.rejected)
    }
}

/// Where a force stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Accept {
    /// Off since a press ended then, if ever one did; `stays` while the finger has been on the pad ever since.
    Off { ended: Option<StreamInstant>, stays: bool },
    /// On, and near this place in millimetres; it counts from `due` on.
    Waiting { due: StreamInstant, place_mm: [f32; 2], ended: Option<StreamInstant> },
    /// It counts.
    Accepted,
}

/// What a press is asked for before it counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions {
    pub(crate) access: Access,
    pub(crate) dwell: Option<Dwell>,
    /// Whether a finger that strayed and stays on the pad goes on with its press: it waits as long as it was away, no longer.
    pub(crate) resumes: bool,
}

impl Accept {
    /// Nothing was ever on.
    pub(crate) const NEVER: Self = Self::Off { ended: None, stays: false };

    /// Whether what is on counts at `t`. Who has left the button's place, or lets go, has to begin anew. A press that came too soon
    /// and lasts counts when it would not have come too soon.
    pub(crate) fn step(
        &mut self,
        conditions: Conditions,
        t: StreamInstant,
        touch: Touch,
        contact: Option<&Contact>,
        presses: &mut Presses,
    ) -> bool {
        let is_on = touch.is_on && touch.is_in_place;
        let place_mm = contact.map_or([0.0; 2], |contact| [contact.x_mm, contact.y_mm]);
        let before = *self;
        *self = match before {
            Self::Off { ended, stays } if is_on => {
                let due = conditions.due(t, ended, stays);
                if due <= t { Self::Accepted } else { Self::Waiting { due, place_mm, ended } }
            }
            Self::Off { ended, stays } => Self::Off { ended, stays: stays && contact.is_some() },
            Self::Waiting { ended, .. } if !is_on => Self::Off { ended, stays: false },
            Self::Waiting { due, place_mm: from_mm, ended } => {
                let moved =
                    conditions.dwell.is_some_and(|dwell| !is_near(from_mm, place_mm, dwell.radius_mm));
                match (moved, due <= t) {
                    (true, _) => Self::Waiting { due: conditions.due(t, ended, false), place_mm, ended },
                    (false, true) => Self::Accepted,
                    (false, false) => before,
                }
            }
            Self::Accepted if !is_on => Self::Off { ended: Some(t), stays: contact.is_some() },
            Self::Accepted => Self::Accepted,
        };
        presses.accepted += u64::from(*self == Self::Accepted && before != Self::Accepted);
        presses.rejected += u64::from(matches!((before, *self), (Self::Waiting { .. }, Self::Off { .. })));
        *self == Self::Accepted
    }

    /// Why what was on until `t` does not count, if it was rejected just now.
    pub(crate) fn why_rejected(self, conditions: Conditions, t: StreamInstant) -> Reason {
        let Conditions { access, dwell, .. } = conditions;
        match (self, dwell) {
            (Self::Off { ended: Some(ended), .. }, _) if t.us_since(ended) < access.bounce_us => {
                Reason::Bounce
            }
            (_, Some(dwell)) if dwell.us > access.slow_us => Reason::Dwell,
            _ => Reason::Slow,
        }
    }

    /// Forgets what waits.
    pub(crate) const fn forget(&mut self) {
        *self = Self::NEVER;
    }
}

impl Conditions {
    /// When a force that comes on at `t` counts, if it lasts.
    fn due(self, t: StreamInstant, ended: Option<StreamInstant>, stays: bool) -> StreamInstant {
        let Self { access, dwell, resumes } = self;
        let wait_us = match (dwell, ended) {
            (Some(dwell), _) if dwell.us > access.slow_us => dwell.us,
            (_, Some(ended)) if resumes && stays => access.slow_us.min(t.us_since(ended)),
            _ => access.slow_us,
        };
        let no_bounce = ended.map_or(t, |ended| ended.plus_us(access.bounce_us));
        t.plus_us(wait_us).max(no_bounce)
    }
}

fn is_near([ax, ay]: [f32; 2], [bx, by]: [f32; 2], radius_mm: f32) -> bool {
    libm::hypotf(ax - bx, ay - by) <= radius_mm
}
