//! One button's light and hard stages.

use super::gate::Touch;
use crate::pipeline::mapping::profile::{Role, Roles, Skip};
use crate::time::StreamInstant;

/// Where a press with two stages stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TwoStagePress {
    /// Not pressed.
    Up,
    /// Pressed since then, and still neither light nor hard.
    Waiting { since: StreamInstant },
    /// Light, and hard on top while it is that.
    Light,
    /// Hard alone.
    Hard,
    /// The force is still on from a press that was forgotten.
    Spent,
}

impl TwoStagePress {
    /// The kinds of press that are on at `t`.
    pub(crate) fn step(&mut self, skip: Skip, t: StreamInstant, touch: Touch) -> Roles {
        let Touch { is_on, is_hard, is_in_place } = touch;
        let before = *self;
        *self = match before {
            Self::Spent => {
                if is_on {
                    Self::Spent
                } else {
                    Self::Up
                }
            }
            _ if !is_in_place || !is_on => Self::Up,
            Self::Up => begun(skip, t, is_hard),
            Self::Waiting { since } => waited(skip, t.us_since(since), before, is_hard),
            Self::Light | Self::Hard => before,
        };
        match *self {
            Self::Light if is_hard && !matches!(skip, Skip::Must { .. }) => {
                Roles::from(Role::Light).with(Role::Hard)
            }
            Self::Light => Role::Light.into(),
            Self::Hard if is_hard => Role::Hard.into(),
            // A press that ended before it was either was light.
            Self::Up if is_in_place && matches!(before, Self::Waiting { .. }) => Role::Light.into(),
            _ => Roles::NONE,
        }
    }

    /// Forgets a press under way.
    pub(crate) const fn forget(&mut self, is_on: bool) {
        *self = if is_on { Self::Spent } else { Self::Up };
    }
}

/// What a press begins as.
const fn begun(skip: Skip, t: StreamInstant, is_hard: bool) -> TwoStagePress {
    match (skip, is_hard) {
        (Skip::No, _) => TwoStagePress::Light,
        (Skip::May { .. } | Skip::Must { .. }, true) => TwoStagePress::Hard,
        (Skip::May { .. } | Skip::Must { .. }, false) => TwoStagePress::Waiting { since: t },
    }
}

/// What a press has become that was neither light nor hard for so long.
const fn waited(skip: Skip, for_us: u64, before: TwoStagePress, is_hard: bool) -> TwoStagePress {
    match skip {
        Skip::May { us } | Skip::Must { us } if for_us < us => {
            if is_hard {
                TwoStagePress::Hard
            } else {
                before
            }
        }
        _ => TwoStagePress::Light,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIGHT: u8 = 1;
    const HARD: u8 = 2;

    /// What is on at each (milliseconds, 0 off, 1 on, 2 hard).
    fn played(skip: Skip, steps: &[(u64, u8)]) -> Vec<u8> {
        let mut stage = TwoStagePress::Up;
        let step = |(ms, force): &(u64, u8)| {
            let touch = Touch { is_on: *force > 0, is_hard: *force > 1, is_in_place: true };
            let roles = stage.step(skip, StreamInstant::from_us(1_000 * ms), touch);
            LIGHT * u8::from(roles.has(Role::Light)) + HARD * u8::from(roles.has(Role::Hard))
        };
        steps.iter().map(step).collect()
    }

    #[test]
    fn without_skip_hard_comes_on_top_of_light() {
        let steps = [(0, 1), (1, 2), (2, 1), (3, 0)];
        assert_eq!(played(Skip::No, &steps), [LIGHT, LIGHT + HARD, LIGHT, 0]);
        assert_eq!(played(Skip::No, &[(0, 2), (1, 0)]), [LIGHT + HARD, 0]);
    }

    #[test]
    fn a_fast_hard_press_is_hard_alone() {
        for skip in [Skip::May { us: 150_000 }, Skip::Must { us: 150_000 }] {
            assert_eq!(
                played(skip, &[(0, 1), (149, 2), (500, 2), (501, 1), (502, 2), (503, 0)]),
                [0, HARD, HARD, 0, HARD, 0]
            );
            assert_eq!(played(skip, &[(0, 2), (1, 0)]), [HARD, 0]);
            // It ended before it was either.
            assert_eq!(played(skip, &[(0, 1), (149, 0), (150, 0)]), [0, LIGHT, 0]);
        }
    }

    #[test]
    fn after_a_slow_one_hard_may_follow_or_never_comes() {
        let steps = [(0, 1), (150, 2), (151, 1), (152, 2), (153, 0)];
        assert_eq!(played(Skip::May { us: 150_000 }, &steps), [0, LIGHT + HARD, LIGHT, LIGHT + HARD, 0]);
        assert_eq!(played(Skip::Must { us: 150_000 }, &steps), [0, LIGHT, LIGHT, LIGHT, 0]);
    }

    #[test]
    fn a_forgotten_press_and_one_that_left_its_place_do_nothing() {
        let mut stage = TwoStagePress::Waiting { since: StreamInstant::from_us(0) };
        let touch = |is_on, is_in_place| Touch { is_on, is_hard: false, is_in_place };
        assert_eq!(
            stage.step(Skip::May { us: 150_000 }, StreamInstant::from_us(9), touch(true, false)),
            Roles::NONE
        );
        assert_eq!(stage, TwoStagePress::Up);
        stage.forget(true);
        assert_eq!(stage.step(Skip::No, StreamInstant::from_us(10), touch(true, true)), Roles::NONE);
        assert_eq!(stage.step(Skip::No, StreamInstant::from_us(11), touch(false, true)), Roles::NONE);
        assert_eq!(stage.step(Skip::No, StreamInstant::from_us(12), touch(true, true)), Role::Light.into());
    }
}
