//! Subscribers to the calls on the bridge's pipeline: each gets all calls from its subscription on.

use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use tactpad_core::pipeline::call::OwnedCall;
use tactpad_core::time::HostInstant;

/// Largest number of calls that wait: two seconds of a pad at 8 kHz, whose reads bring a frame each. Those that find no room are missing;
/// for the subscriber they are a gap in the pad's frames.
const CALLS_MAX: usize = 16 << 10;

/// A call, and when it was made.
pub(super) type TimedCall = (HostInstant, OwnedCall);

/// The subscribers.
#[derive(Debug, Default)]
pub(super) struct CallSubscribers(Vec<SyncSender<TimedCall>>);

impl CallSubscribers {
    /// Subscribes to all calls from now on; dropping the receiver ends that.
    pub(super) fn subscribe(&mut self) -> Receiver<TimedCall> {
        let (to, heard) = sync_channel(CALLS_MAX);
        self.0.push(to);
        heard
    }

    /// Sends a call to all subscribers.
    pub(super) fn publish(&mut self, at: HostInstant, call: &OwnedCall) {
        let is_connected = |subscriber: &SyncSender<TimedCall>| {
            !matches!(subscriber.try_send((at, call.clone())), Err(TrySendError::Disconnected(_)))
        };
        self.0.retain(is_connected);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::call::Call;

    #[test]
    fn each_hears_from_its_begin_on_and_who_left_is_forgotten() {
        let mut call_subscribers = CallSubscribers::default();
        let at = |us| HostInstant::default().plus_us(us);
        let first = call_subscribers.subscribe();
        call_subscribers.publish(at(1), &Call::Pause.into());
        let second = call_subscribers.subscribe();
        call_subscribers.publish(at(2), &Call::Resume.into());
        assert_eq!(first.try_iter().map(|(at, _)| at).collect::<Vec<_>>(), [at(1), at(2)]);
        assert_eq!(second.try_iter().collect::<Vec<_>>(), [(at(2), Call::Resume.into())]);
        drop(first);
        call_subscribers.publish(at(3), &Call::Pause.into());
        assert_eq!((call_subscribers.0.len(), second.try_iter().count()), (1, 1));
    }

    #[test]
    fn who_is_slow_misses_calls_and_keeps_nobody_waiting() {
        let mut call_subscribers = CallSubscribers::default();
        let heard = call_subscribers.subscribe();
        (0..CALLS_MAX as u64 + 5).for_each(|us| {
            call_subscribers.publish(HostInstant::default().plus_us(us), &Call::Timeout.into());
        });
        assert_eq!(heard.try_iter().count(), CALLS_MAX);
        call_subscribers.publish(HostInstant::default(), &Call::Pause.into());
        assert_eq!(heard.try_iter().count(), 1);
    }
}
