//! Products of matrices, for the trainer: row by row, single precision, every side a multiple of [`TILE`].
//!
//! Each entry of a product is one sum in a fixed order, and no product is fused with an addition. So the same numbers
//! come out on every machine, whatever width its vectors have. With the vectors that any x86-64 has, a core does some
//! 25 billion operations in a second: no library is needed.

/// Sides of matrices are multiples of it: what is kept in registers is never cut.
pub(super) const TILE: usize = 8;

/// Rows of a product that are summed at once.
const ROWS: usize = 4;

/// The next multiple of [`TILE`].
pub(super) const fn padded(side: usize) -> usize {
    side.next_multiple_of(TILE)
}

/// C = A B, Cᵢⱼ = Σₖ Aᵢₖ Bₖⱼ: `into` = `left` · `right`; `left` has `inner` columns and `right` has `columns`.
pub(super) fn product(into: &mut [f32], left: &[f32], right: &[f32], [inner, columns]: [usize; 2]) {
    let mut panel = vec![[0.0; ROWS]; inner];
    for (into, left) in into.chunks_exact_mut(ROWS * columns).zip(left.chunks_exact(ROWS * inner)) {
        for (row, left) in left.chunks_exact(inner).enumerate() {
            panel.iter_mut().zip(left).for_each(|(packed, value)| packed[row] = *value);
        }
        strip(into, &panel, right, columns);
    }
}

/// C = Aᵀ B, Cᵢⱼ = Σₖ Aₖᵢ Bₖⱼ: `into` = `left`ᵀ · `right`; `left` has `rows` columns and `right` has `columns`.
pub(super) fn transposed_product(into: &mut [f32], left: &[f32], right: &[f32], [rows, columns]: [usize; 2]) {
    let mut panel = vec![[0.0; ROWS]; left.len() / rows];
    for (index, into) in into.chunks_exact_mut(ROWS * columns).enumerate() {
        for (packed, left) in panel.iter_mut().zip(left.chunks_exact(rows)) {
            packed.copy_from_slice(&left[index * ROWS..][..ROWS]);
        }
        strip(into, &panel, right, columns);
    }
}

/// A few rows of a product. `panel` holds their factors: of all these rows for the first row of `right`, and so on.
fn strip(into: &mut [f32], panel: &[[f32; ROWS]], right: &[f32], columns: usize) {
    for start in (0..columns).step_by(TILE) {
        let mut sums = [[0.0; TILE]; ROWS];
        for (factors, right) in panel.iter().zip(right.chunks_exact(columns)) {
            let Some(right) = right[start..].first_chunk::<TILE>() else { continue };
            // C += a bᵀ, one term k of all sums in registers.
            for row in 0..ROWS {
                for column in 0..TILE {
                    sums[row][column] += factors[row] * right[column];
                }
            }
        }
        for (into, sums) in into.chunks_exact_mut(columns).zip(sums) {
            into[start..start + TILE].copy_from_slice(&sums);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::transposed::transposed;

    /// Whole numbers, so that sums are exact in any order.
    fn matrix(rows: usize, columns: usize, seed: usize) -> Vec<f32> {
        (0..rows * columns).map(|k| ((k * 37 + seed * 11) % 19) as f32 - 9.0).collect()
    }

    fn at(matrix: &[f32], columns: usize, row: usize, column: usize) -> f32 {
        matrix[row * columns + column]
    }

    #[test]
    fn products_are_sums_of_products() {
        let [rows, inner, columns] = [16, 24, 8];
        let (left, right) = (matrix(rows, inner, 1), matrix(inner, columns, 2));
        let entry = |row, column| -> f32 {
            (0..inner).map(|k| at(&left, inner, row, k) * at(&right, columns, k, column)).sum()
        };
        let wanted: Vec<f32> =
            (0..rows).flat_map(|row| (0..columns).map(move |column| entry(row, column))).collect();
        let mut found = vec![7.0; rows * columns];
        product(&mut found, &left, &right, [inner, columns]);
        assert_eq!(found, wanted);
        let turned = transposed(&left, inner);
        assert!(
            (0..rows).all(|row| (0..inner).all(|k| at(&turned, rows, k, row) == at(&left, inner, row, k)))
        );
        let mut found = vec![7.0; rows * columns];
        transposed_product(&mut found, &turned, &right, [rows, columns]);
        assert_eq!(found, wanted);
    }

    #[test]
    fn sides_are_padded_to_whole_tiles() {
        assert_eq!([1, TILE, TILE + 1].map(padded), [TILE, TILE, 2 * TILE]);
    }
}
