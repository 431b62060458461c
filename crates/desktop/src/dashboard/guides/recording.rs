//! A stretch of play that a guide asks for, and what is worked out of it on a thread of its own.

use std::sync::mpsc::{TryRecvError, channel};
use std::thread;

use super::guide::{GuideContext, GuideResult, GuideState, PageStep, PendingResult, StepState};
use crate::dashboard::replay_buffer::{ReplayBuffer, make};
use tactpad_core::time::HostInstant;
use tactpad_lab::tuning::trace::{Trace, Tracer};

/// Why a profile cannot be fitted that was named by its file.
pub(super) const NO_NAME: &str = "the profile in play is a file, or is gone: choose one by its name first";

/// Where a guide that records is.
#[derive(Default)]
pub(super) enum Recording {
    /// It has not begun.
    #[default]
    Idle,
    /// It records.
    On {
        /// Since then,
        begin: HostInstant,
        /// and so long by now.
        for_us: u64,
    },
    /// It works out what came of it.
    Working(PendingResult),
    /// That is known.
    Finished(Result<GuideResult, String>),
}

impl Recording {
    /// Begins to record.
    pub(super) fn begin(context: &GuideContext<'_>) -> Self {
        Self::On { begin: context.now, for_us: 0 }
    }

    /// Goes on: records until `length_us` are over, then lets `work` find what came of it.
    pub(super) fn go_on(
        &mut self,
        context: &GuideContext<'_>,
        length_us: u64,
        work: impl FnOnce(&Trace) -> Result<GuideResult, String> + Send + 'static,
    ) {
        match self {
            Self::On { begin, for_us } if context.now.us_since(*begin) < length_us => {
                *for_us = context.now.us_since(*begin);
            }
            Self::On { begin, .. } => *self = worked((context.past)(), *begin, work),
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

    /// How long it records by now, while it does.
    pub(super) const fn for_us(&self) -> Option<u64> {
        match self {
            Self::On { for_us, .. } => Some(*for_us),
            Self::Idle | Self::Working(_) | Self::Finished(_) => None,
        }
    }

    /// Where a step of the recording is, of which so much is done.
    pub(super) fn step(&self, done: Option<f64>) -> StepState {
        match (self, done) {
            (Self::Idle, _) => StepState::Todo,
            (Self::On { .. }, Some(done)) if done < 0.0 => StepState::Todo,
            (Self::On { .. }, Some(done)) if done < 1.0 => StepState::Doing,
            _ => StepState::Done,
        }
    }

    /// The step in which it is worked out what came of it.
    pub(super) fn working(&self) -> PageStep {
        let state = match self {
            Self::Idle | Self::On { .. } => StepState::Todo,
            Self::Working(_) => StepState::Doing,
            Self::Finished(Ok(_)) => StepState::Done,
            Self::Finished(Err(_)) => StepState::Failed,
        };
        let text = "This takes a few seconds; nothing is to be done.";
        PageStep { state, ..PageStep::to_do("fit", "Fit the profile", text) }
    }

    /// Where the guide is.
    pub(super) const fn progress(&self) -> GuideState {
        match self {
            Self::Idle => GuideState::Idle,
            Self::On { .. } | Self::Working(_) => GuideState::Running,
            Self::Finished(Ok(_)) => GuideState::Done,
            Self::Finished(Err(_)) => GuideState::Failed,
        }
    }

    /// The result, if it is known: a proposal, or in words why there is none.
    pub(super) fn outcome(&self) -> Option<GuideResult> {
        match self {
            Self::Finished(Ok(outcome)) => Some(outcome.clone()),
            Self::Finished(Err(text)) => Some(GuideResult::words(text)),
            Self::Idle | Self::On { .. } | Self::Working(_) => None,
        }
    }
}

fn worked(
    past: Option<ReplayBuffer>,
    begin: HostInstant,
    work: impl FnOnce(&Trace) -> Result<GuideResult, String> + Send + 'static,
) -> Recording {
    let (tell, worked) = channel();
    let spawned = thread::Builder::new().name("guide".into()).spawn(move || {
        let trace = past.map(|past| traced(past, begin)).unwrap_or_default();
        // Who stopped the guide does not hear it.
        let _ = tell.send(work(&trace));
    });
    match spawned {
        Ok(_) => Recording::Working(worked),
        Err(error) => Recording::Finished(Err(error.to_string())),
    }
}

/// The contacts since `begin`.
fn traced(past: ReplayBuffer, begin: HostInstant) -> Trace {
    let ReplayBuffer { begin: mut pipeline, mut calls, .. } = past;
    let earlier = calls.partition_point(|(at, _)| *at < begin);
    calls.drain(..earlier).for_each(|(at, call)| make(&mut pipeline, at, &call, |_| ()));
    let mut tracer = Tracer::going_on(pipeline);
    calls.iter().for_each(|(at, call)| tracer.apply(*at, call.as_call()));
    tracer.finish()
}
