//! D⁻½: rows in standard deviations of their noise, and without what the row before foretells.
//!
//! Within a time series the noise of a row, in its standard deviation, is nₜ = ρ nₜ₋₁ + √(1 − ρ²) eₜ with independent e. So
//! (vₜ − ρ vₜ₋₁)/√(1 − ρ²) is as sharp as what v tells anew. The series' first row stays.
//!
//! Source: S. J. Prais, C. B. Winsten, Cowles Commission Discussion Paper 383 (1954).

/// Largest ρ, and fewest pairs of rows to know it by.
const MEMORY_MAX: f64 = 0.95;
const PAIRS_MIN: usize = 20;

/// Whitening of a channel's rows: weights, and the correlation ρ with the row before.
#[derive(Clone, Debug, PartialEq)]
pub struct Whitening {
    /// One over each row's standard deviation; 0 where it tells nothing.
    pub weights: Vec<f64>,
    /// Whether a row goes on with the row before.
    follows: Vec<bool>,
    /// ρ.
    memory: f64,
}

impl Whitening {
    /// `variances` are infinite where a row tells nothing; `follows` says which rows go on with the row before.
    pub fn of(variances: &[f64], follows: &[bool], memory: f64) -> Self {
        let weights: Vec<f64> = variances.iter().map(|variance| 1.0 / variance.sqrt()).collect();
        let is_told = |at: usize| weights.get(at).is_some_and(|weight| *weight > 0.0);
        let goes_on = |(at, follows): (usize, &bool)| *follows && is_told(at) && is_told(at.wrapping_sub(1));
        Self { follows: follows.iter().enumerate().map(goes_on).collect(), weights, memory }
    }

    /// Of rows that are white.
    pub fn none(rows: usize) -> Self {
        Self::of(&vec![1.0; rows], &vec![false; rows], 0.0)
    }

    /// ρ.
    pub const fn memory(&self) -> f64 {
        self.memory
    }

    /// D⁻½ v.
    pub fn whitened(&self, column: &[f64]) -> Vec<f64> {
        let fresh = (1.0 - self.memory * self.memory).sqrt();
        let mut before = 0.0;
        let rows = column.iter().zip(&self.weights).zip(&self.follows);
        rows.map(|((value, weight), follows)| {
            let now = value * weight;
            let new = if *follows { (now - self.memory * before) / fresh } else { now };
            before = now;
            new
        })
        .collect()
    }

    /// ln det D.
    pub fn log_determinant(&self) -> f64 {
        let told = self.weights.iter().filter(|weight| **weight > 0.0);
        let following = self.follows.iter().filter(|follows| **follows).count() as f64;
        told.map(|weight| -2.0 * weight.ln()).sum::<f64>()
            + following * (1.0 - self.memory * self.memory).ln()
    }

    /// How many rows tell something.
    pub fn told(&self) -> usize {
        self.weights.iter().filter(|weight| **weight > 0.0).count()
    }

    /// ρ by what is left over, whitened: the correlation of rows with those before them.
    pub fn memory_of(&self, left: &[f64]) -> f64 {
        let fresh = (1.0 - self.memory * self.memory).sqrt();
        let (mut before, mut products, mut squares, mut pairs) = (0.0, 0.0, 0.0, 0);
        for (left, follows) in left.iter().zip(&self.follows) {
            let now = if *follows { self.memory * before + fresh * left } else { *left };
            if *follows {
                products += before * now;
                squares += f64::midpoint(before * before, now * now);
                pairs += 1;
            }
            before = now;
        }
        if pairs < PAIRS_MIN || squares <= 0.0 { 0.0 } else { (products / squares).clamp(0.0, MEMORY_MAX) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;
    use tactpad_numeric::statistics::rms;

    #[test]
    fn noise_that_remembers_becomes_white_and_tells_how_much_it_does() {
        let mut random = SplitMix64::new(11);
        let mut noise = vec![2.0 * f64::from(random.normal())];
        for row in 1..4000 {
            noise.push(0.6 * noise[row - 1] + 2.0 * 0.8 * f64::from(random.normal()));
        }
        let follows: Vec<bool> = (0..noise.len()).map(|row| row > 0).collect();
        let variances = vec![4.0; noise.len()];
        let plain = Whitening::of(&variances, &follows, 0.0);
        let memory = plain.memory_of(&plain.whitened(&noise));
        assert!((memory - 0.6).abs() < 0.05, "{memory}");
        let whitening = Whitening::of(&variances, &follows, memory);
        let white = whitening.whitened(&noise);
        assert!((rms(white.iter().copied()) - 1.0).abs() < 0.05);
        assert!(plain.memory_of(&white) < 0.05);
        assert!((whitening.memory_of(&white) - memory).abs() < 1e-9);
    }

    #[test]
    fn a_row_that_tells_nothing_breaks_the_series() {
        let whitening = Whitening::of(&[1.0, f64::INFINITY, 1.0], &[false, true, true], 0.5);
        assert_eq!(whitening.whitened(&[1.0, 7.0, 3.0]), [1.0, 0.0, 3.0]);
        assert_eq!(whitening.told(), 2);
    }
}
