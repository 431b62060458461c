//! The kernel's clocks, and waiting with a deadline.

#![allow(
    clippy::expect_used,
    dead_code,
    reason = "a test may stop at what it did not expect; each uses a part"
)]

use std::os::fd::BorrowedFd;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::time::{ClockId, clock_gettime};

/// Nanoseconds per millisecond.
pub(crate) const MS: u64 = 1_000_000;

/// The monotonic clock, in nanoseconds.
pub(crate) fn monotonic_ns() -> u64 {
    read(ClockId::Monotonic)
}

/// The clock of the kernel's event stamps, in nanoseconds.
///
/// A reader of evdev gets wall-clock stamps unless it asks for others. Nothing sets the wall clock of a guest, so
/// its differences are as good as those of the monotonic clock.
pub(crate) fn stamp_ns() -> u64 {
    read(ClockId::Realtime)
}

fn read(clock: ClockId) -> u64 {
    let now = clock_gettime(clock);
    u64::try_from(now.tv_sec).expect("a time after 1970") * 1_000 * MS
        + u64::try_from(now.tv_nsec).expect("nanoseconds are not negative")
}

/// Waits until `fd` is readable or hung up, but not past `deadline_ns` (monotonic). Says whether it is.
pub(crate) fn readable_before(deadline_ns: u64, fd: BorrowedFd<'_>) -> bool {
    wait(deadline_ns, &mut [PollFd::from_borrowed_fd(fd, PollFlags::IN)])
}

/// Waits until `deadline_ns` (monotonic).
pub(crate) fn wait_until(deadline_ns: u64) {
    wait(deadline_ns, &mut []);
}

fn wait(deadline_ns: u64, fds: &mut [PollFd<'_>]) -> bool {
    loop {
        let rest_ns = deadline_ns.saturating_sub(monotonic_ns());
        let limit = Timespec {
            tv_sec: i64::try_from(rest_ns / (1_000 * MS)).expect("a short wait"),
            tv_nsec: i64::try_from(rest_ns % (1_000 * MS)).expect("less than a second"),
        };
        match poll(fds, Some(&limit)) {
            Ok(0) if rest_ns == 0 => return false,
            Ok(0) | Err(Errno::INTR) => {}
            Ok(_) => return true,
            Err(error) => panic!("poll: {error}"),
        }
    }
}
