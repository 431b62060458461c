//! Principal directions: the unit vectors along which the rows of a matrix have the largest sums of squares.
//!
//! Source: N. Halko, P. G. Martinsson, J. A. Tropp, SIAM Review 53 (2011) 217, section 4.5 (subspace iteration from a random
//! start).

use super::dense::{Matrix, gram};
use super::products::dot;
use super::random::SplitMix64;

/// Directions that are iterated beside those that are asked for: they make these converge faster.
const SPARE: usize = 8;
/// Rounds of the subspace iteration.
const ROUNDS: usize = 12;
/// A direction with a smaller part of its former length is a sum of those before it.
const DEPENDENT: f64 = 1e-10;
/// Sweeps of Jacobi's method: it converges quadratically.
const SWEEPS: usize = 12;

/// A unit vector, and the sum of the squares of all rows along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Principal {
    /// The unit vector v.
    pub direction: Vec<f64>,
    /// ‖A v‖².
    pub square: f64,
}

/// At most `count` orthogonal principal directions of the rows of A, the largest first; fewer if the rows span no more.
pub fn principal_directions(rows: &Matrix, count: usize) -> Vec<Principal> {
    let columns: Vec<Vec<f64>> = (0..rows.columns()).map(|at| rows.column(at)).collect();
    let borrowed: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    // S = AᵀA; V ← orthonormal S V.
    let square = gram(&borrowed);
    let mut random = SplitMix64::new(1);
    let mut draw = |_| (0..square.columns()).map(|_| f64::from(random.normal())).collect();
    let mut basis = orthonormal((0..(count + SPARE).min(square.columns())).map(&mut draw).collect());
    for _ in 0..ROUNDS {
        basis = orthonormal(basis.iter().map(|vector| square.times(vector)).collect());
    }
    rotated(&square, &basis).into_iter().take(count).collect()
}

/// Residual of a row beside these orthonormal directions: v − Σ d (d · v).
pub fn beside(mut row: Vec<f64>, directions: &[Principal]) -> Vec<f64> {
    for Principal { direction, .. } in directions {
        let along = dot(&row, direction);
        row.iter_mut().zip(direction).for_each(|(entry, own)| *entry -= along * own);
    }
    row
}

/// An orthonormal basis of what the vectors span.
fn orthonormal(vectors: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(vectors.len());
    for mut vector in vectors {
        let before = dot(&vector, &vector).sqrt();
        // Gram and Schmidt, twice: what rounding left of the first time goes with the second.
        for other in basis.iter().chain(&basis) {
            let part = dot(&vector, other);
            vector.iter_mut().zip(other).for_each(|(entry, other)| *entry -= part * other);
        }
        let length = dot(&vector, &vector).sqrt();
        if length > DEPENDENT * before {
            vector.iter_mut().for_each(|entry| *entry /= length);
            basis.push(vector);
        }
    }
    basis
}

/// The directions within a basis that make S diagonal there (Rayleigh and Ritz), the largest first.
fn rotated(square: &Matrix, basis: &[Vec<f64>]) -> Vec<Principal> {
    let images: Vec<Vec<f64>> = basis.iter().map(|vector| square.times(vector)).collect();
    let inner: Vec<Vec<f64>> =
        basis.iter().map(|one| images.iter().map(|image| dot(one, image)).collect()).collect();
    let (values, vectors) = diagonalised(inner);
    let direction = |shares: &Vec<f64>| {
        let mut direction = vec![0.0; square.columns()];
        for (share, vector) in shares.iter().zip(basis) {
            direction.iter_mut().zip(vector).for_each(|(sum, entry)| *sum += share * entry);
        }
        direction
    };
    let mut found: Vec<Principal> = values
        .into_iter()
        .zip(&vectors)
        .map(|(square, shares)| Principal { direction: direction(shares), square: square.max(0.0) })
        .collect();
    found.sort_by(|one, other| other.square.total_cmp(&one.square));
    found
}

/// Eigenvalues and unit eigenvectors of a small symmetric matrix, in no order: Jacobi's cyclic rotations (G. H. Golub, C. F. Van
/// Loan, Matrix Computations, section 8.5).
fn diagonalised(mut matrix: Vec<Vec<f64>>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let size = matrix.len();
    let mut vectors: Vec<Vec<f64>> =
        (0..size).map(|row| (0..size).map(|column| f64::from(u8::from(row == column))).collect()).collect();
    for _ in 0..SWEEPS {
        for q in 1..size {
            for p in 0..q {
                rotate(&mut matrix, &mut vectors, p, q);
            }
        }
    }
    ((0..size).map(|at| matrix[at][at]).collect(), vectors)
}

/// The rotation of rows and columns p and q that makes the entry between them zero.
fn rotate(matrix: &mut [Vec<f64>], vectors: &mut [Vec<f64>], p: usize, q: usize) {
    let between = matrix[p][q];
    if between == 0.0 {
        return;
    }
    // t = sign(τ)/(|τ| + √(1 + τ²)) with τ = (a_qq − a_pp)/2a_pq is the smaller root of t² + 2τt = 1.
    let tau = (matrix[q][q] - matrix[p][p]) / (2.0 * between);
    let tangent = tau.signum() / (tau.abs() + tau.hypot(1.0));
    let cosine = tangent.hypot(1.0).recip();
    let turned = |one: f64, other: f64| (cosine * (one - tangent * other), cosine * (tangent * one + other));
    for row in matrix.iter_mut() {
        (row[p], row[q]) = turned(row[p], row[q]);
    }
    for lines in [matrix, vectors] {
        let (above, below) = lines.split_at_mut(q);
        above[p].iter_mut().zip(&mut below[0]).for_each(|(one, other)| (*one, *other) = turned(*one, *other));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows with known principal directions: a rotation of vectors along axes.
    fn rows(sizes: &[f64]) -> (Matrix, Vec<Vec<f64>>) {
        let mut random = SplitMix64::new(3);
        let axes: Vec<Vec<f64>> =
            sizes.iter().map(|_| (0..60).map(|_| f64::from(random.normal())).collect()).collect();
        let axes = orthonormal(axes);
        let scaled: Vec<Vec<f64>> = axes
            .iter()
            .zip(sizes)
            .map(|(axis, size)| axis.iter().map(|entry| size * entry).collect())
            .collect();
        (Matrix::from_rows(&scaled), axes)
    }

    #[test]
    fn the_largest_are_found_in_their_order() {
        let sizes: Vec<f64> = (0..30).map(|k| 0.7_f64.powi(k)).collect();
        let (matrix, axes) = rows(&sizes);
        let found = principal_directions(&matrix, 6);
        assert_eq!(found.len(), 6);
        for ((found, axis), size) in found.iter().zip(&axes).zip(&sizes) {
            assert!((found.square / (size * size) - 1.0).abs() < 1e-9, "{} {size}", found.square);
            assert!((dot(&found.direction, axis).abs() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn beside_directions_nothing_of_them_is_left() {
        let (matrix, _) = rows(&[2.0, 1.0, 0.5]);
        let found = principal_directions(&matrix, 2);
        let row: Vec<f64> = (0..matrix.columns()).map(|at| 1.0 + at as f64).collect();
        let left = beside(row.clone(), &found);
        assert!(found.iter().all(|it| dot(&left, &it.direction).abs() < 1e-12));
        let along: f64 = found.iter().map(|it| dot(&row, &it.direction).powi(2)).sum();
        assert!((dot(&left, &left) + along - dot(&row, &row)).abs() < 1e-9);
    }

    #[test]
    fn there_are_no_more_than_the_rows_span() {
        let (matrix, _) = rows(&[2.0, 1.0, 0.5]);
        let found = principal_directions(&matrix, 6);
        assert_eq!(found.len(), 3);
        let whole: f64 = found.iter().map(|it| it.square).sum();
        assert!((whole - 5.25).abs() < 1e-12, "{whole}");
        assert!(principal_directions(&Matrix::zeros(0, 0), 6).is_empty());
        assert!(principal_directions(&Matrix::zeros(4, 7), 6).is_empty());
    }
}
