//! The shadow pipeline: repeats the calls of the bridge on another thread, and feeds the page with the results.

use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use firmware_proto::identity::Identity;
use rustix::event::{Timespec, poll};

use super::call_subscribers::CallSubscribers;
use super::feed::{Feed, FeedUpdate, Moment};
use super::replay_buffer::ReplayBuffer;
use tactpad_bridge::clock::Clock;
use tactpad_bridge::latency::Durations;
use tactpad_bridge::observer::Observation;
use tactpad_bridge::snapshot::Uncertainty;
use tactpad_bridge::timing::{Stages, Stopwatch};
use tactpad_core::pipeline::call::OwnedCall;
use tactpad_core::pipeline::{Phase, Pipeline};
use tactpad_core::time::{HostInstant, StreamInstant};

/// Looks this often: 83 times a second. The live thread never wakes it.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 12_000_000 };

/// Points of the trace are at least so far apart.
const POINT_US: u64 = 2_000;

/// The state of the shadow pipeline, for readers on other threads.
#[derive(Debug, Default)]
pub(super) struct ShadowState {
    /// The last minute; nothing before the bridge has begun.
    pub(super) replay: Option<ReplayBuffer>,
    /// The connected pad and its identity.
    pub(super) pad: ConnectedPad,
    /// Subscribers to the calls themselves.
    pub(super) call_subscribers: CallSubscribers,
    /// How long decoding and mapping take here.
    pub(super) stages: Stages<Durations>,
}

/// The pad at the other end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ConnectedPad {
    pub(super) is_heard: bool,
    pub(super) identity: Option<Identity>,
}

/// A copy of the bridge's pipeline that follows its calls.
struct ShadowPipeline {
    pipeline: Pipeline,
    clock: Clock,
    /// The stream's time when this began, and how many samples there were by then.
    begun: (StreamInstant, u64),
    /// When the last point of the trace was, and whether that was a touch.
    last_point: (StreamInstant, bool),
}

/// Makes the calls on a thread of its own, until the bridge ends.
///
/// # Errors
/// The system has no thread to give.
pub(super) fn start(
    from: Receiver<Observation>,
    feed: Arc<Feed>,
    state: Arc<Mutex<ShadowState>>,
) -> std::io::Result<()> {
    thread::Builder::new().name("shadow".into()).spawn(move || {
        let mut shadow = None;
        while let Some(update) = drain(&from, &mut shadow, &state) {
            feed.add(update);
            // Nothing wakes it: it lets time pass.
            let _ = poll(&mut [], Some(&LOOK));
        }
        feed.end();
    })?;
    Ok(())
}

/// Makes all calls that wait. `None` once the bridge has ended.
fn drain(
    from: &Receiver<Observation>,
    shadow: &mut Option<ShadowPipeline>,
    state: &Mutex<ShadowState>,
) -> Option<FeedUpdate> {
    use std::sync::mpsc::TryRecvError::{Disconnected, Empty};
    let mut update = FeedUpdate::default();
    let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        match from.try_recv() {
            Ok(Observation::Checkpoint { clock, at, pipeline }) => {
                state.replay = Some(ReplayBuffer::new((*pipeline).clone()));
                let begun = shadow.insert(ShadowPipeline::begin(clock, *pipeline));
                update.profile = Some(Box::new(begun.pipeline.profile().clone()));
                update.now = Some(begun.now(at));
            }
            Ok(Observation::Call { at, call }) => {
                if let Some(shadow) = shadow {
                    shadow.make(at, &call, &mut state.stages, &mut update);
                    state.pad = shadow.pad();
                }
                state.call_subscribers.publish(at, &call);
                if let Some(replay) = &mut state.replay {
                    replay.push(at, call);
                }
            }
            Err(Empty) => return Some(update),
            Err(Disconnected) => return None,
        }
    }
}

impl ShadowPipeline {
    fn begin(clock: Clock, pipeline: Pipeline) -> Self {
        let begun = (pipeline.at(), pipeline.health().samples);
        Self { pipeline, clock, begun, last_point: Default::default() }
    }

    fn make(
        &mut self,
        at: HostInstant,
        call: &OwnedCall,
        stages: &mut Stages<Durations>,
        seen: &mut FeedUpdate,
    ) {
        let mut left = Some(call.as_call());
        let mut probe = Stopwatch::start(self.clock, stages);
        while let Some(call) = left {
            left = self.pipeline.apply(at, call, &mut probe);
            seen.events.extend_from_slice(self.pipeline.events());
            self.add_point(seen);
        }
        seen.presses.extend_from_slice(self.pipeline.verdicts());
        self.pipeline.forget_verdicts();
        if let OwnedCall::Profile(read) = call {
            seen.profile = Some(Box::new(read.profile().clone()));
        }
        seen.now = Some(self.now(at));
    }

    /// Adds where the finger is to the trace, if there is something new.
    fn add_point(&mut self, seen: &mut FeedUpdate) {
        let (t, contact) = (self.pipeline.at(), self.pipeline.contact().copied());
        let (last, was_touched) = self.last_point;
        let is_new = contact.is_some() && t.us_since(last) >= POINT_US;
        if is_new || contact.is_some() != was_touched {
            self.last_point = (t, contact.is_some());
            seen.trace.push((t, contact));
        }
    }

    fn pad(&self) -> ConnectedPad {
        ConnectedPad { is_heard: self.pipeline.is_heard(), identity: self.pipeline.identity().copied() }
    }

    fn now(&self, at: HostInstant) -> Moment {
        let pipeline = &self.pipeline;
        Moment {
            clock: self.clock,
            at,
            t: pipeline.at(),
            contact: pipeline.contact().copied(),
            uncertainty: pipeline.estimate().as_ref().map(Uncertainty::of),
            channels_uv: pipeline.strain().map(|strain| strain.uv),
            held: pipeline.held().collect(),
            is_playing: pipeline.phase() == Phase::Playing,
            period_us: self.period_us(),
        }
    }

    /// The mean time between samples; 0 without samples.
    fn period_us(&self) -> u64 {
        let (begin, samples) = self.begun;
        let samples = self.pipeline.health().samples.saturating_sub(samples);
        self.pipeline.at().us_since(begin).checked_div(samples).unwrap_or(0)
    }
}
