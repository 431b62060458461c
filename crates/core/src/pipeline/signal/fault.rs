//! Channels that cannot be trusted: at the end of their range, or not changing while the others do.
//!
//! Strain gauges and converters are noisy: a channel whose code stays exactly the same is dead. But a pad without
//! noise exists (a simulated one), and there nothing may be concluded from silence. So the pad must first show, while
//! its zero is measured, that most of its channels are noisy.

use firmware_proto::sample::Sample;

use crate::pipeline::health::Health;
use crate::quantity::CHANNELS;

/// This many equal codes in a row are a stuck channel. A lively one repeats a code in at most half of its samples, so
/// that chance brings this about once in 2^64 samples.
const STUCK_SAMPLES: u16 = 64;

/// Watches the raw codes.
#[derive(Clone, Debug)]
pub struct ChannelFaults {
    /// Those that the pad has.
    channels: usize,
    /// Whether 0 is the least that they tell, whatever they would read below.
    is_clamped: bool,
    last: Option<[i32; CHANNELS]>,
    unchanged: [u16; CHANNELS],
    seen: u32,
    changes: [u32; CHANNELS],
    noisy_pad: bool,
    stuck: [bool; CHANNELS],
    saturated: [bool; CHANNELS],
}

impl Default for ChannelFaults {
    fn default() -> Self {
        Self::new(CHANNELS, false)
    }
}

impl ChannelFaults {
    /// Knows nothing yet of a pad with so many channels, of which 0 may be the least that they tell; every one counts as sound.
    pub const fn new(channels: usize, is_clamped: bool) -> Self {
        Self {
            channels,
            is_clamped,
            last: None,
            unchanged: [0; CHANNELS],
            seen: 0,
            changes: [0; CHANNELS],
            noisy_pad: false,
            stuck: [false; CHANNELS],
            saturated: [false; CHANNELS],
        }
    }

    /// Takes one sample; true if it cannot be trusted. Each fault is counted once, when it begins.
    pub fn check(&mut self, sample: &Sample, count_bits: u8, health: &mut Health) -> bool {
        self.watch_changes(&sample.counts);
        let supply = sample.status.supply_fault();
        health.supply_faults += u64::from(supply);
        let saturated = self.check_saturated(sample, count_bits, health);
        let stuck = self.check_stuck(health);
        supply || saturated || stuck
    }

    /// The zero is known, the pad lay still: what changed meanwhile was noise. From here on silence is a fault if
    /// most channels were lively.
    pub fn learn(&mut self) {
        let lively = self
            .changes
            .iter()
            .filter(|&&changes| u64::from(changes) * 2 >= u64::from(self.seen.max(1)))
            .count();
        // Most of the pad must be lively before silence of the rest means anything.
        self.noisy_pad = 2 * lively > self.channels;
    }

    /// Whether a channel is stuck that has read the same for more than so many samples.
    pub fn is_stuck_for_more_than(&self, samples: u32) -> bool {
        let mut channels = self.stuck.iter().zip(self.unchanged);
        channels.any(|(stuck, unchanged)| *stuck && u32::from(unchanged) > samples)
    }

    /// What was seen so far was no rest: what changed need not have been noise.
    pub fn forget_rest(&mut self) {
        (self.seen, self.changes) = (0, [0; CHANNELS]);
    }

    fn watch_changes(&mut self, counts: &[i32; CHANNELS]) {
        if let Some(last) = self.last.replace(*counts) {
            self.seen = self.seen.saturating_add(1);
            for (k, unchanged) in self.unchanged.iter_mut().enumerate() {
                let changed = last.get(k) != counts.get(k);
                *unchanged = if changed { 0 } else { unchanged.saturating_add(1) };
                if let Some(changes) = self.changes.get_mut(k) {
                    *changes = changes.saturating_add(u32::from(changed));
                }
            }
        }
    }

    fn check_saturated(&mut self, sample: &Sample, count_bits: u8, health: &mut Health) -> bool {
        let limit = 1_i64 << (count_bits.clamp(2, 32) - 1);
        for (k, (&count, saturated)) in sample.counts.iter().zip(self.saturated.iter_mut()).enumerate() {
            let count = i64::from(count);
            let now = sample.status.is_out_of_range(k) || count >= limit - 1 || count <= -limit;
            health.channels_saturated += u64::from(now && !*saturated);
            *saturated = now;
        }
        self.saturated.contains(&true)
    }

    fn check_stuck(&mut self, health: &mut Health) -> bool {
        let last = self.last.unwrap_or_default();
        let channels = self.unchanged.iter().zip(last).zip(self.stuck.iter_mut()).take(self.channels);
        for ((&unchanged, last), stuck) in channels {
            let is_below = self.is_clamped && last == 0;
            let now = self.noisy_pad && unchanged >= STUCK_SAMPLES && !is_below;
            health.channels_stuck += u64::from(now && !*stuck);
            *stuck = now;
        }
        self.stuck.contains(&true)
    }
}

#[cfg(test)]
mod tests {
    use firmware_proto::sample::Status;

    use super::*;

    /// Sample `i` of a pad whose channels all change each time, except those in `silent`.
    fn sample(i: i32, silent: &[usize]) -> Sample {
        let mut counts = [0; CHANNELS];
        for (k, count) in counts.iter_mut().enumerate() {
            *count = if silent.contains(&k) { -1 } else { i % 7 };
        }
        Sample { sequence: 0, time_us: 0, counts, temperature_centi_c: 0, status: Status::OK }
    }

    /// A detector that has watched 300 samples at rest, and what it said of the next 100.
    fn run(rest_silent: &[usize], play_silent: &[usize]) -> (Vec<bool>, Health) {
        let (mut faults, mut health) = (ChannelFaults::new(CHANNELS, false), Health::default());
        for i in 0..300 {
            faults.check(&sample(i, rest_silent), 24, &mut health);
        }
        faults.learn();
        let said = (300..400).map(|i| faults.check(&sample(i, play_silent), 24, &mut health)).collect();
        (said, health)
    }

    #[test]
    fn a_channel_that_stops_changing_is_found_after_64_samples() {
        let (said, health) = run(&[], &[4]);
        assert_eq!(said.iter().position(|&faulty| faulty), Some(64));
        assert_eq!(health.channels_stuck, 1);
    }

    #[test]
    fn a_channel_that_never_changed_is_found_at_once() {
        assert!(run(&[2], &[2]).0[0]);
    }

    #[test]
    fn a_channel_below_what_it_can_tell_is_not_stuck() {
        let found = |is_clamped, stands_at: i32| {
            let (mut faults, mut health) = (ChannelFaults::new(CHANNELS, is_clamped), Health::default());
            for i in 0..300 {
                faults.check(&sample(i, &[]), 24, &mut health);
            }
            faults.learn();
            (300..400).any(|i| {
                let mut sample = sample(i, &[]);
                sample.counts[4] = stands_at;
                faults.check(&sample, 24, &mut health)
            })
        };
        assert!(!found(true, 0) && found(true, 7) && found(false, 0));
    }

    #[test]
    fn a_pad_without_noise_is_not_accused() {
        let all: Vec<usize> = (0..CHANNELS).collect();
        let (said, health) = run(&all, &[4]);
        assert!(!said.contains(&true));
        assert_eq!(health.channels_stuck, 0);
    }

    #[test]
    fn the_ends_of_the_range_are_saturation_and_count_once() {
        let (mut faults, mut health) = (ChannelFaults::new(CHANNELS, false), Health::default());
        let top = (1 << 23) - 1;
        for (count, saturated) in
            [(top - 1, false), (top, true), (top, true), (1 - top, false), (-top - 1, true)]
        {
            let mut sample = sample(0, &[]);
            sample.counts[8] = count;
            assert_eq!(faults.check(&sample, 24, &mut health), saturated, "{count}");
        }
        assert_eq!(health.channels_saturated, 2);
    }

    #[test]
    fn the_full_range_of_32_bits_is_allowed() {
        let (mut faults, mut health) = (ChannelFaults::new(CHANNELS, false), Health::default());
        let mut sample = sample(0, &[]);
        sample.counts[0] = i32::MAX - 1;
        assert!(!faults.check(&sample, 32, &mut health));
        sample.counts[0] = i32::MAX;
        assert!(faults.check(&sample, 32, &mut health));
    }
}
