//! What must hold at every step of a story.
//!
//! Safety: each down has one up; nothing is held 100 ms after the last sound sample that was read; nothing goes down without a finger.
//! Liveness: a sound and untouched pad plays, and the first press after that counts; what keeps a pad from playing is named within three
//! seconds, by the name of what is really wrong, and no word is said that is not true.

use std::collections::BTreeMap;
use std::mem::{Discriminant, discriminant};

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

/// A thing that comes and goes is told once a minute, and a state three times.
const REPEAT_US: u64 = 63_000_000;

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

    fn look_at_words(&mut self, play: &Play) -> Result<(), Broken> {
        let now = play.now;
        let state = state(&play.bridge.driver, &play.bridge.connection);
        if state == State::Playing {
            self.kept_since = None;
        } else {
            self.kept_since.get_or_insert(now);
        }
        let finding = play.bridge.driver.pipeline.line_finding();
        if let Some(finding) = finding {
            let [newest, before] = self.found;
            let is_same = newest.is_some_and(|(newest, _)| subject(&newest) == subject(finding));
            self.found = [Some((*finding, now)), if is_same { before } else { newest }];
        }
        // It is about the stream as it was heard last.
        if self.heard.is_none_or(|heard| now.us_since(heard) > RELEASED_US) {
            self.unheard = now;
        }
        let is_heard = now.us_since(self.unheard) > TAKEN_BACK_US;
        let untrue = finding.filter(|finding| !self.is_true(play, finding));
        if let Some(finding) = untrue.filter(|_| is_heard) {
            return broken("what is found is so", format!("{finding}; {}", self.words(play)));
        }
        if state != State::Playing && self.kept_since.is_some_and(|since| now.us_since(since) > NAMED_US) {
            self.is_named(play, state, finding)?;
        }
        self.is_finding_told(play, finding)
    }

    /// What is found for three seconds about a stream that is heard has its own words.
    fn is_finding_told(&mut self, play: &Play, finding: Option<&LineFinding>) -> Result<(), Broken> {
        let now = play.now;
        let subject = finding.map(subject);
        if self.stands.is_none_or(|(before, _)| subject != Some(before)) || self.unheard == now {
            self.stands = subject.map(|subject| (subject, now));
        }
        let lasts = self.stands.is_some_and(|(_, since)| now.us_since(since) > NAMED_US);
        let Some(finding) = finding.filter(|_| lasts) else { return Ok(()) };
        let messages = play.messages.0.lock().unwrap();
        let is_recent = |at: &HostInstant| now.us_since(*at) <= REPEAT_US;
        // A warning takes back no finding, and no state does.
        let last = messages.iter().rfind(|line| is_found(line) && !line.contains(STRAY));
        let recent = messages.iter().zip(&self.told).filter(|(_, at)| is_recent(at)).map(|(line, _)| line);
        if recent.chain(last).any(|line| is_of_kind(line, finding)) {
            return Ok(());
        }
        broken(
            "what is found is told",
            format!("{finding}; {}; {:#?}", self.words(play), self.all_told(now, &messages)),
        )
    }

    /// Whether this finding about the stream is so. Of a number that began again, where that was so, it is believed that it does so at the same
    /// one again, until it has counted past it: a number of 16 bits begins again once a minute.
    fn is_true(&mut self, play: &Play, finding: &LineFinding) -> bool {
        let is_true = self.causes.make_true(play.now, TAKEN_BACK_US, finding);
        let LineFinding::SequenceWraps { largest } = finding else { return is_true };
        let was_true = self.wrapped.filter(|(number, _)| number == largest);
        if is_true || was_true.is_some() && play.sequence <= *largest {
            self.wrapped = Some((*largest, play.now));
            return true;
        }
        was_true.is_some_and(|(_, at)| play.now.us_since(at) <= TAKEN_BACK_US)
    }

    /// What has kept the pad from playing for three seconds has its word, in the status and on the console.
    fn is_named(&self, play: &Play, state: State, finding: Option<&LineFinding>) -> Result<(), Broken> {
        let now = play.now;
        // Of a stream that is not heard any more a finding explains nothing.
        let is_heard = self.heard.is_some_and(|heard| now.us_since(heard) <= NAMED_US);
        let finding = finding.filter(|_| is_heard);
        let is_state_right = self.explain(now, NAMED_US, state);
        if !is_state_right && finding.is_none() {
            return broken("the status names what keeps a pad from playing", self.words(play));
        }
        let messages = play.messages.0.lock().unwrap();
        // What was found stands until it is taken back; what keeps the pad from playing then has its word in time.
        let stood: Vec<LineFinding> = self
            .found
            .iter()
            .flatten()
            .filter(|(_, at)| now.us_since(*at) <= NAMED_US)
            .map(|(finding, _)| *finding)
            .collect();
        let lasts_us = if stood.is_empty() { NAMED_US } else { TAKEN_BACK_US + NAMED_US };
        let is_right = |line: &String| {
            STATES.iter().any(|state| line == state.sentence() && self.explain(now, NAMED_US, *state))
                || is_heard && stood.iter().any(|finding| is_of_kind(line, finding))
                || is_heard && self.is_found_so(now, lasts_us, line) == Some(true)
        };
        // What was told last of the pad or of its stream lasts still, or may not be told again yet.
        let recent = messages.iter().zip(&self.told).filter(|(_, at)| now.us_since(**at) <= REPEAT_US);
        let last_found = messages.iter().rfind(|line| is_state(line) || is_found(line));
        let last = [messages.iter().rfind(|line| is_state(line)), last_found];
        if recent.map(|(line, _)| line).chain(last.into_iter().flatten()).any(is_right) {
            return Ok(());
        }
        let told = self.all_told(now, &messages);
        broken("what keeps a pad from playing is told", format!("{}; {told:#?}", self.words(play)))
    }

    /// All that was told, and when.
    fn all_told(&self, now: HostInstant, messages: &[String]) -> Vec<String> {
        let line =
            |(line, at): (&String, &HostInstant)| format!("{} s ago: {line}", now.us_since(*at) / 1_000_000);
        messages.iter().zip(&self.told).map(line).collect()
    }

    /// What was told since is true.
    fn are_told_true(&mut self, play: &Play) -> Result<(), Broken> {
        let now = play.now;
        if play.bridge.driver.pipeline.phase() == Phase::Weighing {
            // It goes on after something hid it.
            self.causes.note(now, Cause::Weighing);
        }
        let finding = play.bridge.driver.pipeline.line_finding().copied();
        let finding = finding.filter(|finding| self.is_true(play, finding));
        let messages = play.messages.0.lock().unwrap();
        for line in &messages[self.told.len()..] {
            self.told.push(now);
            if finding.is_some_and(|finding| is_of_kind(line, &finding)) {
                continue;
            }
            let state = STATES.iter().find(|state| state.sentence() == line);
            let is_state_untrue = state.is_some_and(|state| !self.explain(now, NAMED_US, *state));
            // It is about the stream as it was heard last. A stray channel stays one until a finger shows that it is none.
            let unheard_us = self.heard.map_or(0, |heard| now.us_since(heard));
            let lasts_us = if line.contains(STRAY) { REPEAT_US } else { TAKEN_BACK_US };
            if is_state_untrue || self.is_found_so(now, lasts_us + unheard_us, line) == Some(false) {
                return broken("what is told is so", format!("{line}; {}", self.words(play)));
            }
        }
        Ok(())
    }

    /// Whether what this line says of the stream, if it does, was so within the last `us`.
    fn is_found_so(&self, now: HostInstant, us: u64, line: &str) -> Option<bool> {
        let (_, causes) = FOUND.iter().find(|(words, _)| line.contains(words))?;
        let was_off = |channel| match line.contains(STRAY) {
            true => self.causes.was_off_since_sound(now, us, channel),
            false => self.causes.was_off(now, us, channel),
        };
        // Of a channel that answers again there is a zero at once.
        let has_recovered = self.recovered.is_some_and(|at| self.causes.last(Channel) <= Some(at));
        Some(self.causes.within(now, us).any(|cause| match cause {
            Channel if line.contains(STRAY) && has_recovered => false,
            Channel => causes.contains(&Channel) && named_channel(line).is_none_or(was_off),
            cause => causes.contains(&cause),
        }))
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

/// States that keep from playing.
const STATES: [State; 11] = [
    State::Waiting,
    State::Denied,
    State::Unclear,
    State::Silent,
    State::Taring,
    State::Loaded,
    State::Unweighed,
    State::Weighing,
    State::Doubtful,
    State::Faulty,
    State::Paused,
];

const STRAY: &str = "reads what no finger makes it read";

/// Words of findings about the stream, and what they come of.
const FOUND: [(&str, &[Cause]); 5] = [
    ("the pad's clock went on by", &[Clock]),
    ("frames are lost or damaged", &[Loss, Frozen, Silent]),
    ("all the time while others change", &[Channel]),
    // What no finger makes a channel read a finger does that has moved since the zero was measured under it.
    (STRAY, &[Channel, ZeroUnderLoad, UnflaggedRestart]),
    ("comes a smaller one", &[Restarted, Wraps]),
];

/// The kind of a finding, and the channel that it is about.
type Subject = (Discriminant<LineFinding>, Option<usize>);

fn subject(finding: &LineFinding) -> Subject {
    (discriminant(finding), finding.channel())
}

/// Whether this line tells a state.
fn is_state(line: &str) -> bool {
    STATES.iter().chain(&[State::Playing]).any(|state| line == state.sentence())
}

/// Whether it tells what was found about the stream.
fn is_found(line: &str) -> bool {
    FOUND.iter().any(|(words, _)| line.contains(words))
}

/// Whether this line tells a finding of this kind, whatever its numbers.
fn is_of_kind(line: &str, finding: &LineFinding) -> bool {
    let words = |text: &str| -> Vec<String> {
        text.split_whitespace()
            .filter(|word| !word.contains(|letter: char| letter.is_ascii_digit()))
            .map(str::to_owned)
            .collect()
    };
    words(line) == words(&finding.to_string()) && named_channel(line) == finding.channel()
}

/// The channel that this line names, if it names one.
fn named_channel(line: &str) -> Option<usize> {
    let name = line.split_once("channel ")?.1.split(' ').next()?;
    CHANNEL_NAMES.iter().position(|known| *known == name)
}
