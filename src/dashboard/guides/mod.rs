//! Guides: lists of steps with a state, that lead people through something. The page shows them and knows none by itself.

mod cues;
mod first_run;
mod force_range;
mod recording;

use std::sync::Arc;
use std::sync::mpsc::Receiver;

use serde::Serialize;

use super::past::Past;
use crate::bridge::request::Request;
use crate::bridge::snapshot::Status;
use crate::time::HostInstant;

/// A guide.
trait Guide: Send {
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
pub(super) struct Scene<'s> {
    /// Host time.
    pub(super) now: HostInstant,
    pub(super) status: &'s Status,
    /// The text of the profile that is played, if it has a name, and that name.
    pub(super) profile: &'s dyn Fn() -> Option<(String, String)>,
    /// The last minute of play.
    pub(super) past: &'s dyn Fn() -> Option<Past>,
}

/// How a guide stands, as the page reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Told {
    id: &'static str,
    title: &'static str,
    about: &'static str,
    state: Progress,
    steps: Vec<Step>,
    result: Option<Outcome>,
}

/// Where a guide is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Progress {
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
struct Step {
    id: &'static str,
    title: &'static str,
    /// What to do.
    text: &'static str,
    state: StepState,
    /// What there is to say of it now.
    detail: Option<String>,
    /// What to do at this very moment; it is read out as soon as it changes.
    cue: Option<String>,
    /// How much of it is done, from 0 to 1.
    progress: Option<f64>,
    actions: Vec<Action>,
}

/// Where a step is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum StepState {
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
struct Action {
    #[serde(rename = "do")]
    name: &'static str,
    label: &'static str,
}

/// What came of a guide.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Outcome {
    text: String,
    /// A profile to look at in the editor.
    draft: Option<Proposal>,
}

/// A profile that a guide proposes; it is not kept.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Proposal {
    profile: String,
    text: String,
}

/// What a guide works out beside the server's thread: a result, or why there is none.
type Worked = Receiver<Result<Outcome, String>>;

/// All guides, and what was told of each.
pub(super) struct Guides {
    all: Vec<Box<dyn Guide>>,
    told: Vec<Arc<str>>,
    /// Counts what changed.
    changes: u64,
}

impl Guides {
    /// None has begun.
    pub(super) fn new() -> Self {
        let all: Vec<Box<dyn Guide>> = vec![
            Box::<first_run::FirstRun>::default(),
            Box::<force_range::ForceRange>::default(),
            Box::<cues::Cues>::default(),
        ];
        let told = vec![Arc::from(""); all.len()];
        Self { all, told, changes: 0 }
    }

    /// How all of them stand.
    pub(super) fn told(&self) -> Vec<Told> {
        self.all.iter().map(|guide| guide.told()).collect()
    }

    /// Lets all of them look. What has changed is told to each page that asks with the number that it had before.
    pub(super) fn look(&mut self, scene: &Scene<'_>) {
        for (guide, told) in self.all.iter_mut().zip(&mut self.told) {
            guide.look(scene);
            let now = super::frame::json(&guide.told());
            if now.as_str() != &**told {
                *told = now.into();
                self.changes += 1;
            }
        }
    }

    /// How often anything changed.
    pub(super) fn changes(&self) -> u64 {
        self.changes
    }

    /// All guides as messages.
    pub(super) fn messages(&self) -> Vec<String> {
        let told = self.told.iter().filter(|told| !told.is_empty());
        told.map(|told| format!(r#"{{"kind":"guide","guide":{told}}}"#)).collect()
    }

    /// Does what people ask of a guide: `start`, `stop`, or an action of a step. `None` if there is no such guide.
    pub(super) fn act(&mut self, id: &str, action: &str, scene: &Scene<'_>) -> Option<Result<Done, String>> {
        let guide = self.all.iter_mut().find(|guide| guide.id() == id)?;
        let asked = match action {
            "start" => guide.start(scene).map(|()| None),
            "stop" => {
                guide.stop();
                Ok(None)
            }
            action => guide.act(action).map(Some).ok_or_else(|| "this step has no such action".to_owned()),
        };
        guide.look(scene);
        Some(asked.map(|request| Done { told: guide.told(), request }))
    }
}

/// What came of an action.
pub(super) struct Done {
    pub(super) told: Told,
    /// What is to be asked of the bridge.
    pub(super) request: Option<Request>,
}
