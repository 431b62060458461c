//! Group score tests: what a hypothesis removes of the residual beyond all columns that are already fitted.

use std::cmp::Ordering;

use crate::covariance::{Fitted, Marginal};
use crate::error::InferenceError;
use tactpad_numeric::chi_square;
use tactpad_numeric::dense::Matrix;

/// A direction of which the fitted columns leave less than this part is theirs.
const LEFT_MIN: f64 = 1e-6;

/// Information and score with the fitted columns projected out.
pub struct Projected {
    /// Whatever the fitted columns leave of Aᵀ V⁻¹ A.
    pub fisher: Matrix,
    /// The same of Aᵀ V⁻¹ r.
    pub score: Vec<f64>,
    /// The diagonal before.
    whole: Vec<f64>,
    /// Iₐₐ⁻¹ Iₐ., a row for each fitted column.
    weights: Matrix,
    fitted: Vec<usize>,
}

/// A group's test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// Reduction of the weighted squares.
    pub square: f64,
    /// In how many directions.
    pub freedom: usize,
}

impl Test {
    /// Of what cannot be.
    pub const NOTHING: Self = Self { square: 0.0, freedom: 1 };

    /// The probability of as much by chance.
    pub fn p_value(self) -> f64 {
        chi_square::exceeded(self.square, self.freedom)
    }

    /// The order of p-values. Those that are too small for a number are told apart by what the test takes off beyond chance.
    pub fn by_chance(&self, other: &Self) -> Ordering {
        let beyond = |test: &Self| test.square - test.freedom as f64;
        self.p_value().total_cmp(&other.p_value()).then(beyond(other).total_cmp(&beyond(self)))
    }
}

impl Projected {
    /// With these columns projected out.
    ///
    /// # Errors
    /// They are not independent.
    pub fn of(marginal: &Marginal, fitted: &Fitted<'_>) -> Result<Self, InferenceError> {
        let all: Vec<usize> = (0..marginal.score.len()).collect();
        let factor = fitted.factorised(marginal)?;
        let across = marginal.fisher.picked(&fitted.columns, &all);
        // Iₐₐ⁻¹ Iₐ. column by column.
        let mut weights = Matrix::zeros(fitted.columns.len(), all.len());
        for column in &all {
            for (row, value) in factor.solve(&across.column(*column)).into_iter().enumerate() {
                weights.row_mut(row)[*column] = value;
            }
        }
        // I − I.ₐ Iₐₐ⁻¹ Iₐ.
        let mut fisher = marginal.fisher.clone();
        for (line, weight) in (0..fitted.columns.len()).map(|row| (across.row(row), weights.row(row))) {
            for (row, left) in line.iter().enumerate().filter(|(_, left)| **left != 0.0) {
                fisher.row_mut(row).iter_mut().zip(weight).for_each(|(entry, right)| *entry -= left * right);
            }
        }
        let whole = all.iter().map(|at| marginal.fisher.at(*at, *at)).collect();
        let mut projected =
            Self { fisher, score: Vec::new(), whole, weights, fitted: fitted.columns.clone() };
        projected.score = projected.projected(&marginal.score);
        Ok(projected)
    }

    /// A score with the fitted columns projected out.
    pub fn projected(&self, score: &[f64]) -> Vec<f64> {
        let of_fitted: Vec<f64> = self.fitted.iter().map(|column| score[*column]).collect();
        let shift = self.weights.transposed_times(&of_fitted);
        score.iter().zip(shift).map(|(score, shift)| score - shift).collect()
    }

    /// The test of these columns together, of the given score.
    pub fn test(&self, columns: &[usize], score: &[f64]) -> Test {
        // Modified Cholesky of the group's block: uᵀ I⁻¹ u = Σ (L⁻¹ u)², without directions that are another's.
        let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
        let mut test = Test { square: 0.0, freedom: 0 };
        for (at, column) in columns.iter().enumerate() {
            let mut line: Vec<f64> =
                columns[..at].iter().map(|other| self.fisher.at(*column, *other)).collect();
            let mut value = score[*column];
            let mut left = self.fisher.at(*column, *column);
            for (before, (row, solved)) in rows.iter().enumerate() {
                let done: f64 = row[..before].iter().zip(&line).map(|(a, b)| a * b).sum();
                line[before] = if row[before] > 0.0 { (line[before] - done) / row[before] } else { 0.0 };
                left -= line[before] * line[before];
                value -= line[before] * solved;
            }
            let is_own = left > LEFT_MIN * self.whole[*column] && left > 0.0;
            let root = if is_own { left.sqrt() } else { 0.0 };
            line.push(root);
            let solved = if is_own { value / root } else { 0.0 };
            test.square += solved * solved;
            test.freedom += usize::from(is_own);
            rows.push((line, solved));
        }
        test
    }

    /// The part of these columns' information that others have as well: the mean over the columns.
    pub fn reproduced(&self, columns: &[usize], others: &[usize]) -> f64 {
        let Some(factor) = self.fisher.picked(others, others).factorised() else { return 0.0 };
        let part = |column: &usize| {
            let across: Vec<f64> = others.iter().map(|other| self.fisher.at(*other, *column)).collect();
            let square: f64 = factor.solve_lower(&across).iter().map(|x| x * x).sum();
            let own = self.fisher.at(*column, *column);
            if own > 0.0 { (square / own).min(1.0) } else { 0.0 }
        };
        columns.iter().map(part).sum::<f64>() / columns.len().max(1) as f64
    }

    /// Whether nothing is left of a column.
    pub fn is_empty(&self, column: usize) -> bool {
        self.fisher.at(column, column) <= LEFT_MIN * self.whole[column] || self.whole[column] <= 0.0
    }
}
