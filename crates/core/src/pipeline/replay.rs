//! Replays contacts that are decoded already: the pipeline's mapping and output, without what comes before them.

use crate::pipeline::control::OutputEvent;
use crate::pipeline::mapping::live::engine::Engine;
use crate::pipeline::mapping::profile::Profile;
use crate::pipeline::output::ledger::{Edges, Ledger};
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// Contacts on their way to events, in order of time.
#[derive(Debug)]
pub struct ContactReplay {
    engine: Engine,
    ledger: Ledger,
}

impl ContactReplay {
    /// Nothing is touched, nothing is held.
    pub fn new(profile: Profile) -> Self {
        Self { ledger: Ledger::new(&profile), engine: Engine::new(profile) }
    }

    /// Takes the contact at `at`, `None` for a lift, and hands on what is due before and what comes of it.
    ///
    /// # Errors
    /// What `deliver` returns ends the step.
    pub fn step<E>(
        &mut self,
        at: StreamInstant,
        contact: Option<&Contact>,
        deliver: &mut impl FnMut(&[OutputEvent]) -> Result<(), E>,
    ) -> Result<(), E> {
        self.settle(at, deliver)?;
        let mut edges = Edges::new();
        // A tap is stated once. The second step, at the same instant, tells the ledger that it is over.
        for _ in 0..2 {
            self.ledger.update(at, &self.engine.step(at, contact), &mut edges);
        }
        deliver(&edges)
    }

    /// Hands on what the minimum press held back and is due before `until`.
    ///
    /// # Errors
    /// What `deliver` returns ends it.
    pub fn settle<E>(
        &mut self,
        until: StreamInstant,
        deliver: &mut impl FnMut(&[OutputEvent]) -> Result<(), E>,
    ) -> Result<(), E> {
        while let Some(due) = self.ledger.next_due().filter(|&due| due < until) {
            let mut edges = Edges::new();
            self.ledger.settle(due, &mut edges);
            deliver(&edges)?;
        }
        Ok(())
    }
}
