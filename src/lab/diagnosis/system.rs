//! The linear system of each channel, reduced to products: rows are read once, everything after works on these.
//!
//! A channel's residual is r = A ψ + B z + n with the signatures A of all hypotheses, the background's functions B with
//! z ~ N(0, T), and noise n ~ N(0, D). With V = D + B T Bᵀ,
//!
//! ```text
//! Aᵀ V⁻¹ A = Aᵀ D⁻¹ A − (Bᵀ D⁻¹ A)ᵀ H⁻¹ (Bᵀ D⁻¹ A),   H = T⁻¹ + Bᵀ D⁻¹ B,   ln det V = ln det D + ln det T + ln det H
//! ```
//!
//! (M. A. Woodbury, Princeton Statistical Research Group 42 (1950)).

use super::basis::Prior;
use super::whitening::Whitening;
use crate::numeric::dense::{Matrix, gram};
use crate::numeric::linear::{LargeFactor, dot};

/// The products of one channel.
pub(super) struct ChannelSystem {
    /// The columns that this channel knows, by their number among all.
    pub(super) columns: Vec<usize>,
    /// Of each row.
    pub(super) whitening: Whitening,
    /// D⁻½ A, column by column.
    pub(super) signatures: Vec<Vec<f64>>,
    /// D⁻½ B, column by column.
    pub(super) background: Vec<Vec<f64>>,
    /// D⁻½ r.
    pub(super) residual: Vec<f64>,
    /// Bᵀ D⁻¹ B.
    background_gram: Matrix,
    /// (Bᵀ D⁻¹ A)ᵀ, a row for each signature.
    mixed: Matrix,
    /// Aᵀ D⁻¹ A.
    signature_gram: Matrix,
    /// Bᵀ D⁻¹ r.
    background_residual: Vec<f64>,
    /// Aᵀ D⁻¹ r.
    signature_residual: Vec<f64>,
    square: f64,
    log_determinant: f64,
}

/// The channel with its background marginalised.
pub(super) struct Reduced {
    /// Of H.
    pub(super) factor: LargeFactor,
    /// L⁻¹ Bᵀ D⁻¹ A, a row for each signature, with H = L Lᵀ.
    pub(super) whitened_mixed: Vec<Vec<f64>>,
    /// Aᵀ V⁻¹ A.
    pub(super) fisher: Matrix,
    /// Aᵀ V⁻¹ r.
    pub(super) score: Vec<f64>,
    /// rᵀ V⁻¹ r.
    pub(super) square: f64,
    /// ln det V.
    pub(super) log_determinant: f64,
}

impl Reduced {
    /// For each load, the degrees of freedom that the rows tell of the background: K − tr(T⁻¹ Var z).
    pub(super) fn freedom(&self, prior: &Prior, shares: &[f64]) -> Vec<f64> {
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

impl ChannelSystem {
    /// `signatures` are columns with their numbers.
    pub(super) fn of(
        signatures: &[(usize, &[f64])],
        background: &[Vec<f64>],
        residual: &[f64],
        whitening: Whitening,
    ) -> Self {
        let columns: Vec<usize> = signatures.iter().map(|(number, _)| *number).collect();
        let signatures: Vec<Vec<f64>> =
            signatures.iter().map(|(_, column)| whitening.whitened(column)).collect();
        let background: Vec<Vec<f64>> = background.iter().map(|column| whitening.whitened(column)).collect();
        let residual = whitening.whitened(residual);
        let slices = |of: &[Vec<f64>]| gram(&of.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let against = |of: &[Vec<f64>]| of.iter().map(|column| dot(column, &residual)).collect();
        let mixed = |column: &Vec<f64>| background.iter().map(|other| dot(column, other)).collect();
        Self {
            background_gram: slices(&background),
            mixed: Matrix::from_rows(&signatures.iter().map(mixed).collect::<Vec<_>>()),
            signature_gram: slices(&signatures),
            background_residual: against(&background),
            signature_residual: against(&signatures),
            square: dot(&residual, &residual),
            log_determinant: whitening.log_determinant(),
            columns,
            whitening,
            signatures,
            background,
            residual,
        }
    }

    /// With a background of T = diag(τ²) ⊗ the process' own, τ being its share for each load; `None` if H is not positive definite.
    pub(super) fn reduced(&self, prior: &Prior, shares: &[f64]) -> Option<Reduced> {
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
        let factor = inner.factorised()?;
        let whitened_mixed: Vec<Vec<f64>> =
            (0..self.signatures.len()).map(|at| factor.solve_lower(self.mixed.row(at))).collect();
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
        Some(Reduced {
            fisher,
            score: score.map(|(own, mixed)| own - dot(mixed, &whitened_residual)).collect(),
            square: self.square - dot(&whitened_residual, &whitened_residual),
            log_determinant: self.log_determinant
                + factor.log_determinant()
                + shares
                    .iter()
                    .map(|share| prior.log_determinant() + 2.0 * width as f64 * share.ln())
                    .sum::<f64>(),
            whitened_mixed,
            factor,
        })
    }

    /// Bᵀ D⁻¹ (r − A ψ), where ψ are the coordinates of the channel's own columns.
    pub(super) fn background_score(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut score = self.background_residual.clone();
        for (at, psi) in coordinates.iter().enumerate().filter(|(_, psi)| **psi != 0.0) {
            score.iter_mut().zip(self.mixed.row(at)).for_each(|(score, mixed)| *score -= psi * mixed);
        }
        score
    }

    /// D⁻½ (r − A ψ − B z).
    pub(super) fn left_over(&self, coordinates: &[f64], background: &[f64]) -> Vec<f64> {
        let mut left = self.residual.clone();
        let mut take = |factors: &[f64], columns: &[Vec<f64>]| {
            for (factor, column) in factors.iter().zip(columns).filter(|(factor, _)| **factor != 0.0) {
                left.iter_mut().zip(column).for_each(|(left, value)| *left -= factor * value);
            }
        };
        take(coordinates, &self.signatures);
        take(background, &self.background);
        left
    }
}
