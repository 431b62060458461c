//! The host's monotonic clock. The only file that reads it.

use std::time::Instant;

use tactpad_core::time::HostInstant;

/// The host's monotonic clock, counted from its making.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    origin: Instant,
}

impl Default for Clock {
    fn default() -> Self {
        Self::start()
    }
}

impl Clock {
    /// A clock that begins now.
    #[expect(clippy::disallowed_methods, reason = "the one place where time comes from")]
    pub fn start() -> Self {
        Self { origin: Instant::now() }
    }

    /// Time since the clock began.
    pub fn now(&self) -> HostInstant {
        HostInstant::from_ns(u64::try_from(self.origin.elapsed().as_nanos()).unwrap_or(u64::MAX))
    }
}
