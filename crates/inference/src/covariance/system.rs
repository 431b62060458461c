//! The linear system of each channel: its rows in standard deviations of their noise, and their products.
//!
//! A channel's residual is r = A ψ + B z + n with the signatures A of all hypotheses, the background's functions B with
//! z ~ N(0, T), and noise n ~ N(0, D). Errors E e of the model with e ~ N(0, 1), if it states any, are taken into D: u D⁻¹ v stands
//! for uᵀ D⁻¹ v − u_Eᵀ v_E with u_E = L⁻¹ Eᵀ D⁻¹ u and L Lᵀ = 1 + Eᵀ D⁻¹ E (M. A. Woodbury, Princeton Statistical Research Group 42
//! (1950)).

use super::equations::NormalEquations;
use super::whitening::Whitening;
use crate::error::{InferenceError, Stage, factorised};
use tactpad_numeric::dense::{Matrix, gram};
use tactpad_numeric::linear::LargeFactor;
use tactpad_numeric::products::dot;

/// One channel.
pub struct ChannelSystem {
    /// Normal equations of its rows.
    pub equations: NormalEquations,
    /// Of each row.
    pub whitening: Whitening,
    /// D⁻½ A, column by column.
    pub signatures: Vec<Vec<f64>>,
    /// D⁻½ B, column by column.
    pub background: Vec<Vec<f64>>,
    /// D⁻½ r.
    pub residual: Vec<f64>,
    /// Stated errors of the model.
    pub stated: StatedErrors,
}

/// The model's stated errors E, and the other columns' products with them.
pub struct StatedErrors {
    /// D⁻½ E, column by column.
    pub columns: Vec<Vec<f64>>,
    /// L; none without errors.
    factor: Option<LargeFactor>,
    /// A_E, B_E and r_E.
    signatures: Vec<Vec<f64>>,
    background: Vec<Vec<f64>>,
    residual: Vec<f64>,
}

impl StatedErrors {
    fn of(
        columns: Vec<Vec<f64>>,
        signatures: &[Vec<f64>],
        background: &[Vec<f64>],
        residual: &[f64],
    ) -> Result<Self, InferenceError> {
        let mut inner = products(&columns);
        (0..columns.len()).for_each(|at| inner.row_mut(at)[at] += 1.0);
        let factor = if columns.is_empty() { None } else { Some(factorised(&inner, Stage::StatedErrors)?) };
        let mut own =
            Self { columns, factor, signatures: Vec::new(), background: Vec::new(), residual: Vec::new() };
        own.signatures = own.products(signatures);
        own.background = own.products(background);
        own.residual = own.product(residual);
        Ok(own)
    }

    /// v_E.
    fn product(&self, of: &[f64]) -> Vec<f64> {
        let Some(factor) = &self.factor else { return Vec::new() };
        factor.solve_lower(&self.columns.iter().map(|column| dot(column, of)).collect::<Vec<f64>>())
    }

    fn products(&self, of: &[Vec<f64>]) -> Vec<Vec<f64>> {
        of.iter().map(|column| self.product(column)).collect()
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
    pub fn freedom(&self) -> f64 {
        let untold: f64 = self.factor.iter().flat_map(LargeFactor::inverse_diagonal).sum();
        self.columns.len() as f64 - untold
    }
}

impl ChannelSystem {
    /// `signatures` are columns with their numbers, `errors` are those that the model states.
    ///
    /// # Errors
    /// The errors are not finite.
    pub fn of(
        signatures: &[(usize, &[f64])],
        background: &[Vec<f64>],
        errors: &[Vec<f64>],
        residual: &[f64],
        whitening: Whitening,
    ) -> Result<Self, InferenceError> {
        let columns: Vec<usize> = signatures.iter().map(|(number, _)| *number).collect();
        let whitened = |of: &[Vec<f64>]| of.iter().map(|column| whitening.whitened(column)).collect();
        let signatures: Vec<Vec<f64>> =
            signatures.iter().map(|(_, column)| whitening.whitened(column)).collect();
        let background: Vec<Vec<f64>> = whitened(background);
        let residual = whitening.whitened(residual);
        let stated = StatedErrors::of(whitened(errors), &signatures, &background, &residual)?;
        let equations = NormalEquations {
            background_gram: less(products(&background), &products(&stated.background)),
            log_determinant: whitening.log_determinant()
                + stated.factor.as_ref().map_or(0.0, LargeFactor::log_determinant),
            columns,
            ..NormalEquations::default()
        };
        let mut system = Self { equations, whitening, signatures, background, residual, stated };
        let columns = system.equations.columns.clone();
        system.equations = system.with(columns, &system.signatures, &system.residual);
        Ok(system)
    }

    /// The normal equations of some of its columns, and of `further` ones with their numbers.
    pub fn beside(&self, columns: &[usize], further: &[(usize, &[f64])]) -> NormalEquations {
        let own = self.equations.columns.iter().copied().zip(self.signatures.iter().cloned());
        let own = own.filter(|(number, _)| columns.contains(number));
        let further = further.iter().map(|(number, values)| (*number, self.whitening.whitened(values)));
        let (numbers, signatures): (Vec<usize>, Vec<Vec<f64>>) = own.chain(further).unzip();
        self.with(numbers, &signatures, &self.residual)
    }

    /// Those of some of its rows, for some of its columns.
    ///
    /// # Errors
    /// The errors are not finite.
    pub fn at(&self, rows: &[usize], columns: &[usize]) -> Result<NormalEquations, InferenceError> {
        let picked = |column: &Vec<f64>| -> Vec<f64> { rows.iter().map(|row| column[*row]).collect() };
        let own = self.equations.columns.iter().zip(&self.signatures);
        let own = own.filter(|(number, _)| columns.contains(number));
        let own: Vec<(usize, Vec<f64>)> = own.map(|(number, column)| (*number, picked(column))).collect();
        let signatures: Vec<(usize, &[f64])> =
            own.iter().map(|(number, column)| (*number, column.as_slice())).collect();
        let [background, errors] =
            [&self.background, &self.stated.columns].map(|all| all.iter().map(picked).collect::<Vec<_>>());
        let white = Whitening::none(rows.len());
        Ok(Self::of(&signatures, &background, &errors, &picked(&self.residual), white)?.equations)
    }

    /// Those of the same rows about another point, where the channel has this residual and these columns.
    pub fn about(&self, columns: &[(usize, &[f64])], residual: &[f64]) -> NormalEquations {
        let whitened = columns.iter().map(|(number, values)| (*number, self.whitening.whitened(values)));
        let (numbers, signatures): (Vec<usize>, Vec<Vec<f64>>) = whitened.unzip();
        self.with(numbers, &signatures, &self.whitening.whitened(residual))
    }

    /// Those of whitened columns and a whitened residual, beside the background.
    fn with(&self, columns: Vec<usize>, signatures: &[Vec<f64>], residual: &[f64]) -> NormalEquations {
        let (stated, stated_residual) = (self.stated.products(signatures), self.stated.product(residual));
        let against = |all: &[Vec<f64>], stated: &[Vec<f64>]| {
            let all = all.iter().zip(stated);
            all.map(|(column, own)| dot(column, residual) - dot(own, &stated_residual)).collect()
        };
        let mixed = |(column, own): (&Vec<f64>, &Vec<f64>)| {
            let others = self.background.iter().zip(&self.stated.background);
            others.map(|(other, theirs)| dot(column, other) - dot(own, theirs)).collect()
        };
        let rows: Vec<Vec<f64>> = signatures.iter().zip(&stated).map(mixed).collect();
        NormalEquations {
            background_gram: self.equations.background_gram.clone(),
            mixed: Matrix::from_rows(&rows),
            signature_gram: less(products(signatures), &products(&stated)),
            background_residual: against(&self.background, &self.stated.background),
            signature_residual: against(signatures, &stated),
            square: dot(residual, residual) - dot(&stated_residual, &stated_residual),
            log_determinant: self.equations.log_determinant,
            columns,
        }
    }

    /// D⁻½ (r − A ψ − B z − E ê).
    pub fn left_over(&self, coordinates: &[f64], background: &[f64]) -> Vec<f64> {
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
    pub fn weighted(&self, signature: usize, smooth: &[f64]) -> Vec<f64> {
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
