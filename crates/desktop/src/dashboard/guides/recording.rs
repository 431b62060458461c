//! Cues that a guide gives at the pace of the hand, what came of them, and what is worked out of that on a thread of its own.

use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use super::cue_sequence::{AnsweredCue, CueSequence, CueTarget, PadObservation};
use super::guide::{
    GuideContext, GuideResult, GuideState, NO_ACTION, PageStep, PendingResult, StepAction, StepState, Target,
};
use super::permutation_test::{ERROR_RATE, follow};
use super::pieces::{Pieces, TAIL_US};
use crate::dashboard::call_subscribers::TimedCall;
use crate::dashboard::practice::Wish;
use crate::dashboard::replay_buffer::{ReplayBuffer, make};
use crate::dashboard::user_key::random;
use tactpad_core::pipeline::call::OwnedCall;
use tactpad_lab::tuning::trace::{Trace, Tracer};

/// Why a profile cannot be fitted that was named by its file.
pub(super) const NO_NAME: &str = "the profile in play is a file, or is gone: choose one by its name first";

/// The pad may have sent so many bytes meanwhile: a quarter of an hour at 1 kHz.
const BYTES_MAX: usize = 40 << 20;

const PAUSE: StepAction = StepAction { name: "pause", label: "Pause", number: None };
const GO_ON: StepAction = StepAction { name: "go-on", label: "Go on", number: None };
const AGAIN: StepAction = StepAction { name: "again", label: "The last one again", number: None };
const LEAVE_OUT: StepAction = StepAction { name: "leave-out", label: "I cannot do this one", number: None };

/// Where a guide that gives cues is.
#[derive(Default)]
pub(super) enum Recording {
    /// It has not begun.
    #[default]
    Idle,
    /// It gives cues and records.
    On(Box<Ongoing>),
    /// It works out what came of it.
    Working(PendingResult),
    /// That is known.
    Finished(Result<GuideResult, String>),
}

/// A recording that is under way.
pub(super) struct Ongoing {
    asking: CueSequence,
    seed: u64,
    past: ReplayBuffer,
    heard: Receiver<TimedCall>,
    calls: Vec<TimedCall>,
    bytes: usize,
}

fn seen(context: &GuideContext<'_>) -> PadObservation {
    let is_touched = context.status.contact.is_some();
    PadObservation { now: context.now, is_touched, touches: context.status.health.pipeline.contacts }
}

impl Ongoing {
    fn hear(&mut self) {
        for (at, call) in self.heard.try_iter() {
            if let OwnedCall::Bytes(bytes) = &call {
                self.bytes += bytes.len();
            }
            self.calls.push((at, call));
        }
    }

    fn tell(&self, context: &GuideContext<'_>) {
        context.host.practise(self.asking.cue().map_or(Wish::Rest, |cue| cue.wish));
    }
}

impl Recording {
    /// Begins to ask for each of these so often.
    ///
    /// # Errors
    /// There is no pad yet, or the system has no random numbers; the text is for people.
    pub(super) fn begin(
        context: &GuideContext<'_>,
        targets: Vec<CueTarget>,
        repeats: usize,
    ) -> Result<Self, String> {
        let seed = u64::from_le_bytes(random().map_err(|error| error.to_string())?);
        let heard = (context.subscribe)();
        let past = (context.past)().ok_or("there is no pad yet: plug it in, then begin")?;
        let asking = CueSequence::begin(targets, repeats, seed, seen(context));
        let ongoing = Ongoing { asking, seed, past, heard, calls: Vec::new(), bytes: 0 };
        ongoing.tell(context);
        Ok(Self::On(Box::new(ongoing)))
    }

    /// Goes on: asks until all was asked, then lets `work` find what came of it, if the presses follow what was asked.
    pub(super) fn go_on(
        &mut self,
        context: &GuideContext<'_>,
        work: impl FnOnce(&Pieces) -> Result<GuideResult, String> + Send + 'static,
    ) {
        match self {
            Self::On(ongoing) => {
                ongoing.hear();
                if ongoing.asking.update(seen(context)) {
                    ongoing.tell(context);
                }
                if ongoing.bytes > BYTES_MAX {
                    let error = "this has taken a quarter of an hour, of which no more is kept: begin anew, and pause by Stop";
                    *self = Self::Finished(Err(error.into()));
                } else if ongoing.asking.is_over()
                    && let Self::On(ongoing) = std::mem::take(self)
                {
                    *self = worked(*ongoing, work);
                }
            }
            Self::Working(worked) => match worked.try_recv() {
                Ok(outcome) => *self = Self::Finished(outcome),
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => {
                    *self = Self::Finished(Err("this failed: begin anew".into()));
                }
            },
            Self::Idle | Self::Finished(_) => {}
        }
    }

    /// Does what people choose beside a cue.
    pub(super) fn act(&mut self, action: &str, context: &GuideContext<'_>) -> Result<(), String> {
        let Self::On(ongoing) = self else { return Err(NO_ACTION.into()) };
        let seen = seen(context);
        match action {
            "pause" => ongoing.asking.pause(),
            "go-on" => ongoing.asking.go_on(seen),
            "again" => ongoing.asking.again(seen),
            "leave-out" => ongoing.asking.leave_out(seen),
            _ => return Err(NO_ACTION.into()),
        }
        ongoing.tell(context);
        Ok(())
    }

    /// The step in which cues are given.
    pub(super) fn asking(&self, id: &'static str, title: &'static str, text: &'static str) -> PageStep {
        let step = PageStep::to_do(id, title, text);
        let asking = match self {
            Self::Idle => return step,
            Self::On(ongoing) => &ongoing.asking,
            Self::Working(_) | Self::Finished(_) => return PageStep { state: StepState::Done, ..step },
        };
        let (asked, count) = (asking.asked.len(), asking.count());
        let detail = if asking.is_paused { "it pauses".into() } else { format!("{} of {count}", asked + 1) };
        let cue = asking.cue();
        let mut actions = vec![if asking.is_paused { GO_ON } else { PAUSE }];
        if asked > 0 {
            actions.push(AGAIN);
        }
        if !asking.is_paused {
            actions.push(LEAVE_OUT);
        }
        PageStep {
            state: StepState::Doing,
            detail: Some(detail),
            cue: cue.map(|it| it.cue.clone()),
            target: cue.and_then(|it| Target::of(it.wish)),
            progress: Some(asked as f64 / count.max(1) as f64),
            actions,
            ..step
        }
    }

    /// The step in which it is worked out what came of it.
    pub(super) fn working(&self) -> PageStep {
        let state = match self {
            Self::Idle | Self::On(_) => StepState::Todo,
            Self::Working(_) => StepState::Doing,
            Self::Finished(Ok(_)) => StepState::Done,
            Self::Finished(Err(_)) => StepState::Failed,
        };
        let text = "This takes a few seconds. You need do nothing.";
        PageStep { state, ..PageStep::to_do("fit", "Fit the profile", text) }
    }

    /// Where the guide is.
    pub(super) const fn progress(&self) -> GuideState {
        match self {
            Self::Idle => GuideState::Idle,
            Self::On(_) | Self::Working(_) => GuideState::Running,
            Self::Finished(Ok(_)) => GuideState::Done,
            Self::Finished(Err(_)) => GuideState::Failed,
        }
    }

    /// The result, if it is known: a proposal, or in words why there is none.
    pub(super) fn outcome(&self) -> Option<GuideResult> {
        match self {
            Self::Finished(Ok(outcome)) => Some(outcome.clone()),
            Self::Finished(Err(text)) => Some(GuideResult::words(text)),
            Self::Idle | Self::On(_) | Self::Working(_) => None,
        }
    }
}

fn worked(
    ongoing: Ongoing,
    work: impl FnOnce(&Pieces) -> Result<GuideResult, String> + Send + 'static,
) -> Recording {
    let (tell, worked) = channel();
    let spawned = thread::Builder::new().name("guide".into()).spawn(move || {
        let Ongoing { asking, seed, past, calls, .. } = ongoing;
        let pieces = Pieces::of(stretches(past, &calls, &asking.asked));
        // Who stopped the guide does not hear it.
        let _ = tell.send(judged(&pieces, seed, work));
    });
    match spawned {
        Ok(_) => Recording::Working(worked),
        Err(error) => Recording::Finished(Err(error.to_string())),
    }
}

/// What `work` finds, if the presses follow what was asked.
pub(super) fn judged(
    pieces: &Pieces,
    seed: u64,
    work: impl FnOnce(&Pieces) -> Result<GuideResult, String>,
) -> Result<GuideResult, String> {
    if follow(&pieces.presses(), seed) {
        return work(pieces);
    }
    Err(format!(
        "These presses do not follow what was asked, so nothing is proposed: presses for the same cue are no more alike than in orders that \
         nobody asked for. Somebody who presses without looking at the cues is told so in {:.0} of 100 cases at least. Begin anew; there is no hurry, and \
         what this hand cannot do may be left out.",
        100.0 * (1.0 - ERROR_RATE)
    ))
}

/// What came for each cue. The pad's clock may have jumped in between, so each stretch has its own begin.
fn stretches(past: ReplayBuffer, calls: &[TimedCall], asked: &[AnsweredCue]) -> Vec<(usize, Trace)> {
    let ReplayBuffer { begin: mut pipeline, calls: earlier, .. } = past;
    let until = earlier.back().map(|(at, _)| *at);
    earlier.iter().for_each(|(at, call)| make(&mut pipeline, *at, call, |_| ()));
    let mut calls = calls.iter().filter(|(at, _)| until.is_none_or(|until| *at > until)).peekable();
    let stretch = |asked: &AnsweredCue| {
        while let Some((at, call)) = calls.next_if(|(at, _)| *at < asked.begin) {
            make(&mut pipeline, *at, call, |_| ());
        }
        let mut tracer = Tracer::going_on(pipeline.clone());
        while let Some((at, call)) = calls.next_if(|(at, _)| *at < asked.end.plus_us(TAIL_US)) {
            tracer.apply(*at, call.as_call());
            make(&mut pipeline, *at, call, |_| ());
        }
        (asked.target, tracer.finish())
    };
    asked.iter().map(stretch).collect()
}
