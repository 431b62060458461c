//! Why a table cannot be held against predictions.

use std::fmt;

use crate::diagnosis::label::no_solution;
use tactpad_core::counted::counted;
use tactpad_inference::error::InferenceError;

/// Fewest rows.
pub(super) const ROWS_MIN: usize = 60;
/// Fewest places, presses, or rows where there are none.
pub(super) const BLOCKS_MIN: usize = 6;

/// Why a table cannot be held against predictions.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PredictionError {
    /// The tables are not equally long.
    Rows {
        /// Rows that were measured.
        measured: usize,
        /// Rows that are predicted.
        predicted: usize,
    },
    /// A label differs from the one in the measured table.
    OtherRow {
        /// Its column.
        name: String,
        /// The row, from 0.
        row: usize,
    },
    /// A channel of a row is not predicted.
    NoPrediction {
        /// Its column.
        name: String,
        /// The row, from 0.
        row: usize,
    },
    /// A column that was asked for is not there, or holds no numbers.
    NoNumbers {
        /// Its name.
        name: String,
        /// In which table.
        which: &'static str,
    },
    /// The tables have no channel in common.
    Channels,
    /// These columns, which could be channels, are predicted as they were measured.
    Same(String),
    /// Too few rows.
    Few(usize),
    /// Too few places or presses.
    Blocks(usize),
    /// No channel goes with its prediction.
    Silent,
    /// A table of derivatives is not one of these rows and channels.
    Derivative {
        /// Its effect.
        name: String,
        /// What is wrong.
        why: String,
    },
    /// What could not be computed, and why.
    NoSolution(String),
}

impl fmt::Display for PredictionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rows { measured, predicted } => write!(
                f,
                "{} measured, and {} predicted: write one prediction for each measured row, in the same order",
                counted(measured, "row"),
                counted(predicted, "row")
            ),
            Self::OtherRow { name, row } => write!(
                f,
                "row {}: {name} is not what it is in the measured table: write one prediction for each measured row, in the same order",
                row + 1
            ),
            Self::NoPrediction { name, row } => write!(
                f,
                "row {}: {name} is no number: each channel must be predicted in each row; leave out the column, or the row in both tables",
                row + 1
            ),
            Self::NoNumbers { name, which } => write!(f, "{which} has no column {name} that holds numbers"),
            Self::Channels => f.write_str(
                "no channel is predicted: no column of the predictions that varies and is no label has the name of a measured one; name \
                 channels alike in both tables",
            ),
            Self::Same(names) => write!(
                f,
                "{names}: the predictions are the measured numbers themselves; write there what your model says"
            ),
            Self::Few(rows) => write!(f, "{} with labels: it takes {ROWS_MIN} at least", counted(rows, "row")),
            Self::Blocks(blocks) => write!(
                f,
                "{}: it takes {BLOCKS_MIN} at least to tell a cause from chance",
                counted(blocks, "different place")
            ),
            Self::Silent => f.write_str(
                "no channel follows its prediction: see that each row has the channels of its own label, in both tables",
            ),
            Self::Derivative { name, why } => write!(f, "{name}.csv: {why}"),
            Self::NoSolution(told) => f.write_str(told),
        }
    }
}

impl PredictionError {
    /// An error of the inference, where channels have these names.
    pub(super) fn of(error: &InferenceError, channels: &[String]) -> Self {
        Self::NoSolution(no_solution(error, channels))
    }
}

impl std::error::Error for PredictionError {}
