//! Lets another thread see every call that is made on the pipeline, so that it can make them again on a pipeline of its own. The same
//! calls give the same events, so that thread sees all that the live one does, and the live one waits for nobody.

use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use crate::clock::Clock;
use tactpad_core::pipeline::Pipeline;
use tactpad_core::pipeline::call::{Call, OwnedCall};
use tactpad_core::time::HostInstant;

/// So many calls may wait: two seconds of a pad at 8 kHz, whose reads bring a frame each.
const CALLS_MAX: usize = 16 << 10;

/// After calls that found no room the whole is offered this often: copying it takes longer than a call.
const WHOLE_US: u64 = 100_000;

/// What an observer hears.
#[derive(Clone, Debug)]
pub enum Observed {
    /// The pipeline as it stands, at the begin and after calls that found no room. What follows goes on from here.
    Whole {
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

/// The bridge's end.
#[derive(Debug)]
pub struct Observer {
    to: SyncSender<Observed>,
    /// The other end has to begin anew, as calls are missing: from then on.
    begin_at: Option<HostInstant>,
    has_left: bool,
}

/// An observer for a bridge, and what hears it. Nothing wakes the one who hears: it looks when it wants to.
pub fn observe() -> (Observer, Receiver<Observed>) {
    let (to, from) = sync_channel(CALLS_MAX);
    (Observer { to, begin_at: None, has_left: false }, from)
}

impl Observer {
    /// Tells of the pipeline before its first call.
    pub(super) fn begin(&mut self, clock: Clock, at: HostInstant, pipeline: &Pipeline) {
        self.tell_whole(clock, at, pipeline);
    }

    /// Tells of a call that was made. After calls that found no room it tells of the whole pipeline, as soon as there is room.
    pub(super) fn tell(&mut self, clock: Clock, at: HostInstant, call: Call<'_>, pipeline: &Pipeline) {
        if self.has_left {
            return;
        }
        match self.begin_at {
            None => self.send(at, Observed::Call { at, call: call.into() }),
            Some(begin_at) if begin_at <= at => self.tell_whole(clock, at, pipeline),
            Some(_) => {}
        }
    }

    fn tell_whole(&mut self, clock: Clock, at: HostInstant, pipeline: &Pipeline) {
        self.send(at, Observed::Whole { clock, at, pipeline: Box::new(pipeline.clone()) });
    }

    fn send(&mut self, at: HostInstant, observed: Observed) {
        match self.to.try_send(observed) {
            Ok(()) => self.begin_at = None,
            Err(TrySendError::Full(_)) => self.begin_at = Some(at.plus_us(WHOLE_US)),
            Err(TrySendError::Disconnected(_)) => self.has_left = true,
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
        assert!(matches!(heard[0], Observed::Whole { .. }));
        assert!(heard[1..].iter().all(|it| matches!(it, Observed::Call { .. })));
        let _ = live.apply(HostInstant::default(), Call::Resume, &mut NoProbe);
        let [soon, later] =
            [1, 2].map(|part| HostInstant::default().plus_us(CALLS_MAX as u64 + part * WHOLE_US));
        observer.tell(clock, HostInstant::default(), Call::Resume, &live);
        assert_eq!(from.try_iter().count(), 0, "it was offered just now");
        observer.tell(clock, soon, Call::Resume, &live);
        observer.tell(clock, later, Call::Pause, &live);
        let heard: Vec<_> = from.try_iter().collect();
        assert!(matches!(&heard[0], Observed::Whole { pipeline, .. } if pipeline.phase() == live.phase()));
        assert!(matches!(&heard[1], Observed::Call { call: OwnedCall::Plain(Call::Pause), .. }));
    }

    #[test]
    fn who_went_away_is_told_nothing_more() {
        let (mut observer, from) = observe();
        drop(from);
        observer.begin(Clock::start(), HostInstant::default(), &pipeline());
        assert!(observer.has_left);
    }
}
