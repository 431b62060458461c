//! Least squares with priors, at one ratio of noise to signal.

use tactpad_numeric::dense::{Matrix, gram};
use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::products::dot;

/// Precision that makes numbers without a prior unique.
const FREE: f64 = 1e-6;

/// Least squares with priors: the products of whitened columns.
pub(crate) struct System {
    gram: Matrix,
    right: Vec<f64>,
    square: f64,
    free: usize,
    rows: f64,
}

/// Weights, and how likely all that is.
pub(crate) struct Solution {
    pub(crate) factor: LargeFactor,
    pub(crate) weights: Vec<f64>,
    pub(crate) variance: f64,
    pub(crate) evidence: f64,
}

impl System {
    /// Of the columns the first `free` ones have no prior.
    pub(crate) fn of(columns: &[Vec<f64>], readings: &[f64], free: usize, rows: usize) -> Self {
        Self {
            gram: gram(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>()),
            right: columns.iter().map(|column| dot(column, readings)).collect(),
            square: dot(readings, readings),
            free,
            rows: rows as f64,
        }
    }

    pub(crate) fn precision(&self, at: usize, ratio: f64) -> f64 {
        ratio * if at < self.free { FREE } else { 1.0 }
    }

    pub(crate) fn factorised(&self, ratio: f64) -> Option<LargeFactor> {
        let mut inner = self.gram.clone();
        (0..inner.columns()).for_each(|at| inner.row_mut(at)[at] += self.precision(at, ratio));
        inner.factorised()
    }

    /// With so much noise over signal, as variances. The evidence is that of the best noise: with n rows, K functions and
    /// S = yᵀy − yᵀX w, −½ (n ln S/n + ln det(XᵀX + P) − K ln ratio).
    pub(crate) fn at(&self, ratio: f64) -> Option<Solution> {
        let factor = self.factorised(ratio)?;
        let (weights, variance, evidence) = self.with(&factor, ratio, &self.right, self.square);
        Some(Solution { factor, weights, variance, evidence })
    }

    pub(crate) fn with(
        &self,
        factor: &LargeFactor,
        ratio: f64,
        right: &[f64],
        square: f64,
    ) -> (Vec<f64>, f64, f64) {
        let weights = factor.solve(right);
        let rows = (self.rows - self.free as f64).max(1.0);
        let variance =
            ((square - dot(&weights, right)) / rows).max(1e-14 * square / rows).max(f64::MIN_POSITIVE);
        let smooth = (self.gram.columns() - self.free) as f64;
        let evidence = -0.5 * (rows * variance.ln() + factor.log_determinant() - smooth * ratio.ln());
        (weights, variance, evidence)
    }
}
