//! Means, deviations, medians, straight lines. Sums go in the order of the values, so that equal values give equal bits.

use std::borrow::Borrow;

/// The mean, Σx/n; not a number without values.
pub fn mean<T: Borrow<f64>>(values: impl IntoIterator<Item = T>) -> f64 {
    let mut count = 0_usize;
    let counted = values.into_iter().inspect(|_| count += 1);
    let sum: f64 = counted.map(|value| *value.borrow()).sum();
    sum / count as f64
}

/// The mean of each component; not numbers without vectors.
pub fn mean_vector<'v, const N: usize>(
    vectors: impl IntoIterator<Item = &'v [f64; N], IntoIter: Clone>,
) -> [f64; N] {
    let vectors = vectors.into_iter();
    std::array::from_fn(|k| mean(vectors.clone().map(|vector| vector[k])))
}

/// The root of the mean square, √(Σx²/n); not a number without values.
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    mean(values.into_iter().map(|value| value.powi(2))).sqrt()
}

/// The standard deviation of a sample, √(Σ(x − mean)²/(n − 1)); not a number below two values.
pub fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (values.len() as f64 - 1.0)).sqrt()
}

/// The standard deviation of a whole population, √(Σ(x − mean)²/n); not a number without values.
pub fn population_deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    rms(values.iter().map(|value| value - mean))
}

/// Σ (x − mean)²; 0 without values.
pub fn squares(values: &[f64]) -> f64 {
    let middle = mean(values);
    values.iter().map(|value| (value - middle).powi(2)).sum()
}

/// The correlation of two columns; 0 where one stays the same.
pub fn correlation(one: &[f64], other: &[f64]) -> f64 {
    let [mean_one, mean_other] = [mean(one), mean(other)];
    let product: f64 = one.iter().zip(other).map(|(a, b)| (a - mean_one) * (b - mean_other)).sum();
    let whole = (squares(one) * squares(other)).sqrt();
    if whole > 0.0 && product.is_finite() { (product / whole).clamp(-1.0, 1.0) } else { 0.0 }
}

/// The middle value, the lower of two; `None` without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) / 2).copied()
}

/// A straight line y = `at_mean` + `slope` (x − `mean_x`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// How much y grows with x.
    pub slope: f64,
    mean_x: f64,
    at_mean: f64,
}

impl Line {
    /// Least squares through (x, y); level where all x are the same, not a number without points.
    pub fn through(points: &[[f64; 2]]) -> Self {
        let [mean_x, at_mean] = mean_vector(points);
        let products: f64 = points.iter().map(|[x, y]| (x - mean_x) * (y - at_mean)).sum();
        let squares: f64 = points.iter().map(|[x, _]| (x - mean_x).powi(2)).sum();
        Self { slope: if squares > 0.0 { products / squares } else { 0.0 }, mean_x, at_mean }
    }

    /// The line's y at this x.
    pub fn at(&self, x: f64) -> f64 {
        self.at_mean + self.slope * (x - self.mean_x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_small_samples() {
        assert_eq!((mean([1.0, 2.0, 6.0]), deviation(&[1.0, 2.0, 6.0])), (3.0, 7.0_f64.sqrt()));
        assert_eq!((rms([3.0, -3.0]), population_deviation(&[1.0, 5.0])), (3.0, 2.0));
        assert_eq!(mean_vector(&[[1.0, 4.0], [3.0, 8.0]]), [2.0, 6.0]);
        assert!(mean::<f64>([]).is_nan() && rms([]).is_nan() && deviation(&[1.0]).is_nan());
        assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(2.0));
        assert_eq!(median([]), None);
    }

    #[test]
    fn a_line_is_found_again() {
        let line = Line::through(&[[1.0, 5.0], [2.0, 7.0], [4.0, 11.0]]);
        assert!((line.slope - 2.0).abs() < 1e-12 && (line.at(0.0) - 3.0).abs() < 1e-12);
        assert_eq!(Line::through(&[[1.0, 5.0], [1.0, 7.0]]).at(9.0), 6.0);
    }
}
