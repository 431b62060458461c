//! Ways to fit a decoder.

use clap::ValueEnum;
use serde::Serialize;

/// Ways to fit a decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Method {
    /// Stage II of the paper's network: train it on, held to where it began.
    Scdf,
    /// The pad's own field, calibrated, and inverted for each reading.
    Inverse,
    /// Least squares from the channels to the forces and to x Fz and y Fz.
    Wrench,
    /// Least squares from the channels to the contact: a baseline.
    Linear,
    /// The mean of the five nearest contacts: a baseline.
    Knn,
}

impl Method {
    /// Memory that a fit takes for each contact.
    pub(super) const fn row_bytes(self) -> usize {
        match self {
            Self::Inverse => 170_000,
            Self::Scdf => 2_000,
            Self::Wrench | Self::Linear | Self::Knn => 1_000,
        }
    }
}
