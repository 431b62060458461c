//! The steps of the guide, as the page shows them.

use super::session_state::{Position, SessionState};
use super::stage::{RunningSession, SessionOptions, Stage};
use crate::dashboard::guides::guide::{Link, NumberField, PageStep, StepAction, StepState};
use tactpad_bridge::state::State;
use tactpad_core::pad::marks::MARKS_MM;
use tactpad_core::pad::weight::GRAMS;
use tactpad_core::pipeline::Phase;
use tactpad_lab::play::guide::{GuideStep, LoadOnPad, REST_S, STILL_S};
use tactpad_lab::play::words::{WITHOUT_WEIGHT, instruction, progress, wrong};

/// The actions that people can choose before it begins.
pub(super) const WEIGHT: &str = "weight";
pub(super) const NO_WEIGHT: &str = "no-weight";
pub(super) const ANEW: &str = "anew";

/// Places in [`STEPS`].
const PREPARE: usize = 0;
const REST: usize = 1;
const PRESS: usize = 2;
const PUT: usize = 3;
const FIT: usize = 4;

/// The steps: a name, a title, what to do.
const STEPS: [(&str, &str, &str); 5] = [
    (
        "prepare",
        "Sheet and weight",
        "Print the sheet at 100 %: its bar must be 50 mm long. Cut the plate's outline out and tape it onto the plate, its arrow to the pad's \
         right. Weigh something of 100 to 500 g, with a foot no wider than 20 mm, on a kitchen scale.",
    ),
    ("rest", "Leave it alone", "So its zero is found."),
    (
        "press",
        "Press anywhere",
        "Press until the finger was on the pad for a minute in all. If you leave a part of the plate out, the guide goes on without it half a minute later.",
    ),
    (
        "marks",
        "Weight on the marks",
        "Take your hand away as soon as the weight stands. The guide notices by itself when it has lain still for two seconds.",
    ),
    (
        "fit",
        "Fit the decoder",
        "This takes half a minute at most. You need do nothing, and the game goes on.",
    ),
];

/// The steps as they stand.
pub(super) fn steps(stage: &Stage) -> Vec<PageStep> {
    let at = match stage {
        Stage::Idle(_) => None,
        Stage::Choosing(_) => Some(PREPARE),
        Stage::RunningSession(begun) => Some(number_of(&begun.standing)),
    };
    let has_marks = !matches!(stage, Stage::RunningSession(RunningSession { weight_g: None, .. }));
    let step_of = |(number, (id, title, text)): (usize, (&'static str, &'static str, &'static str))| {
        let mut step = PageStep::to_do(id, title, text);
        match at {
            Some(at) if number < at => step.state = StepState::Done,
            Some(at) if number == at => begin(&mut step, stage),
            _ => {}
        }
        step
    };
    STEPS.into_iter().enumerate().filter(|(number, _)| has_marks || *number != PUT).map(step_of).collect()
}

/// Where a session is.
const fn number_of(standing: &SessionState) -> usize {
    match standing {
        SessionState::Opening => REST,
        SessionState::Guided(Position { step, .. }) | SessionState::Broken(step, _) => match step {
            GuideStep::Rest { .. } => REST,
            GuideStep::Press { .. } => PRESS,
            GuideStep::Put { .. } | GuideStep::TakeAway { .. } => PUT,
            GuideStep::Done => FIT,
        },
        SessionState::Fitting(_) | SessionState::Finished(_) => FIT,
    }
}

/// Fills in the step that is done now.
fn begin(step: &mut PageStep, stage: &Stage) {
    step.state = StepState::Doing;
    match stage {
        Stage::Idle(_) => {}
        Stage::Choosing(choice) => prepare(step, choice),
        Stage::RunningSession(begun) => match &begun.standing {
            SessionState::Opening => step.detail = Some("reading what was heard earlier".into()),
            SessionState::Guided(position) => guided(step, position, begun.weight_g),
            SessionState::Fitting(share) => step.progress = Some(*share),
            SessionState::Finished(Ok(_)) => step.state = StepState::Done,
            SessionState::Finished(Err(_)) | SessionState::Broken(..) => step.state = StepState::Failed,
        },
    }
}

fn prepare(step: &mut PageStep, choice: &SessionOptions) {
    let earlier = match (choice.was_begun, choice.is_fresh) {
        (false, _) => "",
        (true, false) => " What was heard of this pad earlier is kept, and it goes on from there.",
        (true, true) => " It begins anew: what was heard earlier is written over.",
    };
    step.detail = Some(format!("Without a weight {WITHOUT_WEIGHT}.{earlier}"));
    let [least, largest] = GRAMS;
    let number = Some(NumberField { label: "Weight in grams", unit: "g", least, largest });
    step.actions = vec![
        StepAction { name: WEIGHT, label: "Begin with this weight", number },
        StepAction { name: NO_WEIGHT, label: "Begin without a weight", number: None },
    ];
    if choice.was_begun && !choice.is_fresh {
        step.actions.push(StepAction { name: ANEW, label: "Forget what was heard earlier", number: None });
    }
    step.links = vec![
        Link { path: "/sheet/marks.pdf", label: "Sheet with the marks (PDF)" },
        Link { path: "/sheet/marks.svg", label: "Sheet with the marks (SVG)" },
    ];
}

fn guided(step: &mut PageStep, position: &Position, weight_g: Option<f64>) {
    let cue = wrong(&position.cue, weight_g).unwrap_or_else(|| instruction(&position.cue, weight_g));
    step.cue = Some(obstacle(position.phase).map_or(cue, Into::into));
    let how_far = wrong(&position.step, weight_g).unwrap_or_else(|| progress(&position.step));
    step.detail = Some(how_far).filter(|text| !text.is_empty());
    step.progress = Some(share(position));
}

/// The obstacle that has to be removed first.
const fn obstacle(phase: Phase) -> Option<&'static str> {
    let state = match phase {
        Phase::Waiting => State::Waiting,
        Phase::Loaded => State::Loaded,
        Phase::Faulty => State::Faulty,
        Phase::Refused => State::Refused,
        // These pass by themselves.
        Phase::Taring | Phase::Doubtful | Phase::Playing | Phase::Weighing | Phase::Paused => return None,
    };
    Some(state.sentence())
}

/// How much of the step is done.
fn share(position: &Position) -> f64 {
    let marks = MARKS_MM.len() as f64;
    let done = match &position.step {
        GuideStep::Rest { rested_s } => rested_s / REST_S,
        GuideStep::Press { pressed_s, of_s, .. } => pressed_s / of_s,
        GuideStep::Put { lying: LoadOnPad::Still { still_s }, .. } => {
            (position.placed as f64 + still_s / STILL_S) / marks
        }
        GuideStep::Put { .. } => position.placed as f64 / marks,
        GuideStep::TakeAway { .. } => (position.placed as f64 + 1.0) / marks,
        GuideStep::Done => 1.0,
    };
    done.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::dashboard::guides::guide::GuideResult;

    fn begun(standing: SessionState, weight_g: Option<f64>) -> Stage {
        Stage::RunningSession(RunningSession {
            weight_g,
            shared: Arc::default(),
            stop: Arc::default(),
            standing,
        })
    }

    fn guided(step: GuideStep, phase: Phase) -> SessionState {
        SessionState::Guided(Position { cue: step.clone(), step, placed: 1, phase })
    }

    fn doing(stage: &Stage) -> PageStep {
        steps(stage).into_iter().find(|step| step.state == StepState::Doing).unwrap()
    }

    #[test]
    fn a_weight_is_asked_for_with_its_bounds_and_earlier_sessions_can_be_forgotten() {
        let choice =
            |was_begun, is_fresh| Stage::Choosing(SessionOptions { name: "a".into(), was_begun, is_fresh });
        let names = |stage: &Stage| doing(stage).actions.iter().map(|it| it.name).collect::<Vec<_>>();
        assert_eq!(names(&choice(false, false)), [WEIGHT, NO_WEIGHT]);
        assert_eq!(names(&choice(true, false)), [WEIGHT, NO_WEIGHT, ANEW]);
        assert_eq!(names(&choice(true, true)), [WEIGHT, NO_WEIGHT]);
        let step = doing(&choice(true, false));
        assert!(
            step.detail.is_some_and(|it| it.contains("stays unknown") && it.contains("goes on from there"))
        );
        assert!(step.actions[0].number.as_ref().is_some_and(|it| (it.least, it.largest) == (30.0, 1000.0)));
    }

    #[test]
    fn each_step_has_its_cue_and_how_much_of_it_is_done() {
        let press = GuideStep::Press { pressed_s: 15.0, of_s: 60.0, next: "the left rim", missing: 2 };
        let step = doing(&begun(guided(press, Phase::Playing), None));
        assert_eq!((step.id, step.progress), ("press", Some(0.25)));
        assert_eq!(step.detail.as_deref(), Some("15 of 60 s; not yet: the left rim, and 1 more"));
        let still = GuideStep::Put { mark: 1, lying: LoadOnPad::Still { still_s: 1.0 } };
        let step = doing(&begun(guided(still, Phase::Playing), Some(200.0)));
        assert_eq!(step.cue.as_deref(), Some("put the weight of 200 g on mark 2 of 5 (right)"));
        assert!((step.progress.unwrap() - 0.3).abs() < 1e-9);
        let early = GuideStep::Put { mark: 1, lying: LoadOnPad::TakenTooEarly };
        let step = doing(&begun(guided(early, Phase::Playing), Some(200.0)));
        assert!(step.cue.unwrap().contains("once more"));
        let rest = GuideStep::Rest { rested_s: 0.0 };
        let step = doing(&begun(guided(rest, Phase::Waiting), Some(200.0)));
        assert_eq!(step.cue.as_deref(), Some(State::Waiting.sentence()), "the pad comes first");
    }

    #[test]
    fn without_a_weight_there_are_no_marks_and_an_end_is_done_or_failed() {
        let states = |stage: &Stage| steps(stage).iter().map(|it| (it.id, it.state)).collect::<Vec<_>>();
        let fit = |standing| states(&begun(standing, None)).last().copied();
        assert!(states(&begun(SessionState::Opening, None)).iter().all(|(id, _)| *id != "marks"));
        assert_eq!(fit(SessionState::Fitting(0.5)), Some(("fit", StepState::Doing)));
        assert_eq!(fit(SessionState::Finished(Ok(GuideResult::default()))), Some(("fit", StepState::Done)));
        assert_eq!(fit(SessionState::Finished(Err("no".into()))), Some(("fit", StepState::Failed)));
        let lifted = SessionState::Broken(
            GuideStep::Press { pressed_s: 9.0, of_s: 60.0, next: "", missing: 1 },
            "full".into(),
        );
        let broken = begun(lifted.clone(), None);
        assert!(states(&broken).contains(&("press", StepState::Failed)), "it failed where it was");
        assert_eq!(lifted.outcome(), Some(GuideResult::words("full")));
        assert!(states(&Stage::default()).iter().all(|(_, state)| *state == StepState::Todo));
    }
}
