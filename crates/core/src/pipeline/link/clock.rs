//! The pad's clock as stream time.

use crate::time::{HostInstant, StreamInstant};

/// The longest step of the pad's clock between two samples that is not a jump: 10 periods of the slowest pad.
pub(super) const GAP_MAX_US: u64 = 100_000;

/// The pace of the pad's clock is judged over four parts of this length, µs: over a second, and anew with each part, so that a clock that
/// is sound again is believed soon.
const PACE_PART_US: u64 = 250_000;
const PACE_PARTS: usize = 4;

/// Bytes that waited for a host that was busy arrive at once: so much more may be shown than has passed.
const PACE_BURST_US: u64 = 1_000_000;

/// Pad clocks beyond this are moved to zero, so that no sum of times overflows.
pub(super) const DEVICE_TIME_MAX_US: u64 = 1 << 62;

/// The pad's clock made monotonic and carried on by the host's clock while the pad is silent.
#[derive(Clone, Copy, Debug)]
pub(super) struct StreamClock {
    /// Added to device time, modulo 2^64, to give stream time.
    offset_us: u64,
    /// Stream time of the newest sample.
    pub(super) last: StreamInstant,
    /// Host time at which it was heard.
    pub(super) heard: HostInstant,
    /// False until the first sample, which sets the clock.
    pub(super) set: bool,
    /// Where the newest parts of the look at the pace began, oldest first: host time and the pad's.
    pace_from: [(HostInstant, u64); PACE_PARTS],
    /// So much more than has passed may be shown by a look that begins at one of so many parts from now on.
    burst_us: u64,
    burst_parts: usize,
    /// Whether the last look found that the pad's clock counts microseconds.
    is_on_pace: bool,
    /// Whether the pad's clock does not go on from the sample before the newest one. One whose pace is in doubt may.
    pub(super) has_jumped: bool,
}

impl StreamClock {
    pub(super) const fn new() -> Self {
        Self {
            offset_us: 0,
            last: StreamInstant::from_us(0),
            heard: HostInstant::from_ns(0),
            set: false,
            pace_from: [(HostInstant::from_ns(0), 0); PACE_PARTS],
            burst_us: PACE_BURST_US,
            burst_parts: 0,
            is_on_pace: true,
            has_jumped: false,
        }
    }

    /// Stream time at `now`. It begins with the first sample: what happens before it happens at the origin, so that stream time
    /// never has to go back to where the pad's clock begins.
    pub(super) fn at(&self, now: HostInstant) -> StreamInstant {
        if self.set { self.last.plus_us(now.us_since(self.heard)) } else { self.last }
    }

    /// Lets stream time pass to `now` without a sample.
    pub(super) fn advance(&mut self, now: HostInstant) {
        self.last = self.at(now);
        self.heard = now;
    }

    /// Whether the pad's clock goes half to twice as fast as the host's, by the last look that is over. Times in a profile mean
    /// nothing on a clock that counts milliseconds for microseconds, say.
    fn keeps_pace(&mut self, now: HostInstant, device_us: u64) -> bool {
        let [(host, from_us), .., (newest, _)] = self.pace_from;
        if now.us_since(newest) >= PACE_PART_US {
            let passed_us = now.us_since(host);
            if passed_us >= PACE_PARTS as u64 * PACE_PART_US {
                let shown_us = device_us.wrapping_sub(from_us);
                self.is_on_pace = (passed_us / 2..=2 * passed_us + self.burst_us).contains(&shown_us);
            }
            self.pace_from.rotate_left(1);
            self.pace_from[PACE_PARTS - 1] = (now, device_us);
            self.burst_parts = self.burst_parts.saturating_sub(1);
            if self.burst_parts == 0 {
                self.burst_us = PACE_BURST_US;
            }
        }
        self.is_on_pace
    }

    /// Looks at the pace from here on. What is late by so much may be made up for within a look.
    fn look_anew(&mut self, now: HostInstant, device_us: u64, delay_us: u64) {
        self.pace_from = [(now, device_us); PACE_PARTS];
        self.burst_us = PACE_BURST_US.saturating_add(delay_us);
        self.burst_parts = 2 * PACE_PARTS;
    }

    /// Takes the device time of a sample that comes so much later than it should. Returns false if the clock jumped and was joined anew; `continues` says whether
    /// a running sequence gives something to jump from.
    pub(super) fn accept(
        &mut self,
        now: HostInstant,
        device_us: u64,
        delay_us: u64,
        continues: bool,
    ) -> bool {
        let stream_us = device_us.wrapping_add(self.offset_us);
        let smooth = stream_us > self.last.as_us() && stream_us - self.last.as_us() <= GAP_MAX_US;
        self.has_jumped = !smooth;
        // What a host takes late says nothing of the pace.
        if !continues || !smooth || now.us_since(self.heard) > GAP_MAX_US {
            self.look_anew(now, device_us, delay_us);
            self.is_on_pace |= !continues;
        }
        if continues && smooth && self.keeps_pace(now, device_us) {
            self.last = StreamInstant::from_us(stream_us);
            self.heard = now;
            return true;
        }
        let joined_us = if self.set { self.at(now).as_us() } else { device_us.min(DEVICE_TIME_MAX_US) };
        self.offset_us = joined_us.wrapping_sub(device_us);
        self.last = StreamInstant::from_us(joined_us);
        (self.heard, self.set) = (now, true);
        !continues
    }
}
