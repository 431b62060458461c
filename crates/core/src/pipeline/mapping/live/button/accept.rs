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
    /// Off since a press ended then, if ever one did.
    Off { since: Option<StreamInstant> },
    /// On since then, and near this place in millimetres; it does not count yet.
    Waiting { since: StreamInstant, place_mm: [f32; 2], ended: Option<StreamInstant> },
    /// It counts.
    Accepted,
    /// It came too soon after the last one, which ended then.
    Rejected { ended: Option<StreamInstant> },
}

/// What a press is asked for before it counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions {
    pub(crate) access: Access,
    pub(crate) dwell: Option<Dwell>,
}

impl Accept {
    /// Whether what is on counts at `t`. Who has left the button's place, or lets go, has to begin anew.
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
            Self::Off { since: ended } if is_on => begun(conditions, t, place_mm, ended),
            Self::Waiting { since, place_mm: from_mm, ended } if is_on => {
                let is_still =
                    conditions.dwell.is_none_or(|dwell| is_near(from_mm, place_mm, dwell.radius_mm));
                match (is_still, t.us_since(since) >= wait_us(conditions)) {
                    (false, _) => Self::Waiting { since: t, place_mm, ended },
                    (true, true) => Self::Accepted,
                    (true, false) => before,
                }
            }
            Self::Accepted if !touch.is_on || !touch.is_in_place => Self::Off { since: Some(t) },
            Self::Waiting { ended, .. } | Self::Rejected { ended } if !is_on => Self::Off { since: ended },
            other => other,
        };
        presses.accepted += u64::from(*self == Self::Accepted && before != Self::Accepted);
        let is_refused = matches!(*self, Self::Rejected { .. }) && before != *self
            || matches!((before, *self), (Self::Waiting { .. }, Self::Off { .. }));
        presses.rejected += u64::from(is_refused);
        *self == Self::Accepted
    }

    /// Why what it stands for does not count, if it was rejected just now.
    pub(crate) const fn why_rejected(self, Conditions { access, dwell }: Conditions) -> Reason {
        match (self, dwell) {
            (Self::Rejected { .. }, _) => Reason::Bounce,
            (_, Some(dwell)) if dwell.us > access.slow_us => Reason::Dwell,
            _ => Reason::Slow,
        }
    }

    /// Forgets what waits.
    pub(crate) const fn forget(&mut self) {
        *self = Self::Off { since: None };
    }
}

/// How long a force must be on before it counts.
const fn wait_us(Conditions { access, dwell }: Conditions) -> u64 {
    match dwell {
        Some(dwell) if dwell.us > access.slow_us => dwell.us,
        _ => access.slow_us,
    }
}

/// A force that comes on.
fn begun(
    conditions: Conditions,
    t: StreamInstant,
    place_mm: [f32; 2],
    ended: Option<StreamInstant>,
) -> Accept {
    match ended {
        Some(ended) if t.us_since(ended) < conditions.access.bounce_us => {
            Accept::Rejected { ended: Some(ended) }
        }
        _ if wait_us(conditions) == 0 => Accept::Accepted,
        _ => Accept::Waiting { since: t, place_mm, ended },
    }
}

fn is_near([ax, ay]: [f32; 2], [bx, by]: [f32; 2], radius_mm: f32) -> bool {
    libm::hypotf(ax - bx, ay - by) <= radius_mm
}
