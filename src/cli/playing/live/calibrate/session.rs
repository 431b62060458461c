//! The session: a thread that hears every call, asks the guide, saves the calls, and says what to do.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use super::hands::Hands;
use super::kept::SessionFiles;
use super::screen::SessionScreen;
use crate::cli::failure::Failure;
use tactpad::bridge::observer::Observation;
use tactpad::bridge::request::{Request, RequestSender};
use tactpad::lab::play::guide::{Guide, GuideStep};
use tactpad::lab::play::words::is_other;
use tactpad::pipeline::call::Call;
use tactpad::time::HostInstant;

/// Interval between two updates of the screen while no call comes.
const LOOK: Duration = Duration::from_millis(100);

/// A session that goes on.
pub(super) struct Session {
    guide: Guide,
    files: SessionFiles,
    hands: Option<Hands>,
    sender: RequestSender,
    screen: SessionScreen,
    /// The step that was begun last, and how many windows were judged when it was shown.
    begun: Option<GuideStep>,
    judged: usize,
}

impl Session {
    /// A session; the hands do what it asks for.
    pub(super) fn new(
        guide: Guide,
        files: SessionFiles,
        hands: Option<Hands>,
        sender: RequestSender,
        screen: SessionScreen,
    ) -> Self {
        Self { guide, files, hands, sender, screen, begun: None, judged: 0 }
    }

    /// Goes on until nothing is left to do, and then ends the bridge; or until the bridge has ended.
    pub(super) fn run(mut self, calls: &Receiver<Observation>) -> Result<Guide, Failure> {
        let went = self.hear(calls);
        let settled = self.files.settle(self.guide.placements());
        self.screen.end();
        // A bridge that has ended needs no word.
        let _ = self.sender.send(Request::End);
        went.and(settled).map(|()| self.guide)
    }

    fn hear(&mut self, calls: &Receiver<Observation>) -> Result<(), Failure> {
        self.attend()?;
        while *self.guide.step() != GuideStep::Done {
            match calls.recv_timeout(LOOK) {
                Ok(Observation::Call { at, call }) => self.take(at, call.as_call())?,
                // Calls that found no room are missing in the capture, too: for the guide they are a gap.
                Ok(Observation::Checkpoint { .. }) => {}
                Err(RecvTimeoutError::Timeout) => self.screen.show(&self.guide),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        Ok(())
    }

    fn take(&mut self, at: HostInstant, call: Call<'_>) -> Result<(), Failure> {
        let at = self.files.at(at);
        self.files.write(at, call)?;
        self.guide.apply(at, call);
        if self.guide.judged() == self.judged {
            return Ok(());
        }
        self.judged = self.guide.judged();
        self.attend()
    }

    /// Does what a step begins with, and says what to do.
    fn attend(&mut self) -> Result<(), Failure> {
        let step = self.guide.step().clone();
        if self.begun.as_ref().is_none_or(|begun| is_other(begun, &step)) {
            if let Some(hands) = &mut self.hands {
                hands.obey(&step, self.guide.weight_g());
            }
            self.files.settle(self.guide.placements())?;
            self.begun = Some(step);
        }
        self.screen.show(&self.guide);
        Ok(())
    }
}
