//! Acting at absolute times of the monotonic clock, until told to stop.
//!
//! Only the sources that play a pad's part need this: a recording and the virtual pad. Deadlines are
//! absolute, so a late wake-up delays one chunk and never the ones after it.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::Arc;

use rustix::event::{EventfdFlags, PollFd, PollFlags, Timespec, eventfd, poll};
use rustix::io::Errno;
use rustix::time::{ClockId, clock_gettime};

/// How long a full pipe or terminal is left alone before it is looked at again, in microseconds.
///
/// A terminal may miss to report that it has room again, so the wait is bounded.
pub(super) const RETRY_US: u64 = 10_000;

/// A state that is told in no frames of its own is sent again after so long without a new one, µs: at twice the pace of the slowest pad.
pub(super) const REPEAT_US: u64 = 5_000;

/// Frames that are made of it are at least so far apart, µs.
pub(super) const FRAME_MIN_US: u64 = 100;

/// The monotonic clock, in microseconds since an arbitrary origin.
pub(super) fn monotonic_us() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    let seconds_us = u64::try_from(now.tv_sec).unwrap_or(0).saturating_mul(1_000_000);
    seconds_us.saturating_add(u64::try_from(now.tv_nsec).unwrap_or(0) / 1_000)
}

/// `us` microseconds as a time limit for `poll`.
pub(super) fn limit(us: u64) -> Timespec {
    let seconds = i64::try_from(us / 1_000_000).unwrap_or(i64::MAX);
    let ns = (us % 1_000_000).saturating_mul(1_000);
    Timespec { tv_sec: seconds, tv_nsec: i64::try_from(ns).unwrap_or(0) }
}

/// Whether there is something to read, or to be told of the descriptor's end.
pub(super) fn is_readable(fd: BorrowedFd<'_>) -> io::Result<bool> {
    match poll(&mut [PollFd::from_borrowed_fd(fd, PollFlags::IN)], Some(&limit(0))) {
        Ok(ready) => Ok(ready > 0),
        Err(Errno::INTR) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

/// Tells a thread to stop; every wait of that thread ends at once.
#[derive(Clone, Debug)]
pub(super) struct StopSignal(Arc<OwnedFd>);

impl StopSignal {
    /// A signal that is not raised.
    ///
    /// # Errors
    /// The kernel gives no more descriptors.
    pub(super) fn new() -> io::Result<Self> {
        Ok(Self(Arc::new(eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?)))
    }

    /// Raises the signal for good.
    pub(super) fn raise(&self) {
        // It can only fail where the signal is raised 2^64 times.
        let _ = rustix::io::write(&self.0, &1_u64.to_ne_bytes());
    }
}

/// Why a wait ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WaitOutcome {
    /// The time has come, or the descriptor has something to say.
    Ready,
    /// Nobody is at the other end of the descriptor.
    Gone,
    /// The stop signal is raised.
    Stopped,
}

/// Waits until `until_us` of the monotonic clock, or `watched` has one of its events, or `stop` is raised.
///
/// # Errors
/// The descriptors cannot be polled.
pub(super) fn wait(
    stop: &StopSignal,
    watched: Option<(BorrowedFd<'_>, PollFlags)>,
    until_us: u64,
) -> io::Result<WaitOutcome> {
    let (fd, events) = watched.unwrap_or((stop.0.as_fd(), PollFlags::IN));
    let mut fds = [PollFd::new(&stop.0, PollFlags::IN), PollFd::from_borrowed_fd(fd, events)];
    match poll(&mut fds, Some(&limit(until_us.saturating_sub(monotonic_us())))) {
        Ok(_) | Err(Errno::INTR) => {}
        Err(error) => return Err(error.into()),
    }
    let [told, other] = fds;
    Ok(if told.revents().contains(PollFlags::IN) {
        WaitOutcome::Stopped
    } else if other.revents().intersects(PollFlags::HUP | PollFlags::ERR) {
        WaitOutcome::Gone
    } else {
        WaitOutcome::Ready
    })
}

/// How a write ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WriteOutcome {
    /// Every byte is out; `blocked_us` of that time the other end took nothing.
    Whole {
        /// Time spent waiting for room, in microseconds.
        blocked_us: u64,
    },
    /// The stop signal came first.
    Stopped,
    /// Nobody is at the other end.
    Gone,
}

/// Writes all of `bytes` to the non-blocking `to`; waits where it has no room.
///
/// # Errors
/// The write failed for another reason than a missing reader.
pub(super) fn write_whole(stop: &StopSignal, to: BorrowedFd<'_>, bytes: &[u8]) -> io::Result<WriteOutcome> {
    let mut rest = bytes;
    let mut blocked_us = 0_u64;
    while !rest.is_empty() {
        match rustix::io::write(to, rest) {
            Ok(count) => rest = rest.get(count..).unwrap_or_default(),
            Err(Errno::INTR) => {}
            Err(Errno::PIPE | Errno::IO) => return Ok(WriteOutcome::Gone),
            Err(Errno::AGAIN) => {
                let from_us = monotonic_us();
                match wait(stop, Some((to, PollFlags::OUT)), from_us.saturating_add(RETRY_US))? {
                    WaitOutcome::Ready => {}
                    WaitOutcome::Gone => return Ok(WriteOutcome::Gone),
                    WaitOutcome::Stopped => return Ok(WriteOutcome::Stopped),
                }
                blocked_us = blocked_us.saturating_add(monotonic_us().saturating_sub(from_us));
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(WriteOutcome::Whole { blocked_us })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wait_ends_at_the_deadline_and_not_before() {
        let stop = StopSignal::new().unwrap();
        let until_us = monotonic_us() + 3_000;
        assert_eq!(wait(&stop, None, until_us).unwrap(), WaitOutcome::Ready);
        assert!(monotonic_us() >= until_us);
    }

    #[test]
    fn raised_stop_ends_every_wait_at_once() {
        let stop = StopSignal::new().unwrap();
        stop.clone().raise();
        for _ in 0..2 {
            assert_eq!(wait(&stop, None, u64::MAX).unwrap(), WaitOutcome::Stopped);
        }
    }

    #[test]
    fn limit_splits_seconds_and_nanoseconds() {
        assert_eq!(limit(999_999), Timespec { tv_sec: 0, tv_nsec: 999_999_000 });
        assert_eq!(limit(1_000_000), Timespec { tv_sec: 1, tv_nsec: 0 });
        assert_eq!(limit(2_000_001), Timespec { tv_sec: 2, tv_nsec: 1_000 });
    }
}
