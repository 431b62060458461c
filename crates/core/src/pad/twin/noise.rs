//! Random processes: Ornstein-Uhlenbeck processes, random walks, and white noise.

use crate::bytes::{Reader, push_doubles};
use tactpad_numeric::random::SplitMix64;

/// A random number of mean 0 that is forgotten with a time constant (Ornstein and Uhlenbeck's process), in units of its
/// standard deviation. It begins drawn from its distribution.
#[derive(Clone, Debug)]
pub(super) struct Lasting {
    random: SplitMix64,
    time_s: f64,
    value: f64,
}

impl Lasting {
    /// With a time constant of zero each value is fresh.
    pub(super) fn new(mut random: SplitMix64, time_s: f64) -> Self {
        let value = f64::from(random.normal());
        Self { random, time_s, value }
    }

    /// The number `after_s` later.
    pub(super) fn next(&mut self, after_s: f64) -> f64 {
        // v ← ρ v + √(1 − ρ²) n with ρ = exp(−t/τ): exact for any step of time.
        let kept = if self.time_s > 0.0 { libm::exp(-after_s / self.time_s) } else { 0.0 };
        let fresh = libm::sqrt(1.0 - kept * kept);
        self.value = kept * self.value + fresh * f64::from(self.random.normal());
        self.value
    }

    pub(super) fn write(&self, to: &mut Vec<u8>) {
        write_stream(to, &self.random, self.value);
    }

    /// Takes up what [`Self::write`] wrote.
    pub(super) fn take_up(&mut self, from: &mut Reader<'_>) -> Option<()> {
        (self.random, self.value) = read_stream(from)?;
        Some(())
    }
}

/// A random walk that begins at zero; its standard deviation after an hour is 1.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    random: SplitMix64,
    value: f64,
}

impl Walk {
    pub(super) const fn new(random: SplitMix64) -> Self {
        Self { random, value: 0.0 }
    }

    /// Where it is `after_s` later.
    pub(super) fn next(&mut self, after_s: f64) -> f64 {
        self.value += libm::sqrt(after_s / 3600.0) * f64::from(self.random.normal());
        self.value
    }

    pub(super) fn write(&self, to: &mut Vec<u8>) {
        write_stream(to, &self.random, self.value);
    }

    /// Takes up what [`Self::write`] wrote.
    pub(super) fn take_up(&mut self, from: &mut Reader<'_>) -> Option<()> {
        (self.random, self.value) = read_stream(from)?;
        Some(())
    }
}

fn write_stream(to: &mut Vec<u8>, random: &SplitMix64, value: f64) {
    to.extend(random.state().to_le_bytes());
    push_doubles(to, &[value]);
}

fn read_stream(from: &mut Reader<'_>) -> Option<(SplitMix64, f64)> {
    Some((SplitMix64::new(from.bits()?), from.finite()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean_square(values: &[f64]) -> f64 {
        values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
    }

    #[test]
    fn a_lasting_number_keeps_its_size_and_forgets_exponentially() {
        for (time_s, after_s) in [(2.0, 0.5), (0.5, 0.5), (0.0, 0.5)] {
            let mut number = Lasting::new(SplitMix64::new(4), time_s);
            let values: Vec<f64> = (0..200_000).map(|_| number.next(after_s)).collect();
            let square = mean_square(&values);
            let product = values.iter().zip(&values[1..]).map(|(one, next)| one * next).sum::<f64>() / 2e5;
            let kept = if time_s > 0.0 { (-after_s / time_s).exp() } else { 0.0 };
            // With n values of correlation ρ the error of a mean square is about √(2(1+ρ²)/((1−ρ²)n)).
            assert!((square - 1.0).abs() < 0.03, "{time_s}: {square}");
            assert!((product - kept).abs() < 0.03, "{time_s}: {product}");
        }
    }

    #[test]
    fn steps_of_any_length_make_the_same_process() {
        let mut number = Lasting::new(SplitMix64::new(9), 1.0);
        let ends: Vec<f64> = (0..50_000)
            .map(|_| {
                let before = number.value;
                for _ in 0..10 {
                    number.next(0.1);
                }
                before * number.value
            })
            .collect();
        let product = ends.iter().sum::<f64>() / 5e4;
        assert!((product - (-1.0_f64).exp()).abs() < 0.03, "{product}");
    }

    #[test]
    fn a_walk_spreads_with_the_square_root_of_time() {
        let after = |hours: f64, steps: u32| {
            let ends: Vec<f64> = (0..20_000)
                .map(|seed| {
                    let mut walk = Walk::new(SplitMix64::named(seed, "walk"));
                    (0..steps).map(|_| walk.next(3600.0 * hours / f64::from(steps))).last().unwrap()
                })
                .collect();
            mean_square(&ends)
        };
        assert!((after(1.0, 7) - 1.0).abs() < 0.05);
        assert!((after(4.0, 3) - 4.0).abs() < 0.2);
    }
}
