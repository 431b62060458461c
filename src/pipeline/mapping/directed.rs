//! Which directions count: those that the place of the contact asks for, as far as Slow Keys and Bounce Keys let them.

use super::accept::{Accept, Conditions, Presses};
use super::gate::Touch;
use super::profile::{Access, Direction};
use super::sector::Sector;
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// Horizontal ones first: that is the order of the output.
const DIRECTIONS: [Direction; 4] = [Direction::Left, Direction::Right, Direction::Up, Direction::Down];

/// Where each direction stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Directed {
    accepts: [Accept; DIRECTIONS.len()],
}

/// Directions that are on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Directions([bool; DIRECTIONS.len()]);

impl Directed {
    /// None was ever on.
    pub(super) const fn fresh() -> Self {
        Self { accepts: [Accept::Off { since: None }; DIRECTIONS.len()] }
    }

    /// Goes on to `t`, where the contact is in `sector`; the directions that count.
    pub(super) fn step(
        &mut self,
        access: Access,
        t: StreamInstant,
        (sector, contact): (Option<Sector>, Option<&Contact>),
        presses: &mut Presses,
    ) -> Directions {
        let conditions = Conditions { access, dwell: None };
        let mut on = Directions::default();
        for ((direction, accept), is_on) in DIRECTIONS.into_iter().zip(&mut self.accepts).zip(&mut on.0) {
            let is_asked = sector.is_some_and(|sector| sector.has(direction));
            let touch = Touch { is_on: is_asked, is_hard: false, is_in_place: true };
            *is_on = accept.step(conditions, t, (touch, contact), presses);
        }
        on
    }
}

impl Directions {
    /// In the order of the output.
    pub(super) fn iter(self) -> impl Iterator<Item = Direction> {
        DIRECTIONS.into_iter().zip(self.0).filter(|(_, is_on)| *is_on).map(|(direction, _)| direction)
    }

    /// Whether it is among them.
    pub(super) fn has(self, direction: Direction) -> bool {
        self.iter().any(|it| it == direction)
    }

    /// Whether there are none.
    pub(super) fn is_empty(self) -> bool {
        self.iter().next().is_none()
    }
}
