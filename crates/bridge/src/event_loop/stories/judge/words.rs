//! Whether what is told is so, and whether what is so is told.

use std::mem::discriminant;

use super::*;

/// A thing that comes and goes is told once a minute, and a state three times.
const REPEAT_US: u64 = 63_000_000;

impl Judge {
    pub(super) fn look_at_words(&mut self, play: &Play) -> Result<(), Broken> {
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
    pub(super) fn are_told_true(&mut self, play: &Play) -> Result<(), Broken> {
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
