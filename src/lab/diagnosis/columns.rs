//! All columns of the linear systems: each channel's zero, the model's own errors, and the hypotheses' signatures.

use super::covariance::{Column, Fitted};
use super::model::{CommonError, Hypothesis, Linearised, Signature};
use super::observations::Observations;
use super::target::Target;

/// The cause whose column is the channel's zero itself, which is always fitted.
pub(super) const ZERO: &str = "channel_offset";

/// Which column means what.
pub(super) struct Columns {
    /// The zeros, and the model's own errors.
    nuisance: Vec<Signature>,
    /// For each hypothesis, the numbers of its columns.
    pub(super) of_hypothesis: Vec<Vec<usize>>,
    /// For each column, the precision of its prior; 0: none.
    pub(super) precisions: Vec<f64>,
    channels: usize,
}

impl Columns {
    pub(super) fn of(hypotheses: &[Hypothesis], errors: &[CommonError], observations: &Observations) -> Self {
        let (channels, rows) = (observations.channels.len(), observations.rows());
        let zero = |channel: usize| -> Signature {
            (0..channels).map(|k| (k == channel).then(|| vec![1.0; rows])).collect()
        };
        let mut nuisance: Vec<Signature> = (0..channels).map(zero).collect();
        nuisance.extend(errors.iter().map(|error| error.signature.clone()));
        // A channel that tells nothing has no zero.
        let dead = |channel: usize| f64::from(u8::from(!observations.is_alive(channel)));
        let mut precisions: Vec<f64> = (0..channels).map(dead).collect();
        precisions.extend(errors.iter().map(|error| 1.0 / (error.deviation * error.deviation)));
        let mut next = nuisance.len();
        let of_hypothesis = hypotheses
            .iter()
            .map(|hypothesis| match hypothesis.target {
                Target::Channel(channel) if hypothesis.effect == ZERO => vec![channel],
                _ => {
                    let first = next;
                    next += hypothesis.parameters.len();
                    (first..next).collect()
                }
            })
            .collect();
        precisions.resize(next, 0.0);
        Self { nuisance, of_hypothesis, precisions, channels }
    }

    /// The columns themselves, about the present point.
    pub(super) fn signatures<'c>(&'c self, linearised: &'c Linearised) -> Vec<Column<'c>> {
        let own = linearised.signatures.iter().zip(&self.of_hypothesis);
        let of_hypotheses = own.filter(|(_, columns)| columns[0] >= self.channels).flat_map(|(all, _)| all);
        self.nuisance.iter().chain(of_hypotheses).map(Vec::as_slice).collect()
    }

    /// The nuisances and these hypotheses, free.
    pub(super) fn fitted(&self, hypotheses: impl IntoIterator<Item = usize>) -> Fitted<'_> {
        let mut columns: Vec<usize> = (0..self.nuisance.len()).collect();
        for hypothesis in hypotheses {
            let own = self.of_hypothesis[hypothesis].iter().filter(|column| **column >= self.nuisance.len());
            columns.extend(own);
        }
        Fitted { columns, precisions: &self.precisions }
    }
}
