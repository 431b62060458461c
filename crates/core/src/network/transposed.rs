//! Transposition of matrices.

/// The matrix of `columns` columns, turned.
pub(super) fn transposed(from: &[f32], columns: usize) -> Vec<f32> {
    let rows = from.len() / columns;
    let mut into = vec![0.0; from.len()];
    for (row, from) in from.chunks_exact(columns).enumerate() {
        for (column, value) in from.iter().enumerate() {
            into[column * rows + row] = *value;
        }
    }
    into
}
