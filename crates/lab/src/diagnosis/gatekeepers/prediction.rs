//! Prediction of a channel by others: least squares.

use tactpad_numeric::dense::{Matrix, gram};
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::{mean, squares};

/// Of a regressor that is nearly a sum of others, this part of its square is added, so that the system has a solution.
const RIDGE: f64 = 1e-9;

/// A reading as a constant and parts of regressors.
pub(super) struct Fitted {
    constant: f64,
    factors: Vec<f64>,
}

impl Fitted {
    /// The least-squares fit of `values` by columns of the same length; `None` if there are too few values.
    pub(super) fn of(values: &[f64], regressors: &[Vec<f64>]) -> Option<Self> {
        if values.len() <= regressors.len() + 2 {
            return None;
        }
        let middles: Vec<f64> = regressors.iter().map(mean).collect();
        let centred: Vec<Vec<f64>> = regressors
            .iter()
            .zip(&middles)
            .map(|(column, middle)| column.iter().map(|x| x - middle).collect())
            .collect();
        let middle = mean(values);
        let deviations: Vec<f64> = values.iter().map(|y| y - middle).collect();
        let factors = solved(&centred, &deviations)?;
        let constant = middle - factors.iter().zip(&middles).map(|(b, x)| b * x).sum::<f64>();
        (constant.is_finite() && factors.iter().all(|b| b.is_finite())).then_some(Self { constant, factors })
    }

    /// The factor of one of the regressors.
    pub(super) fn factor(&self, regressor: usize) -> f64 {
        self.factors[regressor]
    }

    /// What it says of regressors' values in other rows.
    pub(super) fn predicted(&self, regressors: &[Vec<f64>], row: usize) -> f64 {
        self.constant + self.factors.iter().zip(regressors).map(|(b, column)| b * column[row]).sum::<f64>()
    }
}

/// (XᵀX)⁻¹ Xᵀy.
fn solved(columns: &[Vec<f64>], values: &[f64]) -> Option<Vec<f64>> {
    let mut normal: Matrix = gram(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>());
    for at in 0..columns.len() {
        let own = normal.at(at, at);
        normal.row_mut(at)[at] += RIDGE * own + f64::MIN_POSITIVE.sqrt();
    }
    let right: Vec<f64> = columns.iter().map(|column| dot(column, values)).collect();
    if columns.is_empty() { Some(Vec::new()) } else { Some(normal.factorised()?.solve(&right)) }
}

/// R²: the part of the values' variance that the regressors explain; 0 where nothing can be said.
pub(super) fn explained(values: &[f64], regressors: &[Vec<f64>]) -> f64 {
    let Some(fitted) = Fitted::of(values, regressors) else { return 0.0 };
    let left: Vec<f64> =
        values.iter().enumerate().map(|(row, y)| y - fitted.predicted(regressors, row)).collect();
    let whole = squares(values);
    if whole > 0.0 { (1.0 - squares(&left) / whole).clamp(0.0, 1.0) } else { 0.0 }
}
