//! The first run: find the pad, may it be opened, measure its zero, press it.

use super::guide::{
    GuideContext, GuideState, GuideStatus, NO_ACTION, PageGuide, PageStep, StepAction, StepState,
};
use crate::dashboard::practice::{Level, PressWish, Wish};
use tactpad_bridge::request::Request;
use tactpad_bridge::state::State;

/// So many touches are enough to believe that it works.
const TOUCHES: u64 = 3;

const TARE: StepAction = StepAction { name: "tare", label: "Measure the zero", number: None };

/// The steps: a name, a title, what to do.
const STEPS: [(&str, &str, &str); 4] = [
    ("find", "Find the pad", "Plug the pad in. One pad at a time."),
    (
        "permission",
        "Let it be opened",
        "The system must let you open the pad. If it does not, the view Doctor has the command that mends it.",
    ),
    (
        "tare",
        "Measure the zero",
        "Leave the pad untouched for a second. Measure again if it lay on something.",
    ),
    ("try", "Press it", "Press the pad three times with one finger, and lift the finger in between."),
];

/// What a hand does to try the pad.
const PRESS: PressWish =
    PressWish { at_mm: [0.0; 2], push: [0.0; 2], level: Level::Usual, is_long: false, is_double: false };

/// The guide.
#[derive(Default)]
pub(super) struct FirstRun {
    state: GuideState,
    /// How many steps are done.
    done: usize,
    /// How many touches there were when the last step began.
    touches_before: Option<u64>,
    touches: u64,
    sentence: Option<&'static str>,
}

/// How many of the first three steps a state of the bridge means to be done.
const fn reached(state: State) -> usize {
    match state {
        State::Waiting | State::Unclear => 0,
        State::Denied => 1,
        State::Silent | State::Taring | State::Loaded | State::Refused | State::Faulty | State::Paused => 2,
        State::Unweighed | State::Playing | State::Weighing | State::Doubtful => 3,
    }
}

impl PageGuide for FirstRun {
    fn id(&self) -> &'static str {
        "first-run"
    }

    fn start(&mut self, _scene: &GuideContext<'_>) -> Result<(), String> {
        *self = Self { state: GuideState::Running, ..Self::default() };
        Ok(())
    }

    fn stop(&mut self, _scene: &GuideContext<'_>) {
        *self = Self::default();
    }

    fn update(&mut self, context: &GuideContext<'_>) {
        if self.state != GuideState::Running {
            return;
        }
        let status = context.status;
        let reached = reached(status.state);
        self.sentence = (reached < 3).then(|| status.state.sentence());
        // A pad that is pulled out has to be found again.
        self.done = reached;
        if reached < 3 {
            (self.touches_before, self.touches) = (None, 0);
            return;
        }
        let contacts = status.health.pipeline.contacts;
        let (is_first, before) = (self.touches_before.is_none(), self.touches);
        self.touches = contacts - *self.touches_before.get_or_insert(contacts);
        if is_first || self.touches != before {
            context.host.practise(if self.touches < TOUCHES { Wish::Press(PRESS) } else { Wish::Rest });
        }
        if self.touches >= TOUCHES {
            (self.state, self.done) = (GuideState::Done, STEPS.len());
        }
    }

    fn act(
        &mut self,
        action: &str,
        _number: Option<f64>,
        _scene: &GuideContext<'_>,
    ) -> Result<Option<Request>, String> {
        if action == TARE.name { Ok(Some(Request::Retare)) } else { Err(NO_ACTION.into()) }
    }

    fn status(&self) -> GuideStatus {
        let step = |(index, (id, title, text)): (usize, (&'static str, &'static str, &'static str))| {
            let state = match (self.state, index) {
                (GuideState::Idle | GuideState::Failed, _) => StepState::Todo,
                (_, index) if index < self.done => StepState::Done,
                (_, index) if index == self.done => StepState::Doing,
                _ => StepState::Todo,
            };
            let is_doing = state == StepState::Doing;
            let is_try = index == 3;
            let counted = || format!("{} of {TOUCHES} touches", self.touches);
            PageStep {
                state,
                detail: if is_try {
                    is_doing.then(counted)
                } else {
                    self.sentence.filter(|_| is_doing).map(Into::into)
                },
                progress: (is_try && is_doing).then_some(self.touches as f64 / TOUCHES as f64),
                actions: if index == 2 && self.state == GuideState::Running {
                    vec![TARE]
                } else {
                    Vec::new()
                },
                ..PageStep::to_do(id, title, text)
            }
        };
        GuideStatus {
            id: self.id(),
            title: "First run",
            about: "This leads you from plugging the pad in to the first press.",
            state: self.state,
            steps: STEPS.into_iter().enumerate().map(step).collect(),
            result: None,
        }
    }
}
