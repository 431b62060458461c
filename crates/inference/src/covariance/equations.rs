//! The normal equations of a channel, with and without a background: rows are read once, everything after works on these.
//!
//! With V = D + B T Bᵀ,
//!
//! ```text
//! Aᵀ V⁻¹ A = Aᵀ D⁻¹ A − (Bᵀ D⁻¹ A)ᵀ H⁻¹ (Bᵀ D⁻¹ A),   H = T⁻¹ + Bᵀ D⁻¹ B,   ln det V = ln det D + ln det T + ln det H
//! ```
//!
//! (M. A. Woodbury, Princeton Statistical Research Group 42 (1950)).

use super::basis::Prior;
use crate::error::{InferenceError, Stage, factorised};
use tactpad_numeric::dense::Matrix;
use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::products::dot;

/// Products of a channel's columns.
#[derive(Default)]
pub struct NormalEquations {
    /// The columns that this channel knows, by their number among all.
    pub columns: Vec<usize>,
    /// Bᵀ D⁻¹ B.
    pub background_gram: Matrix,
    /// (Bᵀ D⁻¹ A)ᵀ, a row for each signature.
    pub mixed: Matrix,
    /// Aᵀ D⁻¹ A.
    pub signature_gram: Matrix,
    /// Bᵀ D⁻¹ r.
    pub background_residual: Vec<f64>,
    /// Aᵀ D⁻¹ r.
    pub signature_residual: Vec<f64>,
    /// rᵀ D⁻¹ r.
    pub square: f64,
    /// ln det D.
    pub log_determinant: f64,
}

/// The channel with its background marginalised.
pub struct Reduced {
    /// Of H.
    pub factor: LargeFactor,
    /// L⁻¹ Bᵀ D⁻¹ A, a row for each signature, with H = L Lᵀ.
    pub whitened_mixed: Vec<Vec<f64>>,
    /// Aᵀ V⁻¹ A.
    pub fisher: Matrix,
    /// Aᵀ V⁻¹ r.
    pub score: Vec<f64>,
    /// rᵀ V⁻¹ r.
    pub square: f64,
    /// ln det V.
    pub log_determinant: f64,
}

impl Reduced {
    /// For each load, the degrees of freedom that the rows tell of the background: K − tr(T⁻¹ Var z).
    pub fn freedom(&self, prior: &Prior, shares: &[f64]) -> Vec<f64> {
        let width = prior.precision.columns();
        let blocks = self.factor.inverse_blocks(width);
        let untold = |(block, share): (&Vec<Vec<f64>>, &f64)| {
            let trace: f64 =
                block.iter().enumerate().map(|(at, row)| dot(row, prior.precision.row(at))).sum();
            (width as f64 - trace / (share * share)).max(0.0)
        };
        blocks.iter().zip(shares).map(untold).collect()
    }
}

impl NormalEquations {
    /// Those of some of all columns.
    pub fn picked(&self, columns: &[usize]) -> Self {
        let kept: Vec<usize> =
            (0..self.columns.len()).filter(|at| columns.contains(&self.columns[*at])).collect();
        let mixed: Vec<Vec<f64>> = kept.iter().map(|at| self.mixed.row(*at).to_vec()).collect();
        Self {
            columns: kept.iter().map(|at| self.columns[*at]).collect(),
            background_gram: self.background_gram.clone(),
            mixed: Matrix::from_rows(&mixed),
            signature_gram: self.signature_gram.picked(&kept, &kept),
            background_residual: self.background_residual.clone(),
            signature_residual: kept.iter().map(|at| self.signature_residual[*at]).collect(),
            square: self.square,
            log_determinant: self.log_determinant,
        }
    }

    /// Those of these rows and of `times` as many of other ones, for the same columns.
    pub fn plus(&self, times: f64, other: &Self) -> Self {
        let sums = |own: &[f64], others: &[f64]| -> Vec<f64> {
            own.iter().zip(others).map(|(own, other)| own + times * other).collect()
        };
        Self {
            columns: self.columns.clone(),
            background_gram: self.background_gram.plus(times, &other.background_gram),
            mixed: self.mixed.plus(times, &other.mixed),
            signature_gram: self.signature_gram.plus(times, &other.signature_gram),
            background_residual: sums(&self.background_residual, &other.background_residual),
            signature_residual: sums(&self.signature_residual, &other.signature_residual),
            square: self.square + times * other.square,
            log_determinant: self.log_determinant + times * other.log_determinant,
        }
    }

    /// With a background of T = diag(τ²) ⊗ the process' own, τ being its share for each load.
    ///
    /// # Errors
    /// H is not positive definite.
    pub fn reduced(&self, prior: &Prior, shares: &[f64]) -> Result<Reduced, InferenceError> {
        let mut inner = self.background_gram.clone();
        let width = prior.precision.columns();
        for (load, share) in shares.iter().enumerate() {
            for at in 0..width {
                let entries = &mut inner.row_mut(load * width + at)[load * width..][..width];
                entries
                    .iter_mut()
                    .zip(prior.precision.row(at))
                    .for_each(|(entry, own)| *entry += own / (share * share));
            }
        }
        let factor = factorised(&inner, Stage::Background)?;
        let log_determinant = self.log_determinant
            + factor.log_determinant()
            + shares
                .iter()
                .map(|share| prior.log_determinant() + 2.0 * width as f64 * share.ln())
                .sum::<f64>();
        Ok(self.reduced_by(factor, log_determinant))
    }

    /// The same with H known, and ln det V.
    pub fn reduced_by(&self, factor: LargeFactor, log_determinant: f64) -> Reduced {
        let whitened_mixed: Vec<Vec<f64>> =
            (0..self.columns.len()).map(|at| factor.solve_lower(self.mixed.row(at))).collect();
        let whitened_residual = factor.solve_lower(&self.background_residual);
        let mut fisher = self.signature_gram.clone();
        for (row, left) in whitened_mixed.iter().enumerate() {
            for (column, right) in whitened_mixed.iter().enumerate().take(row + 1) {
                let value = fisher.at(row, column) - dot(left, right);
                fisher.row_mut(row)[column] = value;
                fisher.row_mut(column)[row] = value;
            }
        }
        let score = self.signature_residual.iter().zip(&whitened_mixed);
        Reduced {
            fisher,
            score: score.map(|(own, mixed)| own - dot(mixed, &whitened_residual)).collect(),
            square: self.square - dot(&whitened_residual, &whitened_residual),
            log_determinant,
            whitened_mixed,
            factor,
        }
    }

    /// Bᵀ D⁻¹ (r − A ψ), where ψ are the coordinates of the channel's own columns.
    pub fn background_score(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut score = self.background_residual.clone();
        for (at, psi) in coordinates.iter().enumerate().filter(|(_, psi)| **psi != 0.0) {
            score.iter_mut().zip(self.mixed.row(at)).for_each(|(score, mixed)| *score -= psi * mixed);
        }
        score
    }
}
