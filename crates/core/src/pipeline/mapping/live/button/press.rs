//! One button's press: when it starts, ends, becomes long, comes twice, or no longer counts.

use super::gate::Touch;
use crate::pipeline::mapping::profile::{Action, Role};
use crate::time::StreamInstant;

/// Where a button stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TimedPress {
    /// Not pressed.
    Up,
    /// Pressed since then; `long` once it was stated as a long press.
    Down { since: StreamInstant, long: bool },
    /// A short press ended then, and a double press may come.
    Between { since: StreamInstant },
    /// Pressed a second time.
    Twice,
    /// The force is still on from a press that was forgotten; nothing happens until it was released once.
    Spent,
}

impl TimedPress {
    /// The kind of press that is on at `t`. One that `is_hold` is a long one by now, whatever its time.
    pub(crate) fn step(
        &mut self,
        action: &Action,
        t: StreamInstant,
        touch: Touch,
        is_hold: bool,
    ) -> Option<Role> {
        let Touch { is_on, is_in_place, .. } = touch;
        match *self {
            Self::Up if is_on && is_in_place => {
                *self = Self::Down { since: t, long: false };
                self.on(action, t, false)
            }
            Self::Between { since } => self.wait(action, since, t, is_on && is_in_place),
            // Who slides off a button has changed their mind: nothing is tapped.
            Self::Down { .. } | Self::Twice if !is_in_place => {
                *self = Self::Up;
                None
            }
            Self::Down { since, long } if !is_on => {
                *self = Self::Up;
                match action {
                    // One between whose long moment and its end no sample came is stated here, or it would be lost.
                    Action::ByTime { hold: Some(hold), .. } if is_hold || t.us_since(since) >= hold.us => {
                        (!long).then_some(Role::Hold)
                    }
                    _ if long => None,
                    Action::ByTime { double: Some(_), .. } => {
                        *self = Self::Between { since: t };
                        None
                    }
                    Action::ByTime { .. } => Some(Role::Tap),
                    Action::Hold(_) | Action::ByForce { .. } => None,
                }
            }
            Self::Twice | Self::Spent if !is_on => {
                *self = Self::Up;
                None
            }
            _ => self.on(action, t, is_hold),
        }
    }

    /// Forgets a press under way, and a short one that may become a double one: neither does anything any more.
    pub(crate) const fn forget(&mut self, is_on: bool) {
        *self = if is_on { Self::Spent } else { Self::Up };
    }

    /// Since when it is pressed, if it is open whether that is a short press or a long one.
    pub(crate) const fn undecided(&self) -> Option<StreamInstant> {
        match *self {
            Self::Down { since, long: false } => Some(since),
            _ => None,
        }
    }

    /// What a press under way is.
    fn on(&mut self, action: &Action, t: StreamInstant, is_hold: bool) -> Option<Role> {
        match (&mut *self, action) {
            (Self::Down { .. }, Action::Hold(_)) => Some(Role::Out),
            (Self::Down { since, long }, Action::ByTime { hold: Some(hold), .. }) => {
                *long |= is_hold || t.us_since(*since) >= hold.us;
                long.then_some(Role::Hold)
            }
            (Self::Twice, _) => Some(Role::Double),
            _ => None,
        }
    }

    /// What comes of a short press that a second one may follow.
    fn wait(
        &mut self,
        action: &Action,
        since: StreamInstant,
        t: StreamInstant,
        pressed: bool,
    ) -> Option<Role> {
        let window_us = match action {
            Action::ByTime { double: Some(double), .. } => double.us,
            Action::ByTime { .. } | Action::Hold(_) | Action::ByForce { .. } => 0,
        };
        let is_over = t.us_since(since) >= window_us;
        match (is_over, pressed) {
            (false, true) => *self = Self::Twice,
            (false, false) => {}
            (true, true) => *self = Self::Down { since: t, long: false },
            (true, false) => *self = Self::Up,
        }
        match (is_over, pressed) {
            (true, _) => Some(Role::Tap),
            (false, true) => Some(Role::Double),
            (false, false) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::mapping::live::button::gate::{Gate, Thresholds};
    use crate::pipeline::mapping::profile::{Effect, HoldOn, Keys, Mode, Output, TimedEffect};

    const OUT: Option<Role> = Some(Role::Out);
    const TAP: Option<Role> = Some(Role::Tap);
    const HOLD: Option<Role> = Some(Role::Hold);
    const DOUBLE: Option<Role> = Some(Role::Double);

    const THRESHOLDS: Thresholds = Thresholds { press_n: 2.0, release_n: 1.5, hair_n: None };

    /// A button with these times in milliseconds.
    fn by_time(double_ms: Option<u64>, hold_ms: Option<u64>) -> Action {
        let effect = Effect { output: Output::Keys(Keys::new([])), mode: Mode::Plain };
        let [double, hold] =
            [double_ms, hold_ms].map(|ms| ms.map(|ms| TimedEffect { effect, us: 1_000 * ms }));
        Action::ByTime { tap: effect, double, hold, hold_on: HoldOn::Time }
    }

    /// Steps a fresh press through (milliseconds, force) and returns what was on at each step.
    fn played(action: &Action, steps: &[(u64, Option<f32>)]) -> Vec<Option<Role>> {
        let (mut press, mut gate) = (TimedPress::Up, Gate::Off);
        steps.iter().map(|step| stepped((&mut press, &mut gate), action, *step)).collect()
    }

    fn stepped(
        (press, gate): (&mut TimedPress, &mut Gate),
        action: &Action,
        (ms, force_n): (u64, Option<f32>),
    ) -> Option<Role> {
        let is_on = gate.step(THRESHOLDS, force_n);
        press.step(
            action,
            StreamInstant::from_us(ms * 1_000),
            Touch { is_on, is_hard: false, is_in_place: true },
            false,
        )
    }

    #[test]
    fn a_hold_button_follows_the_press() {
        let button = Action::Hold(Effect { output: Output::Keys(Keys::new([])), mode: Mode::Plain });
        let steps = [
            (0, Some(1.99)),
            (1, Some(2.0)),
            (2, Some(1.5)),
            (3, Some(1.49)),
            (4, Some(1.99)),
            (5, Some(2.5)),
        ];
        assert_eq!(played(&button, &steps), [None, OUT, OUT, None, None, OUT]);
        assert_eq!(played(&button, &[(0, Some(3.0)), (1, None), (2, None)]), [OUT, None, None]);
    }

    #[test]
    fn a_press_taps_below_the_long_press_and_holds_from_there() {
        let button = by_time(None, Some(400));
        assert_eq!(played(&button, &[(7, Some(2.0)), (406, None), (407, None)]), [None, TAP, None]);
        assert_eq!(
            played(
                &button,
                &[(0, Some(2.0)), (399, Some(2.0)), (400, Some(1.6)), (401, Some(1.0)), (402, None)]
            ),
            [None, None, HOLD, None, None]
        );
        assert_eq!(played(&button, &[(0, Some(2.0)), (400, None), (401, None)]), [None, HOLD, None]);
    }

    #[test]
    fn a_forgotten_press_does_nothing_until_released() {
        let button = by_time(None, Some(400));
        let mut press = TimedPress::Down { since: StreamInstant::from_us(0), long: false };
        press.forget(true);
        let mut gate = Gate::On { highest_n: 2.5 };
        let mut step = |ms, force_n| stepped((&mut press, &mut gate), &button, (ms, force_n));
        assert_eq!([step(10, Some(2.5)), step(900, Some(1.5)), step(901, Some(1.0))], [None; 3]);
        assert_eq!([step(902, Some(2.0)), step(903, Some(1.0))], [None, TAP]);
    }

    #[test]
    fn a_second_press_in_time_is_a_double_one() {
        let button = by_time(Some(300), None);
        let short = [(0, Some(2.0)), (100, None)];
        let then = |rest: &[(u64, Option<f32>)]| played(&button, &[&short, rest].concat())[2..].to_vec();
        assert_eq!(then(&[(399, Some(2.0)), (5_000, Some(1.5)), (5_001, None)]), [DOUBLE, DOUBLE, None]);
        assert_eq!(then(&[(399, None), (400, None), (401, None)]), [None, TAP, None]);
        // Too late: the first press taps, and this one is the first of its own.
        assert_eq!(then(&[(400, Some(2.0)), (410, None), (420, Some(2.0))]), [TAP, None, DOUBLE]);
        // Two double presses in a row are four presses.
        assert_eq!(
            then(&[(110, Some(2.0)), (120, None), (130, Some(2.0)), (140, None)]),
            [DOUBLE, None, None, None]
        );
    }

    #[test]
    fn a_long_press_is_no_first_of_two() {
        let button = by_time(Some(300), Some(400));
        let steps =
            [(0, Some(2.0)), (400, Some(2.0)), (500, None), (510, Some(2.0)), (600, None), (900, None)];
        assert_eq!(played(&button, &steps), [None, HOLD, None, None, None, TAP]);
    }

    #[test]
    fn a_forgotten_short_press_never_taps() {
        let button = by_time(Some(300), None);
        let mut press = TimedPress::Between { since: StreamInstant::from_us(0) };
        press.forget(false);
        assert_eq!(stepped((&mut press, &mut Gate::Off), &button, (300, None)), None);
    }

    #[test]
    fn who_slides_off_taps_nothing() {
        let button = by_time(None, None);
        let mut press = TimedPress::Down { since: StreamInstant::from_us(0), long: false };
        let touch = |is_in_place| Touch { is_on: true, is_hard: false, is_in_place };
        assert_eq!(press.step(&button, StreamInstant::from_us(1_000), touch(false), false), None);
        assert_eq!(press, TimedPress::Up);
        assert_eq!(press.step(&button, StreamInstant::from_us(2_000), touch(true), false), None);
        assert!(matches!(press, TimedPress::Down { .. }), "who slides back presses anew");
    }
}
