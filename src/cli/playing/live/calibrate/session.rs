//! The session: a thread that hears every call, asks the guide, keeps what was heard, and says what to do.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use super::hands::Hands;
use super::kept::Kept;
use super::told::Told;
use crate::cli::failure::Failure;
use tactpad::bridge::observer::Observed;
use tactpad::bridge::request::{Asker, Request};
use tactpad::lab::play::guide::{Guide, GuideStep};
use tactpad::lab::play::words::is_other;
use tactpad::pipeline::call::Call;
use tactpad::time::HostInstant;

/// Something new is told this often although no call came.
const LOOK: Duration = Duration::from_millis(100);

/// A session that goes on.
pub(super) struct Session {
    guide: Guide,
    kept: Kept,
    hands: Option<Hands>,
    asker: Asker,
    told: Told,
    /// The step that was begun last, and how many windows were judged when it was told.
    begun: Option<GuideStep>,
    judged: usize,
}

impl Session {
    /// A session; the hands do what it asks for.
    pub(super) fn new((guide, kept): (Guide, Kept), hands: Option<Hands>, asker: Asker, told: Told) -> Self {
        Self { guide, kept, hands, asker, told, begun: None, judged: 0 }
    }

    /// Goes on until nothing is left to do, and then ends the bridge; or until the bridge has ended.
    pub(super) fn run(mut self, heard: &Receiver<Observed>) -> Result<Guide, Failure> {
        let went = self.hear(heard);
        let settled = self.kept.settle(self.guide.placements());
        self.told.end();
        // A bridge that has ended needs no word.
        let _ = self.asker.ask(Request::End);
        went.and(settled).map(|()| self.guide)
    }

    fn hear(&mut self, heard: &Receiver<Observed>) -> Result<(), Failure> {
        self.attend()?;
        while *self.guide.step() != GuideStep::Done {
            match heard.recv_timeout(LOOK) {
                Ok(Observed::Call { at, call }) => self.take(at, call.as_call())?,
                // Calls that found no room are missing in the capture, too: for the guide they are a gap.
                Ok(Observed::Whole { .. }) => {}
                Err(RecvTimeoutError::Timeout) => self.told.show(&self.guide),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        Ok(())
    }

    fn take(&mut self, at: HostInstant, call: Call<'_>) -> Result<(), Failure> {
        let at = self.kept.at(at);
        self.kept.write(at, call)?;
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
            self.kept.settle(self.guide.placements())?;
            self.begun = Some(step);
        }
        self.told.show(&self.guide);
        Ok(())
    }
}
