//! Lets another thread see every call that is made on the pipeline, so that it can make them again on a pipeline of its own. The same
//! calls give the same events, so that thread sees all that the live one does, and the live one waits for nobody.

use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use crate::clock::Clock;
use tactpad_core::pipeline::Pipeline;
use tactpad_core::pipeline::call::{Call, OwnedCall};
use tactpad_core::time::HostInstant;

/// Largest number of calls that wait: two seconds of a pad at 8 kHz, whose reads bring a frame each.
const CALLS_MAX: usize = 16 << 10;

/// Interval between checkpoints after calls that found no room, in microseconds: copying the pipeline takes longer than a call.
const CHECKPOINT_US: u64 = 100_000;

/// A message to an observer.
#[derive(Clone, Debug)]
pub enum Observation {
    /// A copy of the pipeline, at the start and after calls that found no room. What follows goes on from here.
    Checkpoint {
        /// The clock of all instants.
        clock: Clock,
        /// When it stood so.
        at: HostInstant,
        /// The pipeline.
        pipeline: Box<Pipeline>,
    },
    /// A call that was made on it.
    Call {
        /// When it was made.
        at: HostInstant,
        /// The call.
        call: OwnedCall,
    },
}

/// The bridge's end of the channel to an observer.
#[derive(Debug)]
pub struct Observer {
    to: SyncSender<Observation>,
    /// Time of the next checkpoint, because calls are missing at the other end.
    checkpoint_at: Option<HostInstant>,
    is_disconnected: bool,
}

/// An observer for a bridge, and the receiver of its messages. Nothing wakes the receiver: it polls.
pub fn observe() -> (Observer, Receiver<Observation>) {
    let (to, from) = sync_channel(CALLS_MAX);
    (Observer { to, checkpoint_at: None, is_disconnected: false }, from)
}

impl Observer {
    /// Sends the pipeline before its first call.
    pub(super) fn begin(&mut self, clock: Clock, at: HostInstant, pipeline: &Pipeline) {
        self.send_checkpoint(clock, at, pipeline);
    }

    /// Sends a call that was made. After calls that found no room it sends the whole pipeline, as soon as there is room.
    pub(super) fn tell(&mut self, clock: Clock, at: HostInstant, call: Call<'_>, pipeline: &Pipeline) {
        if self.is_disconnected {
            return;
        }
        match self.checkpoint_at {
            None => self.send(at, Observation::Call { at, call: call.into() }),
            Some(checkpoint_at) if checkpoint_at <= at => self.send_checkpoint(clock, at, pipeline),
            Some(_) => {}
        }
    }

    fn send_checkpoint(&mut self, clock: Clock, at: HostInstant, pipeline: &Pipeline) {
        self.send(at, Observation::Checkpoint { clock, at, pipeline: Box::new(pipeline.clone()) });
    }

    fn send(&mut self, at: HostInstant, observed: Observation) {
        match self.to.try_send(observed) {
            Ok(()) => self.checkpoint_at = None,
            Err(TrySendError::Full(_)) => self.checkpoint_at = Some(at.plus_us(CHECKPOINT_US)),
            Err(TrySendError::Disconnected(_)) => self.is_disconnected = true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::NoProbe;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad_core::pipeline::mapping::read::shipped as profiles;
    use tactpad_core::pipeline::shipped;

    fn pipeline() -> Pipeline {
        let profile = read(profiles::text("contra").unwrap(), OutputChoice::AsWritten).0.unwrap();
        Pipeline::new(shipped::decoder(), profile)
    }

    #[test]
    fn who_hears_too_late_begins_anew_with_the_whole() {
        let (mut observer, from) = observe();
        let (clock, mut live) = (Clock::start(), pipeline());
        observer.begin(clock, HostInstant::default(), &live);
        for us in 0..CALLS_MAX as u64 + 10 {
            let at = HostInstant::default().plus_us(us);
            let _ = live.apply(at, Call::Pause, &mut NoProbe);
            observer.tell(clock, at, Call::Pause, &live);
        }
        let heard: Vec<_> = from.try_iter().collect();
        assert_eq!(heard.len(), CALLS_MAX);
        assert!(matches!(heard[0], Observation::Checkpoint { .. }));
        assert!(heard[1..].iter().all(|it| matches!(it, Observation::Call { .. })));
        let _ = live.apply(HostInstant::default(), Call::Resume, &mut NoProbe);
        let [soon, later] =
            [1, 2].map(|part| HostInstant::default().plus_us(CALLS_MAX as u64 + part * CHECKPOINT_US));
        observer.tell(clock, HostInstant::default(), Call::Resume, &live);
        assert_eq!(from.try_iter().count(), 0, "it was offered just now");
        observer.tell(clock, soon, Call::Resume, &live);
        observer.tell(clock, later, Call::Pause, &live);
        let heard: Vec<_> = from.try_iter().collect();
        assert!(
            matches!(&heard[0], Observation::Checkpoint { pipeline, .. } if pipeline.phase() == live.phase())
        );
        assert!(matches!(&heard[1], Observation::Call { call: OwnedCall::Plain(Call::Pause), .. }));
    }

    #[test]
    fn who_went_away_is_told_nothing_more() {
        let (mut observer, from) = observe();
        drop(from);
        observer.begin(Clock::start(), HostInstant::default(), &pipeline());
        assert!(observer.is_disconnected);
    }
}
