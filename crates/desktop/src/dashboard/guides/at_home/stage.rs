//! Where the guide is.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::session_state::{SessionState, SharedSessionState};
use crate::dashboard::guides::guide::{GuideResult, GuideState};

/// Where it is.
pub(super) enum Stage {
    /// It has not begun, or was stopped: what is said of that.
    Idle(Option<GuideResult>),
    /// People say which weight they have.
    Choosing(SessionOptions),
    /// It listens, fits, or is over.
    RunningSession(RunningSession),
}

/// The options of a session that has not begun.
pub(super) struct SessionOptions {
    /// The name of what is kept of this pad.
    pub(super) name: String,
    /// Whether there is an earlier session.
    pub(super) was_begun: bool,
    /// Whether that is to be forgotten.
    pub(super) is_fresh: bool,
}

/// A session.
pub(super) struct RunningSession {
    pub(super) weight_g: Option<f64>,
    pub(super) shared: Arc<SharedSessionState>,
    pub(super) stop: Arc<AtomicBool>,
    /// How it stood when somebody looked last.
    pub(super) standing: SessionState,
}

impl Default for Stage {
    fn default() -> Self {
        Self::Idle(None)
    }
}

impl RunningSession {
    /// How that is, as guides tell it.
    pub(super) const fn progress(&self) -> GuideState {
        match &self.standing {
            SessionState::Finished(Ok(_)) => GuideState::Done,
            SessionState::Finished(Err(_)) | SessionState::Broken(..) => GuideState::Failed,
            _ => GuideState::Running,
        }
    }
}
