//! What must hold at every step of a story.
//!
//! Safety: each down has one up; nothing is held 100 ms after the last sound sample that was read; nothing goes down without a finger.
//! Liveness: a sound and untouched pad plays, and the first press after that counts; what keeps a pad from playing is named within three
//! seconds, by the name of what is really wrong, and no word is said that is not true.

mod words;

use std::collections::BTreeMap;
use std::mem::Discriminant;

use super::super::state;
use super::super::virtual_time::Play;
use super::cause::Cause::{
    self, Channel, Clock, Delayed, Frozen, Loss, Restarted, Silent, UnflaggedRestart, Wraps, ZeroUnderLoad,
};
use super::cause::Causes;
use crate::state::State;
use tactpad_core::pipeline::Phase;
use tactpad_core::pipeline::control::{Code, OutputDevice};
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::quantity::CHANNEL_NAMES;
use tactpad_core::time::HostInstant;

/// A zero that is measured anew was asked for within this time, µs: frames that do not go on are a run after three of them, at 100 a second.
const ANEW_US: u64 = 1_000_000;

/// Silence releases everything within this time, µs.
const RELEASED_US: u64 = 100_000;

/// What a finger did goes out within this time after its last sample was read: a filter at 100 samples a second, a tap that waits whether it
/// becomes a long press, the shortest time of a press.
const GHOST_US: u64 = 600_000;

/// A channel that is off may look like a finger so long, which is then let go of.
const FAR_US: u64 = 10_500_000;

/// What keeps a pad from playing is named within this time, µs.
const NAMED_US: u64 = 3_000_000;

/// The words are looked at so often, µs.
const LOOK_US: u64 = 40_000;

/// What is found about the stream is taken back within this time after it is over: six looks of 0.9 s.
pub(super) const TAKEN_BACK_US: u64 = 6_500_000;

/// A firm press counts within this time, µs: a filter of six samples at 100 a second, and what is between.
const COUNTS_US: u64 = 120_000;

/// A finger that stayed counts again within this time, µs.
const STAYS_US: u64 = 1_700_000;

/// An invariant that broke, and what was seen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Broken {
    pub(super) rule: &'static str,
    pub(super) seen: String,
}

pub(super) fn broken<T>(rule: &'static str, seen: impl ToString) -> Result<T, Broken> {
    Err(Broken { rule, seen: seen.to_string() })
}

/// The kind of a finding, and the channel that it is about.
type Subject = (Discriminant<LineFinding>, Option<usize>);

/// Knows what happened, and watches.
#[derive(Default)]
pub(super) struct Judge {
    pub(super) causes: Causes,
    down: BTreeMap<(OutputDevice, u16), i32>,
    /// When the bridge read a sound sample last, and one with a finger.
    pub(super) heard: Option<HostInstant>,
    touch_heard: Option<HostInstant>,
    /// When it had heard none for a while.
    unheard: HostInstant,
    looked: HostInstant,
    /// What was found about the stream last, and before that, and when it was so last.
    found: [Option<(LineFinding, HostInstant)>; 2],
    /// What is found, and since when it is the same.
    stands: Option<(Subject, HostInstant)>,
    kept_since: Option<HostInstant>,
    /// When channels recovered again of which there was no zero.
    recovered: Option<HostInstant>,
    /// When a channel was off last, or was hidden by a finger since.
    seemed_off: Option<HostInstant>,
    /// A press that has to count by then.
    promise: Option<HostInstant>,
    /// The number after which a smaller one came, and when the pad had not counted past it.
    wrapped: Option<(u32, HostInstant)>,
    /// How many messages were read, and when each was told.
    told: Vec<HostInstant>,
    /// All that went out, as one number, and the same with its times.
    pub(super) edges: u64,
    pub(super) trace: u64,
}

impl Judge {
    /// A firm press begins now. It has to count if the pad has to play.
    pub(super) fn press(&mut self, now: HostInstant) {
        if self.causes.have_passed(now) {
            self.promise = Some(now.plus_us(COUNTS_US));
        }
    }

    /// A finger that held something stayed while the pad was not heard. It counts again, once what came late is read.
    pub(super) fn press_again(&mut self, now: HostInstant) {
        self.promise = Some(now.plus_us(STAYS_US));
    }

    /// Something other than the pad's own fault is in the way of what was promised.
    pub(super) fn excuse(&mut self) {
        self.promise = None;
    }

    /// The bridge reads a sound sample now.
    pub(super) fn hear(&mut self, now: HostInstant, is_touched: bool) {
        self.heard = Some(now);
        if is_touched {
            self.touch_heard = Some(now);
        }
    }

    /// The loop did not come to run until now.
    pub(super) fn thaw(&mut self, now: HostInstant, frozen_us: u64) {
        self.delay_is_over(now, frozen_us);
        let is_touched = self.causes.within(now, frozen_us).any(|cause| cause == Cause::Touched);
        self.hear(now, is_touched);
        (self.kept_since, self.unheard) = (None, now);
    }

    /// What waited for so long comes now, and with it whatever was there then.
    pub(super) fn delay_is_over(&mut self, now: HostInstant, waited_us: u64) {
        self.causes.note_again(now, waited_us + NAMED_US);
        self.wrapped = self.wrapped.map(|(number, at)| {
            let is_recent = now.us_since(at) <= waited_us + TAKEN_BACK_US;
            (number, if is_recent { now } else { at })
        });
    }

    /// Whether something within the last `us` makes this state right. Where a zero is wanted, a finger that is read late is in its way.
    fn explain(&self, now: HostInstant, us: u64, state: State) -> bool {
        let is_late = self.causes.within(now, GHOST_US).any(|cause| matches!(cause, Frozen | Delayed));
        let is_in_the_way = state == State::Loaded && is_late && !self.is_untouched(now);
        self.causes.explain(now, us, state) || is_in_the_way && self.causes.explain(now, us, State::Taring)
    }

    /// Takes what went out by now, and what was told.
    pub(super) fn take(&mut self, play: &Play) -> Result<(), Broken> {
        for event in play.taken() {
            let mix = |sum: u64, value: u64| sum.rotate_left(5).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ value;
            self.edges = mix(
                self.edges,
                event.code.to_string().bytes().fold(event.value as u64, |sum, byte| mix(sum, byte.into())),
            );
            self.trace = mix(self.trace ^ self.edges, play.now.as_ns());
            let Code::Key(code) = event.code else { continue };
            let before = self.down.insert((event.device, code), event.value).unwrap_or(0);
            if before == event.value {
                return broken("each down has one up", format!("{} is {} twice", event.code, event.value));
            }
            if event.value != 0 {
                self.may_go_down(play, &event.code)?;
            }
        }
        self.are_told_true(play)
    }

    /// Whether no finger was heard for so long that nothing comes of it any more.
    pub(super) fn is_untouched(&self, now: HostInstant) -> bool {
        self.is_untouched_for(now, GHOST_US)
    }

    fn is_untouched_for(&self, now: HostInstant, us: u64) -> bool {
        self.touch_heard.is_none_or(|at| now.us_since(at) > us)
    }

    /// All channels that were off answer again, and the zero was measured without them: it is measured anew.
    pub(super) fn channels_recover(&mut self, now: HostInstant) {
        self.recovered = Some(now);
    }

    fn may_go_down(&self, play: &Play, code: &Code) -> Result<(), Broken> {
        if self.is_untouched(play.now) && !self.may_look_like_a_finger(play.now) {
            return broken("nothing goes down without a finger", code);
        }
        Ok(())
    }

    /// Whether a channel is off, or was, and may look like a finger still.
    fn may_look_like_a_finger(&self, now: HostInstant) -> bool {
        let was_off = self.seemed_off.is_some_and(|at| now.us_since(at) <= FAR_US);
        was_off && self.causes.last(Channel) > self.recovered
    }

    /// Whether it is off now, or was and a finger hides it.
    fn seems_off(&self, now: HostInstant) -> bool {
        let is_off = (0..CHANNEL_NAMES.len()).any(|channel| self.causes.was_off(now, 0, channel));
        is_off || self.may_look_like_a_finger(now) && !self.is_untouched_for(now, COUNTS_US)
    }

    /// Looks at the bridge, which comes to run.
    pub(super) fn look(&mut self, play: &Play) -> Result<(), Broken> {
        let (now, pipeline) = (play.now, &play.bridge.driver.pipeline);
        let is_held = pipeline.held().next().is_some();
        if self.seems_off(now) {
            self.seemed_off = Some(now);
        }
        let is_ghost = pipeline.contact().is_some() && self.is_untouched_for(now, COUNTS_US);
        if is_ghost && self.may_look_like_a_finger(now) {
            self.causes.note(now, Channel);
        }
        let silent_us = self.heard.map_or(u64::MAX, |heard| now.us_since(heard));
        if is_held && silent_us > RELEASED_US {
            return broken("silence releases everything within 100 ms", format!("{silent_us} µs"));
        }
        if !is_held && self.down.values().any(|value| *value != 0) {
            return broken("each down has one up", "a key stays down that nothing holds");
        }
        if self.causes.have_passed(now) && pipeline.phase() != Phase::Playing {
            return broken("a sound pad plays", self.words(play));
        }
        let state = state(&play.bridge.driver, &play.bridge.connection);
        // On a bad line, or by a clock in doubt, a zero takes its time.
        let is_slow = self.causes.within(now, NAMED_US).any(|cause| matches!(cause, Loss | Clock));
        let is_anew = matches!(state, State::Taring | State::Loaded) && !is_slow;
        if is_anew && !self.explain(now, ANEW_US, state) {
            return broken("the zero is measured anew where something asks for it", self.words(play));
        }
        self.keep_promise(play, is_held)?;
        if now.us_since(self.looked) >= LOOK_US {
            self.looked = now;
            self.look_at_words(play)?;
        }
        Ok(())
    }

    fn keep_promise(&mut self, play: &Play, is_held: bool) -> Result<(), Broken> {
        let Some(by) = self.promise else { return Ok(()) };
        if is_held {
            self.promise = None;
        } else if play.now > by {
            return broken("a press on a sound pad counts", self.words(play));
        }
        Ok(())
    }

    /// What the bridge says, and what is wrong.
    pub(super) fn words(&self, play: &Play) -> String {
        let (now, pipeline) = (play.now, &play.bridge.driver.pipeline);
        let causes: Vec<Cause> = self.causes.within(now, NAMED_US).collect();
        let state = state(&play.bridge.driver, &play.bridge.connection).word();
        let finding = pipeline.line_finding().map(ToString::to_string);
        format!("it says {state} {finding:?}, and there is {causes:?}")
    }
}
