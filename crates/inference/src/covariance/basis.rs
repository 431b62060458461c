//! Smooth functions of the place: a Gaussian process in low-rank form.
//!
//! A process with the covariance exp(−d²/2l²) is taken as Σⱼ zⱼ φⱼ(x, y) with z ~ N(0, T) and waves φ on a rectangle around the
//! places. The waves do not depend on the length l, so that another length costs no look at the rows. On points g that fill the
//! places' ellipse, T = P K Pᵀ with P = (Φᵀ Φ)⁻¹ Φᵀ: the process as near as the waves can come to it. (Independent zⱼ would be
//! cheaper, but then the process vanishes at the rectangle's border, and long lengths need a rectangle far away.)
//!
//! Source: A. Solin, S. Särkkä, Hilbert space methods for reduced-rank Gaussian process regression, Statistics and Computing 30
//! (2020) 419 (the waves); J. Quiñonero-Candela, C. E. Rasmussen, J. Machine Learning Research 6 (2005) 1939 (projections).

use std::f64::consts::PI;
use std::sync::OnceLock;

use crate::error::{InferenceError, Stage, factorised};
use crate::observations::Observations;
use tactpad_numeric::dense::{Matrix, gram};
use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::products::dot;

/// The rectangle reaches so far beyond the places, relative to them: the waves vanish at its border.
const REACH: f64 = 1.4;
/// Functions along each side; of two sides together those within the circle of that radius.
const PER_SIDE: usize = 8;
/// Least and greatest correlation length, as shares of the places' half side: shorter ones are not resolved by so many functions,
/// longer ones are all alike. And how many are tried, evenly in their logarithms.
const LENGTHS: [f64; 2] = [0.3, 1.2];
pub(crate) const LENGTHS_TRIED: usize = 11;
/// Points by which the process is projected, and what makes a projection of functions that are nearly alike there unique, as a
/// share of their mean square.
const POINTS: usize = 200;
const RIDGE: f64 = 1e-6;
/// Half a side of places that are all on one line.
const HALF_SIDE_MIN_MM: f64 = 1.0;

/// The functions of a measurement's places.
#[derive(Debug)]
pub struct Basis {
    /// Along x and y: the middle of the places, and half their extent.
    sides: [[f64; 2]; 2],
    /// Of each function: half waves along x and y.
    orders: Vec<[f64; 2]>,
    /// For each row, the functions' values.
    pub values: Vec<Vec<f64>>,
    /// Of each length that is tried.
    priors: [OnceLock<Result<Prior, InferenceError>>; LENGTHS_TRIED],
}

/// z ~ N(0, T).
#[derive(Clone, Debug)]
pub struct Prior {
    /// l.
    pub length_mm: f64,
    /// Of T = L Lᵀ.
    factor: LargeFactor,
    /// T⁻¹.
    pub precision: Matrix,
}

impl Prior {
    /// L⁻¹ z.
    pub fn whitened(&self, z: &[f64]) -> Vec<f64> {
        self.factor.solve_lower(z)
    }

    /// zᵀ T⁻¹ z.
    pub fn energy(&self, z: &[f64]) -> f64 {
        let whitened = self.whitened(z);
        dot(&whitened, &whitened)
    }

    /// ln det T.
    pub fn log_determinant(&self) -> f64 {
        self.factor.log_determinant()
    }
}

impl Basis {
    /// The functions of the places of these rows.
    pub fn of(observations: &Observations) -> Self {
        let places = || observations.samples.iter().map(|sample| sample.place_mm);
        let sides = [0, 1].map(|axis| {
            let along = || places().map(|place| place[axis]);
            let (least, most) =
                (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
            [(least + most) / 2.0, ((most - least) / 2.0).max(HALF_SIDE_MIN_MM)]
        });
        let all = (1..=PER_SIDE).flat_map(|i| (1..=PER_SIDE).map(move |j| [i as f64, j as f64]));
        let orders = all.filter(|[i, j]| libm::hypot(*i, *j) <= 1.0 + PER_SIDE as f64).collect();
        let mut basis = Self { sides, orders, values: Vec::new(), priors: Default::default() };
        basis.values = places().map(|place_mm| basis.at(place_mm)).collect();
        basis
    }

    /// The functions at a place: φ(x, y) = sin(ωx (x + L)) sin(ωy (y + L)).
    pub fn at(&self, place_mm: [f64; 2]) -> Vec<f64> {
        let sine = |order: f64, axis: usize| {
            let [middle, half] = self.sides[axis];
            libm::sin(self.frequency(order, axis) * (place_mm[axis] - middle + REACH * half))
        };
        self.orders.iter().map(|[i, j]| sine(*i, 0) * sine(*j, 1)).collect()
    }

    /// ω of so many half waves, 1/mm.
    fn frequency(&self, order: f64, axis: usize) -> f64 {
        order * PI / (2.0 * REACH * self.sides[axis][1])
    }

    /// How many functions there are.
    pub(crate) const fn len(&self) -> usize {
        self.orders.len()
    }

    /// One of the correlation lengths that are tried, from the least to the greatest.
    fn length_mm(&self, at: usize) -> f64 {
        let half_mm = self.sides[0][1].max(self.sides[1][1]);
        let [least, most] = LENGTHS;
        let share = least * libm::pow(most / least, at as f64 / (LENGTHS_TRIED - 1) as f64);
        share * half_mm
    }

    /// The process of one of the [`LENGTHS_TRIED`]; it is computed once.
    pub(crate) fn prior(&self, at: usize) -> Result<&Prior, InferenceError> {
        self.priors[at].get_or_init(|| self.process(self.length_mm(at))).as_ref().map_err(|error| *error)
    }

    /// The process of this length with a mean square of 1.
    fn process(&self, length_mm: f64) -> Result<Prior, InferenceError> {
        let points = self.points();
        let values: Vec<Vec<f64>> = points.iter().map(|point| self.at(*point)).collect();
        let columns: Vec<Vec<f64>> =
            (0..self.len()).map(|at| values.iter().map(|row| row[at]).collect()).collect();
        let mut inner = gram(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let mean_square = (0..self.len()).map(|at| inner.at(at, at)).sum::<f64>() / self.len() as f64;
        (0..self.len()).for_each(|at| inner.row_mut(at)[at] += RIDGE * mean_square);
        let factor = factorised(&inner, Stage::Process)?;
        // P, a column for each point.
        let projection: Vec<Vec<f64>> = values.iter().map(|row| factor.solve(row)).collect();
        let projection = Matrix::from_rows(&projection);
        let kernel = |one: &[f64; 2], other: &[f64; 2]| {
            let away_mm = libm::hypot(one[0] - other[0], one[1] - other[1]);
            libm::exp(-0.5 * (away_mm / length_mm).powi(2))
        };
        // K Pᵀ, a row for each point.
        let spread = points.iter().map(|one| {
            let row: Vec<f64> = points.iter().map(|other| kernel(one, other)).collect();
            projection.transposed_times(&row)
        });
        let spread = Matrix::from_rows(&spread.collect::<Vec<_>>());
        let mut covariance = Matrix::zeros(self.len(), self.len());
        for at in 0..self.len() {
            covariance.row_mut(at).copy_from_slice(&spread.transposed_times(&projection.column(at)));
            covariance.row_mut(at)[at] += RIDGE;
        }
        let factor = factorised(&covariance, Stage::Process)?;
        let unit = |at: usize| (0..self.len()).map(|k| f64::from(u8::from(k == at))).collect::<Vec<_>>();
        let precision: Vec<Vec<f64>> = (0..self.len()).map(|at| factor.solve(&unit(at))).collect();
        Ok(Prior { length_mm, factor, precision: Matrix::from_rows(&precision) })
    }

    /// Points that fill the ellipse of the places evenly: a sunflower.
    fn points(&self) -> Vec<[f64; 2]> {
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let point = |at: usize| {
            let radius = libm::sqrt((at as f64 + 0.5) / POINTS as f64);
            let angle = golden * at as f64;
            let along = [radius * libm::cos(angle), radius * libm::sin(angle)];
            [0, 1].map(|axis| self.sides[axis][0] + self.sides[axis][1] * along[axis])
        };
        (0..POINTS).map(point).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observations::Sample;

    fn disc() -> Basis {
        let places = (0..72).map(|at| {
            let (sin, cos) = (libm::sin(f64::from(at)), libm::cos(f64::from(at)));
            [29.0 * cos * f64::from(at % 6 + 1) / 6.0, 29.0 * sin * f64::from(at % 6 + 1) / 6.0]
        });
        let samples = places.map(|place_mm| Sample { place_mm, ..Sample::default() }).collect();
        Basis::of(&Observations { samples, ..Observations::default() })
    }

    #[test]
    fn the_process_has_its_covariance() {
        let basis = disc();
        // The projection is found to lose up to a tenth of the mean square; from where is not known.
        for length_mm in [10.0, 14.0, 20.0, 30.0] {
            let prior = basis.process(length_mm).unwrap();
            let covariance = |one: [f64; 2], other: [f64; 2]| {
                let [one, other] = [one, other].map(|place| basis.at(place));
                let factor = prior.precision.factorised().unwrap();
                dot(&factor.solve_lower(&one), &factor.solve_lower(&other))
            };
            for (one, other) in
                [([0.0, 0.0], [0.0, 0.0]), ([20.0, 5.0], [20.0, 5.0]), ([20.0, 5.0], [8.0, -3.0])]
            {
                let away_mm = libm::hypot(one[0] - other[0], one[1] - other[1]);
                let expected = libm::exp(-0.5 * (away_mm / length_mm).powi(2));
                let found = covariance(one, other);
                assert!((found - expected).abs() < 0.12, "{length_mm} {one:?} {other:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn places_on_one_spot_are_no_fault() {
        let samples = vec![Sample::default(); 3];
        let basis = Basis::of(&Observations { samples, ..Observations::default() });
        assert!((0..LENGTHS_TRIED).all(|at| basis.prior(at).is_ok()));
    }
}
