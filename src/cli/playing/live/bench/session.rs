//! The session: a thread that hears every call, asks the guide, and says what to do.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use super::hands::Hands;
use super::words;
use crate::cli::printing::written::say;
use tactpad::bridge::observer::Observation;
use tactpad::bridge::request::{Request, RequestSender};
use tactpad::lab::bench::guide::{BenchGuide, BenchStep};
use tactpad::lab::bench::touch::Touch;

/// Interval between two looks at what the bridge tells.
const LOOK: Duration = Duration::from_millis(100);

/// A session that goes on.
pub(super) struct Session<'p> {
    guide: BenchGuide<'p>,
    hands: Option<Hands>,
    sender: RequestSender,
    /// What the bridge tells of the pad.
    of_pad: Receiver<String>,
    /// What was said last.
    said: Vec<String>,
    /// The step that was begun last.
    begun: Option<BenchStep>,
    is_taken_away: bool,
}

impl<'p> Session<'p> {
    /// A session; the hands do what it asks for.
    pub(super) const fn new(
        guide: BenchGuide<'p>,
        hands: Option<Hands>,
        sender: RequestSender,
        of_pad: Receiver<String>,
    ) -> Self {
        Self { guide, hands, sender, of_pad, said: Vec::new(), begun: None, is_taken_away: false }
    }

    /// Goes on until nothing is left to do, and then ends the bridge; or until the bridge has ended.
    pub(super) fn run(mut self, calls: &Receiver<Observation>) -> BenchGuide<'p> {
        self.attend();
        while *self.guide.step() != BenchStep::Done {
            match calls.recv_timeout(LOOK) {
                Ok(Observation::Call { at, call }) => {
                    self.guide.apply(at, call.as_call());
                    self.attend();
                }
                // Calls that found no room are missing: for the guide they are lost frames.
                Ok(Observation::Checkpoint { .. }) => {}
                Err(RecvTimeoutError::Timeout) => self.attend(),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        // A bridge that has ended needs no word.
        let _ = self.sender.send(Request::End);
        self.guide
    }

    /// Does what a step begins with, and says what to do, each thing once.
    fn attend(&mut self) {
        let step = *self.guide.step();
        if self.begun.is_none_or(|begun| is_other(&begun, &step)) {
            if let Some(hands) = &mut self.hands {
                hands.obey(&step, self.guide.weight_g());
            }
            self.said.clear();
            self.begun = Some(step);
        }
        if words::is_time_to_take_away(&step) && !self.is_taken_away {
            self.is_taken_away = true;
            if let Some(hands) = &mut self.hands {
                hands.take_away();
            }
        }
        for line in self.of_pad.try_iter().filter(|line| words::is_of_line(line)) {
            say(line);
        }
        for line in words::lines(&step, self.guide.weight_g(), self.guide.trouble()) {
            if !self.said.contains(&line) {
                say(&line);
                self.said.push(line);
            }
        }
    }
}

/// Whether something else is to be done; or the same anew, because it was too short.
fn is_other(begun: &BenchStep, step: &BenchStep) -> bool {
    match (begun, step) {
        (BenchStep::Rest { is_again: was, .. }, BenchStep::Rest { is_again: is, .. }) => was != is,
        (BenchStep::Weigh { .. }, BenchStep::Weigh { touch: Touch::TooShort }) => false,
        (BenchStep::Weigh { .. }, BenchStep::Weigh { .. }) => false,
        (BenchStep::Do { deed: one, is_again: was, .. }, BenchStep::Do { deed, is_again: is, .. }) => {
            one != deed || was != is
        }
        (begun, step) => std::mem::discriminant(begun) != std::mem::discriminant(step),
    }
}
