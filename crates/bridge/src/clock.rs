//! The monotonic clock of a bridge: the host's, or virtual time. The only file that reads the host's.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use tactpad_core::time::HostInstant;

/// A monotonic clock, counted from its beginning.
#[derive(Clone, Copy, Debug)]
pub struct Clock(Source);

#[derive(Clone, Copy, Debug)]
enum Source {
    /// The host's clock, since this moment.
    Host(Instant),
    /// Nanoseconds that somebody else sets.
    Virtual(&'static AtomicU64),
}

impl Clock {
    /// The host's clock, counted from now.
    #[expect(clippy::disallowed_methods, reason = "the one place where time comes from")]
    pub fn start() -> Self {
        Self(Source::Host(Instant::now()))
    }

    /// A clock of virtual time: it shows these nanoseconds, and whoever has them sets it.
    pub const fn virtual_time(now_ns: &'static AtomicU64) -> Self {
        Self(Source::Virtual(now_ns))
    }

    /// Time since the clock began.
    pub fn now(&self) -> HostInstant {
        HostInstant::from_ns(match self.0 {
            Source::Host(origin) => u64::try_from(origin.elapsed().as_nanos()).unwrap_or(u64::MAX),
            Source::Virtual(now_ns) => now_ns.load(Ordering::Relaxed),
        })
    }
}
