//! The paper's mean filter: the mean of the last W samples, of fewer while fewer have come.
//!
//! Source: Sensors 2026, 26, 1378, section 3.1: y_i = (1/i) Σ x_j for i < W, then (1/W) Σ over the last W. It cuts
//! white noise by √W and delays by (W − 1)/2 samples; it does not suppress drift.

use crate::quantity::CHANNELS;

/// The widest window.
pub const FILTER_SAMPLES_MAX: usize = 64;

/// A running mean over counts. Sums are whole numbers, so that no rounding builds up.
#[derive(Clone, Debug)]
pub struct MeanFilter {
    ring: [[i32; CHANNELS]; FILTER_SAMPLES_MAX],
    window: usize,
    filled: usize,
    oldest: usize,
    sums: [i64; CHANNELS],
}

impl MeanFilter {
    /// A filter over `window` samples; taken as 1 below 1 and as [`FILTER_SAMPLES_MAX`] above it.
    pub fn new(window: usize) -> Self {
        Self {
            ring: [[0; CHANNELS]; FILTER_SAMPLES_MAX],
            window: window.clamp(1, FILTER_SAMPLES_MAX),
            filled: 0,
            oldest: 0,
            sums: [0; CHANNELS],
        }
    }

    /// Forgets every sample.
    pub fn clear(&mut self) {
        *self = Self::new(self.window);
    }

    /// Adds a sample and gives the mean of those in the window, in counts.
    pub fn push(&mut self, counts: &[i32; CHANNELS]) -> [f64; CHANNELS] {
        if let Some(place) = self.ring.get_mut(self.oldest) {
            for ((sum, &new), &old) in self.sums.iter_mut().zip(counts).zip(place.iter()) {
                *sum += i64::from(new) - i64::from(old);
            }
            *place = *counts;
        }
        self.oldest = (self.oldest + 1) % self.window;
        self.filled = (self.filled + 1).min(self.window);
        let filled = self.filled as f64;
        self.sums.map(|sum| sum as f64 / filled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn means(window: usize, inputs: &[i32]) -> Vec<f64> {
        let mut filter = MeanFilter::new(window);
        inputs.iter().map(|&count| filter.push(&[count; CHANNELS])[8]).collect()
    }

    #[test]
    fn the_window_grows_and_then_slides() {
        assert_eq!(means(3, &[3, 5, 10, 30, 2]), [3.0, 4.0, 6.0, 15.0, 14.0]);
    }

    #[test]
    fn a_window_of_one_passes_samples_through() {
        assert_eq!(means(1, &[7, -4, 9]), [7.0, -4.0, 9.0]);
    }

    #[test]
    fn extreme_counts_neither_overflow_nor_leave_a_trace() {
        let mut inputs = vec![i32::MIN; FILTER_SAMPLES_MAX];
        inputs.extend([i32::MAX; FILTER_SAMPLES_MAX]);
        inputs.extend([0; FILTER_SAMPLES_MAX]);
        let means = means(FILTER_SAMPLES_MAX, &inputs);
        assert_eq!(means[FILTER_SAMPLES_MAX - 1], f64::from(i32::MIN));
        assert_eq!(*means.last().unwrap(), 0.0);
    }

    #[test]
    fn clearing_makes_the_window_grow_anew() {
        let mut filter = MeanFilter::new(4);
        filter.push(&[100; CHANNELS]);
        filter.clear();
        assert_eq!(filter.push(&[8; CHANNELS]), [8.0; CHANNELS]);
    }
}
