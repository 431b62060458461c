//! A line in the spectrum of a short stretch of a time series, beside a smooth course: least squares at the samples' own times.
//!
//! The stretch's cosine and sine are freed of its smooth functions, and of each other: c, s. What a line at the frequency f takes
//! off the squares of r is (c·r)² + (s·r)². The times need not be even, and a line that the sampling folds to another frequency,
//! |f − m fₛ|, is met there by itself; where it folds into the smooth course, nothing is left of c and s.
//!
//! Source: N. R. Lomb, Astrophysics and Space Science 39 (1976) 447; J. D. Scargle, Astrophysical Journal 263 (1982) 835; J. T.
//! VanderPlas, Astrophysical Journal Supplement 236 (2018) 16.

use std::f64::consts::{PI, TAU};

use tactpad_numeric::products::dot;

/// Up to here a course counts as smooth.
const SMOOTH_HZ: f64 = 2.0;
/// A line of which less than this part of its square is left beside the smooth course is not seen.
const LEFT_MIN: f64 = 0.5;

/// Rows of a series that follow each other.
#[derive(Clone, Debug)]
pub(crate) struct RowRun {
    /// Which rows.
    pub(crate) rows: Vec<usize>,
    t_s: Vec<f64>,
    /// Orthonormal functions of a smooth course.
    smooth: Vec<Vec<f64>>,
}

/// A line's two functions in a stretch, orthonormal, and how they follow from cosine and sine.
#[derive(Clone, Debug)]
pub(crate) struct Waves {
    pair: [Vec<f64>; 2],
    /// Cosine = n₀ c + …, sine = m c + n₁ s + …, but for smooth functions: n₀, m, n₁.
    parts: [f64; 3],
}

impl RowRun {
    /// `t_s` are the times of `rows`.
    pub(crate) fn of(rows: Vec<usize>, t_s: Vec<f64>) -> Self {
        let first = t_s.first().copied().unwrap_or(0.0);
        let span = t_s.last().map_or(0.0, |last| last - first).max(f64::MIN_POSITIVE);
        let orders = (2.0 * span * SMOOTH_HZ).ceil().min(rows.len() as f64 / 4.0) as usize;
        let along: Vec<f64> = t_s.iter().map(|t| (t - first) / span).collect();
        let mut stretch = Self { rows, t_s, smooth: Vec::new() };
        let functions = (0..=orders)
            .map(|order| along.iter().map(|x| libm::cos(PI * order as f64 * x)).collect::<Vec<f64>>());
        for function in [along.clone()].into_iter().chain(functions) {
            let (left, norm) = stretch.without_smooth(function.clone());
            if norm > 1e-6 * dot(&function, &function).sqrt() {
                stretch.smooth.push(left.iter().map(|x| x / norm).collect());
            }
        }
        stretch
    }

    /// How long it takes.
    pub(crate) fn span_s(&self) -> f64 {
        self.t_s.last().zip(self.t_s.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// Residual of a function beside a smooth course, and its norm.
    fn without_smooth(&self, mut function: Vec<f64>) -> (Vec<f64>, f64) {
        // Twice: what rounding leaves goes as well.
        for smooth in self.smooth.iter().chain(&self.smooth) {
            let part = dot(smooth, &function);
            function.iter_mut().zip(smooth).for_each(|(value, smooth)| *value -= part * smooth);
        }
        let norm = dot(&function, &function).sqrt();
        (function, norm)
    }

    /// The line itself, as far as `values` have it; `None` where it is not seen.
    pub(crate) fn line(&self, frequency_hz: f64, values: &[f64]) -> Option<Vec<f64>> {
        let [cosine, sine] = self.waves(frequency_hz)?.factors(values);
        let value = |t: &f64| {
            let phase = TAU * libm::fmod(frequency_hz * t, 1.0);
            cosine * libm::cos(phase) + sine * libm::sin(phase)
        };
        Some(self.t_s.iter().map(value).collect())
    }

    /// The functions of a line; `None` where it cannot be told from a smooth course.
    pub(crate) fn waves(&self, frequency_hz: f64) -> Option<Waves> {
        let wave = |of: fn(f64) -> f64| -> Vec<f64> {
            self.t_s.iter().map(|t| of(TAU * libm::fmod(frequency_hz * t, 1.0))).collect()
        };
        let (cosine, cosine_norm) = self.without_smooth(wave(libm::cos));
        let (mut sine, _) = self.without_smooth(wave(libm::sin));
        let cosine: Vec<f64> = cosine.iter().map(|x| x / cosine_norm).collect();
        let mixed = dot(&cosine, &sine);
        sine.iter_mut().zip(&cosine).for_each(|(sine, cosine)| *sine -= mixed * cosine);
        let sine_norm = dot(&sine, &sine).sqrt();
        let least = (0.5 * LEFT_MIN * self.t_s.len() as f64).sqrt();
        let is_seen = cosine_norm > least && sine_norm > least;
        is_seen.then(|| Waves {
            pair: [cosine, sine.iter().map(|x| x / sine_norm).collect()],
            parts: [cosine_norm, mixed, sine_norm],
        })
    }
}

impl Waves {
    /// Reduction of the squares by the line.
    pub(crate) fn square(&self, values: &[f64]) -> f64 {
        self.pair.iter().map(|wave| dot(wave, values).powi(2)).sum()
    }

    /// The factors of cosine and sine.
    fn factors(&self, values: &[f64]) -> [f64; 2] {
        let [cosine, mixed, sine] = self.parts;
        let [c, s] = [0, 1].map(|at| dot(&self.pair[at], values));
        [(c - mixed * s / sine) / cosine, s / sine]
    }

    /// Its amplitude.
    pub(crate) fn amplitude(&self, values: &[f64]) -> f64 {
        let [cosine, sine] = self.factors(values);
        libm::hypot(cosine, sine)
    }

    /// Mean square of a wave of amplitude 1, times the number of samples.
    pub(crate) fn weight(&self) -> f64 {
        0.5 * self.parts.iter().map(|part| part * part).sum::<f64>()
    }
}
