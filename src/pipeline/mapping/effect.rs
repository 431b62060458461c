//! How a button's keys follow its kinds of press: down as long as they last, toggled, or again and again.

use super::profile::{Binding, Button, Mode, Role};
use crate::time::StreamInstant;

/// What goes on at a button.
#[derive(Clone, Copy, Debug)]
pub(super) struct Playing {
    /// The kind of press that is on.
    role: Option<Role>,
    /// Since when.
    since: StreamInstant,
    /// The kinds whose keys were toggled down.
    toggled: [bool; Role::ALL.len()],
}

impl Playing {
    /// Nothing.
    pub(super) const fn nothing() -> Self {
        Self { role: None, since: StreamInstant::from_us(0), toggled: [false; Role::ALL.len()] }
    }

    /// Goes on to `role` at `t`; the bindings that are then down.
    pub(super) fn step(
        &mut self,
        button: &Button,
        t: StreamInstant,
        role: Option<Role>,
    ) -> impl Iterator<Item = Binding> + use<> {
        let begins = role != self.role;
        if begins {
            (self.role, self.since) = (role, t);
        }
        let lasts_us = t.us_since(self.since);
        let mut down = button.effects();
        for ((own, toggled), effect) in Role::ALL.into_iter().zip(&mut self.toggled).zip(&mut down) {
            let is_on = role == Some(own);
            *toggled ^= begins && is_on;
            *effect = effect.filter(|effect| match effect.mode {
                Mode::Plain => is_on,
                Mode::Toggle => *toggled,
                // Down in [0, T/2) of each period T.
                Mode::Turbo { period_us } => is_on && 2 * (lasts_us % period_us.max(1)) < period_us,
            });
        }
        down.into_iter().flatten().flat_map(|effect| effect.keys.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::control::{Code, OutputDevice};
    use crate::pipeline::mapping::profile::{Action, Effect, Force, Keys};

    /// How many keys are down at each of these milliseconds and kinds of press.
    fn down(mode: Mode, steps: &[(u64, bool)]) -> Vec<usize> {
        let key = |code| Binding { device: OutputDevice::Keyboard, code: Code::Key(code), value: 1 };
        let action = Action::Hold(Effect { keys: Keys::new([key(1), key(2)]), mode });
        let button = Button { force: Force::Fz, press_n: 2.0, release_n: 1.5, action };
        let mut playing = Playing::nothing();
        let step = |(ms, is_on): &(u64, bool)| {
            let role = is_on.then_some(Role::Out);
            playing.step(&button, StreamInstant::from_us(1_000 * ms), role).count()
        };
        steps.iter().map(step).collect()
    }

    #[test]
    fn plain_keys_follow() {
        assert_eq!(down(Mode::Plain, &[(0, false), (1, true), (2, true), (3, false)]), [0, 2, 2, 0]);
    }

    #[test]
    fn toggled_keys_change_where_a_press_begins() {
        let steps = [(0, true), (1, true), (2, false), (3, true), (4, false), (5, true)];
        assert_eq!(down(Mode::Toggle, &steps), [2, 2, 2, 0, 0, 2]);
    }

    #[test]
    fn turbo_begins_with_a_press_and_ends_with_it() {
        let turbo = Mode::Turbo { period_us: 100_000 };
        let steps = [(7, true), (56, true), (57, true), (106, true), (107, true), (120, false), (121, true)];
        assert_eq!(down(turbo, &steps), [2, 2, 0, 0, 2, 0, 2]);
    }
}
