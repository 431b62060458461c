//! The linear system of each channel, reduced to products: rows are read once, everything after works on these.
//!
//! A channel's residual is r = A ψ + B z + n with the signatures A of all hypotheses, the background's functions B with
//! z ~ N(0, T), and noise n ~ N(0, D). With V = D + B T Bᵀ,
//!
//! ```text
//! Aᵀ V⁻¹ A = Aᵀ D⁻¹ A − (Bᵀ D⁻¹ A)ᵀ H⁻¹ (Bᵀ D⁻¹ A),   H = T⁻¹ + Bᵀ D⁻¹ B,   ln det V = ln det D + ln det T + ln det H
//! ```
//!
//! (M. A. Woodbury, Princeton Statistical Research Group 42 (1950)). Errors E e of the model with e ~ N(0, 1), if it states any, are
//! taken into D once, the same way: u D⁻¹ v stands for uᵀ D⁻¹ v − u_Eᵀ v_E with u_E = L⁻¹ Eᵀ D⁻¹ u and L Lᵀ = 1 + Eᵀ D⁻¹ E.

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
    /// What the model states of its own errors.
    pub(super) stated: Stated,
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

/// The model's stated errors E, and the other columns' products with them.
pub(super) struct Stated {
    /// D⁻½ E, column by column.
    pub(super) columns: Vec<Vec<f64>>,
    /// L; none without errors.
    factor: Option<LargeFactor>,
    /// A_E, B_E and r_E.
    signatures: Vec<Vec<f64>>,
    background: Vec<Vec<f64>>,
    residual: Vec<f64>,
}

impl Stated {
    fn of(
        columns: Vec<Vec<f64>>,
        signatures: &[Vec<f64>],
        background: &[Vec<f64>],
        residual: &[f64],
    ) -> Option<Self> {
        let mut inner = products(&columns);
        (0..columns.len()).for_each(|at| inner.row_mut(at)[at] += 1.0);
        let factor = if columns.is_empty() { None } else { Some(inner.factorised()?) };
        let against = |of: &[f64]| -> Vec<f64> {
            let right: Vec<f64> = columns.iter().map(|column| dot(column, of)).collect();
            factor.as_ref().map_or_else(Vec::new, |factor| factor.solve_lower(&right))
        };
        Some(Self {
            signatures: signatures.iter().map(|column| against(column)).collect(),
            background: background.iter().map(|column| against(column)).collect(),
            residual: against(residual),
            factor,
            columns,
        })
    }

    /// ê = (1 + Eᵀ D⁻¹ E)⁻¹ Eᵀ D⁻¹ (v − B z), where `own` is v_E.
    fn estimate(&self, mut own: Vec<f64>, background: &[f64]) -> Vec<f64> {
        let Some(factor) = &self.factor else { return Vec::new() };
        for (z, column) in background.iter().zip(&self.background) {
            own.iter_mut().zip(column).for_each(|(own, value)| *own -= z * value);
        }
        factor.solve_upper(&own)
    }

    /// The degrees of freedom that the rows tell of the errors: K − tr (1 + Eᵀ D⁻¹ E)⁻¹.
    pub(super) fn freedom(&self) -> f64 {
        let untold: f64 = self.factor.iter().flat_map(LargeFactor::inverse_diagonal).sum();
        self.columns.len() as f64 - untold
    }
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
    /// `signatures` are columns with their numbers, `errors` are those that the model states; `None` if they are not finite.
    pub(super) fn of(
        signatures: &[(usize, &[f64])],
        background: &[Vec<f64>],
        errors: &[Vec<f64>],
        residual: &[f64],
        whitening: Whitening,
    ) -> Option<Self> {
        let columns: Vec<usize> = signatures.iter().map(|(number, _)| *number).collect();
        let whitened = |of: &[Vec<f64>]| of.iter().map(|column| whitening.whitened(column)).collect();
        let signatures: Vec<Vec<f64>> =
            signatures.iter().map(|(_, column)| whitening.whitened(column)).collect();
        let background: Vec<Vec<f64>> = whitened(background);
        let residual = whitening.whitened(residual);
        let stated = Stated::of(whitened(errors), &signatures, &background, &residual)?;
        let against = |of: &[Vec<f64>], own: &[Vec<f64>]| {
            let of = of.iter().zip(own);
            of.map(|(column, own)| dot(column, &residual) - dot(own, &stated.residual)).collect()
        };
        let mixed = |(column, own): (&Vec<f64>, &Vec<f64>)| {
            let others = background.iter().zip(&stated.background);
            others.map(|(other, theirs)| dot(column, other) - dot(own, theirs)).collect()
        };
        let rows: Vec<Vec<f64>> = signatures.iter().zip(&stated.signatures).map(mixed).collect();
        Some(Self {
            background_gram: less(products(&background), &products(&stated.background)),
            mixed: Matrix::from_rows(&rows),
            signature_gram: less(products(&signatures), &products(&stated.signatures)),
            background_residual: against(&background, &stated.background),
            signature_residual: against(&signatures, &stated.signatures),
            square: dot(&residual, &residual) - dot(&stated.residual, &stated.residual),
            log_determinant: whitening.log_determinant()
                + stated.factor.as_ref().map_or(0.0, LargeFactor::log_determinant),
            columns,
            whitening,
            signatures,
            background,
            residual,
            stated,
        })
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

    /// D⁻½ (r − A ψ − B z − E ê).
    pub(super) fn left_over(&self, coordinates: &[f64], background: &[f64]) -> Vec<f64> {
        let mut left = self.residual.clone();
        let mut own = self.stated.residual.clone();
        for (psi, column) in coordinates.iter().zip(&self.stated.signatures) {
            own.iter_mut().zip(column).for_each(|(own, value)| *own -= psi * value);
        }
        take(&mut left, coordinates, &self.signatures);
        take(&mut left, background, &self.background);
        take(&mut left, &self.stated.estimate(own, background), &self.stated.columns);
        left
    }

    /// D½ V⁻¹ A of a signature, where `smooth` is what the background takes of it.
    pub(super) fn weighted(&self, signature: usize, smooth: &[f64]) -> Vec<f64> {
        let mut left = self.signatures[signature].clone();
        take(&mut left, smooth, &self.background);
        let stated = self.stated.estimate(self.stated.signatures[signature].clone(), smooth);
        take(&mut left, &stated, &self.stated.columns);
        left
    }
}

/// Takes so much of each column off.
fn take(left: &mut [f64], factors: &[f64], columns: &[Vec<f64>]) {
    for (factor, column) in factors.iter().zip(columns).filter(|(factor, _)| **factor != 0.0) {
        left.iter_mut().zip(column).for_each(|(left, value)| *left -= factor * value);
    }
}

fn products(columns: &[Vec<f64>]) -> Matrix {
    gram(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

fn less(mut from: Matrix, other: &Matrix) -> Matrix {
    for row in 0..other.rows().min(from.rows()) {
        from.row_mut(row).iter_mut().zip(other.row(row)).for_each(|(value, other)| *value -= other);
    }
    from
}
