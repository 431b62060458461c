//! The two clocks. There is no `now()` here: time is always an argument.
//!
//! *Host time* ([`HostInstant`]) is the bridge's monotonic clock; it says when bytes came and when the link fell
//! silent. *Stream time* ([`StreamInstant`]) is the pad's own clock, made monotonic by `link::StreamClock`; every
//! decision about a contact is taken in it, so that the same bytes give the same events.

/// A point of the host's monotonic clock, in nanoseconds since an arbitrary origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct HostInstant(u64);

impl HostInstant {
    /// The point `ns` nanoseconds after the clock's origin.
    pub const fn from_ns(ns: u64) -> Self {
        Self(ns)
    }

    /// Nanoseconds since the clock's origin.
    pub const fn as_ns(self) -> u64 {
        self.0
    }

    /// This point moved `us` microseconds later; saturates at the end of time.
    #[must_use]
    pub const fn plus_us(self, us: u64) -> Self {
        Self(self.0.saturating_add(us.saturating_mul(1_000)))
    }

    /// Whole microseconds from `earlier` to here; 0 if `earlier` is later.
    pub const fn us_since(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0) / 1_000
    }
}

/// A point of stream time: microseconds of the pad's own clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct StreamInstant(u64);

impl StreamInstant {
    /// The point `us` microseconds after the stream's origin.
    pub const fn from_us(us: u64) -> Self {
        Self(us)
    }

    /// Microseconds since the stream's origin.
    pub const fn as_us(self) -> u64 {
        self.0
    }

    /// This point moved `us` microseconds later; saturates at the end of time.
    #[must_use]
    pub const fn plus_us(self, us: u64) -> Self {
        Self(self.0.saturating_add(us))
    }

    /// Microseconds from `earlier` to here; 0 if `earlier` is later.
    pub const fn us_since(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0)
    }
}
