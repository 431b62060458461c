//! How far a decoder's contacts are from those that were written down, or from the truth.

use std::fmt;

use serde::Serialize;

use tactpad_core::counted::counted;
use tactpad_core::network::Zero;
use tactpad_core::pipeline::contact::{Decoder, watch};
use tactpad_core::quantity::{Contact, Strain};
use tactpad_core::tables::measured::{Label, Row, Table, zero};
use tactpad_core::tables::recording::Recording;

/// Mean magnitude of the errors along one axis each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PerAxis {
    /// Place.
    pub x_mm: f64,
    /// Place.
    pub y_mm: f64,
    /// Force.
    pub fx_n: f64,
    /// Force.
    pub fy_n: f64,
    /// Force.
    pub fz_n: f64,
}

/// Errors over many contacts. MAE is the mean of the magnitudes of the component errors: x and y; Fx, Fy and Fz.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// How many contacts.
    pub rows: usize,
    /// Mean of |Δx| and |Δy|.
    pub position_mae_mm: f64,
    /// Mean distance.
    pub position_mean_euclid_mm: f64,
    /// Root of the mean square of the distance.
    pub position_rmse_mm: f64,
    /// Mean of |ΔFx|, |ΔFy| and |ΔFz|.
    pub force_mae_n: f64,
    /// Each axis on its own.
    pub per_axis: PerAxis,
}

/// A decoder's errors on a measured table. It is written as one JSON object.
#[derive(Clone, Debug, Serialize)]
pub struct Evaluation {
    /// Against what was written down.
    #[serde(flatten)]
    pub by_labels: Errors,
    /// Share of the rows that are not one finger on the decoder's pad; null for a decoder that does not warn.
    pub warned: Option<f64>,
    /// Against the true contacts, where they are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<ByTruth>,
}

/// A decoder's errors against the truth.
#[derive(Clone, Debug, Serialize)]
pub struct ByTruth {
    /// How far off it is.
    #[serde(flatten)]
    pub errors: Errors,
    /// Share of the true contacts in the decoder's 95 % regions; null for a decoder without.
    pub coverage95: Option<f64>,
}

/// Why a table does not tell a decoder's errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EvaluationError {
    /// The truth is of another table. As text it goes behind the table's name.
    OtherRows {
        /// Rows of the table.
        rows: usize,
        /// Rows of its truth.
        truths: usize,
    },
    /// Nothing says what the untouched pad reads, and the decoder has to know.
    NoZero,
    /// No row has a contact and channels.
    NoContacts,
}

impl fmt::Display for EvaluationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherRows { rows, truths } => {
                write!(f, "has {}, and its truth {truths}: give both of one run", counted(rows, "row"))
            }
            Self::NoZero => f.write_str(
                "no row without force says what the untouched pad reads, and neither does the decoder; measure some, or \
                 adapt a decoder to a table without such rows",
            ),
            Self::NoContacts => f.write_str("no row has a contact and its nine channels"),
        }
    }
}

impl std::error::Error for EvaluationError {}

impl Evaluation {
    /// Decodes the table's contacts, and compares them with its labels and, row by row, with `truth`. `full_scale_n` is
    /// the pad's largest force.
    ///
    /// # Errors
    /// There is nothing to compare, or nothing to compare it with.
    pub fn of(
        decoder: &Decoder,
        table: Table,
        truth: Option<&[Label]>,
        full_scale_n: f64,
    ) -> Result<Self, EvaluationError> {
        if let Some(truth) = truth.filter(|truth| truth.len() != table.rows.len()) {
            return Err(EvaluationError::OtherRows { rows: table.rows.len(), truths: truth.len() });
        }
        let taken = taken(decoder, table, full_scale_n).ok_or(EvaluationError::NoZero)?;
        let evaluation = Self::of_taken(decoder, taken, truth);
        if evaluation.by_labels.rows == 0 { Err(EvaluationError::NoContacts) } else { Ok(evaluation) }
    }

    /// Of a table as the decoder takes it.
    fn of_taken(decoder: &Decoder, taken: Table, truth: Option<&[Label]>) -> Self {
        let (rows, places) = contacts(taken);
        let found = decoded(decoder, &rows);
        let by_truth = |truth: &[Label]| {
            let truths: Vec<Label> = places.iter().map(|at| truth[*at]).collect();
            ByTruth { errors: errors(&found, &truths), coverage95: coverage95(decoder, &rows, &truths) }
        };
        Self {
            by_labels: errors(&found, rows.iter().map(|row| &row.label)),
            warned: warned(decoder, &rows),
            truth: truth.map(by_truth),
        }
    }
}

/// The table's contacts, and their places in it. A table may have a million rows: they stay where they are.
fn contacts(mut table: Table) -> (Vec<Row>, Vec<usize>) {
    let places = zero::contacts(&table);
    for (to, from) in places.iter().enumerate() {
        // Never a place that is still to come: to ≤ from.
        table.rows.swap(to, *from);
    }
    table.rows.truncate(places.len());
    (table.rows, places)
}

/// The table as the decoder takes it. `None` if nothing says what the untouched pad reads, and the decoder has to know.
fn taken(decoder: &Decoder, table: Table, full_scale_n: f64) -> Option<Table> {
    if decoder.zero() == Zero::Raw {
        return Some(table);
    }
    let recording = Recording::tared_or_raw(table, full_scale_n);
    let recording = match decoder.compensation.zero_uv {
        _ if recording.is_tared() => recording,
        Some(zero_uv) => recording.less(&zero_uv),
        None => return None,
    };
    Some(recording.into_taken(decoder))
}

/// Decoded contacts of tared rows; a row without channels is no contact.
pub fn decoded(decoder: &Decoder, rows: &[Row]) -> Vec<Contact> {
    rows.iter().map(|row| decoder.decode(&strain(row))).collect()
}

/// A row's channels as a decoder takes them.
pub fn strain(row: &Row) -> Strain {
    Strain { uv: row.uv.unwrap_or_default().map(|uv| uv as f32) }
}

/// Compares contacts one by one; both lists are taken as long as the shorter.
pub fn errors<'l>(
    found: &[Contact],
    wanted: impl IntoIterator<Item = &'l Label, IntoIter: ExactSizeIterator>,
) -> Errors {
    let wanted = wanted.into_iter();
    let mut errors = Errors { rows: found.len().min(wanted.len()), ..Errors::default() };
    let count = errors.rows.max(1) as f64;
    for (found, wanted) in found.iter().zip(wanted) {
        let [x, y] = [f64::from(found.x_mm) - wanted.x_mm, f64::from(found.y_mm) - wanted.y_mm];
        let force = [
            f64::from(found.fx_n) - wanted.fx_n,
            f64::from(found.fy_n) - wanted.fy_n,
            f64::from(found.fz_n) - wanted.fz_n,
        ];
        let axes = &mut errors.per_axis;
        let sums = [&mut axes.x_mm, &mut axes.y_mm, &mut axes.fx_n, &mut axes.fy_n, &mut axes.fz_n];
        sums.into_iter()
            .zip([x, y].into_iter().chain(force))
            .for_each(|(sum, off)| *sum += off.abs() / count);
        errors.position_mean_euclid_mm += x.hypot(y) / count;
        errors.position_rmse_mm += (x * x + y * y) / count;
    }
    let PerAxis { x_mm, y_mm, fx_n, fy_n, fz_n } = errors.per_axis;
    errors.position_mae_mm = (x_mm + y_mm) / 2.0;
    errors.force_mae_n = (fx_n + fy_n + fz_n) / 3.0;
    errors.position_rmse_mm = errors.position_rmse_mm.sqrt();
    errors
}

/// χ² of five numbers below which 95 % of all cases lie.
const CHI_SQUARE_95: f64 = 11.0705;

/// The share of contacts that lie in the decoder's own 95 % regions; `None` for a decoder that states none.
pub fn coverage95(decoder: &Decoder, rows: &[Row], wanted: &[Label]) -> Option<f64> {
    let inverse = decoder.inverse()?;
    let covered = rows.iter().zip(wanted).filter(|(row, wanted)| {
        let distance =
            inverse.estimate(&strain(row)).and_then(|estimate| estimate.distance_square(&wanted.numbers()));
        distance.is_some_and(|square| square <= CHI_SQUARE_95)
    });
    Some(covered.count() as f64 / rows.len().max(1) as f64)
}

/// The share of rows that the decoder would warn of in play; `None` for one that does not warn.
pub fn warned(decoder: &Decoder, rows: &[Row]) -> Option<f64> {
    let inverse = decoder.inverse()?;
    let warned = rows.iter().filter(|row| watch::warns(inverse, &strain(row)) == Some(true));
    Some(warned.count() as f64 / rows.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_figure_is_its_definition() {
        let found = [Contact { x_mm: 3.0, y_mm: 4.0, fz_n: 1.0, ..Contact::default() }, Contact::default()];
        let wanted = [Label::default(), Label { fx_n: 0.6, ..Label::default() }];
        let errors = errors(&found, &wanted);
        assert_eq!(errors.rows, 2);
        assert_eq!(errors.position_mae_mm, (1.5 + 2.0) / 2.0);
        assert_eq!(errors.position_mean_euclid_mm, 2.5);
        assert!((errors.position_rmse_mm - 12.5_f64.sqrt()).abs() < 1e-12);
        assert!((errors.force_mae_n - (0.3 + 0.5) / 3.0).abs() < 1e-12);
        assert_eq!(errors.per_axis.fz_n, 0.5);
    }
}
