//! Small dense matrices and the products that least squares needs.

use super::linear::{LargeFactor, Symmetric};
use super::products::{AT_ONCE, dot, products};
use super::simd::widest;

/// A matrix, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix {
    columns: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// A matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { columns, values: vec![0.0; rows * columns] }
    }

    /// From its rows, which are equally long.
    pub fn from_rows(rows: &[Vec<f64>]) -> Self {
        Self { columns: rows.first().map_or(0, Vec::len), values: rows.concat() }
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.values.len().checked_div(self.columns).unwrap_or(0)
    }

    /// How many columns there are.
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// A row.
    pub fn row(&self, at: usize) -> &[f64] {
        &self.values[at * self.columns..][..self.columns]
    }

    /// A row, to change.
    pub fn row_mut(&mut self, at: usize) -> &mut [f64] {
        &mut self.values[at * self.columns..][..self.columns]
    }

    /// An entry.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.row(row)[column]
    }

    /// A column.
    pub fn column(&self, at: usize) -> Vec<f64> {
        self.values.iter().skip(at).step_by(self.columns.max(1)).copied().collect()
    }

    /// A b.
    pub fn times(&self, vector: &[f64]) -> Vec<f64> {
        self.values.chunks_exact(self.columns.max(1)).map(|row| dot(row, vector)).collect()
    }

    /// Aᵀ b.
    pub fn transposed_times(&self, vector: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.columns];
        for (row, weight) in self.values.chunks_exact(self.columns.max(1)).zip(vector) {
            sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
        }
        sums
    }

    /// A + factor · B of a matrix B of the same size.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let sums = self.values.iter().zip(&other.values).map(|(own, other)| own + factor * other);
        Self { columns: self.columns, values: sums.collect() }
    }

    /// Rows and columns of a square matrix at these places.
    pub fn picked(&self, rows: &[usize], columns: &[usize]) -> Self {
        let picked: Vec<Vec<f64>> =
            rows.iter().map(|row| columns.iter().map(|column| self.at(*row, *column)).collect()).collect();
        Self::from_rows(&picked)
    }

    /// Whether all entries are numbers.
    pub fn is_finite(&self) -> bool {
        self.values.iter().all(|value| value.is_finite())
    }

    /// Cholesky's factor of a symmetric matrix; `None` if it is not positive definite.
    pub fn factorised(&self) -> Option<LargeFactor> {
        Symmetric::of(self.columns, &self.values).factorised()
    }
}

/// XᵀX for the vectors that are X's columns, which are equally long.
pub fn gram(columns: &[&[f64]]) -> Matrix {
    let mut gram = Matrix::zeros(columns.len(), columns.len());
    for (row, left) in columns.iter().enumerate() {
        let line = &mut gram.row_mut(row)[..=row];
        widest(
            #[inline(always)]
            || products_with(left, &columns[..=row], line),
        );
    }
    for row in 0..columns.len() {
        for column in 0..row {
            gram.row_mut(column)[row] = gram.at(row, column);
        }
    }
    gram
}

/// Products of a vector with each of these.
#[inline(always)]
fn products_with(left: &[f64], columns: &[&[f64]], to: &mut [f64]) {
    let (fours, rest) = columns.as_chunks::<AT_ONCE>();
    let (four_products, single_products) = to.as_chunks_mut::<AT_ONCE>();
    for (four, to) in fours.iter().zip(four_products) {
        *to = products(left, *four);
    }
    for (one, to) in rest.iter().zip(single_products) {
        [*to] = products(left, [one]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_definition() {
        let matrix = Matrix::from_rows(&[vec![1.0, 2.0], vec![3.0, 4.0], vec![5.0, 6.0]]);
        assert_eq!((matrix.rows(), matrix.columns(), matrix.at(2, 1)), (3, 2, 6.0));
        assert_eq!(matrix.times(&[1.0, -1.0]), [-1.0, -1.0, -1.0]);
        assert_eq!(matrix.transposed_times(&[1.0, 0.0, 1.0]), [6.0, 8.0]);
        assert_eq!(matrix.column(1), [2.0, 4.0, 6.0]);
        let gram = gram(&[&matrix.column(0), &matrix.column(1)]);
        assert_eq!(gram, Matrix::from_rows(&[vec![35.0, 44.0], vec![44.0, 56.0]]));
        let factor = gram.factorised().unwrap();
        let solved = factor.solve(&[79.0, 100.0]);
        assert!((solved[0] - 1.0).abs() < 1e-9 && (solved[1] - 1.0).abs() < 1e-9);
        assert_eq!(gram.picked(&[1], &[0, 1]).row(0), [44.0, 56.0]);
        assert_eq!(gram.plus(-2.0, &gram).row(1), [-44.0, -56.0]);
        assert!(Matrix::zeros(2, 2).factorised().is_none());
    }
}
