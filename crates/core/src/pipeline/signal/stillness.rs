//! Whether the pad has lain still, from the means of its last raw samples.

use crate::quantity::CHANNELS;
use crate::time::StreamInstant;

/// Length of a block of stream time: a period of 50 Hz mains.
const BLOCK_US: u64 = 20_000;

/// Blocks in a third of the window: three periods of 50 Hz mains, and of 60 Hz a twelfth of the amplitude is left.
const THIRD: usize = 3;

/// Blocks in the window: 180 ms. Longer would not fit into a short lift, 0.3 s with the finger's ways down and up.
const BLOCKS: usize = 3 * THIRD;

/// Thirds of the window agree within this on a pad at rest; a finger that comes or goes with 0.15 N/s does not.
pub(super) const STILL_UV: f64 = 25.0;

/// Longer than a block without a sample: what is older says nothing of now.
const GAP_US: u64 = BLOCK_US;

/// Means of the nine raw channels (µV) over the last blocks.
#[derive(Clone, Debug)]
pub struct Stillness {
    block_began: StreamInstant,
    last_at: StreamInstant,
    sums_uv: [f64; CHANNELS],
    samples: u32,
    /// The newest last.
    means_uv: [[f64; CHANNELS]; BLOCKS],
    known: usize,
}

impl Default for Stillness {
    fn default() -> Self {
        Self::new()
    }
}

impl Stillness {
    /// Has seen nothing.
    pub const fn new() -> Self {
        Self {
            block_began: StreamInstant::from_us(0),
            last_at: StreamInstant::from_us(0),
            sums_uv: [0.0; CHANNELS],
            samples: 0,
            means_uv: [[0.0; CHANNELS]; BLOCKS],
            known: 0,
        }
    }

    /// Takes a raw sample; the mean of the block that it closes, if it closes one.
    pub fn push(&mut self, at: StreamInstant, raw_uv: &[f64; CHANNELS]) -> Option<[f64; CHANNELS]> {
        if at.us_since(self.last_at) > GAP_US {
            *self = Self { block_began: at, ..Self::new() };
        }
        self.last_at = at;
        for (sum, raw) in self.sums_uv.iter_mut().zip(raw_uv) {
            *sum += raw;
        }
        self.samples += 1;
        (at.us_since(self.block_began) >= BLOCK_US).then(|| self.close(at))
    }

    fn close(&mut self, at: StreamInstant) -> [f64; CHANNELS] {
        let samples = f64::from(self.samples);
        let mean_uv = self.sums_uv.map(|sum| sum / samples);
        self.means_uv.rotate_left(1);
        if let Some(newest) = self.means_uv.last_mut() {
            *newest = mean_uv;
        }
        self.known = (self.known + 1).min(BLOCKS);
        (self.block_began, self.sums_uv, self.samples) = (at, [0.0; CHANNELS], 0);
        mean_uv
    }

    /// Whether there are samples for a whole window.
    pub const fn is_full(&self) -> bool {
        self.known == BLOCKS
    }

    /// Whether the newest block is another load than the one before.
    pub fn has_just_moved(&self) -> bool {
        let [.., before, newest] = &self.means_uv;
        self.known > 1 && before.iter().zip(newest).any(|(before, newest)| (newest - before).abs() > STILL_UV)
    }

    /// The mean of a window in which every channel stood still.
    pub fn mean_uv(&self) -> Option<[f64; CHANNELS]> {
        if !self.is_full() {
            return None;
        }
        let (thirds, _) = self.means_uv.as_chunks::<THIRD>();
        let mut mean_uv = [0.0; CHANNELS];
        for (k, mean) in mean_uv.iter_mut().enumerate() {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for third in thirds {
                let value = third.iter().map(|block| block[k]).sum::<f64>() / THIRD as f64;
                (low, high) = (low.min(value), high.max(value));
                *mean += value * THIRD as f64 / BLOCKS as f64;
            }
            if high - low > STILL_UV {
                return None;
            }
        }
        Some(mean_uv)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a pad is still after 400 ms of `uv(ms)`, sampled with this period.
    fn still(period_ms: u64, uv: impl Fn(u64) -> f64) -> Option<f64> {
        let mut stillness = Stillness::new();
        for ms in (0..400).step_by(period_ms as usize) {
            stillness.push(StreamInstant::from_us(1_000 * ms), &[uv(ms); CHANNELS]);
        }
        stillness.mean_uv().map(|mean| mean[4])
    }

    #[test]
    fn mains_are_no_movement_and_leave_little_in_the_mean() {
        for (frequency_hz, left_uv) in [(50.0, 0.01), (60.0, 3.0)] {
            let mains = |ms: u64| 100.0 * (std::f64::consts::TAU * frequency_hz * 1e-3 * ms as f64).sin();
            let mean_uv = still(1, mains).unwrap();
            assert!(mean_uv.abs() <= left_uv, "{frequency_hz} Hz: {mean_uv}");
        }
    }

    #[test]
    fn a_finger_that_comes_is_movement_at_any_rate() {
        for period_ms in [1, 2, 10] {
            assert_eq!(still(period_ms, |ms| 0.25 * ms as f64), None);
            assert!(still(period_ms, |_| 7.0).is_some());
        }
    }

    #[test]
    fn a_tap_within_the_window_is_movement() {
        assert_eq!(still(1, |ms| if (300..340).contains(&ms) { 300.0 } else { 0.0 }), None);
    }

    #[test]
    fn what_was_before_a_gap_does_not_count() {
        let mut stillness = Stillness::new();
        let mut push = |ms: u64| stillness.push(StreamInstant::from_us(1_000 * ms), &[0.0; CHANNELS]);
        (0..190).for_each(|ms| {
            push(ms);
        });
        push(250);
        assert!(!stillness.is_full());
    }
}
