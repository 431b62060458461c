//! Where the guide is.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::standing::{Shared, Standing};
use crate::dashboard::guides::guide::{Outcome, Progress};

/// Where it is.
pub(super) enum Stage {
    /// It has not begun, or was stopped: what is said of that.
    Idle(Option<Outcome>),
    /// People say which weight they have.
    Choosing(Choice),
    /// It listens, fits, or is over.
    Begun(Begun),
}

/// What is to be begun.
pub(super) struct Choice {
    /// The name of what is kept of this pad.
    pub(super) name: String,
    /// Whether there is an earlier session.
    pub(super) was_begun: bool,
    /// Whether that is to be forgotten.
    pub(super) is_fresh: bool,
}

/// A session.
pub(super) struct Begun {
    pub(super) weight_g: Option<f64>,
    pub(super) shared: Arc<Shared>,
    pub(super) stop: Arc<AtomicBool>,
    /// How it stood when somebody looked last.
    pub(super) standing: Standing,
}

impl Default for Stage {
    fn default() -> Self {
        Self::Idle(None)
    }
}

impl Begun {
    /// How that is, as guides tell it.
    pub(super) const fn progress(&self) -> Progress {
        match &self.standing {
            Standing::Over(Ok(_)) => Progress::Done,
            Standing::Over(Err(_)) | Standing::Broken(..) => Progress::Failed,
            _ => Progress::Running,
        }
    }
}
