//! All that goes on at one button: `gate` → `accept` → `press`, `stage` → `effect`.

pub(crate) mod accept;
pub(crate) mod effect;
pub(crate) mod gate;
mod press;
mod stage;

use self::accept::{Accept, Conditions, Presses};
use self::effect::{EffectState, Playing};
use self::gate::{Gate, Thresholds, Touch};
use self::press::TimedPress;
use self::stage::TwoStagePress;
use super::verdict::Reason;
use crate::pipeline::mapping::profile::{Access, Action, Button, Force, Roles};
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// Where a button stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ButtonState {
    gate: Gate,
    hard: Gate,
    accept: Accept,
    press: TimedPress,
    stage: TwoStagePress,
    follower: EffectState,
}

impl ButtonState {
    /// Where a button stands that nothing has pressed yet.
    pub(crate) const fn fresh() -> Self {
        Self {
            gate: Gate::Off,
            hard: Gate::Off,
            accept: Accept::NEVER,
            press: TimedPress::Up,
            stage: TwoStagePress::Up,
            follower: EffectState::nothing(),
        }
    }

    /// Where a button stands that was pressed before it was there.
    pub(crate) const fn spent(force_n: f32) -> Self {
        Self {
            gate: Gate::On { highest_n: force_n },
            press: TimedPress::Spent,
            stage: TwoStagePress::Spent,
            ..Self::fresh()
        }
    }

    /// Goes on to `t`; what is then on. `is_in_place` says whether the contact is where the button counts.
    pub(crate) fn step(
        &mut self,
        button: &Button,
        t: StreamInstant,
        contact: Option<&Contact>,
        is_in_place: bool,
        access: Access,
        presses: &mut Presses,
    ) -> impl Iterator<Item = Playing> + use<> {
        let force_n = contact.map(|contact| force_of(button.force, contact));
        let Button { press_n, release_n, hair_n, .. } = *button;
        let is_on = self.gate.step(Thresholds { press_n, release_n, hair_n }, force_n);
        let mut touch = Touch { is_on, is_hard: false, is_in_place };
        let conditions = Conditions { access, dwell: button.dwell, resumes: false };
        // A forgotten press is over when its force is, whether it would count or not.
        let is_spent = match button.action {
            Action::ByForce { .. } => self.stage == TwoStagePress::Spent,
            Action::Hold(_) | Action::ByTime { .. } => self.press == TimedPress::Spent,
        };
        if !is_spent {
            let is_accepted = self.accept.step(conditions, t, touch, contact, presses);
            touch.is_on = is_accepted || (is_on && !is_in_place);
        }
        let roles = match &button.action {
            Action::ByForce { hard_press_n, hard_release_n, skip, .. } => {
                let thresholds =
                    Thresholds { press_n: *hard_press_n, release_n: *hard_release_n, hair_n: None };
                touch.is_hard = self.hard.step(thresholds, force_n);
                self.stage.step(*skip, t, touch)
            }
            action => self.press.step(action, t, touch).map_or(Roles::NONE, Roles::from),
        };
        self.follower.step(button, t, roles)
    }

    /// Goes on to `t` while the button does not count: presses are forgotten, what was toggled stays.
    pub(crate) fn sleep(
        &mut self,
        button: &Button,
        t: StreamInstant,
        contact: Option<&Contact>,
    ) -> impl Iterator<Item = Playing> + use<> {
        let force_n = contact.map(|contact| force_of(button.force, contact));
        let Button { press_n, release_n, hair_n, .. } = *button;
        let is_on = self.gate.step(Thresholds { press_n, release_n, hair_n }, force_n);
        self.press.forget(is_on);
        self.stage.forget(is_on);
        self.accept.forget();
        self.follower.step(button, t, Roles::NONE)
    }

    /// Why its press until `t` does not count, if it was rejected just now.
    pub(crate) fn why_rejected(&self, button: &Button, access: Access, t: StreamInstant) -> Reason {
        self.accept.why_rejected(Conditions { access, dwell: button.dwell, resumes: false }, t)
    }

    /// Forgets what is under way and what was toggled. A force that is on does nothing until it was released once.
    pub(crate) const fn forget(&mut self) {
        let is_on = self.gate.is_on();
        self.press.forget(is_on);
        self.stage.forget(is_on);
        self.follower = EffectState::nothing();
        self.accept.forget();
    }

    /// Whether an action is on, see [`EffectState::is_acting`].
    pub(crate) fn is_acting(&self, button: &Button) -> bool {
        self.follower.is_acting(button)
    }

    /// Another press has ended.
    pub(crate) fn unlatch(&mut self) {
        self.follower.unlatch();
    }

    /// Whether the force is on, counting or not.
    pub(crate) const fn is_under_way(&self) -> bool {
        self.gate.is_on()
    }
}

/// The part of the contact's force that counts for a button, in newtons.
pub(crate) const fn force_of(force: Force, contact: &Contact) -> f32 {
    match force {
        Force::Fz => contact.fz_n,
        Force::FxPositive => contact.fx_n,
        Force::FxNegative => -contact.fx_n,
        Force::FyPositive => contact.fy_n,
        Force::FyNegative => -contact.fy_n,
    }
}
