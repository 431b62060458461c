//! What a guide is, and how it tells where it is.

use std::sync::mpsc::Receiver;

use serde::Serialize;

use crate::bridge::request::Request;
use crate::bridge::snapshot::Status;
use crate::dashboard::past::Past;
use crate::time::HostInstant;

/// A guide.
pub(super) trait Guide: Send {
    /// Its name in requests.
    fn id(&self) -> &'static str;

    /// Begins anew.
    ///
    /// # Errors
    /// It cannot begin; the text is for people.
    fn start(&mut self, scene: &Scene<'_>) -> Result<(), String>;

    /// Ends before its end.
    fn stop(&mut self);

    /// Looks at what has happened; called some ten times a second.
    fn look(&mut self, scene: &Scene<'_>);

    /// What is asked of the bridge where people choose an action of a step; `None` if it has no such action.
    fn act(&mut self, action: &str) -> Option<Request>;

    /// How it stands.
    fn told(&self) -> Told;
}

/// What a guide sees.
pub(in crate::dashboard) struct Scene<'s> {
    /// Host time.
    pub(in crate::dashboard) now: HostInstant,
    pub(in crate::dashboard) status: &'s Status,
    /// The text of the profile that is played, if it has a name, and that name.
    pub(in crate::dashboard) profile: &'s dyn Fn() -> Option<(String, String)>,
    /// The last minute of play.
    pub(in crate::dashboard) past: &'s dyn Fn() -> Option<Past>,
}

/// How a guide stands, as the page reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::dashboard) struct Told {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) about: &'static str,
    pub(super) state: Progress,
    pub(super) steps: Vec<Step>,
    pub(super) result: Option<Outcome>,
}

/// Where a guide is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Progress {
    /// Not begun.
    #[default]
    Idle,
    /// On its way.
    Running,
    /// At its end.
    Done,
    /// It came to nothing.
    Failed,
}

/// One step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Step {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    /// What to do.
    pub(super) text: &'static str,
    pub(super) state: StepState,
    /// What there is to say of it now.
    pub(super) detail: Option<String>,
    /// What to do at this very moment; it is read out as soon as it changes.
    pub(super) cue: Option<String>,
    /// How much of it is done, from 0 to 1.
    pub(super) progress: Option<f64>,
    pub(super) actions: Vec<Action>,
}

/// Where a step is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum StepState {
    /// It comes later.
    Todo,
    /// It is the one to do.
    Doing,
    /// It is done.
    Done,
    /// It came to nothing.
    Failed,
}

/// What people can choose in a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Action {
    #[serde(rename = "do")]
    pub(super) name: &'static str,
    pub(super) label: &'static str,
}

/// What came of a guide.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Outcome {
    pub(super) text: String,
    /// A profile to look at in the editor.
    pub(super) draft: Option<Proposal>,
}

/// A profile that a guide proposes; it is not kept.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Proposal {
    pub(super) profile: String,
    pub(super) text: String,
}

/// What a guide works out beside the server's thread: a result, or why there is none.
pub(super) type Worked = Receiver<Result<Outcome, String>>;
