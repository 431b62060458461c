//! Presses that may still become a tap or a hold, and what another press makes of them.

use std::ops::BitOr;

use super::button::Ruling;
use super::directions::{DIRECTIONS, Directions};
use crate::pipeline::mapping::profile::{BUTTONS_MAX, Direction, HoldOn};

/// Presses of buttons and directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PressSet(u32);

/// A press under way of which it is open whether it is a tap or a hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Undecided {
    /// The number of its button, from 0 on.
    pub(crate) button: usize,
    /// What makes it a hold besides its time.
    pub(crate) hold_on: HoldOn,
    /// Whether its time is over.
    pub(crate) is_due: bool,
    /// The layer that is on if it is one.
    pub(crate) layer: Option<usize>,
}

/// What comes of all presses in one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Decision {
    /// Those that are a hold from now on.
    pub(crate) holds: PressSet,
    /// Those that wait until one before them is decided.
    pub(crate) withheld: PressSet,
    /// Those that waited and are over by now: they begin and end in this step.
    pub(crate) replayed: PressSet,
}

/// Which presses are on, and which of them wait.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Interrupts {
    on: PressSet,
    withheld: PressSet,
}

impl Interrupts {
    /// Where presses stand when another profile takes over: what is on did not begin now.
    pub(crate) const fn taken_over() -> Self {
        Self { on: PressSet(u32::MAX), withheld: PressSet::NONE }
    }

    /// Goes on to the presses that are `on` now; what comes of them and of those that were `undecided` before.
    pub(crate) fn step(&mut self, on: PressSet, undecided: &[Undecided]) -> Decision {
        let begun = on.without(self.on);
        let ended = self.withheld.without(on);
        let (mut holds, mut must_wait) = (PressSet::NONE, false);
        for it in undecided {
            let own = PressSet::button(it.button);
            let is_interrupted = match it.hold_on {
                HoldOn::Time => false,
                HoldOn::OtherPress => on.has(own) && begun != PressSet::NONE,
                HoldOn::NestedPress => ended != PressSet::NONE,
            };
            if it.is_due || is_interrupted {
                holds = holds | own;
            } else {
                must_wait |= it.hold_on == HoldOn::NestedPress;
            }
        }
        let withheld = if must_wait { self.withheld | begun } else { PressSet::NONE };
        *self = Self { on, withheld };
        Decision { holds, withheld, replayed: if must_wait { PressSet::NONE } else { ended } }
    }
}

impl Decision {
    /// What it comes to for the press of the button of this number.
    pub(crate) const fn of(self, button: usize) -> Ruling {
        let own = PressSet::button(button);
        match (self.holds.has(own), self.withheld.has(own), self.replayed.has(own)) {
            (true, ..) => Ruling::Hold,
            (_, true, _) => Ruling::Withheld,
            (.., true) => Ruling::Replayed,
            (false, false, false) => Ruling::Free,
        }
    }

    /// The directions to state, of those that are on.
    pub(crate) fn directions(self, on: Directions) -> impl Iterator<Item = Direction> {
        let is_stated = move |direction: &Direction| {
            let own = PressSet::direction(*direction);
            (on.has(*direction) && !self.withheld.has(own)) || self.replayed.has(own)
        };
        DIRECTIONS.into_iter().filter(is_stated)
    }
}

impl PressSet {
    /// No press.
    pub(crate) const NONE: Self = Self(0);

    /// The press of the button of this number, from 0 on.
    pub(crate) const fn button(number: usize) -> Self {
        Self(1 << number)
    }

    /// These directions.
    pub(crate) fn directions(on: Directions) -> Self {
        on.iter().map(Self::direction).fold(Self::NONE, BitOr::bitor)
    }

    const fn direction(direction: Direction) -> Self {
        Self(1 << (BUTTONS_MAX + direction as usize))
    }

    /// Whether one of those is among these.
    pub(crate) const fn has(self, those: Self) -> bool {
        self.0 & those.0 != 0
    }

    const fn without(self, those: Self) -> Self {
        Self(self.0 & !those.0)
    }
}

impl BitOr for PressSet {
    type Output = Self;

    fn bitor(self, those: Self) -> Self {
        Self(self.0 | those.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes of a press of button 0 in a second step, where these buttons are on (1 and 2 are others).
    fn decided(hold_on: HoldOn, steps: [u32; 2]) -> Decision {
        let mut interrupts = Interrupts { on: PressSet(1), withheld: PressSet::NONE };
        let undecided = [Undecided { button: 0, hold_on, is_due: false, layer: None }];
        interrupts.step(PressSet(steps[0]), &undecided);
        interrupts.step(PressSet(steps[1]), &undecided)
    }

    #[test]
    fn a_press_inside_another_makes_that_a_hold_and_is_played_then() {
        let nested = decided(HoldOn::NestedPress, [0b011, 0b001]);
        assert_eq!((nested.holds, nested.withheld, nested.replayed), (PressSet(1), PressSet(0), PressSet(2)));
        // Both end with the same sample: the finger was lifted.
        assert_eq!(decided(HoldOn::NestedPress, [0b011, 0b000]).holds, PressSet(1));
        let open = decided(HoldOn::NestedPress, [0b011, 0b111]);
        assert_eq!((open.holds, open.withheld, open.replayed), (PressSet(0), PressSet(6), PressSet(0)));
        // It ends first: a tap, and the other one waits for the next sample.
        let rolled = decided(HoldOn::NestedPress, [0b011, 0b010]);
        assert_eq!((rolled.holds, rolled.withheld), (PressSet(0), PressSet(2)));
    }

    #[test]
    fn any_other_press_makes_it_a_hold_if_that_is_asked_for() {
        let other = decided(HoldOn::OtherPress, [0b001, 0b101]);
        assert_eq!((other.holds, other.withheld), (PressSet(1), PressSet(0)));
        assert_eq!(decided(HoldOn::OtherPress, [0b001, 0b100]).holds, PressSet(0), "it has ended");
        assert_eq!(decided(HoldOn::Time, [0b001, 0b101]).holds, PressSet(0));
    }
}
