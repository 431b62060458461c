//! One button's press: when it starts, ends, becomes long, or no longer counts.

use super::profile::{Action, Binding, Button};
use crate::time::StreamInstant;

/// Where a button stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Press {
    /// Not pressed.
    Up,
    /// Pressed since then; `long` once the long press's output was stated.
    Down { since: StreamInstant, long: bool },
    /// The force is still on from a press that was forgotten; nothing happens until it was released once.
    Spent,
}

impl Press {
    /// What the button holds at `t`, given its force; `None` for the force means that the contact has ended.
    pub(super) fn step(
        &mut self,
        button: &Button,
        t: StreamInstant,
        force_n: Option<f32>,
    ) -> Option<Binding> {
        let released = force_n.is_none_or(|force_n| force_n < button.release_n);
        let pressed = force_n.is_some_and(|force_n| force_n >= button.press_n);
        match *self {
            Self::Up if pressed => {
                *self = Self::Down { since: t, long: false };
                self.hold(button, t)
            }
            Self::Down { since, long } if released => {
                *self = Self::Up;
                on_release(button.action, t.us_since(since), long)
            }
            Self::Spent if released => {
                *self = Self::Up;
                None
            }
            _ => self.hold(button, t),
        }
    }

    /// Forgets a press under way: it neither taps nor holds any more.
    pub(super) fn forget(&mut self) {
        if self.is_under_way() {
            *self = Self::Spent;
        }
    }

    /// Whether the force is on, counting or not.
    pub(super) const fn is_under_way(self) -> bool {
        !matches!(self, Self::Up)
    }

    fn hold(&mut self, button: &Button, t: StreamInstant) -> Option<Binding> {
        let Self::Down { since, long } = self else { return None };
        match button.action {
            Action::Hold(out) => Some(out),
            Action::TapHold { hold, long_press_us, .. } => {
                *long |= t.us_since(*since) >= long_press_us;
                long.then_some(hold)
            }
        }
    }
}

/// What a press that lasted `lasted_us` states in the step that ends it.
///
/// A long press between whose long moment and its end no sample came states its output here, or it would be
/// lost.
fn on_release(action: Action, lasted_us: u64, long: bool) -> Option<Binding> {
    match action {
        Action::TapHold { tap, long_press_us, .. } if lasted_us < long_press_us => Some(tap),
        Action::TapHold { hold, .. } if !long => Some(hold),
        Action::Hold(_) | Action::TapHold { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::control::{Code, OutputDevice};
    use crate::pipeline::mapping::profile::Force;

    const TAP: Binding = Binding { device: OutputDevice::Gamepad, code: Code::Key(1), value: 1 };
    const HOLD: Binding = Binding { device: OutputDevice::Gamepad, code: Code::Key(2), value: 1 };

    const fn button(action: Action) -> Button {
        Button { force: Force::Fz, press_n: 2.0, release_n: 1.5, action }
    }

    /// Steps a fresh press through (milliseconds, force) and returns what each step held.
    fn played(button: &Button, steps: &[(u64, Option<f32>)]) -> Vec<Option<Binding>> {
        let mut press = Press::Up;
        steps
            .iter()
            .map(|(ms, force_n)| press.step(button, StreamInstant::from_us(ms * 1_000), *force_n))
            .collect()
    }

    #[test]
    fn a_hold_button_follows_the_press() {
        let button = button(Action::Hold(HOLD));
        let steps = [
            (0, Some(1.99)),
            (1, Some(2.0)),
            (2, Some(1.5)),
            (3, Some(1.49)),
            (4, Some(1.99)),
            (5, Some(2.5)),
        ];
        assert_eq!(played(&button, &steps), [None, Some(HOLD), Some(HOLD), None, None, Some(HOLD)]);
        assert_eq!(played(&button, &[(0, Some(3.0)), (1, None), (2, None)]), [Some(HOLD), None, None]);
    }

    #[test]
    fn a_press_taps_below_the_long_press_and_holds_from_there() {
        let button = button(Action::TapHold { tap: TAP, hold: HOLD, long_press_us: 400_000 });
        assert_eq!(played(&button, &[(7, Some(2.0)), (406, None), (407, None)]), [None, Some(TAP), None]);
        assert_eq!(
            played(
                &button,
                &[(0, Some(2.0)), (399, Some(2.0)), (400, Some(1.6)), (401, Some(1.0)), (402, None)]
            ),
            [None, None, Some(HOLD), None, None]
        );
        assert_eq!(played(&button, &[(0, Some(2.0)), (400, None), (401, None)]), [None, Some(HOLD), None]);
    }

    #[test]
    fn a_forgotten_press_does_nothing_until_released() {
        let button = button(Action::TapHold { tap: TAP, hold: HOLD, long_press_us: 400_000 });
        let mut press = Press::Down { since: StreamInstant::from_us(0), long: false };
        press.forget();
        let mut step = |ms: u64, force_n| press.step(&button, StreamInstant::from_us(ms * 1_000), force_n);
        assert_eq!([step(10, Some(2.5)), step(900, Some(1.5)), step(901, Some(1.0))], [None; 3]);
        assert_eq!([step(902, Some(2.0)), step(903, Some(1.0))], [None, Some(TAP)]);
    }
}
