//! Products and sums of vectors.

use super::simd::widest;

/// Vectors of so many numbers gain by wider vectors of the processor.
const LONG: usize = 64;
/// So many products of one vector with others are summed at once: it is loaded once for all of them.
pub(super) const AT_ONCE: usize = 4;

/// Σ aᵢ bᵢ, in eight sums side by side, so that the loop becomes vectors that do not wait for one another; the order is fixed.
pub fn dot(left: &[f64], right: &[f64]) -> f64 {
    if left.len() < LONG {
        return products(left, [right])[0];
    }
    widest(
        #[inline(always)]
        || products(left, [right])[0],
    )
}

/// [`dot`] of one vector with each of several ones.
#[inline(always)]
pub(super) fn products<const N: usize>(left: &[f64], right: [&[f64]; N]) -> [f64; N] {
    let (left, rest) = left.as_chunks::<8>();
    let right = right.map(|right| right.as_chunks::<8>());
    let whole = right.iter().map(|(chunks, _)| chunks.len()).fold(left.len(), usize::min);
    let mut sums = [[0.0; 8]; N];
    // By indices: iterators would be calls of their own, outside the widest vectors.
    for at in 0..whole {
        for n in 0..N {
            let (left, right) = (&left[at], &right[n].0[at]);
            for k in 0..8 {
                sums[n][k] += left[k] * right[k];
            }
        }
    }
    let mut of_all = [0.0; N];
    for n in 0..N {
        let mut sum: f64 = rest.iter().zip(right[n].1).map(|(left, right)| left * right).sum();
        for part in sums[n] {
            sum += part;
        }
        of_all[n] = sum;
    }
    of_all
}

/// The product of a matrix with the matrix of these rows, which are equally long.
pub fn combined<const N: usize>(matrix: &[[f64; N]; N], rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let combination = |factors: &[f64; N]| {
        let mut sum = vec![0.0; rows.first().map_or(0, Vec::len)];
        let terms: Vec<(f64, &[f64])> =
            factors.iter().zip(rows).map(|(factor, row)| (*factor, row.as_slice())).collect();
        widest(
            #[inline(always)]
            || add_combination(&mut sum, &terms),
        );
        sum
    };
    matrix.iter().map(combination).collect()
}

/// Adds Σ factor · v to a line, which is as long as each v.
#[inline(always)]
pub(super) fn add_combination(line: &mut [f64], terms: &[(f64, &[f64])]) {
    // Four at a time, so that an entry is loaded and stored once for all of them.
    let (fours, rest) = terms.as_chunks::<4>();
    for [(a, one), (b, two), (c, three), (d, four)] in fours {
        for (entry, (((one, two), three), four)) in
            line.iter_mut().zip(one.iter().zip(*two).zip(*three).zip(*four))
        {
            *entry = *entry + a * one + b * two + c * three + d * four;
        }
    }
    for (factor, vector) in rest {
        line.iter_mut().zip(*vector).for_each(|(entry, value)| *entry += factor * value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_and_combinations_are_those_of_the_definition() {
        // Longer and shorter than what is summed side by side, and no multiple of it.
        for length in [3, 70, 133] {
            let vector = |factor: f64| (0..length).map(|at| factor + f64::from(at)).collect::<Vec<f64>>();
            let (one, other) = (vector(0.5), vector(-2.0));
            let wanted: f64 = (0..length).map(|at| (0.5 + f64::from(at)) * (f64::from(at) - 2.0)).sum();
            assert!((dot(&one, &other) - wanted).abs() < 1e-6);
            assert_eq!(products(&one, [&other, &one]), [dot(&one, &other), dot(&one, &one)]);
            let rows: Vec<Vec<f64>> = (0..5).map(|row| vector(f64::from(row))).collect();
            let mut matrix = [[0.0; 5]; 5];
            matrix[3] = [1.0, 0.0, 2.0, -1.0, 0.5];
            let combined = combined(&matrix, &rows);
            let sum =
                |at: usize| matrix[3].iter().zip(&rows).map(|(factor, row)| factor * row[at]).sum::<f64>();
            assert_eq!(combined[0], vec![0.0; rows[0].len()]);
            assert!((0..rows[0].len()).all(|at| (combined[3][at] - sum(at)).abs() < 1e-9));
        }
    }
}
