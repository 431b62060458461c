//! All columns of the linear systems: each channel's zero, the model's own errors, and the hypotheses' signatures.

use crate::covariance::{Fitted, Marginal};
use crate::hypothesis::{Hypothesis, Parameter};
use crate::model::{Column, CommonError, Linearised, Signature};
use crate::observations::Observations;

/// Which column means what.
pub struct Columns {
    /// The channels' zeros.
    zeros: Vec<Signature>,
    /// How many columns the zeros and the model's own errors are.
    nuisances: usize,
    /// For each hypothesis, the numbers of the columns that are asked for.
    pub of_hypothesis: Vec<Vec<usize>>,
    /// For each hypothesis, the columns of its course: free wherever it holds.
    pub shapes: Vec<Vec<usize>>,
    /// For each column, the precision of its prior; 0: none.
    pub precisions: Vec<f64>,
    channels: usize,
}

impl Columns {
    /// The columns of these hypotheses at these rows, beside the zeros and the model's own errors.
    pub fn of<L>(hypotheses: &[Hypothesis<L>], errors: &[CommonError], observations: &Observations) -> Self {
        let (channels, rows) = (observations.channels.len(), observations.rows());
        let zero = |channel: usize| -> Signature {
            (0..channels).map(|k| (k == channel).then(|| vec![1.0; rows])).collect()
        };
        let zeros = (0..channels).map(zero).collect();
        // A channel that tells nothing has no zero.
        let dead = |channel: usize| f64::from(u8::from(!observations.is_alive(channel)));
        let mut precisions: Vec<f64> = (0..channels).map(dead).collect();
        precisions.extend(errors.iter().map(|error| 1.0 / (error.deviation * error.deviation)));
        let nuisances = channels + errors.len();
        let mut next = nuisances;
        let (mut of_hypothesis, mut shapes) = (Vec::new(), Vec::new());
        for hypothesis in hypotheses {
            if let Some(channel) = hypothesis.zero_of {
                of_hypothesis.push(vec![channel]);
                shapes.push(Vec::new());
                continue;
            }
            let asked = next + hypothesis.asked().len();
            of_hypothesis.push((next..asked).collect());
            next += hypothesis.parameters.len();
            shapes.push((asked..next).collect());
            let precision = |it: &Parameter| it.shape.map_or(0.0, |deviation| 1.0 / (deviation * deviation));
            precisions.extend(hypothesis.parameters.iter().map(precision));
        }
        Self { zeros, nuisances, of_hypothesis, shapes, precisions, channels }
    }

    /// The columns themselves, about the present point.
    pub fn signatures<'c>(
        &'c self,
        linearised: &'c Linearised,
        errors: &'c [CommonError],
    ) -> Vec<Column<'c>> {
        let own = linearised.signatures.iter().zip(&self.of_hypothesis);
        let of_hypotheses = own.filter(|(_, columns)| columns[0] >= self.channels).flat_map(|(all, _)| all);
        self.nuisance_signatures(errors).chain(of_hypotheses.map(Vec::as_slice)).collect()
    }

    /// Those of the zeros and of the model's own errors.
    pub fn nuisance_signatures<'c>(&'c self, errors: &'c [CommonError]) -> impl Iterator<Item = Column<'c>> {
        self.zeros.iter().chain(errors.iter().map(|error| &error.signature)).map(Vec::as_slice)
    }

    /// Adds the pull of the priors where courses are other than expected: −P ψ.
    pub fn pull(&self, marginal: &mut Marginal, applied: &[(usize, Vec<f64>)]) {
        for (at, coordinates) in applied {
            let shapes = &self.shapes[*at];
            let own = &coordinates[coordinates.len() - shapes.len()..];
            for (column, psi) in shapes.iter().zip(own) {
                marginal.score[*column] -= self.precisions[*column] * psi;
            }
        }
    }

    /// The nuisances, free.
    pub fn nuisances(&self) -> Fitted<'_> {
        self.fitted([])
    }

    /// Σ P ψ² of the courses.
    pub fn prior_square(&self, applied: &[(usize, Vec<f64>)]) -> f64 {
        let of = |(at, coordinates): &(usize, Vec<f64>)| -> f64 {
            let shapes = &self.shapes[*at];
            let own = &coordinates[coordinates.len() - shapes.len()..];
            shapes.iter().zip(own).map(|(column, psi)| self.precisions[*column] * psi * psi).sum()
        };
        applied.iter().map(of).sum()
    }

    /// All columns of a hypothesis, in the order of its numbers.
    pub fn all_of(&self, hypothesis: usize) -> impl Iterator<Item = usize> {
        self.of_hypothesis[hypothesis].iter().chain(&self.shapes[hypothesis]).copied()
    }

    /// The nuisances and these hypotheses, free.
    pub fn fitted(&self, hypotheses: impl IntoIterator<Item = usize>) -> Fitted<'_> {
        let mut columns: Vec<usize> = (0..self.nuisances).collect();
        for hypothesis in hypotheses {
            let own = self.of_hypothesis[hypothesis].iter().filter(|column| **column >= self.nuisances);
            columns.extend(own.chain(&self.shapes[hypothesis]));
        }
        Fitted { columns, precisions: &self.precisions }
    }
}
