//! Prior standard deviations of the background's polynomials, degree by degree: how large and how smooth it is.
//!
//! They are found by the evidence (D. J. C. MacKay, Neural Computation 4 (1992) 415), as nobody knows beforehand what a simulator
//! gets wrong.

use crate::calibration::data::contacts::BACKGROUND_DEGREE;

const DEGREES: usize = BACKGROUND_DEGREE + 1;
/// The whole background that the search begins with, as a share of each map's root mean square.
const FIRST: f64 = 0.01;
/// Least deviation of a whole background, which never vanishes: the simulator is 0.44 % off from an independent solution.
const LEAST: f64 = 4e-3;
/// Degrees of freedom that the size of all degrees counts for in each.
const POOLED_FREEDOM: f64 = 6.0;

/// A coefficient β of the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coefficient {
    /// Of its polynomial.
    pub(crate) degree: usize,
    pub(crate) value: f64,
    /// Its posterior variance.
    pub(crate) variance: f64,
}

/// Of a polynomial of each degree, as shares of a map's root mean square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BackgroundDeviations([f64; DEGREES]);

impl BackgroundDeviations {
    /// Where the search begins: finer features are smaller.
    pub(crate) fn first() -> Self {
        Self(std::array::from_fn(|degree| FIRST * share(degree)))
    }

    /// Of a polynomial of this degree.
    pub(crate) const fn of(&self, degree: usize) -> f64 {
        self.0[degree]
    }

    /// Of the whole background: the root of Σ (n + 1) τₙ², as there are n + 1 polynomials of degree n.
    pub(crate) fn whole(&self) -> f64 {
        self.0.iter().enumerate().map(|(n, own)| (n + 1) as f64 * own * own).sum::<f64>().sqrt()
    }

    /// By the evidence. With κ pseudo-observations of the size σ of all degrees together,
    ///
    /// ```text
    /// τₙ² = (κ σ² sₙ² + Σ β²)/(κ + Σ γ),    σ² = Σ β²/sₙ²/Σ γ,    γ = 1 − v/τₙ²
    /// ```
    ///
    /// where the share s is that of a degree in a background of size 1, and γ how far the contacts determine a coefficient; and at
    /// least [`LEAST`] of that share. Without a coefficient they stay what they are.
    pub(crate) fn reestimated(&self, coefficients: impl Iterator<Item = Coefficient>) -> Self {
        let mut sums = [[0.0; 2]; DEGREES];
        for Coefficient { degree, value, variance } in coefficients {
            sums[degree][0] += value * value;
            sums[degree][1] += (1.0 - variance / self.of(degree).powi(2)).clamp(0.0, 1.0);
        }
        if sums == [[0.0; 2]; DEGREES] {
            return *self;
        }
        let told: f64 = sums.iter().map(|[_, freedom]| freedom).sum();
        let pooled = sums.iter().enumerate().map(|(n, [square, _])| square / share(n).powi(2)).sum::<f64>();
        let size = pooled / told.max(f64::MIN_POSITIVE);
        Self(std::array::from_fn(|n| {
            let [square, freedom] = sums[n];
            let own = (POOLED_FREEDOM * size * share(n).powi(2) + square) / (POOLED_FREEDOM + freedom);
            own.sqrt().max(LEAST * share(n))
        }))
    }
}

/// Deviation of a polynomial of degree n in a background of size 1 of no known smoothness.
fn share(n: usize) -> f64 {
    // (1/(1 + n))/√(Σ (n + 1) (1/(1 + n))²): all variances add up to 1.
    let size = |n: usize| 1.0 / (1 + n) as f64;
    let whole: f64 = (0..DEGREES).map(|n| (n + 1) as f64 * size(n).powi(2)).sum();
    size(n) / whole.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found of 27 maps whose coefficients have these deviations and are known to within `noise`.
    fn found(deviations: [f64; DEGREES], noise: f64) -> BackgroundDeviations {
        (0..60).fold(BackgroundDeviations::first(), |present, _| {
            let all = (0..27).flat_map(|map| (0..DEGREES).map(move |degree| (map, degree)));
            let coefficients = all.flat_map(|(map, degree)| {
                // In ±1.2 deviations, of which the posterior keeps as much as it is told.
                let sign = if map % 2 == 0 { 1.2 } else { -1.2 };
                let prior = present.of(degree).powi(2);
                let kept = prior / (prior + noise * noise);
                let value = kept * libm::hypot(sign * deviations[degree], 0.9 * noise) * sign.signum();
                std::iter::repeat_n(Coefficient { degree, value, variance: kept * noise * noise }, degree + 1)
            });
            present.reestimated(coefficients)
        })
    }

    #[test]
    fn size_and_smoothness_are_found() {
        let smooth = [0.8, 0.5, 0.2, 0.05, 0.01, 0.002].map(|share| 0.015 * share);
        let of = found(smooth, 1e-4);
        for (degree, wanted) in smooth.iter().enumerate().take(4) {
            assert!((of.of(degree) / wanted / 1.2 - 1.0).abs() < 0.25, "{degree}: {of:?}");
        }
        assert!(of.of(5) < 0.5 * BackgroundDeviations::first().of(5), "{of:?}");
    }

    #[test]
    fn none_becomes_small_and_does_not_vanish() {
        let of = found([0.0; DEGREES], 1e-3).whole();
        assert!((of / LEAST - 1.0).abs() < 1e-9, "{of}");
    }
}
