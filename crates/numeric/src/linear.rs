//! Symmetric positive definite systems: small ones of a known size, without allocation, and large ones.
//!
//! Both by Cholesky's factorisation, A = L Lᵀ (G. H. Golub, C. F. Van Loan, Matrix Computations, section 4.2).

use std::ops::Range;

use super::products::{AT_ONCE, add_combination, dot, products};
use super::simd::widest;

/// The factor L of a small matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor<const N: usize> {
    lower: [[f64; N]; N],
}

impl<const N: usize> Factor<N> {
    /// Factorises; only the lower triangle is read. `None` if the matrix is not positive definite, or not finite.
    pub fn of(matrix: &[[f64; N]; N]) -> Option<Self> {
        let mut lower = [[0.0; N]; N];
        for row in 0..N {
            for column in 0..=row {
                // Lᵢⱼ = (Aᵢⱼ − Σₖ Lᵢₖ Lⱼₖ)/Lⱼⱼ over k < j, Lᵢᵢ = √(Aᵢᵢ − Σₖ Lᵢₖ²).
                let sum: f64 = (0..column).map(|k| lower[row][k] * lower[column][k]).sum();
                let rest = matrix[row][column] - sum;
                lower[row][column] = if row == column { root(rest)? } else { rest / lower[column][column] };
            }
        }
        Some(Self { lower })
    }

    /// The x with L x = b. Its square is bᵀ A⁻¹ b.
    pub fn solve_lower(&self, right: &[f64; N]) -> [f64; N] {
        // Forward substitution: xᵢ = (bᵢ − Σₖ Lᵢₖ xₖ)/Lᵢᵢ over k < i.
        let mut x = *right;
        for row in 0..N {
            let sum: f64 = (0..row).map(|k| self.lower[row][k] * x[k]).sum();
            x[row] = (x[row] - sum) / self.lower[row][row];
        }
        x
    }

    /// ln det A = 2 Σ ln Lᵢᵢ.
    pub fn log_determinant(&self) -> f64 {
        (0..N).map(|row| 2.0 * libm::log(self.lower[row][row])).sum()
    }

    /// The x with A x = b.
    pub fn solve(&self, right: &[f64; N]) -> [f64; N] {
        // Backward substitution of Lᵀ x = y: xᵢ = (yᵢ − Σₖ Lₖᵢ xₖ)/Lᵢᵢ over k > i.
        let mut x = self.solve_lower(right);
        for row in (0..N).rev() {
            let sum: f64 = (row + 1..N).map(|k| self.lower[k][row] * x[k]).sum();
            x[row] = (x[row] - sum) / self.lower[row][row];
        }
        x
    }

    /// The inverse of A.
    pub fn inverse(&self) -> [[f64; N]; N] {
        std::array::from_fn(|column| {
            self.solve(&std::array::from_fn(|row| f64::from(u8::from(row == column))))
        })
    }
}

/// The root of a pivot; `None` if that is not positive and finite.
fn root(pivot: f64) -> Option<f64> {
    (pivot > 0.0 && pivot.is_finite()).then(|| libm::sqrt(pivot))
}

/// A large symmetric matrix, row by row; only its lower triangle is kept up to date.
#[derive(Clone, Debug, PartialEq)]
pub struct Symmetric {
    size: usize,
    rows: Vec<f64>,
}

impl Symmetric {
    /// A matrix of zeros.
    pub fn zeros(size: usize) -> Self {
        Self { size, rows: vec![0.0; size * size] }
    }

    /// From all its entries, row by row.
    pub(super) fn of(size: usize, rows: &[f64]) -> Self {
        Self { size, rows: rows.to_vec() }
    }

    /// Adds to a diagonal entry.
    pub fn add_diagonal(&mut self, at: usize, value: f64) {
        if let Some(entry) = self.rows.get_mut(at * self.size + at) {
            *entry += value;
        }
    }

    /// Adds weight · v vᵀ. Zeros of v cost nothing but a look.
    pub fn add_product(&mut self, weight: f64, vector: &[f64]) {
        let runs = runs(vector);
        widest(
            #[inline(always)]
            || {
                for run in &runs {
                    for row in run.clone() {
                        self.add_to_row(row, weight * vector[row], &runs, vector);
                    }
                }
            },
        );
    }

    /// Adds factor · v to a row, up to the diagonal.
    #[inline(always)]
    fn add_to_row(&mut self, row: usize, factor: f64, runs: &[Range<usize>], vector: &[f64]) {
        let line = &mut self.rows[row * self.size..][..self.size];
        for run in runs.iter().take_while(|run| run.start <= row) {
            for column in run.start..run.end.min(row + 1) {
                line[column] += factor * vector[column];
            }
        }
    }

    /// Adds Σ l rᵀ of these pairs (l, r), a sum that is symmetric. A zero of l costs nothing but a look. Many pairs at once cost
    /// less each: the matrix is gone through once.
    pub fn add_products(&mut self, pairs: &[(Vec<f64>, Vec<f64>)]) {
        widest(
            #[inline(always)]
            || {
                let mut terms = Vec::with_capacity(pairs.len());
                for row in 0..self.size {
                    let used = pairs.iter().filter(|(left, _)| left[row] != 0.0);
                    terms.clear();
                    terms.extend(used.map(|(left, right)| (left[row], &right[..=row])));
                    add_combination(&mut self.rows[row * self.size..][..=row], &terms);
                }
            },
        );
    }

    /// Adds another matrix.
    pub fn add(&mut self, other: &Self) {
        self.rows.iter_mut().zip(&other.rows).for_each(|(entry, other)| *entry += other);
    }

    /// Factorises in place; `None` if it is not positive definite.
    pub fn factorised(mut self) -> Option<LargeFactor> {
        self.factorise(self.size)?;
        Some(LargeFactor { size: self.size, lower: self.rows })
    }

    /// Rows of L, each up to the column `columns` or its diagonal.
    fn factorise(&mut self, columns: usize) -> Option<()> {
        widest(
            #[inline(always)]
            || self.factorise_rows(columns),
        )
    }

    #[inline(always)]
    fn factorise_rows(&mut self, columns: usize) -> Option<()> {
        let size = self.size;
        for row in 0..size {
            // Row by row, as in [`Factor::of`]; the rows above are done.
            let (above, from_row) = self.rows.split_at_mut(row * size);
            let line = &mut from_row[..size];
            let known = row.min(columns);
            let mut column = 0;
            while column + AT_ONCE <= known {
                // What the columns before these four take, and then these of one another.
                let others: [&[f64]; AT_ONCE] =
                    std::array::from_fn(|k| &above[(column + k) * size..][..column]);
                let taken = products(&line[..column], others);
                for (k, taken) in taken.into_iter().enumerate() {
                    let other = &above[(column + k) * size..][..=column + k];
                    let rest: f64 = (column..column + k).map(|at| line[at] * other[at]).sum();
                    line[column + k] = (line[column + k] - (taken + rest)) / other[column + k];
                }
                column += AT_ONCE;
            }
            for column in column..known {
                let other = &above[column * size..][..=column];
                line[column] =
                    (line[column] - products(&line[..column], [&other[..column]])[0]) / other[column];
            }
            if row < columns {
                line[row] = root(line[row] - products(&line[..row], [&line[..row]])[0])?;
            }
        }
        Some(())
    }

    /// The equations A x = b of all but the first unknowns, which are free: with A = [H Gᵀ; G K] and b = [h; k] the Schur complement
    /// S = K − G H⁻¹ Gᵀ and s = k − G H⁻¹ h. `None` if H is not positive definite.
    pub fn reduced(mut self, right: &[f64], first: usize) -> Option<Reduced> {
        self.factorise(first)?;
        let line = |row: usize| &self.rows[row * self.size..][..first];
        // y = L⁻¹h, forwards as in [`Factor::solve_lower`].
        let mut half = right[..first].to_vec();
        for row in 0..first {
            half[row] = (half[row] - dot(&line(row)[..row], &half[..row])) / line(row)[row];
        }
        // The rows below H are G L⁻ᵀ: S = K − (G L⁻ᵀ)(G L⁻ᵀ)ᵀ, s = k − (G L⁻ᵀ) y.
        let entry = |row: usize, column: usize| {
            let (low, high) = (row.min(column), row.max(column));
            self.rows[high * self.size + low] - dot(line(row), line(column))
        };
        let rest = first..self.size;
        let row = |row: usize| rest.clone().map(|column| entry(row, column)).collect();
        Some(Reduced {
            information: rest.clone().map(row).collect(),
            score: rest.clone().map(|row| right[row] - dot(line(row), &half)).collect(),
        })
    }
}

/// Where a vector is not zero, stretch by stretch; single zeros between two stretches belong to them.
fn runs(vector: &[f64]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for at in (0..vector.len()).filter(|at| vector[*at] != 0.0) {
        match runs.last_mut() {
            Some(run) if run.end + 1 >= at => run.end = at + 1,
            _ => runs.push(at..at + 1),
        }
    }
    runs
}

/// Normal equations S x = s that remain when the other unknowns are free (Schur complement).
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// S, row by row.
    pub information: Vec<Vec<f64>>,
    /// s.
    pub score: Vec<f64>,
}

impl Reduced {
    /// The equations of the first unknowns alone, the others being zero, and those of the others alone.
    pub fn split(&self, first: usize) -> (Self, Self) {
        let part = |from: usize, to: usize| Self {
            information: self.information[from..to].iter().map(|row| row[from..to].to_vec()).collect(),
            score: self.score[from..to].to_vec(),
        };
        (part(0, first), part(first, self.score.len()))
    }

    /// The equations of linear combinations of the unknowns: CᵀSC and Cᵀs, with the columns of C one after the other.
    pub fn combined(&self, columns: &[Vec<f64>]) -> Self {
        let turned: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| self.information.iter().map(|row| dot(row, column)).collect())
            .collect();
        let row = |column: &Vec<f64>| turned.iter().map(|turned| dot(turned, column)).collect();
        Self {
            information: columns.iter().map(row).collect(),
            score: columns.iter().map(|column| dot(column, &self.score)).collect(),
        }
    }

    /// The equations of all unknowns where some combinations of them are free: S − S C (CᵀSC)⁻¹ CᵀS and s − S C (CᵀSC)⁻¹ Cᵀs, with
    /// the columns of C one after the other. `None` if CᵀSC is not positive definite.
    pub fn beside(&self, free: &[Vec<f64>]) -> Option<Self> {
        let small = self.combined(free);
        let factor = Symmetric::of(free.len(), &small.information.concat()).factorised()?;
        // Row by row L⁻¹CᵀS, one column for each unknown.
        let turned = |row: &Vec<f64>| free.iter().map(|column| dot(row, column)).collect::<Vec<f64>>();
        let halves: Vec<Vec<f64>> =
            self.information.iter().map(|row| factor.solve_lower(&turned(row))).collect();
        let half = factor.solve_lower(&small.score);
        let row = |(row, one): (&Vec<f64>, &Vec<f64>)| {
            row.iter().zip(&halves).map(|(entry, other)| entry - dot(one, other)).collect()
        };
        Some(Self {
            information: self.information.iter().zip(&halves).map(row).collect(),
            score: self.score.iter().zip(&halves).map(|(entry, one)| entry - dot(one, &half)).collect(),
        })
    }

    /// The solution S⁻¹s, and the diagonal of S⁻¹; `None` if S is not positive definite.
    pub fn solved(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let factor = Symmetric::of(self.score.len(), &self.information.concat()).factorised()?;
        Some((factor.solve(&self.score), factor.inverse_diagonal()))
    }

    /// How much less the weighted squares are at the solution: sᵀ S⁻¹ s.
    pub fn square(&self) -> Option<f64> {
        let (solution, _) = self.solved()?;
        Some(dot(&solution, &self.score))
    }
}

/// The factor L of a large matrix.
#[derive(Clone, Debug)]
pub struct LargeFactor {
    size: usize,
    lower: Vec<f64>,
}

impl LargeFactor {
    /// The x with L x = b. Its square is bᵀ A⁻¹ b.
    pub fn solve_lower(&self, right: &[f64]) -> Vec<f64> {
        let mut x = right.to_vec();
        for row in 0..self.size {
            let line = &self.lower[row * self.size..][..=row];
            x[row] = (x[row] - dot(&line[..row], &x[..row])) / line[row];
        }
        x
    }

    /// The x with A x = b. `right` has as many numbers as the matrix rows.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        self.solve_upper(&self.solve_lower(right))
    }

    /// The x with Lᵀ x = b.
    pub fn solve_upper(&self, right: &[f64]) -> Vec<f64> {
        // Column by column: once xᵢ is known, Lᵢₖ xᵢ is taken off all k < i.
        let mut x = right.to_vec();
        for row in (0..self.size).rev() {
            let line = &self.lower[row * self.size..][..=row];
            x[row] /= line[row];
            let value = x[row];
            x[..row].iter_mut().zip(line).for_each(|(x, factor)| *x -= factor * value);
        }
        x
    }

    /// The diagonal of A = L Lᵀ: Aᵢᵢ = Σₖ Lᵢₖ².
    pub fn diagonal(&self) -> Vec<f64> {
        let line = |row: usize| &self.lower[row * self.size..][..=row];
        (0..self.size).map(|row| dot(line(row), line(row))).collect()
    }

    /// The square blocks of this width along the diagonal of the inverse of A.
    pub fn inverse_blocks(&self, width: usize) -> Vec<Vec<Vec<f64>>> {
        // A⁻¹ = L⁻ᵀ L⁻¹: products of columns of L⁻¹, whose entries above the diagonal are zero.
        let block = |first: usize| {
            let end = (first + width).min(self.size);
            let columns: Vec<Vec<f64>> = (first..end)
                .step_by(AT_ONCE)
                .flat_map(|at| self.inverse_columns(at, first).into_iter().take(end - at))
                .collect();
            let product = |one: &Vec<f64>| columns.iter().map(|other| dot(one, other)).collect();
            columns.iter().map(product).collect()
        };
        (0..self.size).step_by(width.max(1)).map(block).collect()
    }

    /// The diagonal of the inverse of A.
    pub fn inverse_diagonal(&self) -> Vec<f64> {
        // A⁻¹ = L⁻ᵀ L⁻¹, so (A⁻¹)ᵢᵢ is the square of column i of L⁻¹.
        let four = |at: usize| self.inverse_columns(at, at).map(|column| dot(&column, &column));
        (0..self.size).step_by(AT_ONCE).flat_map(four).take(self.size).collect()
    }

    /// Columns of L⁻¹ from `at` on, without their first `above` entries, which are zero. Beyond the last column they are zero. A row
    /// of L is loaded once for all of them.
    fn inverse_columns(&self, at: usize, above: usize) -> [Vec<f64>; AT_ONCE] {
        let mut columns = [const { Vec::new() }; AT_ONCE];
        columns.iter_mut().for_each(|column| column.resize(self.size - above, 0.0));
        widest(
            #[inline(always)]
            || {
                for row in at..self.size {
                    // xᵢ = (eᵢ − Σₖ Lᵢₖ xₖ)/Lᵢᵢ over k < i, forwards.
                    let line = &self.lower[row * self.size..][..=row];
                    let known = at - above..row - above;
                    let sums =
                        products(&line[at..row], columns.each_ref().map(|column| &column[known.clone()]));
                    for (k, (column, sum)) in columns.iter_mut().zip(sums).enumerate() {
                        let unit = if row == at + k { 1.0 } else { 0.0 };
                        column[row - above] = (unit - sum) / line[row];
                    }
                }
            },
        );
        columns
    }

    /// ln det A = 2 Σ ln Lᵢᵢ.
    pub fn log_determinant(&self) -> f64 {
        (0..self.size).map(|row| 2.0 * self.lower[row * self.size + row].ln()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    /// A random positive definite matrix.
    fn matrix<const N: usize>(seed: u64) -> [[f64; N]; N] {
        let mut random = SplitMix64::new(seed);
        let factors: [[f64; N]; N] = [[0; N]; N].map(|row| row.map(|_| f64::from(random.uniform())));
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let product: f64 = factors[i].iter().zip(&factors[j]).map(|(a, b)| a * b).sum();
                product + if i == j { 0.1 } else { 0.0 }
            })
        })
    }

    #[test]
    fn solutions_solve() {
        let (a, b) = (matrix::<5>(1), [1.0, -2.0, 3.0, 0.5, 7.0]);
        let factor = Factor::of(&a).unwrap();
        let x = factor.solve(&b);
        let product = a.map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>());
        assert!(product.iter().zip(b).all(|(found, wanted)| (found - wanted).abs() < 1e-9));
        let inverse = factor.inverse();
        let entry: f64 = (0..5).map(|k| a[2][k] * inverse[k][2]).sum();
        assert!((entry - 1.0).abs() < 1e-9);
    }

    #[test]
    fn large_and_small_agree() {
        let (a, b) = (matrix::<9>(2), [0.3, 1.0, -2.0, 3.0, 0.5, 7.0, 0.0, -1.0, 2.0]);
        let mut large = Symmetric::zeros(9);
        // A sum of products of the columns of its factor is the matrix.
        let small = Factor::of(&a).unwrap();
        for column in 0..9 {
            let vector: Vec<f64> = small.lower.iter().map(|row| row[column]).collect();
            large.add_product(0.5, &vector);
        }
        let half = large.clone();
        large.add(&half);
        large.add_products(&[(b.map(|entry| -entry).to_vec(), b.to_vec())]);
        large.add_product(1.0, &b);
        let factor = large.factorised().unwrap();
        assert!(factor.solve(&b).iter().zip(small.solve(&b)).all(|(one, other)| (one - other).abs() < 1e-8));
        let inverse = small.inverse();
        let diagonal = factor.inverse_diagonal();
        assert!((0..9).all(|k| (diagonal[k] / inverse[k][k] - 1.0).abs() < 1e-8));
        let form: f64 = b.iter().zip(small.solve(&b)).map(|(b, x)| b * x).sum();
        let half: f64 = factor.solve_lower(&b).iter().map(|x| x * x).sum();
        assert!((half - form).abs() < 1e-8);
        let determinant: f64 = (0..9).map(|k| small.lower[k][k].powi(2)).product();
        assert!((factor.log_determinant() - determinant.ln()).abs() < 1e-9);
    }

    #[test]
    fn what_is_left_of_equations_has_the_solution_of_all() {
        let (a, b) = (matrix::<9>(3), [0.3, 1.0, -2.0, 3.0, 0.5, 7.0, 0.4, -1.0, 2.0]);
        let reduced = Symmetric::of(9, a.as_flattened()).reduced(&b, 5).unwrap();
        let small = Factor::of(&a).unwrap();
        let (solution, variances) = reduced.solved().unwrap();
        let (all, inverse) = (small.solve(&b), small.inverse());
        for at in 0..4 {
            assert!((solution[at] - all[5 + at]).abs() < 1e-8, "{solution:?} {all:?}");
            assert!((variances[at] / inverse[5 + at][5 + at] - 1.0).abs() < 1e-8);
        }
        // bᵀA⁻¹b is what the first ones explain alone, and what the others do beside them.
        let (first, rest) = Reduced { information: a.map(Vec::from).to_vec(), score: b.to_vec() }.split(5);
        let whole: f64 = b.iter().zip(all).map(|(b, x)| b * x).sum();
        assert!((first.square().unwrap() + reduced.square().unwrap() - whole).abs() < 1e-8);
        assert_eq!(rest.score, b[5..]);
        let picked: Vec<Vec<f64>> = vec![vec![1.0, 0.0, 2.0, 0.0]];
        let combined = reduced.combined(&picked);
        let form =
            reduced.information[0][0] + 4.0 * reduced.information[2][0] + 4.0 * reduced.information[2][2];
        assert!((combined.information[0][0] - form).abs() < 1e-9);
        assert!((combined.score[0] - reduced.score[0] - 2.0 * reduced.score[2]).abs() < 1e-12);
        // What one explains, and another beside it, is what both explain.
        let other = vec![0.0, 1.0, 0.0, -1.0];
        let both = reduced.combined(&[picked[0].clone(), other.clone()]).square().unwrap();
        let beside = reduced.beside(&picked).unwrap().combined(&[other]).square().unwrap();
        assert!((combined.square().unwrap() + beside - both).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_positive_definite_has_no_factor() {
        assert_eq!(Factor::of(&[[1.0, 2.0], [2.0, 1.0]]), None);
        assert_eq!(Factor::of(&[[f64::NAN]]), None);
        let mut large = Symmetric::zeros(2);
        assert!(large.clone().factorised().is_none());
        large.add_diagonal(0, 1.0);
        large.add_diagonal(1, 2.0);
        assert!(large.factorised().is_some());
    }
}
