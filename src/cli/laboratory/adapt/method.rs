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
