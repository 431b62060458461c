//! Smooth functions of the place: a Gaussian process in low-rank form.
//!
//! A process with the covariance exp(−d²/2l²) on a rectangle is, to any accuracy, Σⱼ zⱼ φⱼ(x, y) with the eigenfunctions φ of
//! the Laplacian and independent zⱼ ~ N(0, S(ωⱼ)), where S is the process's spectral density at the eigenfunction's frequency.
//! The functions do not depend on l, so that another length costs nothing but other variances, and rows enter once.
//!
//! Source: A. Solin, S. Särkkä, Hilbert space methods for reduced-rank Gaussian process regression, Statistics and Computing 30
//! (2020) 419.

use std::f64::consts::PI;

use super::observations::Observations;

/// The rectangle reaches so far beyond the places, relative to them: the functions vanish at its border.
const REACH: f64 = 1.6;
/// Functions along each side; of two sides together those within the circle of that radius.
const PER_SIDE: usize = 8;
/// Least and greatest correlation length, as shares of the places' half side: shorter ones are not resolved by so many functions,
/// longer ones are all alike. (G. Riutort-Mayol and others, Statistics and Computing 33 (2023) 17, equation 11.)
const LENGTHS: [f64; 2] = [0.35, 1.2];
/// Half a side of places that are all on one line.
const HALF_SIDE_MIN_MM: f64 = 1.0;

/// The functions of a measurement's places.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Basis {
    /// For each row, the functions' values.
    pub(super) values: Vec<Vec<f64>>,
    /// ω² of each function, 1/mm².
    square_frequencies: Vec<f64>,
    /// For each function, its mean square over the rows.
    mean_squares: Vec<f64>,
    /// The larger half side of the places.
    half_mm: f64,
}

impl Basis {
    pub(super) fn of(observations: &Observations) -> Self {
        let places: Vec<[f64; 2]> = observations.samples.iter().map(|sample| sample.place_mm).collect();
        let sides = [0, 1].map(|axis| {
            let along = || places.iter().map(|place| place[axis]);
            let (least, most) =
                (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
            ((least + most) / 2.0, ((most - least) / 2.0).max(HALF_SIDE_MIN_MM))
        });
        let all = || (1..=PER_SIDE).flat_map(|i| (1..=PER_SIDE).map(move |j| [i as f64, j as f64]));
        let orders = || all().filter(|[i, j]| libm::hypot(*i, *j) <= 1.0 + PER_SIDE as f64);
        let frequency = |order: f64, axis: usize| order * PI / (2.0 * REACH * sides[axis].1);
        // φ(x, y) = sin(ωx (x + L)) sin(ωy (y + L)).
        let value = |place: &[f64; 2], order: [f64; 2]| -> f64 {
            let sine = |axis: usize| {
                let (middle, half) = sides[axis];
                libm::sin(frequency(order[axis], axis) * (place[axis] - middle + REACH * half))
            };
            sine(0) * sine(1)
        };
        let values: Vec<Vec<f64>> =
            places.iter().map(|place| orders().map(|order| value(place, order)).collect()).collect();
        let mean_square = |at: usize| {
            values.iter().map(|row: &Vec<f64>| row[at] * row[at]).sum::<f64>() / places.len() as f64
        };
        Self {
            mean_squares: (0..orders().count()).map(mean_square).collect(),
            square_frequencies: orders()
                .map(|[i, j]| frequency(i, 0).powi(2) + frequency(j, 1).powi(2))
                .collect(),
            half_mm: sides[0].1.max(sides[1].1),
            values,
        }
    }

    /// How many functions there are.
    pub(super) const fn len(&self) -> usize {
        self.square_frequencies.len()
    }

    /// The least and the greatest correlation length.
    pub(super) fn lengths_mm(&self) -> [f64; 2] {
        LENGTHS.map(|share| share * self.half_mm)
    }

    /// Variances of the zⱼ such that the process has a mean square of 1 over the rows.
    pub(super) fn variances(&self, length_mm: f64) -> Vec<f64> {
        // S(ω) ∝ exp(−l² ω²/2).
        let density: Vec<f64> = self
            .square_frequencies
            .iter()
            .map(|square| libm::exp(-0.5 * length_mm * length_mm * square))
            .collect();
        let whole: f64 = density.iter().zip(&self.mean_squares).map(|(s, square)| s * square).sum();
        density.iter().map(|s| (s / whole).max(1e-9)).collect()
    }
}
