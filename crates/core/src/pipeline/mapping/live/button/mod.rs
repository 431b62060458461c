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
    /// What the force says; `None` while the button cannot count.
    touch: Option<Touch>,
    accept: Accept,
    press: TimedPress,
    stage: TwoStagePress,
    follower: EffectState,
}

/// What other presses make of a button's press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ruling {
    /// Nothing.
    Free,
    /// It is a long one from now on.
    Hold,
    /// It waits.
    Withheld,
    /// It waited and is over: it begins and ends now.
    Replayed,
}

impl ButtonState {
    /// Where a button stands that nothing has pressed yet.
    pub(crate) const fn fresh() -> Self {
        Self {
            gate: Gate::Off,
            hard: Gate::Off,
            touch: None,
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

    /// Follows the force to `t`. `is_in_place` says whether the contact is where the button counts.
    pub(crate) fn feel(
        &mut self,
        button: &Button,
        t: StreamInstant,
        contact: Option<&Contact>,
        is_in_place: bool,
        access: Access,
        presses: &mut Presses,
    ) {
        let is_on = self.follow(button, contact);
        let mut touch = Touch { is_on, is_hard: false, is_in_place };
        let conditions = Conditions { access, dwell: button.dwell, resumes: false };
        // A forgotten press is over when its force is, whether it would count or not.
        if !self.is_spent(button) {
            let is_accepted = self.accept.step(conditions, t, touch, contact, presses);
            touch.is_on = is_accepted || (is_on && !is_in_place);
        }
        if let Action::ByForce { hard_press_n, hard_release_n, .. } = button.action {
            let thresholds = Thresholds { press_n: hard_press_n, release_n: hard_release_n, hair_n: None };
            touch.is_hard =
                self.hard.step(thresholds, contact.map(|contact| force_of(button.force, contact)));
        }
        self.touch = Some(touch);
    }

    /// Follows the force while the button cannot count.
    pub(crate) fn doze(&mut self, button: &Button, contact: Option<&Contact>) {
        self.follow(button, contact);
        self.accept.forget();
        self.touch = None;
    }

    fn follow(&mut self, button: &Button, contact: Option<&Contact>) -> bool {
        let Button { press_n, release_n, hair_n, .. } = *button;
        let force_n = contact.map(|contact| force_of(button.force, contact));
        self.gate.step(Thresholds { press_n, release_n, hair_n }, force_n)
    }

    /// What is on at `t`, given what other presses make of this one.
    pub(crate) fn play(
        &mut self,
        button: &Button,
        t: StreamInstant,
        ruling: Ruling,
    ) -> impl Iterator<Item = Playing> + use<> {
        let mut touch = self.touch.unwrap_or(Touch { is_on: false, is_hard: false, is_in_place: true });
        touch.is_on &= ruling != Ruling::Withheld;
        let begun = (ruling == Ruling::Replayed).then(|| {
            let roles =
                self.roles(button, t, Touch { is_on: true, is_hard: false, is_in_place: true }, false);
            self.follower.step(button, t, roles)
        });
        let roles = self.roles(button, t, touch, ruling == Ruling::Hold);
        begun.into_iter().flatten().chain(self.follower.step(button, t, roles))
    }

    /// The kinds of press that are on at `t`; one that `is_hold` is a long one, whatever its time.
    fn roles(&mut self, button: &Button, t: StreamInstant, touch: Touch, is_hold: bool) -> Roles {
        match &button.action {
            Action::ByForce { skip, .. } => self.stage.step(*skip, t, touch),
            action => self.press.step(action, t, touch, is_hold).map_or(Roles::NONE, Roles::from),
        }
    }

    /// What is on at `t` while the button does not count: presses are forgotten, what was toggled stays. A press that may still come
    /// to count is not.
    pub(crate) fn sleep(
        &mut self,
        button: &Button,
        t: StreamInstant,
    ) -> impl Iterator<Item = Playing> + use<> {
        let is_on = self.gate.is_on();
        if self.touch.is_none() || !is_on {
            self.press.forget(is_on);
            self.stage.forget(is_on);
        }
        self.follower.step(button, t, Roles::NONE)
    }

    /// Whether a press is on that counts, or may come to count.
    pub(crate) fn is_pressed(&self, button: &Button) -> bool {
        self.touch.is_some_and(|touch| touch.is_on && touch.is_in_place) && !self.is_spent(button)
    }

    /// Whether the force is on from a press that was forgotten.
    fn is_spent(&self, button: &Button) -> bool {
        match button.action {
            Action::ByForce { .. } => self.stage == TwoStagePress::Spent,
            Action::Hold(_) | Action::ByTime { .. } => self.press == TimedPress::Spent,
        }
    }

    /// Since when it is pressed, if it is open whether that is a tap or a hold.
    pub(crate) const fn undecided(&self) -> Option<StreamInstant> {
        self.press.undecided()
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
