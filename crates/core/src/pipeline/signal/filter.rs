//! The paper's mean filter: the mean of the last W samples, of fewer while fewer have come. It may begin anew where the load changes.
//!
//! Source: Sensors 2026, 26, 1378, section 3.1: y_i = (1/i) Σ x_j for i < W, then (1/W) Σ over the last W. It cuts
//! white noise by √W and delays by (W − 1)/2 samples; it does not suppress drift.
//!
//! An adaptive one leaves out of the mean what was before a change of the load, which shows in two samples: a finger that comes quickly is
//! delayed by half a sample, and what rests is as calm as behind the plain mean.

use crate::quantity::CHANNELS;

/// The widest window.
pub const FILTER_SAMPLES_MAX: usize = 64;

/// The load has changed where the two newest samples are away from the mean of those before by more than this, in sum over the channels, in squares
/// of the standard error …
const CHANGED: f64 = 10.0;

/// … of which no channel counts for more: a spike in one is no finger, which all nine feel.
const CHANNEL_MAX: f64 = 3.0;

/// Of a finger that comes the second sample shows no more than so many times what the first did.
const UNEVEN: f64 = 4.0;

/// A running mean over counts. Sums are whole numbers, so that no rounding builds up.
#[derive(Clone, Debug)]
pub struct MeanFilter {
    ring: [[i32; CHANNELS]; FILTER_SAMPLES_MAX],
    window: usize,
    filled: usize,
    /// The place of the next sample.
    next: usize,
    sums: [i64; CHANNELS],
    /// Of an adaptive filter.
    noise: Option<Noise>,
}

impl MeanFilter {
    /// A filter over `window` samples; taken as 1 below 1 and as [`FILTER_SAMPLES_MAX`] above it.
    pub fn new(window: usize) -> Self {
        Self {
            ring: [[0; CHANNELS]; FILTER_SAMPLES_MAX],
            window: window.clamp(1, FILTER_SAMPLES_MAX),
            filled: 0,
            next: 0,
            sums: [0; CHANNELS],
            noise: None,
        }
    }

    /// One that begins anew where the load changes.
    pub fn adaptive(window: usize) -> Self {
        Self { noise: Some(Noise::new()), ..Self::new(window) }
    }

    /// Forgets every sample, and not how much they vary.
    pub fn clear(&mut self) {
        (self.filled, self.next, self.sums) = (0, 0, [0; CHANNELS]);
    }

    /// Adds a sample and gives the mean of those in the window, in counts.
    pub fn push(&mut self, counts: &[i32; CHANNELS]) -> [f64; CHANNELS] {
        if self.filled == self.window {
            self.drop_oldest();
        }
        if let (Some(noise), true) = (&mut self.noise, self.filled > 0) {
            noise.take(counts, &self.ring[(self.next + FILTER_SAMPLES_MAX - 1) % FILTER_SAMPLES_MAX]);
        }
        self.ring[self.next] = *counts;
        self.next = (self.next + 1) % FILTER_SAMPLES_MAX;
        self.filled += 1;
        self.sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += i64::from(*count));
        while self.has_changed() {
            self.drop_oldest();
        }
        let filled = self.filled as f64;
        self.sums.map(|sum| sum as f64 / filled)
    }

    /// The sample that came so many before the newest.
    const fn before(&self, age: usize) -> &[i32; CHANNELS] {
        &self.ring[(self.next + 2 * FILTER_SAMPLES_MAX - 1 - age) % FILTER_SAMPLES_MAX]
    }

    fn drop_oldest(&mut self) {
        self.filled -= 1;
        let oldest = *self.before(self.filled);
        self.sums.iter_mut().zip(oldest).for_each(|(sum, count)| *sum -= i64::from(count));
    }

    /// Whether the two newest samples show another load than those before:
    ///
    /// Σ_k min(d_k² / (σ_k² (1 + 1/n)), max) > threshold,
    ///
    /// where d_k is the lesser of their two deviations from the mean of the n before, and zero where these have not the same sign or one is more
    /// than [`UNEVEN`] times the other: a sample after a spike says nothing.
    fn has_changed(&self) -> bool {
        let (Some(noise), Some(before)) = (&self.noise, self.filled.checked_sub(2).filter(|n| *n > 0)) else {
            return false;
        };
        let (newest, last, n) = (self.before(0), self.before(1), before as f64);
        let squares = (0..CHANNELS).map(|k| {
            let [newest, last] = [newest[k], last[k]].map(f64::from);
            let mean = (self.sums[k] as f64 - newest - last) / n;
            let [newest, last] = [newest - mean, last - mean];
            let (least, most) = (newest.abs().min(last.abs()), newest.abs().max(last.abs()));
            let least = if newest * last > 0.0 && most <= UNEVEN * least { least } else { 0.0 };
            let sigma = noise.sigma(k);
            (least * least / (sigma * sigma * (1.0 + 1.0 / n))).min(CHANNEL_MAX)
        });
        squares.sum::<f64>() > CHANGED
    }
}

/// How much samples vary from one to the next, by channel, in counts. A finger that moves shifts it little: it is a quantile, not a mean square.
#[derive(Clone, Debug)]
struct Noise {
    /// The quantile [`QUANTILE`] of |x_i − x_{i−1}|.
    steps: [f64; CHANNELS],
    /// So many were seen, up to [`BEGINNING`].
    seen: u32,
}

/// The share of steps that are smaller than the one that is followed …
const QUANTILE: f64 = 0.6;

/// … which is so many σ in white noise: √2 · 0.8416.
const STEP_SIGMAS: f64 = 1.190;

/// With each step the quantile moves by this share of itself, up by [`QUANTILE`] of that or down by the rest.
const STEP_SHARE: f64 = 0.02;

/// Of so many first steps it is the largest. It comes down from there.
const BEGINNING: u32 = 8;

impl Noise {
    const fn new() -> Self {
        Self { steps: [1.0; CHANNELS], seen: 0 }
    }

    fn take(&mut self, counts: &[i32; CHANNELS], last: &[i32; CHANNELS]) {
        let is_begun = self.seen >= BEGINNING;
        self.seen = (self.seen + 1).min(BEGINNING);
        for ((quantile, count), last) in self.steps.iter_mut().zip(counts).zip(last) {
            let step = (f64::from(*count) - f64::from(*last)).abs();
            let is_larger = step > *quantile;
            let share = if is_larger { QUANTILE } else { QUANTILE - 1.0 };
            *quantile = if is_begun { *quantile * (1.0 + STEP_SHARE * share) } else { quantile.max(step) };
            // Counts are whole: what seems to have no noise has that of rounding.
            *quantile = quantile.max(1.0);
        }
    }

    /// The standard deviation of a sample, counts.
    fn sigma(&self, channel: usize) -> f64 {
        self.steps[channel] / STEP_SIGMAS
    }
}

#[cfg(test)]
mod tests {
    use tactpad_numeric::random::SplitMix64;

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

    /// Counts of an adaptive filter of six: nine channels with a load that is added by shares, on white noise of 100 counts.
    fn adaptive(samples: u32, load: impl Fn(u32) -> [f64; CHANNELS]) -> Vec<[f64; CHANNELS]> {
        let mut random = SplitMix64::named(1, "filter");
        let mut filter = MeanFilter::adaptive(6);
        let mut counts = |i| load(i).map(|load| (load + 100.0 * f64::from(random.normal())) as i32);
        (0..samples).map(|i| filter.push(&counts(i))).collect()
    }

    /// The root mean square of these means, all channels.
    fn spread(means: &[[f64; CHANNELS]]) -> f64 {
        let squares: f64 = means.as_flattened().iter().map(|mean| mean * mean).sum();
        (squares / means.as_flattened().len() as f64).sqrt()
    }

    #[test]
    fn what_rests_is_as_calm_as_behind_the_plain_mean() {
        let means = adaptive(20_000, |_| [0.0; CHANNELS]);
        let plain = 100.0 / 6.0_f64.sqrt();
        let ratio = spread(&means[1_000..]) / plain;
        assert!((0.99..1.03).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_finger_that_comes_is_there_with_the_second_sample() {
        let force = [8.0, -3.0, 5.0, 1.0, -6.0, 2.0, 4.0, -2.0, 3.0].map(|share| 200.0 * share);
        let means = adaptive(1_010, |i| if i < 1_000 { [0.0; CHANNELS] } else { force });
        let share = |i: usize| means[i][0] / force[0];
        assert!(share(1_000) < 0.3, "one sample may be a spike: {}", share(1_000));
        assert!((share(1_001) - 1.0).abs() < 0.1, "{}", share(1_001));
    }

    /// Here and there noise has just begun the mean anew, and a spike is spread over fewer samples.
    #[test]
    fn a_spike_is_spread_over_the_window_whether_it_lasts_for_a_sample_or_two_in_one_channel() {
        for length in [1, 2] {
            let is_spread = |at: u32| {
                let spike = |i: u32| {
                    let is_in = (at..at + length).contains(&i);
                    std::array::from_fn(|k| if is_in && (length == 1 || k == 4) { 60_000.0 } else { 0.0 })
                };
                let means = adaptive(at + 10, spike);
                means.iter().all(|mean| mean[4] < 60_000.0 * f64::from(length) / 6.0 + 200.0)
            };
            let spread = (1_000..1_200).filter(|at| is_spread(*at)).count();
            assert!(spread >= 190, "{length}: {spread} of 200");
        }
    }

    #[test]
    fn a_hand_that_moves_all_the_time_is_not_taken_for_noise() {
        // It rises and falls within 100 samples each, with pauses as long.
        let force = |i: u32| {
            let share = match i % 400 {
                phase @ 0..100 => f64::from(phase),
                phase @ 100..200 => f64::from(200 - phase),
                _ => 0.0,
            };
            [40.0 * share; CHANNELS]
        };
        let mut random = SplitMix64::named(2, "filter");
        let mut noise = Noise::new();
        let mut last = [0; CHANNELS];
        for i in 0..20_000 {
            let counts = force(i).map(|load| (load + 100.0 * f64::from(random.normal())) as i32);
            noise.take(&counts, &std::mem::replace(&mut last, counts));
        }
        assert!((90.0..150.0).contains(&noise.sigma(4)), "{}", noise.sigma(4));
    }
}
