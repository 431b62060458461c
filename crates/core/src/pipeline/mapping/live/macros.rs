//! Macros that are playing: one after the other, in the order in which they began.

use arrayvec::ArrayVec;

use super::intent::{Intents, LEVELS_MAX};
use super::stated::StepOutput;
use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::profile::{Binding, Keys, MACROS_MAX, Macro, Profile};
use crate::time::StreamInstant;

/// Which macros play, and what they must know of the controls for that.
#[derive(Clone, Debug, Default)]
pub(crate) struct MacroPlayback {
    /// Those that have begun and not ended: the first one plays, the others wait for it.
    queue: ArrayVec<usize, MACROS_MAX>,
    /// Since when the first one plays; `None` until what it presses first is up.
    since: Option<StreamInstant>,
    /// Controls that are down, and those that may still be.
    recent: ArrayVec<RecentControl, LEVELS_MAX>,
}

/// A control that was stated, and what is known of it from that.
#[derive(Clone, Copy, Debug)]
struct RecentControl {
    device: OutputDevice,
    code: Code,
    state: ControlState,
}

/// Where a control stands.
#[derive(Clone, Copy, Debug)]
enum ControlState {
    /// It is stated since then.
    Down { since: StreamInstant },
    /// It was stated from then on and is no longer; the minimum press may still hold it.
    Held { since: StreamInstant },
    /// It is up since then.
    Up { since: StreamInstant },
}

impl MacroPlayback {
    /// Lets those begin that `stated` says, and states what the one that plays presses at `t`. A macro that has begun and not ended
    /// does not begin anew.
    pub(crate) fn step(&mut self, profile: &Profile, t: StreamInstant, stated: &mut StepOutput) {
        let Profile { macros, min_press_us, .. } = profile;
        for (number, _) in stated.begun.iter().enumerate().filter(|(_, begun)| **begun) {
            if !self.queue.contains(&number) {
                // Each of them stands there once, so there is always room.
                let _ = self.queue.try_push(number);
            }
        }
        // What is pressed anew was up in an earlier step, or nobody would see it.
        self.recent.retain(|it| !matches!(it.state, ControlState::Up { since } if since < t));
        if let Some(it) = self.current(macros, t) {
            self.play(it, t, stated);
        }
        self.remember(t, *min_press_us, &stated.levels);
    }

    /// Ends all that play or wait.
    pub(crate) fn forget(&mut self) {
        self.queue.clear();
        self.since = None;
    }

    /// The macro whose turn it is at `t`.
    fn current<'p>(&mut self, macros: &'p [Macro], t: StreamInstant) -> Option<&'p Macro> {
        let it = macros.get(*self.queue.first()?)?;
        let is_over = |since| it.steps.last().is_none_or(|step| t.us_since(since) >= step.until_us);
        if !self.since.is_some_and(is_over) {
            return Some(it);
        }
        self.queue.remove(0);
        self.since = None;
        macros.get(*self.queue.first()?)
    }

    /// States what a macro presses at `t`. It has its controls for its own, so that what the fingers do meanwhile does not get among
    /// its steps. Modifiers of the fingers are lifted, and come back after it. While any are lifted, or the macro holds one, no other
    /// key goes down.
    fn play(&mut self, it: &Macro, t: StreamInstant, stated: &mut StepOutput) {
        let first = it.steps.iter().find_map(|step| step.keys);
        let may_be_down =
            |binding: Binding| self.recent.iter().any(|recent| recent.is(binding.device, binding.code));
        if self.since.is_none() && !first.iter().flat_map(Keys::iter).any(may_be_down) {
            self.since = Some(t);
        }
        let step =
            self.since.and_then(|since| it.steps.iter().find(|step| t.us_since(since) < step.until_us));
        let keys = step.and_then(|step| step.keys);
        let own = || keys.iter().flat_map(Keys::iter);
        let is_modified = own().any(|binding| binding.code.is_modifier())
            || stated.levels.iter().any(|level| level.code.is_modifier());
        stated.levels.retain(|level| {
            let mut down = self.recent.iter().filter(|it| matches!(it.state, ControlState::Down { .. }));
            let mut is_down = || down.any(|it| it.is(level.device, level.code));
            !level.code.is_modifier() && (!is_modified || !level.code.takes_modifiers() || is_down())
        });
        it.steps.iter().filter_map(|step| step.keys.as_ref()).for_each(|keys| stated.free(keys));
        own().for_each(|binding| stated.state(binding));
    }

    /// Keeps in mind where the controls stand that are stated at `t`, and those that are no longer.
    fn remember(&mut self, t: StreamInstant, min_press_us: u64, levels: &Intents) {
        for it in &mut self.recent {
            let is_stated = levels.iter().any(|level| it.is(level.device, level.code));
            it.state = match it.state {
                ControlState::Held { .. } | ControlState::Up { .. } if is_stated => {
                    ControlState::Down { since: t }
                }
                ControlState::Down { since } | ControlState::Held { since } if !is_stated => {
                    if t.us_since(since) < min_press_us {
                        ControlState::Held { since }
                    } else {
                        ControlState::Up { since: t }
                    }
                }
                state => state,
            };
        }
        for level in levels {
            if !self.recent.iter().any(|it| it.is(level.device, level.code)) {
                let (device, code, state) = (level.device, level.code, ControlState::Down { since: t });
                // Those of another profile are gone after its minimum press: there is room.
                let _ = self.recent.try_push(RecentControl { device, code, state });
            }
        }
    }
}

impl RecentControl {
    fn is(&self, device: OutputDevice, code: Code) -> bool {
        (self.device, self.code) == (device, code)
    }
}
