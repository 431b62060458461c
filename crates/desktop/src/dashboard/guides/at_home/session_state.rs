//! How a session stands, told by its thread to whoever looks.

use std::sync::{Mutex, PoisonError};

use crate::dashboard::guides::guide::GuideResult;
use tactpad_core::pipeline::Phase;
use tactpad_lab::play::guide::{Guide, GuideStep};

/// How it stands.
#[derive(Clone, Debug, Default)]
pub(super) enum SessionState {
    /// The recording of an earlier session is read.
    #[default]
    Opening,
    /// It listens.
    Guided(Position),
    /// The decoder is fitted: so much of it is done, from 0 to 1.
    Fitting(f64),
    /// It broke off in this step.
    Broken(GuideStep, String),
    /// The result of the fit, or why there is none.
    Finished(Result<GuideResult, String>),
}

/// Where a session that listens is.
#[derive(Clone, Debug)]
pub(super) struct Position {
    pub(super) step: GuideStep,
    /// The same step, as it was when something else was to be done or mended last.
    pub(super) cue: GuideStep,
    /// Marks that the weight was put on.
    pub(super) placed: usize,
    /// The phase of the pad.
    pub(super) phase: Phase,
}

/// The place where it is told.
#[derive(Debug, Default)]
pub(super) struct SharedSessionState(Mutex<SessionState>);

impl SharedSessionState {
    /// How it stands now.
    pub(super) fn now(&self) -> SessionState {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// It stands so from now on.
    pub(super) fn set(&self, standing: SessionState) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = standing;
    }

    /// It failed where it stands.
    pub(super) fn fail(&self, why: String) {
        self.set(match self.now() {
            SessionState::Opening => SessionState::Broken(GuideStep::Rest { rested_s: 0.0 }, why),
            SessionState::Guided(Position { step, .. }) | SessionState::Broken(step, _) => {
                SessionState::Broken(step, why)
            }
            SessionState::Fitting(_) | SessionState::Finished(_) => SessionState::Finished(Err(why)),
        });
    }
}

impl SessionState {
    /// Whether it needs somebody at the pad.
    pub(super) const fn listens(&self) -> bool {
        matches!(self, Self::Opening | Self::Guided(_))
    }

    /// The result, or the error in words.
    pub(super) fn outcome(&self) -> Option<GuideResult> {
        match self {
            Self::Finished(Ok(outcome)) => Some(outcome.clone()),
            Self::Finished(Err(why)) | Self::Broken(_, why) => Some(GuideResult::words(why)),
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
