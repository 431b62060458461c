//! How what a button acts on follows its kinds of press: on as long as they last, toggled, or again and again.

use crate::pipeline::mapping::profile::{Button, Mode, Output, Role, Roles};
use crate::time::StreamInstant;

/// Something that is on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Playing {
    pub(crate) output: Output,
    /// Whether its press begins now.
    pub(crate) begins: bool,
}

/// What goes on at a button.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EffectState {
    /// The kinds of press that are on.
    roles: Roles,
    /// Each since when.
    since: [StreamInstant; Role::ALL.len()],
    /// The kinds whose keys stay down.
    stays: [StickyState; Role::ALL.len()],
}

/// Whether keys stay down when their press is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StickyState {
    Up,
    /// Until another press has ended.
    Latched,
    /// Until the next press of its own.
    Locked,
}

impl StickyState {
    /// What a press makes of it.
    const fn pressed(self, mode: Mode) -> Self {
        match (self, mode) {
            (Self::Up, Mode::Sticky) => Self::Latched,
            (Self::Up, _) | (Self::Latched, _) => Self::Locked,
            (Self::Locked, _) => Self::Up,
        }
    }
}

impl EffectState {
    /// Nothing.
    pub(crate) const fn nothing() -> Self {
        let since = [StreamInstant::from_us(0); Role::ALL.len()];
        Self { roles: Roles::NONE, since, stays: [StickyState::Up; Role::ALL.len()] }
    }

    /// Goes on to `roles` at `t`; what is then on.
    pub(crate) fn step(
        &mut self,
        button: &Button,
        t: StreamInstant,
        roles: Roles,
    ) -> impl Iterator<Item = Playing> + use<> {
        let mut on = [None; Role::ALL.len()];
        let places = self.since.iter_mut().zip(&mut self.stays).zip(&mut on);
        for ((role, effect), ((since, stay), on)) in Role::ALL.into_iter().zip(button.effects()).zip(places) {
            let Some(effect) = effect else { continue };
            let is_pressed = roles.has(role);
            let begins = is_pressed && !self.roles.has(role);
            if begins {
                *since = t;
                *stay = stay.pressed(effect.mode);
            }
            let is_on = match effect.mode {
                Mode::Plain => is_pressed,
                Mode::Toggle | Mode::Sticky => *stay != StickyState::Up,
                // Down in [0, T/2) of each period T.
                Mode::Turbo { period_us } => {
                    is_pressed && 2 * (t.us_since(*since) % period_us.max(1)) < period_us
                }
            };
            *on = is_on.then_some(Playing { output: effect.output, begins });
        }
        self.roles = roles;
        on.into_iter().flatten()
    }

    /// Whether any kind of press is on whose keys are not sticky ones: an action, that is, on which latched keys are meant to work.
    pub(crate) fn is_acting(&self, button: &Button) -> bool {
        let of_role = Role::ALL.into_iter().zip(button.effects());
        of_role.into_iter().any(|(role, effect)| {
            self.roles.has(role) && effect.is_some_and(|effect| effect.mode != Mode::Sticky)
        })
    }

    /// Another press has ended: what was latched goes up.
    pub(crate) fn unlatch(&mut self) {
        self.stays
            .iter_mut()
            .filter(|stay| **stay == StickyState::Latched)
            .for_each(|stay| *stay = StickyState::Up);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::control::{Code, OutputDevice};
    use crate::pipeline::mapping::profile::{Action, Binding, Effect, Force, Keys, When};

    /// How many keys are down at each of these milliseconds and kinds of press.
    fn down(mode: Mode, steps: &[(u64, bool)]) -> Vec<usize> {
        let key = |code| Binding { device: OutputDevice::Keyboard, code: Code::Key(code), value: 1 };
        let action = Action::Hold(Effect { output: Output::Keys(Keys::new([key(1), key(2)])), mode });
        let button = Button {
            force: Force::Fz,
            press_n: 2.0,
            release_n: 1.5,
            hair_n: None,
            dwell: None,
            place: None,
            when: When::Always,
            action,
        };
        let mut follower = EffectState::nothing();
        let step = |(ms, is_on): &(u64, bool)| {
            let roles = if *is_on { Role::Out.into() } else { Roles::NONE };
            follower
                .step(&button, StreamInstant::from_us(1_000 * ms), roles)
                .flat_map(|playing| playing.output.bindings())
                .count()
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
