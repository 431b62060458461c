//! The mean square of residuals over contacts like those that were measured, and over contacts of another plan.
//!
//! Let e² be the squared residuals at the locked rows, and ê² those that the fit to the open rows lets expect, at all rows: with the
//! fitted causes, the smooth background and the noise. Then, with a weight w for each row,
//!
//! ```text
//! ⟨e²⟩ = Σ w ê² / Σ w over all rows + Σ w (e² − ê²) / Σ w over the locked ones + (φ − 1) ⟨σ²⟩
//! ```
//!
//! The locked rows correct whatever the expectation has wrong. The better that is, the less it counts which places were locked.
//!
//! What is stated must hold on another recording of the pad, by another plan. So intervals are over draws of clusters, of weights that
//! shift the mean load, shear, radius and kind of row, and of the noise's variance φ.
//!
//! Source: A. N. Angelopoulos, S. Bates, C. Fannjiang, M. I. Jordan, T. Zrnic, Science 382 (2023) 669 (prediction-powered inference);
//! H. Shimodaira, J. Stat. Plan. Inference 90 (2000) 227 (weights for another distribution of the same inputs).

use tactpad_inference::observations::{Observations, Sample};
use tactpad_numeric::random::SplitMix64;
use tactpad_numeric::statistics::{mean, rms};

/// Draws of the bootstrap over clusters and plans.
const DRAWS: usize = 1000;
/// The same draws for the same data.
const SEED: u64 = 0x6a19;
/// Features that a plan chooses: load, shear, radius, kind of row.
const FEATURES: usize = 4;
/// By how many of its own deviations over the rows another plan's mean of each of these is off.
const PLAN_DEVIATION: f64 = 0.5;
/// Deviation of the logarithm of φ: another plan has other times of reading.
const NOISE_DEVIATION: f64 = 0.7;

/// Squares of the rows, each added up over the channels.
pub(crate) struct Squares {
    /// At the locked rows.
    pub(crate) found: Vec<f64>,
    /// Those that are to be expected at the locked and at the open rows; none where nothing is known of that.
    pub(crate) expected: Option<[Vec<f64>; 2]>,
}

/// Populations over which means are taken: the locked and the open rows.
pub(crate) struct Population {
    parts: [RowClass; 2],
}

/// Rows of one kind.
#[derive(Default)]
struct RowClass {
    clusters: Vec<usize>,
    /// How many readings each row has that tell something.
    counts: Vec<f64>,
    /// The variance of these readings' noise, added up.
    noise: Vec<f64>,
    features: Vec<[f64; FEATURES]>,
}

/// How much each row counts, and by how much larger the noise's variance is.
pub(crate) struct Draw {
    pub(crate) weights: [Vec<f64>; 2],
    noise: f64,
}

impl Population {
    /// Of locked and open rows, with the variances of their noise.
    pub(crate) fn of(rows: [&Observations; 2], noise: [Vec<f64>; 2]) -> Self {
        let features = rows.map(|rows| rows.samples.iter().map(features).collect::<Vec<_>>());
        let standard = standardised(features);
        let mut parts = rows.into_iter().zip(noise).zip(standard).map(|((rows, noise), features)| {
            let told = |row: usize| rows.is_told.iter().filter(|of| of[row]).count() as f64;
            RowClass {
                clusters: rows.clusters(),
                counts: (0..rows.rows()).map(told).collect(),
                noise,
                features,
            }
        });
        Self { parts: std::array::from_fn(|_| parts.next().unwrap_or_default()) }
    }

    /// Each row once.
    pub(crate) fn as_measured(&self) -> Draw {
        Draw { weights: self.parts.each_ref().map(|part| vec![1.0; part.counts.len()]), noise: 1.0 }
    }

    /// Clusters as often as they are drawn, and another plan.
    fn random(&self, random: &mut SplitMix64) -> Draw {
        let tilt: [f64; FEATURES] = std::array::from_fn(|_| PLAN_DEVIATION * f64::from(random.normal()));
        let noise = libm::exp(NOISE_DEVIATION * f64::from(random.normal()));
        Draw { weights: self.parts.each_ref().map(|part| part.drawn(&tilt, random)), noise }
    }

    /// ⟨e²⟩.
    pub(crate) fn mean(&self, squares: &Squares, draw: &Draw) -> f64 {
        let over =
            |at: usize, of: &[f64]| -> f64 { draw.weights[at].iter().zip(of).map(|(w, x)| w * x).sum() };
        let [locked, open] = [0, 1].map(|at| over(at, &self.parts[at].counts));
        let [at_locked, at_open] = [0, 1].map(|at| over(at, &self.parts[at].noise));
        let noise = (draw.noise - 1.0) * (at_locked + at_open) / (locked + open);
        let found = over(0, &squares.found) / locked + noise;
        let Some([at_locked, at_open]) = &squares.expected else { return found };
        let expected = [over(0, at_locked), over(1, at_open)];
        (found - expected[0] / locked + (expected[0] + expected[1]) / (locked + open)).max(0.0)
    }

    /// Ends of the 95 % interval of what is computed of draws.
    pub(crate) fn interval95(&self, of: impl Fn(&Draw) -> f64) -> [f64; 2] {
        let mut random = SplitMix64::new(SEED);
        let mut drawn: Vec<f64> = (0..DRAWS).map(|_| of(&self.random(&mut random))).collect();
        drawn.sort_by(f64::total_cmp);
        [0.025, 0.975].map(|share| drawn[(share * DRAWS as f64) as usize])
    }
}

impl RowClass {
    /// How often each row is drawn, as often as there are clusters, times exp(Σ aₖ xₖ).
    fn drawn(&self, tilt: &[f64; FEATURES], random: &mut SplitMix64) -> Vec<f64> {
        let clusters = self.clusters.iter().max().map_or(0, |last| last + 1);
        let mut times = vec![0.0; clusters];
        for _ in 0..clusters {
            times[(random.next_bits() % clusters as u64) as usize] += 1.0;
        }
        let rows = self.clusters.iter().zip(&self.features);
        rows.map(|(cluster, features)| {
            let shift: f64 = tilt.iter().zip(features).map(|(a, x)| a * x).sum();
            times[*cluster] * libm::exp(shift)
        })
        .collect()
    }
}

/// Features of a row that a plan chooses.
fn features(sample: &Sample) -> [f64; FEATURES] {
    let [fx, fy, _] = sample.load;
    let load = libm::sqrt(sample.load.iter().map(|n| n * n).sum());
    let shear = if load > 0.0 { libm::hypot(fx, fy) / load } else { 0.0 };
    let radius_mm = libm::hypot(sample.place_mm[0], sample.place_mm[1]);
    [load, shear, radius_mm, f64::from(u8::from(sample.is_in_series()))]
}

/// The same about their means over all rows, over their deviations; zero where they are all alike.
fn standardised(parts: [Vec<[f64; FEATURES]>; 2]) -> [Vec<[f64; FEATURES]>; 2] {
    let of = |k: usize| parts.iter().flatten().map(move |features| features[k]);
    let scales: [[f64; 2]; FEATURES] = std::array::from_fn(|k| {
        let middle = mean(of(k).collect::<Vec<_>>());
        [middle, rms(of(k).map(|x| x - middle))]
    });
    let standard = |features: &[f64; FEATURES]| {
        std::array::from_fn(|k| {
            let [middle, deviation] = scales[k];
            if deviation > 0.0 { (features[k] - middle) / deviation } else { 0.0 }
        })
    };
    parts.each_ref().map(|part| part.iter().map(standard).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten locked clusters and forty open ones of two rows; every second row is under twice the load. All are as large as expected,
    /// and locked ones half as large again.
    fn population(is_expected: bool) -> (Population, Squares) {
        let rows = |clusters: usize| Observations {
            channels: vec![String::new()],
            readings: vec![vec![0.0; 2 * clusters]],
            is_told: vec![vec![true; 2 * clusters]],
            samples: (0..2 * clusters)
                .map(|row| Sample {
                    place_mm: [(row / 2) as f64, 0.0],
                    load: [0.0, 0.0, 1.0 + (row % 2) as f64],
                    ..Sample::default()
                })
                .collect(),
            numbers: (0..2 * clusters).collect(),
        };
        let at = |row: usize| 1.0 + (row / 2 % 10) as f64;
        let expected = [20, 80].map(|rows| (0..rows).map(at).collect::<Vec<f64>>());
        let found = expected[0].iter().map(|square| 1.5 * square).collect();
        let noise = [20, 80].map(|rows| vec![0.0; rows]);
        let population = Population::of([&rows(10), &rows(40)], noise);
        (population, Squares { found, expected: is_expected.then_some(expected) })
    }

    #[test]
    fn what_was_expected_wrongly_is_corrected_and_narrows_the_interval() {
        let widths = [false, true].map(|is_expected| {
            let (population, squares) = population(is_expected);
            let mean = population.mean(&squares, &population.as_measured());
            assert!((mean - 1.5 * 5.5).abs() < 1e-9, "{mean}");
            let [low, high] = population.interval95(|draw| population.mean(&squares, draw));
            assert!(low < mean && mean < high);
            high - low
        });
        assert!(widths[1] < widths[0], "{widths:?}");
    }

    #[test]
    fn another_plan_counts_rows_under_other_loads_more() {
        let (population, _) = population(true);
        // 4 under twice the load, 1 else.
        let of_row =
            |rows: usize| (0..rows).map(|row| if row % 2 == 1 { 4.0 } else { 1.0 }).collect::<Vec<f64>>();
        let squares = Squares { found: of_row(20), expected: Some([of_row(20), of_row(80)]) };
        let [low, high] = population.interval95(|draw| population.mean(&squares, draw));
        // With half of the rows the mean is 2.5; a mean load off by half a deviation makes 1.8 or 3.2 of it.
        assert!((1.2..2.0).contains(&low) && (3.0..3.8).contains(&high), "{low} {high}");
    }
}
