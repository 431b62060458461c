//! Channels that are sampled one after another: each shows its signal with a delay of its own.

use std::collections::VecDeque;

use crate::bytes::{Reader, push_doubles};
use crate::quantity::CHANNELS;

/// The signals of the last moments, as long as the longest delay.
#[derive(Clone, Debug)]
pub(super) struct Delay {
    delay_s: [f64; CHANNELS],
    longest_s: f64,
    /// Times and signals, the oldest first; it begins with the last one that is older than the longest delay.
    past: VecDeque<(f64, [f64; CHANNELS])>,
}

impl Delay {
    pub(super) fn new(skew_us: [f64; CHANNELS]) -> Self {
        let delay_s = skew_us.map(|us| us * 1e-6);
        Self { delay_s, longest_s: delay_s.iter().copied().fold(0.0, f64::max), past: VecDeque::new() }
    }

    /// Delayed channels at `at_s`, µV, when their signals are `now_uv`. Between two calls signals go evenly; before
    /// the first one they were as they were then.
    pub(super) fn show(&mut self, at_s: f64, now_uv: [f64; CHANNELS]) -> [f64; CHANNELS] {
        if self.longest_s <= 0.0 {
            return now_uv;
        }
        self.past.push_back((at_s, now_uv));
        while self.past.get(1).is_some_and(|(second_s, _)| *second_s <= at_s - self.longest_s) {
            self.past.pop_front();
        }
        std::array::from_fn(|channel| self.at(at_s - self.delay_s[channel], channel))
    }

    pub(super) fn write(&self, to: &mut Vec<u8>) {
        to.extend((self.past.len() as u32).to_le_bytes());
        for (at_s, uv) in &self.past {
            push_doubles(to, &[*at_s]);
            push_doubles(to, uv);
        }
    }

    /// Takes up what [`Self::write`] wrote. Times that go back are refused.
    pub(super) fn take_up(&mut self, from: &mut Reader<'_>) -> Option<()> {
        self.past.clear();
        for _ in 0..from.length()? {
            self.past.push_back((from.finite()?, from.finites()?));
        }
        self.past.iter().is_sorted_by_key(|(at_s, _)| *at_s).then_some(())
    }

    fn at(&self, at_s: f64, channel: usize) -> f64 {
        let later = self.past.partition_point(|(time_s, _)| *time_s < at_s);
        let after = self.past.get(later).or_else(|| self.past.back());
        let before = later.checked_sub(1).and_then(|index| self.past.get(index)).or(after);
        match (before, after) {
            (Some((from_s, from)), Some((to_s, to))) if to_s > from_s => {
                let share = (at_s - from_s) / (to_s - from_s);
                from[channel] + share * (to[channel] - from[channel])
            }
            (_, Some((_, uv))) => uv[channel],
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_channel_lags_by_its_own_time() {
        let mut skew_us = [0.0; CHANNELS];
        (skew_us[1], skew_us[2]) = (400.0, 12_300.0);
        let mut delay = Delay::new(skew_us);
        for millisecond in 0..100 {
            let at_s = f64::from(millisecond) * 1e-3;
            let shown = delay.show(at_s, [1e4 * at_s; CHANNELS]);
            for (channel, late_s) in [(0, 0.0), (1, 0.4e-3), (2, 12.3e-3)] {
                let wanted = 1e4 * (at_s - late_s).max(0.0);
                assert!((shown[channel] - wanted).abs() < 1e-9, "channel {channel} at {at_s} s");
            }
        }
        assert!(delay.past.len() < 16, "{}", delay.past.len());
    }

    #[test]
    fn without_delays_nothing_is_kept() {
        let mut delay = Delay::new([0.0; CHANNELS]);
        assert_eq!(delay.show(1.0, [3.0; CHANNELS]), [3.0; CHANNELS]);
        assert!(delay.past.is_empty());
    }
}
