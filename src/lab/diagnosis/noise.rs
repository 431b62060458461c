//! Noise of each channel: an additive part, and one that grows with the signal.
//!
//! Source: H. Zhou, L. Hu, J. Zhou, K. Lange, J. Computational and Graphical Statistics 28 (2019) 350 (an ascent for variance
//! components).

use crate::numeric::statistics::{mean, rms};

/// Steps of the search; each costs one look at the rows.
const STEPS: usize = 100;
/// No channel is better than this part of its signal: steps of the converter, and what a file's digits leave.
const LEAST_SHARE: f64 = 1e-4;

/// Standard deviation of a reading s: √(additive² + share² s²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoiseLevel {
    /// In the channel's unit.
    pub(super) additive: f64,
    /// Of the signal.
    pub(super) share: f64,
    /// Where it ends.
    least: f64,
}

impl NoiseLevel {
    /// Before anything is known: a hundredth of the signal, and as much of its root mean square.
    pub(super) fn first(signal: &[f64]) -> Self {
        let size = rms(signal.iter().copied());
        Self { additive: 0.01 * size, share: 0.01, least: least(size) }
    }

    /// The level with the greatest likelihood of these residuals, of which `freedom_ratio` are degrees of freedom.
    pub(super) fn of(residual: &[f64], signal: &[f64], freedom_ratio: f64) -> Self {
        let size = rms(signal.iter().copied());
        let floor = least(size).powi(2);
        let squares: Vec<f64> = residual.iter().map(|r| r * r / freedom_ratio).collect();
        let mean_square = mean(&squares);
        let (mut additive, mut share) = (0.5 * mean_square, 0.5 * mean_square / (size * size).max(floor));
        for _ in 0..STEPS {
            // a² ← a² √(Σ r²/v² / Σ 1/v), b² ← b² √(Σ s² r²/v² / Σ s²/v): never less likely than before.
            let mut sums = [0.0; 4];
            for (square, s) in squares.iter().zip(signal) {
                let (s2, v) = (s * s, (additive + share * s * s).max(floor));
                let terms = [square / (v * v), 1.0 / v, s2 * square / (v * v), s2 / v];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
            additive *= (sums[0] / sums[1]).sqrt();
            share *= if sums[3] > 0.0 { (sums[2] / sums[3]).sqrt() } else { 0.0 };
        }
        Self { additive: additive.sqrt(), share: share.sqrt(), least: least(size) }
    }

    /// Mean variance of these readings.
    pub(super) fn mean_square(&self, signal: &[f64]) -> f64 {
        mean(signal.iter().map(|signal| self.variance(*signal)))
    }

    /// Variance of a reading.
    pub(super) fn variance(&self, signal: f64) -> f64 {
        (self.additive * self.additive + (self.share * signal).powi(2)).max(self.least * self.least)
    }
}

fn least(size: f64) -> f64 {
    (LEAST_SHARE * size).max(f64::MIN_POSITIVE.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;

    #[test]
    fn both_parts_are_found() {
        let mut random = SplitMix64::new(5);
        for (additive, share) in [(4.0, 0.01), (4.0, 0.0), (0.2, 0.02)] {
            let signal: Vec<f64> = (0..4000).map(|_| 800.0 * f64::from(random.normal())).collect();
            let noise =
                |s: &f64| additive * f64::from(random.normal()) + share * s * f64::from(random.normal());
            let residual: Vec<f64> = signal.iter().map(noise).collect();
            let found = NoiseLevel::of(&residual, &signal, 1.0);
            assert!((found.additive - additive).abs() < 0.1 * additive + 0.3, "{found:?}");
            assert!((found.share - share).abs() < 0.1 * share + 1.5e-3, "{found:?}");
        }
    }
}
