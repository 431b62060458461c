//! Which directions count: those that the place of the contact asks for, as far as Slow Keys and Bounce Keys let them.

use super::verdict::{Verdict, VerdictEvent, Verdicts};
use crate::pipeline::mapping::live::button::accept::{Accept, Conditions, Presses};
use crate::pipeline::mapping::live::button::gate::Touch;
use crate::pipeline::mapping::profile::sector::Sector;
use crate::pipeline::mapping::profile::{Access, Direction};
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// Horizontal ones first: that is the order of the output.
pub(crate) const DIRECTIONS: [Direction; 4] =
    [Direction::Left, Direction::Right, Direction::Up, Direction::Down];

/// Where each direction stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectionGates {
    accepts: [Accept; DIRECTIONS.len()],
}

/// Directions that are on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Directions([bool; DIRECTIONS.len()]);

impl DirectionGates {
    /// None was ever on.
    pub(crate) const fn fresh() -> Self {
        Self { accepts: [Accept::NEVER; DIRECTIONS.len()] }
    }

    /// Goes on to `t`, where the contact is in `sector`; the directions that count. Of those that could be rejected it is told what became
    /// of them.
    pub(crate) fn step(
        &mut self,
        access: Access,
        t: StreamInstant,
        sector: Option<Sector>,
        contact: Option<&Contact>,
        presses: &mut Presses,
        verdicts: &mut Verdicts,
    ) -> Directions {
        let conditions = Conditions { access, dwell: None, resumes: true };
        let may_reject = [access.slow_us, access.bounce_us] != [0, 0];
        let mut on = Directions::default();
        for ((direction, accept), is_on) in DIRECTIONS.into_iter().zip(&mut self.accepts).zip(&mut on.0) {
            let is_asked = sector.is_some_and(|sector| sector.has(direction));
            let touch = Touch { is_on: is_asked, is_hard: false, is_in_place: true };
            let before = *presses;
            *is_on = accept.step(conditions, t, touch, contact, presses);
            if let Some(is_rejected) = presses.since(before).filter(|_| may_reject) {
                let rejected = is_rejected.then(|| accept.why_rejected(conditions, t));
                verdicts.keep(Verdict { t, told: VerdictEvent::Direction { direction, rejected } });
            }
        }
        on
    }
}

impl Directions {
    /// In the order of the output.
    pub(crate) fn iter(self) -> impl Iterator<Item = Direction> {
        DIRECTIONS.into_iter().zip(self.0).filter(|(_, is_on)| *is_on).map(|(direction, _)| direction)
    }

    /// Whether it is among them.
    pub(crate) fn has(self, direction: Direction) -> bool {
        self.iter().any(|it| it == direction)
    }

    /// Whether there are none.
    pub(crate) fn is_empty(self) -> bool {
        self.iter().next().is_none()
    }
}
