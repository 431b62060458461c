//! Latency figures: what was measured, as percentiles.

use hdrhistogram::Histogram;
use serde::Serialize;

/// Longer times are counted as this.
const LONGEST_NS: u64 = 10_000_000_000;

/// The first bin of a picture ends here.
const FIRST_BIN_NS: u64 = 1_000;

/// A collection of durations, each kept to 1 %. Recording allocates nothing.
#[derive(Clone, Debug)]
pub struct Durations {
    histogram: Option<Histogram<u64>>,
}

/// Percentiles in microseconds; all 0 when nothing was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Percentiles {
    /// Median.
    pub p50: f64,
    /// 95 of 100 are at most this.
    pub p95: f64,
    /// 99 of 100 are at most this.
    pub p99: f64,
    /// The longest.
    pub max: f64,
}

impl Default for Durations {
    fn default() -> Self {
        Self::new()
    }
}

impl Durations {
    /// Nothing measured yet.
    pub fn new() -> Self {
        // The bounds are constants inside the allowed range, so there always is a histogram.
        Self { histogram: Histogram::new_with_bounds(1, LONGEST_NS, 2).ok() }
    }

    /// Adds one duration.
    pub fn record_ns(&mut self, duration_ns: u64) {
        if let Some(histogram) = &mut self.histogram {
            histogram.saturating_record(duration_ns);
        }
    }

    /// How many were recorded.
    pub fn len(&self) -> u64 {
        self.histogram.as_ref().map_or(0, Histogram::len)
    }

    /// Whether none was recorded.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many were counted, by their length: each bin from the end of the one before up to its own, in microseconds. Bins grow by a factor
    /// of √2, from 1 µs on; those at both ends that are empty are left out.
    pub fn bins_us(&self) -> Vec<(f64, u64)> {
        let Some(histogram) = &self.histogram else { return Vec::new() };
        let bins = histogram.iter_log(FIRST_BIN_NS, std::f64::consts::SQRT_2);
        let bins: Vec<_> = bins
            .map(|bin| (bin.value_iterated_to() as f64 / 1_000.0, bin.count_since_last_iteration()))
            .collect();
        let first = bins.iter().position(|(_, count)| *count > 0).unwrap_or(bins.len());
        bins.into_iter().skip(first).collect()
    }

    /// The percentiles so far.
    pub fn percentiles(&self) -> Percentiles {
        let Some(histogram) = self.histogram.as_ref().filter(|histogram| !histogram.is_empty()) else {
            return Percentiles::default();
        };
        let us = |quantile| histogram.value_at_quantile(quantile) as f64 / 1_000.0;
        Percentiles { p50: us(0.50), p95: us(0.95), p99: us(0.99), max: us(1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_in_microseconds() {
        let mut durations = Durations::new();
        (1..=1_000).for_each(|us| durations.record_ns(us * 1_000));
        let Percentiles { p50, p95, p99, max } = durations.percentiles();
        for (measured, expected) in [(p50, 500.0), (p95, 950.0), (p99, 990.0), (max, 1_000.0)] {
            assert!((measured - expected).abs() <= 0.01 * expected, "{measured} is not {expected}");
        }
    }

    #[test]
    fn every_duration_is_in_one_bin() {
        let mut durations = Durations::new();
        assert_eq!(durations.bins_us(), []);
        [10_000, 11_000, 900_000].into_iter().for_each(|ns| durations.record_ns(ns));
        let bins = durations.bins_us();
        assert_eq!(bins.iter().map(|(_, count)| count).sum::<u64>(), 3);
        let (first, last) = (bins[0], bins[bins.len() - 1]);
        assert!(first.1 == 2 && (11.0..16.0).contains(&first.0), "{bins:?}");
        assert!(last.1 == 1 && (900.0..1_300.0).contains(&last.0), "{bins:?}");
    }

    #[test]
    fn nothing_measured_gives_zeros() {
        assert_eq!(Durations::new().percentiles(), Percentiles::default());
    }

    #[test]
    fn endless_and_vanishing_durations_are_kept() {
        let mut durations = Durations::new();
        durations.record_ns(0);
        durations.record_ns(u64::MAX);
        assert_eq!(durations.len(), 2);
    }
}
