//! Means, deviations, straight lines.

/// The mean; not a number without values.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The standard deviation, with one value less in the divisor; not a number below two values.
pub(super) fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (values.len() as f64 - 1.0)).sqrt()
}

/// The middle one, the lower of two; `None` without values.
pub(super) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) / 2).copied()
}

/// A straight line y = `at_mean` + `slope` (x − `mean_x`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) slope: f64,
    mean_x: f64,
    at_mean: f64,
}

impl Line {
    /// Least squares through (x, y); level where all x are the same, not a number without points.
    pub(super) fn through(points: &[[f64; 2]]) -> Self {
        let count = points.len() as f64;
        let mean_x = points.iter().map(|[x, _]| x).sum::<f64>() / count;
        let at_mean = points.iter().map(|[_, y]| y).sum::<f64>() / count;
        let products: f64 = points.iter().map(|[x, y]| (x - mean_x) * (y - at_mean)).sum();
        let squares: f64 = points.iter().map(|[x, _]| (x - mean_x).powi(2)).sum();
        Self { slope: if squares > 0.0 { products / squares } else { 0.0 }, mean_x, at_mean }
    }

    pub(super) fn at(&self, x: f64) -> f64 {
        self.at_mean + self.slope * (x - self.mean_x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_small_samples() {
        assert_eq!((mean(&[1.0, 2.0, 6.0]), deviation(&[1.0, 2.0, 6.0])), (3.0, 7.0_f64.sqrt()));
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
