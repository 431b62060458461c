//! Who hears each call that was made on the bridge's pipeline, from some moment on.

use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use tactpad_core::pipeline::call::OwnedCall;
use tactpad_core::time::HostInstant;

/// So many calls may wait: two seconds of a pad at 8 kHz, whose reads bring a frame each. Those that find no room are missing, which is a
/// gap in the pad's frames for who hears the others.
const CALLS_MAX: usize = 16 << 10;

/// A call, and when it was made.
pub(super) type Heard = (HostInstant, OwnedCall);

/// All who hear.
#[derive(Debug, Default)]
pub(super) struct Ears(Vec<SyncSender<Heard>>);

impl Ears {
    /// Hears all calls from now on, until it is dropped.
    pub(super) fn add(&mut self) -> Receiver<Heard> {
        let (to, heard) = sync_channel(CALLS_MAX);
        self.0.push(to);
        heard
    }

    /// Tells of a call.
    pub(super) fn tell(&mut self, at: HostInstant, call: &OwnedCall) {
        let is_there = |ear: &SyncSender<Heard>| {
            !matches!(ear.try_send((at, call.clone())), Err(TrySendError::Disconnected(_)))
        };
        self.0.retain(is_there);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::call::Call;

    #[test]
    fn each_hears_from_its_begin_on_and_who_left_is_forgotten() {
        let mut ears = Ears::default();
        let at = |us| HostInstant::default().plus_us(us);
        let first = ears.add();
        ears.tell(at(1), &Call::Pause.into());
        let second = ears.add();
        ears.tell(at(2), &Call::Resume.into());
        assert_eq!(first.try_iter().map(|(at, _)| at).collect::<Vec<_>>(), [at(1), at(2)]);
        assert_eq!(second.try_iter().collect::<Vec<_>>(), [(at(2), Call::Resume.into())]);
        drop(first);
        ears.tell(at(3), &Call::Pause.into());
        assert_eq!((ears.0.len(), second.try_iter().count()), (1, 1));
    }

    #[test]
    fn who_is_slow_misses_calls_and_keeps_nobody_waiting() {
        let mut ears = Ears::default();
        let heard = ears.add();
        (0..CALLS_MAX as u64 + 5)
            .for_each(|us| ears.tell(HostInstant::default().plus_us(us), &Call::Timeout.into()));
        assert_eq!(heard.try_iter().count(), CALLS_MAX);
        ears.tell(HostInstant::default(), &Call::Pause.into());
        assert_eq!(heard.try_iter().count(), 1);
    }
}
