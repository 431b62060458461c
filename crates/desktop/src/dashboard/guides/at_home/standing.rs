//! How a session stands, told by its thread to whoever looks.

use std::sync::{Mutex, PoisonError};

use crate::dashboard::guides::guide::Outcome;
use tactpad_core::pipeline::Phase;
use tactpad_lab::play::guide::{Guide, GuideStep};

/// How it stands.
#[derive(Clone, Debug, Default)]
pub(super) enum Standing {
    /// What was heard earlier is read.
    #[default]
    Opening,
    /// It listens.
    Guided(Position),
    /// The decoder is fitted: so much of it is done, from 0 to 1.
    Fitting(f64),
    /// It broke off in this step.
    Broken(GuideStep, String),
    /// What came of the fit, or why nothing did.
    Over(Result<Outcome, String>),
}

/// Where a session that listens is.
#[derive(Clone, Debug)]
pub(super) struct Position {
    pub(super) step: GuideStep,
    /// The same step, as it was when something else was to be done or mended last.
    pub(super) cue: GuideStep,
    /// Marks that the weight was put on.
    pub(super) placed: usize,
    /// What the pad is doing.
    pub(super) phase: Phase,
}

/// The place where it is told.
#[derive(Debug, Default)]
pub(super) struct Shared(Mutex<Standing>);

impl Shared {
    /// How it stands now.
    pub(super) fn now(&self) -> Standing {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// It stands so from now on.
    pub(super) fn set(&self, standing: Standing) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = standing;
    }

    /// It failed where it stands.
    pub(super) fn fail(&self, why: String) {
        self.set(match self.now() {
            Standing::Opening => Standing::Broken(GuideStep::Rest { rested_s: 0.0 }, why),
            Standing::Guided(Position { step, .. }) | Standing::Broken(step, _) => {
                Standing::Broken(step, why)
            }
            Standing::Fitting(_) | Standing::Over(_) => Standing::Over(Err(why)),
        });
    }
}

impl Standing {
    /// Whether it needs somebody at the pad.
    pub(super) const fn listens(&self) -> bool {
        matches!(self, Self::Opening | Self::Guided(_))
    }

    /// What came of it, in words where nothing did.
    pub(super) fn outcome(&self) -> Option<Outcome> {
        match self {
            Self::Over(Ok(outcome)) => Some(outcome.clone()),
            Self::Over(Err(why)) | Self::Broken(_, why) => Some(Outcome::words(why)),
            _ => None,
        }
    }
}

impl Position {
    /// Where this guide is; it asks for the same as at `cue`.
    pub(super) fn of(guide: &Guide, cue: &GuideStep) -> Self {
        Self {
            step: guide.step().clone(),
            cue: cue.clone(),
            placed: guide.placements().len(),
            phase: guide.phase(),
        }
    }
}
