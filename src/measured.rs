//! Tables of measured contacts, and the plans by which they are measured.
//!
//! A row is what the reference wrote down about a contact (its label), and what the nine channels read, raw: offset and
//! temperature included. Rows of one trial are one time series in order; a row without trial is a static sample. A plan is
//! the same table without channels.

use crate::quantity::CHANNELS;

/// What was written down about a contact: place and force on the plate, not the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Label {
    /// Along +x.
    pub x_mm: f64,
    /// Along +y.
    pub y_mm: f64,
    /// Along +x.
    pub fx_n: f64,
    /// Along +y.
    pub fy_n: f64,
    /// Pressing in.
    pub fz_n: f64,
}

/// How a static load is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Approach {
    /// From rest.
    Loading,
    /// From a higher load.
    Unloading,
}

/// One line of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Its line in the file, from 1; 0 for a row that comes from no file.
    pub line: usize,
    /// Index of its trial in [`Table::trials`].
    pub trial: Option<usize>,
    /// Index of its session in [`Table::sessions`].
    pub session: Option<usize>,
    /// Time on the pad's clock.
    pub t_s: Option<f64>,
    /// Temperature of the pad.
    pub temp_c: Option<f64>,
    /// Cycles of load that the pad has behind it.
    pub cycle: Option<f64>,
    /// How long a static load is held before it is read; only plans have it.
    pub dwell_s: Option<f64>,
    /// From where a static load comes; only plans have it.
    pub approach: Option<Approach>,
    /// What the reference wrote.
    pub label: Label,
    /// The channels, in the order of [`CHANNEL_NAMES`](crate::quantity::CHANNEL_NAMES); none in a plan.
    pub uv: Option<[f64; CHANNELS]>,
}

/// Rows, and the names of their trials and sessions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// In the file's order.
    pub rows: Vec<Row>,
    /// Names of the trials, in the order in which they first appear.
    pub trials: Vec<String>,
    /// Names of the sessions, in the order in which they first appear.
    pub sessions: Vec<String>,
}
