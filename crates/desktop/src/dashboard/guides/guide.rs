//! The interface of a guide, and its status as the page shows it.

use std::sync::Arc;
use std::sync::mpsc::Receiver;

use serde::Serialize;

use crate::dashboard::call_subscribers::TimedCall;
use crate::dashboard::host::DashboardHost;
use crate::dashboard::practice::{PressWish, Wish};
use crate::dashboard::replay_buffer::ReplayBuffer;
use crate::dashboard::shadow::ConnectedPad;
use tactpad_bridge::request::{Request, RequestSender};
use tactpad_bridge::snapshot::Status;
use tactpad_core::time::HostInstant;

/// Why an action is refused that no step offers.
pub(super) const NO_ACTION: &str = "this step has no such action";

/// A guide.
pub(super) trait PageGuide: Send {
    /// Its name in requests.
    fn id(&self) -> &'static str;

    /// Begins anew.
    ///
    /// # Errors
    /// It cannot begin; the text is for people.
    fn start(&mut self, context: &GuideContext<'_>) -> Result<(), String>;

    /// Ends before its end.
    fn stop(&mut self, context: &GuideContext<'_>);

    /// Nobody looks any more.
    fn on_page_closed(&mut self, _scene: &GuideContext<'_>) {}

    /// Looks at what has happened; called some ten times a second.
    fn update(&mut self, context: &GuideContext<'_>);

    /// Does what people choose in a step, with the number that they gave; what is to be asked of the bridge for it.
    ///
    /// # Errors
    /// There is no such action now, or it cannot be done; the text is for people.
    fn act(
        &mut self,
        _action: &str,
        _number: Option<f64>,
        _scene: &GuideContext<'_>,
    ) -> Result<Option<Request>, String> {
        Err(NO_ACTION.into())
    }

    /// How it stands.
    fn status(&self) -> GuideStatus;
}

/// The context of a guide: the state of the bridge and the handles that it may use.
pub(in crate::dashboard) struct GuideContext<'s> {
    /// Host time.
    pub(in crate::dashboard) now: HostInstant,
    pub(in crate::dashboard) status: &'s Status,
    pub(in crate::dashboard) pad: ConnectedPad,
    /// The text of the profile that is played, if it has a name, and that name.
    pub(in crate::dashboard) profile: &'s dyn Fn() -> Option<(String, String)>,
    /// The last minute of play.
    pub(in crate::dashboard) past: &'s dyn Fn() -> Option<ReplayBuffer>,
    /// Hears all calls from now on.
    pub(in crate::dashboard) subscribe: &'s dyn Fn() -> Receiver<TimedCall>,
    /// Asks the bridge, also later and from another thread.
    pub(in crate::dashboard) sender: &'s Arc<RequestSender>,
    /// The program around the bridge.
    pub(in crate::dashboard) host: &'s Arc<dyn DashboardHost>,
}

/// How a guide stands, as the page reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::dashboard) struct GuideStatus {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) about: &'static str,
    pub(super) state: GuideState,
    pub(super) steps: Vec<PageStep>,
    pub(super) result: Option<GuideResult>,
}

/// Where a guide is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum GuideState {
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
pub(super) struct PageStep {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    /// The instruction.
    pub(super) text: &'static str,
    pub(super) state: StepState,
    /// Details at this moment.
    pub(super) detail: Option<String>,
    /// The instruction at this very moment; it is read out as soon as it changes.
    pub(super) cue: Option<String>,
    /// Where that is to be done; it is lit on the plate.
    pub(super) target: Option<Target>,
    /// How much of it is done, from 0 to 1.
    pub(super) progress: Option<f64>,
    pub(super) actions: Vec<StepAction>,
    pub(super) links: Vec<Link>,
}

impl PageStep {
    /// One that comes later.
    pub(super) fn to_do(id: &'static str, title: &'static str, text: &'static str) -> Self {
        let (actions, links) = (Vec::new(), Vec::new());
        Self {
            id,
            title,
            text,
            state: StepState::Todo,
            detail: None,
            cue: None,
            target: None,
            progress: None,
            actions,
            links,
        }
    }
}

/// A place of the plate, and the direction along it in which it is to be pushed there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Target {
    at_mm: [f32; 2],
    push: [f32; 2],
}

impl Target {
    /// Where a wish is to be done; nowhere if the pad is to be left alone.
    pub(super) fn of(wish: Wish) -> Option<Self> {
        match wish {
            Wish::Press(PressWish { at_mm, push, .. }) => Some(Self { at_mm, push }),
            Wish::Lay { mark_mm, .. } => Some(Self { at_mm: mark_mm.map(|mm| mm as f32), push: [0.0; 2] }),
            Wish::Rest | Wish::Anywhere | Wish::TakeAway => None,
        }
    }
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

/// An action that people can choose in a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct StepAction {
    #[serde(rename = "do")]
    pub(super) name: &'static str,
    pub(super) label: &'static str,
    /// The number that it takes, if it takes one.
    pub(super) number: Option<NumberField>,
}

/// A number that people give.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct NumberField {
    pub(super) label: &'static str,
    pub(super) unit: &'static str,
    pub(super) least: f64,
    pub(super) largest: f64,
}

/// A file of the program that people may want.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Link {
    /// The path of its request.
    pub(super) path: &'static str,
    pub(super) label: &'static str,
}

/// The result of a guide.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct GuideResult {
    pub(super) text: String,
    /// A profile to look at in the editor.
    pub(super) draft: Option<Proposal>,
    /// Numbers that belong to it.
    pub(super) table: Option<ResultTable>,
    /// Commands for a terminal.
    pub(super) commands: Vec<CommandLine>,
}

/// Numbers with their names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ResultTable {
    pub(super) caption: &'static str,
    pub(super) heads: Vec<&'static str>,
    pub(super) rows: Vec<Vec<String>>,
}

/// A command, and what it does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct CommandLine {
    pub(super) label: &'static str,
    pub(super) text: String,
}

impl GuideResult {
    /// Words alone.
    pub(super) fn words(text: impl Into<String>) -> Self {
        Self { text: text.into(), ..Self::default() }
    }
}

/// A profile that a guide proposes; it is not kept.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Proposal {
    pub(super) profile: String,
    pub(super) text: String,
}

/// A result that is computed on another thread, or the reason why there is none.
pub(super) type PendingResult = Receiver<Result<GuideResult, String>>;
