//! Why two tables cannot be compared.

use std::fmt;

use crate::diagnosis::label::no_solution;
use tactpad_core::counted::counted;
use tactpad_inference::error::InferenceError;

/// Fewest rows, of a recording and of a channel of it.
pub(super) const ROWS_MIN: usize = 60;
/// Fewest places, or presses, by which changes can be told.
pub(super) const BLOCKS_MIN: usize = 6;

/// Why two tables cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ComparisonError {
    /// A column that was asked for is not there.
    Missing {
        /// Its name.
        name: String,
        /// In which table.
        which: &'static str,
    },
    /// A column that was asked for holds no numbers.
    NoNumbers {
        /// Its name.
        name: String,
        /// In which table.
        which: &'static str,
    },
    /// No column can be a channel.
    Channels,
    /// No column can be a label.
    Labels,
    /// All labels stay the same.
    Constant,
    /// All labels go next to nowhere, and the channels as far as in the earlier recording.
    Narrow {
        /// Name of the first.
        name: String,
        /// Its least and greatest value: in the earlier recording, and in the measured table.
        extents: [[String; 2]; 2],
    },
    /// Too few rows.
    Rows {
        /// How many.
        rows: usize,
        /// In which table.
        which: &'static str,
    },
    /// Of the labels that were named, none is a place or a load.
    Circumstances(String),
    /// Too few rows within the labels of the earlier recording.
    Apart(usize),
    /// Too few places or presses.
    Blocks(usize),
    /// No channel goes with the labels.
    Silent,
    /// What could not be computed, and why.
    NoSolution(String),
}

impl fmt::Display for ComparisonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing { name, which } => write!(f, "{which} has no column {name}"),
            Self::NoNumbers { name, which } => write!(f, "column {name} of {which} holds no numbers"),
            Self::Channels => f.write_str(
                "the two tables have no channel in common: no column of numbers that varies and is no label has the same name in both; \
                 name channels with --channels",
            ),
            Self::Labels => f.write_str(
                "the two tables have no place and no load in common (x_mm, y_mm, z_mm, fx_n, fy_n, fz_n, scale_g); name labels with \
                 --labels",
            ),
            Self::Circumstances(labels) => write!(
                f,
                "--labels {labels} says when and how, and neither where nor how hard: name a column of places or of loads, too"
            ),
            Self::Constant => f.write_str(
                "all labels stay the same in the earlier recording: what the channels should read under others is not known",
            ),
            Self::Narrow { name, extents: [[low, high], [least, most]] } => write!(
                f,
                "{name} goes from {least} to {most} in the measured table and from {low} to {high} in the earlier recording, while the channels \
                 go as far as there: it is stuck, or in another unit; mend that column, or leave it out with --labels"
            ),
            Self::Rows { rows, which } => {
                write!(f, "{which} has {} with labels: it takes {ROWS_MIN} at least", counted(rows, "row"))
            }
            Self::Apart(rows) => write!(
                f,
                "{} with labels that the earlier recording has, too: it takes {ROWS_MIN} at least; measure where the earlier one \
                 was measured",
                counted(rows, "row")
            ),
            Self::Blocks(blocks) => write!(
                f,
                "contacts at {}, or in as many presses: it takes {BLOCKS_MIN} at least to tell a change from chance",
                counted(blocks, "place")
            ),
            Self::Silent => f.write_str("no channel follows the labels as it did in the earlier recording; see that each row has the channels of its own contact"),
            Self::NoSolution(told) => f.write_str(told),
        }
    }
}

impl ComparisonError {
    /// An error of the inference, where channels have these names.
    pub(super) fn of(error: &InferenceError, channels: &[String]) -> Self {
        Self::NoSolution(no_solution(error, channels))
    }
}

impl std::error::Error for ComparisonError {}
