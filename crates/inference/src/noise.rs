//! Noise of each channel: an additive part, and one that grows with the signal. A static sample may be the mean of several readings,
//! a row of a series is one; so each kind of row has its own.
//!
//! Source: H. Zhou, L. Hu, J. Zhou, K. Lange, J. Computational and Graphical Statistics 28 (2019) 350 (an ascent for variance
//! components).

use tactpad_numeric::statistics::{mean, rms};

/// Steps of the search; each costs one look at the rows.
const STEPS: usize = 100;
/// No channel is better than this part of its signal: steps of the converter, and what a file's digits leave.
const LEAST_SHARE: f64 = 1e-4;
/// Fewest rows of a kind that tell of a noise of its own.
const ROWS_MIN: usize = 40;
/// So many rows of a series at the channel's whole signal would say that it grows there as in static samples.
const PRIOR_ROWS: usize = 10;

/// Noise of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    of_static: NoiseLevel,
    of_series: NoiseLevel,
}

impl Noise {
    /// Before anything is known.
    pub fn first(signal: &[f64]) -> Self {
        Self::alike(NoiseLevel::first(signal))
    }

    /// The levels with the greatest likelihood of these residuals, of which `freedom_ratio` are degrees of freedom; one level where
    /// there are too few rows of a kind. Series are often at few loads: how their noise grows with the signal is as in static
    /// samples unless they tell. `size` is what the channel reads, as a root mean square: where noise ends is a share of that, whatever
    /// a model makes of the signal, so that models can be compared by their likelihoods.
    pub fn of(residual: &[f64], signal: &[f64], in_series: &[bool], freedom_ratio: f64, size: f64) -> Self {
        let squares: Vec<f64> = residual.iter().map(|r| r * r / freedom_ratio).collect();
        let mut kinds = [const { (Vec::new(), Vec::new()) }; 2];
        for ((square, signal), in_series) in squares.iter().zip(signal).zip(in_series) {
            let (squares, signals) = &mut kinds[usize::from(*in_series)];
            squares.push(*square);
            signals.push(*signal);
        }
        let [(at_rest, signals_at_rest), (mut moving, mut signals_moving)] = kinds;
        if at_rest.len().min(moving.len()) < ROWS_MIN {
            return Self::alike(NoiseLevel::of(&squares, signal, size));
        }
        let of_static = NoiseLevel::of(&at_rest, &signals_at_rest, size);
        // κ² = mean of r²/v
        let ratio =
            mean(moving.iter().zip(&signals_moving).map(|(square, s)| square / of_static.variance(*s)));
        moving.extend([ratio * of_static.variance(size); PRIOR_ROWS]);
        signals_moving.extend([size; PRIOR_ROWS]);
        Self { of_static, of_series: NoiseLevel::of(&moving, &signals_moving, size) }
    }

    const fn alike(level: NoiseLevel) -> Self {
        Self { of_static: level, of_series: level }
    }

    /// Additive part and share of static samples, and of series.
    pub fn known(parts: [[f64; 2]; 2]) -> Self {
        let [of_static, of_series] =
            parts.map(|[additive, share]| NoiseLevel { additive, share, least: f64::MIN_POSITIVE });
        Self { of_static, of_series }
    }

    /// Whether each kind of row has its own.
    pub fn is_by_kind(&self) -> bool {
        self.of_static != self.of_series
    }

    /// Mean variance of these readings.
    pub fn mean_square(&self, signal: &[f64], in_series: &[bool]) -> f64 {
        mean(signal.iter().zip(in_series).map(|(signal, in_series)| self.variance(*signal, *in_series)))
    }

    /// Variance of a reading.
    pub fn variance(&self, signal: f64, in_series: bool) -> f64 {
        if in_series { self.of_series.variance(signal) } else { self.of_static.variance(signal) }
    }
}

/// Standard deviation of a reading s: √(additive² + share² s²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseLevel {
    /// In the channel's unit.
    pub additive: f64,
    /// Of the signal.
    pub share: f64,
    /// Where it ends.
    least: f64,
}

impl NoiseLevel {
    /// Before anything is known: a hundredth of the signal, and as much of its root mean square.
    pub fn first(signal: &[f64]) -> Self {
        let size = rms(signal.iter().copied());
        Self { additive: 0.01 * size, share: 0.01, least: least(size) }
    }

    /// The level with the greatest likelihood of these squared residuals; `size` is the root mean square of the channel's signal.
    pub fn of(squares: &[f64], signal: &[f64], size: f64) -> Self {
        let floor = least(size).powi(2);
        let mean_square = mean(squares);
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

    /// Variance of a reading.
    pub fn variance(&self, signal: f64) -> f64 {
        (self.additive * self.additive + (self.share * signal).powi(2)).max(self.least * self.least)
    }
}

fn least(size: f64) -> f64 {
    (LEAST_SHARE * size).max(f64::MIN_POSITIVE.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;

    #[test]
    fn both_parts_are_found() {
        let mut random = SplitMix64::new(5);
        for (additive, share) in [(4.0, 0.01), (4.0, 0.0), (0.2, 0.02)] {
            let signal: Vec<f64> = (0..4000).map(|_| 800.0 * f64::from(random.normal())).collect();
            let noise =
                |s: &f64| additive * f64::from(random.normal()) + share * s * f64::from(random.normal());
            let residual: Vec<f64> = signal.iter().map(noise).collect();
            let squares: Vec<f64> = residual.iter().map(|r| r * r).collect();
            let found = NoiseLevel::of(&squares, &signal, rms(signal.iter().copied()));
            assert!((found.additive - additive).abs() < 0.1 * additive + 0.3, "{found:?}");
            assert!((found.share - share).abs() < 0.1 * share + 1.5e-3, "{found:?}");
        }
    }

    #[test]
    fn means_of_readings_have_their_own() {
        let mut random = SplitMix64::new(6);
        let in_series: Vec<bool> = (0..2000).map(|row| row >= 1000).collect();
        let deviation = |in_series: &bool| if *in_series { 8.0 } else { 2.0 };
        let residual: Vec<f64> =
            in_series.iter().map(|it| deviation(it) * f64::from(random.normal())).collect();
        let signal = vec![100.0; 2000];
        let of = |rows: usize| Noise::of(&residual[..rows], &signal[..rows], &in_series[..rows], 1.0, 100.0);
        let found = of(2000);
        assert!(found.is_by_kind());
        for kind in [false, true] {
            assert!((found.variance(100.0, kind).sqrt() / deviation(&kind) - 1.0).abs() < 0.06, "{found:?}");
        }
        // Too few rows of a series.
        assert!(!of(1000 + ROWS_MIN - 1).is_by_kind() && of(1000 + ROWS_MIN).is_by_kind());
    }
}
