//! How a button's keys follow its kinds of press: down as long as they last, toggled, or again and again.

use super::profile::{Binding, Button, Mode, Role, Roles};
use crate::time::StreamInstant;

/// What goes on at a button.
#[derive(Clone, Copy, Debug)]
pub(super) struct Playing {
    /// The kinds of press that are on.
    roles: Roles,
    /// Each since when.
    since: [StreamInstant; Role::ALL.len()],
    /// The kinds whose keys were toggled down.
    toggled: [bool; Role::ALL.len()],
}

impl Playing {
    /// Nothing.
    pub(super) const fn nothing() -> Self {
        let since = [StreamInstant::from_us(0); Role::ALL.len()];
        Self { roles: Roles::NONE, since, toggled: [false; Role::ALL.len()] }
    }

    /// Goes on to `roles` at `t`; the bindings that are then down.
    pub(super) fn step(
        &mut self,
        button: &Button,
        t: StreamInstant,
        roles: Roles,
    ) -> impl Iterator<Item = Binding> + use<> {
        let mut down = button.effects();
        let places = self.since.iter_mut().zip(&mut self.toggled).zip(&mut down);
        for (role, ((since, toggled), effect)) in Role::ALL.into_iter().zip(places) {
            let is_on = roles.has(role);
            if is_on && !self.roles.has(role) {
                *since = t;
                *toggled = !*toggled;
            }
            let lasts_us = t.us_since(*since);
            *effect = effect.filter(|effect| match effect.mode {
                Mode::Plain => is_on,
                Mode::Toggle => *toggled,
                // Down in [0, T/2) of each period T.
                Mode::Turbo { period_us } => is_on && 2 * (lasts_us % period_us.max(1)) < period_us,
            });
        }
        self.roles = roles;
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
        let button =
            Button { force: Force::Fz, press_n: 2.0, release_n: 1.5, hair_n: None, place: None, action };
        let mut playing = Playing::nothing();
        let step = |(ms, is_on): &(u64, bool)| {
            let roles = if *is_on { Role::Out.into() } else { Roles::NONE };
            playing.step(&button, StreamInstant::from_us(1_000 * ms), roles).count()
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
