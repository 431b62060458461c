//! Baselines from measured contacts: linear functions by least squares, and the contacts themselves as neighbours.

use tactpad_core::network::Zero;
use tactpad_core::pipeline::contact::neighbours::{KNOWN_MAX, LabelledContact, NEIGHBOURS, Neighbours};
use tactpad_core::pipeline::contact::regression::{Regression, TERMS, Target};
use tactpad_core::quantity::CHANNELS;
use tactpad_core::tables::measured::Row;
use tactpad_numeric::linear::Factor;

use super::fit::FitError;

/// Fits linear functions of the terms φ = (nine channels, 1) by least squares. `zero` is what the rows' channels are relative to,
/// `reach_mm` is the largest distance of a contact from the axis.
///
/// # Errors
/// Fewer contacts than functions have terms.
pub fn regression(rows: &[Row], zero: Zero, target: Target, reach_mm: f64) -> Result<Regression, FitError> {
    enough(rows, TERMS)?;
    // Normal equations Σ φ φᵀ c = Σ φ y of each function c: N (`normal`) and `right`; of a wrench y is x Fz, y Fz, Fx, Fy, Fz.
    let mut normal = [[0.0; TERMS]; TERMS];
    let mut right = [[0.0; TERMS]; 5];
    for row in rows {
        let Some(terms) = terms(row) else { continue };
        let label = &row.label;
        let arm = if target == Target::Wrench { label.fz_n } else { 1.0 };
        let wanted = [label.x_mm * arm, label.y_mm * arm, label.fx_n, label.fy_n, label.fz_n];
        for (i, left) in terms.iter().enumerate() {
            normal[i].iter_mut().zip(&terms).for_each(|(entry, other)| *entry += left * other);
            right.iter_mut().zip(wanted).for_each(|(right, wanted)| right[i] += left * wanted);
        }
    }
    // Scaled to a unit diagonal, S⁻¹ N S⁻¹ with S = √diag N, and a ridge of 1e-10: a channel that never moves gets no factor.
    let scale: [f64; TERMS] = std::array::from_fn(|k| normal[k][k].max(1e-300).sqrt());
    let scaled: [[f64; TERMS]; TERMS] = std::array::from_fn(|i| {
        std::array::from_fn(|j| normal[i][j] / scale[i] / scale[j] + if i == j { 1e-10 } else { 0.0 })
    });
    let factor = Factor::of(&scaled).ok_or(FitError::Senseless)?;
    // c = S⁻¹ (S⁻¹ N S⁻¹)⁻¹ S⁻¹ b.
    let functions = right.map(|right| {
        let solved = factor.solve(&std::array::from_fn(|k| right[k] / scale[k]));
        std::array::from_fn(|k| solved[k] / scale[k])
    });
    Ok(Regression { zero, target, functions, reach_mm })
}

/// Keeps the contacts as neighbours. `zero` is what their channels are relative to.
///
/// # Errors
/// Fewer contacts than neighbours are asked, or more than a decoder keeps.
pub fn neighbours(rows: &[Row], zero: Zero) -> Result<Neighbours, FitError> {
    enough(rows, NEIGHBOURS)?;
    let channels: Vec<[f64; CHANNELS]> = rows.iter().filter_map(|row| row.uv).collect();
    if channels.len() > KNOWN_MAX {
        return Err(FitError::TooMany { contacts: channels.len(), most: KNOWN_MAX });
    }
    let count = channels.len().max(1) as f64;
    let deviation_uv: [f32; CHANNELS] = std::array::from_fn(|k| {
        // Root mean square difference from the mean; of a channel that never moves 1.
        let mean = channels.iter().map(|uv| uv[k]).sum::<f64>() / count;
        let square = channels.iter().map(|uv| (uv[k] - mean).powi(2)).sum::<f64>() / count;
        if square > 0.0 { square.sqrt() as f32 } else { 1.0 }
    });
    let known = |row: &Row| {
        let uv = row.uv?;
        let channels = std::array::from_fn(|k| uv[k] as f32 / deviation_uv[k]);
        Some(LabelledContact { channels, contact: row.label.into() })
    };
    Ok(Neighbours { zero, deviation_uv, known: rows.iter().filter_map(known).collect() })
}

fn enough(rows: &[Row], least: usize) -> Result<(), FitError> {
    let contacts = rows.iter().filter(|row| row.uv.is_some()).count();
    if contacts < least { Err(FitError::TooFew { contacts, least }) } else { Ok(()) }
}

fn terms(row: &Row) -> Option<[f64; TERMS]> {
    let uv = row.uv?;
    Some(std::array::from_fn(|k| uv.get(k).copied().unwrap_or(1.0)))
}
