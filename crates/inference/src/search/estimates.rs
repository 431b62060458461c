//! Numbers of fitted causes with their intervals, and the sizes at which others would have been found.

use super::score_test::Projected;
use super::{Attribution, Search};
use crate::error::InferenceError;
use crate::hypothesis::Parameter;
use crate::policy::{POWER, WITHIN_95};
use tactpad_numeric::chi_square;
use tactpad_numeric::dense::Matrix;

/// A number with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Its name, the unit last.
    pub name: &'static str,
    /// The value.
    pub value: f64,
    /// Ends of the 95 % interval.
    pub interval95: [f64; 2],
}

/// The size at which a cause that was not found would have been.
#[derive(Clone, Debug, PartialEq)]
pub struct Detectable {
    /// For each number: the deviation from none that is found in as many measurements like this one as [`POWER`] says.
    pub minimum: Vec<(&'static str, f64)>,
    /// The largest part of its signature that another cause reproduces.
    pub rival_share: f64,
}

/// How large coordinates are, in units of their own deviations: of several the root of the sum of squares.
fn norm(coordinates: &[f64], covariance: &Matrix) -> f64 {
    let square = |(k, psi): (usize, &f64)| psi * psi / covariance.at(k, k).max(f64::MIN_POSITIVE);
    coordinates.iter().enumerate().map(square).sum::<f64>().sqrt()
}

impl<L> Search<'_, L> {
    /// A fitted cause's numbers with their intervals. `doubt` is what else may be in each of them, as a variance.
    pub fn estimates(
        &self,
        found: &Attribution,
        at: usize,
        doubt: &[f64],
    ) -> Result<Vec<Estimate>, InferenceError> {
        let covariance = self.covariance(&found.fit, at)?;
        let (hypothesis, coordinates) = &found.fit.applied[at];
        let it = &self.model.hypotheses()[*hypothesis];
        let parameters = it.asked();
        let size = norm(&coordinates[..parameters.len()], &covariance);
        let estimate = |(k, parameter): (usize, &Parameter)| {
            let deviation = covariance.at(k, k).max(0.0).sqrt();
            // An error of the signature moves all numbers in proportion, and turns them by as much.
            let deviation = deviation * libm::hypot(1.0, it.signature_error * size);
            let spread = WITHIN_95 * libm::hypot(deviation, doubt.get(k).copied().unwrap_or_default().sqrt());
            Estimate {
                name: parameter.name,
                value: parameter.value(coordinates[k]),
                interval95: [-spread, spread].map(|by| parameter.value(coordinates[k] + by)),
            }
        };
        Ok(parameters.iter().enumerate().map(estimate).collect())
    }

    /// The numbers of a fitted cause's course.
    pub fn shapes(&self, found: &Attribution, at: usize) -> Vec<(&'static str, f64)> {
        let (hypothesis, coordinates) = &found.fit.applied[at];
        let it = &self.model.hypotheses()[*hypothesis];
        let numbers = it.parameters.iter().zip(coordinates).skip(it.asked().len());
        numbers.map(|(parameter, psi)| (parameter.name, parameter.value(*psi))).collect()
    }

    /// For each hypothesis that was asked for and not found, its number and the size that would have been; none where nothing tells of it.
    pub fn detectable(&self, found: &Attribution) -> Result<Vec<(usize, Detectable)>, InferenceError> {
        let projected = self.projected(&found.fit)?;
        let largest = self.columns.of_hypothesis.iter().map(Vec::len).max().unwrap_or(0);
        let noncentralities: Vec<f64> = (0..=largest)
            .map(|freedom| {
                chi_square::noncentrality(chi_square::quantile(found.critical, freedom), freedom, POWER)
            })
            .collect();
        let asked = (0..self.columns.of_hypothesis.len())
            .filter(|at| !self.is_zero(*at) && found.fit.applied.iter().all(|(held, _)| held != at));
        let detectable = |at| Some((at, self.detectable_size(&projected, at, &noncentralities)?));
        Ok(asked.filter_map(detectable).collect())
    }

    fn detectable_size(
        &self,
        projected: &Projected,
        at: usize,
        noncentralities: &[f64],
    ) -> Option<Detectable> {
        let it = &self.model.hypotheses()[at];
        let columns = &self.columns.of_hypothesis[at];
        let freedom = projected.test(columns, &projected.score).freedom;
        if freedom == 0 {
            return None;
        }
        let minimum_detectable =
            columns.iter().zip(it.asked()).filter(|(column, _)| !projected.is_empty(**column));
        let size = |(column, parameter): (&usize, &Parameter)| {
            // λ = ψ² I.
            let psi = (noncentralities[freedom] / projected.fisher.at(*column, *column)).sqrt();
            (parameter.name, (parameter.value(psi) - parameter.none).abs())
        };
        Some(Detectable {
            minimum: minimum_detectable.map(size).collect(),
            rival_share: self.rival_share(projected, at),
        })
    }

    /// The largest part of a hypothesis' signature that another one reproduces.
    fn rival_share(&self, projected: &Projected, at: usize) -> f64 {
        let own = &self.columns.of_hypothesis[at];
        let rivals =
            (0..self.columns.of_hypothesis.len()).filter(|rival| *rival != at && !self.is_zero(*rival));
        rivals.map(|rival| projected.reproduced(own, &self.columns.of_hypothesis[rival])).fold(0.0, f64::max)
    }
}
