//! Errors of a table.

use std::fmt;
use std::io;

use super::columns::{LABEL, TableKind};

/// A table that cannot be read: where, and why.
#[derive(Debug)]
pub struct ReadError {
    /// The line, from 1.
    pub line: usize,
    /// Fault of it.
    pub fault: Fault,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.fault)
    }
}

impl std::error::Error for ReadError {}

/// What is wrong with a line. As text: what, and the way out; the caller says where.
#[derive(Debug)]
#[non_exhaustive]
pub enum Fault {
    /// The system did not give the bytes.
    Io(io::Error),
    /// There is no line.
    Empty(TableKind),
    /// There is no line, where any names of columns would do.
    NoHeader,
    /// The text has two bytes for each character.
    Utf16,
    /// A line that is longer than any row.
    LongLine,
    /// A quotation mark opens and does not close, or something follows the closing one.
    Quotation,
    /// The file is compressed, or a workbook, which is a ZIP archive.
    Packed,
    /// The line holds bytes that are zero, as files do that a machine wrote when its power failed.
    Zeros,
    /// The line holds carriage returns, as files do whose lines end with nothing else.
    CarriageReturn,
    /// A fault in a last line that has no line end.
    InOpenLine(Box<Self>),
    /// A last line without a line end whose last cell is shorter than those above it.
    CutOff {
        /// The column.
        name: String,
        /// What it holds; its beginning, if that is long.
        text: String,
    },
    /// What the reader of a certain table says of a row.
    Row(String),
    /// The columns are not separated by commas.
    Separator,
    /// Columns that the table must have.
    MissingColumns {
        /// Theirs, with commas between.
        names: String,
        /// What the table was read as.
        kind: TableKind,
    },
    /// No channel at all.
    NoChannels,
    /// Some of the channels, by their columns' names.
    MissingChannels(String),
    /// Two columns of one name.
    DoubledColumn(String),
    /// Nothing follows the first line.
    NoRows,
    /// More rows than fit into a gigabyte: so many do.
    TooManyRows(usize),
    /// A row with too few or too many cells.
    Width {
        /// Cells of the row.
        found: usize,
        /// Columns of the table.
        named: usize,
    },
    /// A cell that must not be empty.
    EmptyCell(String),
    /// A cell that holds no finite number.
    NotANumber {
        /// The column.
        name: String,
        /// What it holds; its beginning, if that is long.
        text: String,
    },
    /// A number that no pad and no rig has.
    OutOfRange {
        /// The column.
        name: String,
        /// The number, as it is written.
        text: String,
        /// The least that passes.
        low: f64,
        /// The most that passes.
        high: f64,
        /// Of all three.
        unit: &'static str,
    },
    /// A name that is not UTF-8.
    NotText(&'static str),
    /// An approach that is neither of the two.
    Approach(String),
    /// A time before the one above it.
    TimeGoesBack {
        /// The time above, s.
        from_s: f64,
        /// The time here, as it is written.
        text: String,
        /// The trial, if the rows have one.
        trial: Option<String>,
    },
    /// A time series of which some rows have times and others none.
    PartlyTimed(String),
    /// A trial whose rows do not stand together.
    ScatteredTrial(String),
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "{error}"),
            Self::Empty(kind) => write!(f, "the file is empty; it begins with {}", ExpectedHeader(*kind)),
            Self::NoHeader => f.write_str("the file is empty; it begins with a line of the columns' names"),
            Self::Utf16 => f.write_str("the table is UTF-16; save it as UTF-8"),
            Self::LongLine => f.write_str("the line is longer than 1 MB: this is no table of contacts"),
            Self::Quotation => f.write_str(
                "a quotation mark does not close, or does not close the cell; write \"\" for one inside a text, and \
                 no line breaks",
            ),
            Self::Packed => f.write_str(
                "the file is compressed, or a workbook; unpack it, or save the table as CSV",
            ),
            Self::CarriageReturn => f.write_str(
                "a carriage return stands inside the line: end lines with a line feed, as \"CSV\" and \"CSV UTF-8\" do and \
                 \"CSV (Macintosh)\" does not",
            ),
            Self::Zeros => f.write_str(
                "the line holds bytes that are zero: the file was not written to its end; leave out what begins here",
            ),
            Self::InOpenLine(fault) => write!(
                f,
                "{fault}; the file ends in this line without a line end: if it was cut off, copy it anew or leave the line out"
            ),
            Self::CutOff { name, text } => write!(
                f,
                "the file ends in this line, and its last {name}, {text:?}, is cut off or has fewer digits than those \
                 above; copy the file anew, leave the line out, or end it if it is whole"
            ),
            Self::Row(why) => f.write_str(why),
            Self::Separator => f.write_str(
                "the columns are not separated by commas; save the table as CSV with commas, and points in numbers",
            ),
            Self::MissingColumns { names, kind } => {
                write!(f, "no column is named {names}; expected is {}", ExpectedHeader(*kind))
            }
            Self::NoChannels => f.write_str(
                "no column is a channel (m0x_uv to m2z_uv): this is a plan or a list of contacts; name a measured table",
            ),
            Self::MissingChannels(names) => {
                write!(f, "no column is named {names}; a measured table has all nine channels, m0x_uv to m2z_uv")
            }
            Self::DoubledColumn(name) => write!(f, "two columns are named {name}; rename one of them"),
            Self::NoRows => f.write_str("no contact follows the names of the columns"),
            Self::TooManyRows(most) => write!(
                f,
                "the table goes on after {most} rows, which take a gigabyte of memory; leave out what is not needed, or take every tenth row"
            ),
            Self::Width { found, named } => {
                write!(f, "{found} values where the header names {named} columns")
            }
            cell => cell.cell(f),
        }
    }
}

impl Fault {
    /// Those of one cell.
    fn cell(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EmptyCell(name) => write!(f, "{name} is empty; fill it in, or leave the row out"),
            Self::NotANumber { name, text } => write!(f, "{name} is {text:?}, which is not a number"),
            Self::OutOfRange { name, text, low, high, unit } => {
                write!(f, "{name} is {text}, and the pad's are {low} to {high}{}{unit}", gap(unit))
            }
            Self::NotText(name) => write!(f, "{name} is not UTF-8 text; save the table as UTF-8"),
            Self::Approach(text) => {
                write!(f, "approach is {text:?}; write loading or unloading, or leave it empty")
            }
            Self::TimeGoesBack { from_s, text, trial: None } => {
                write!(f, "t_s goes back from {from_s} to {text}; sort the rows by time")
            }
            Self::TimeGoesBack { from_s, text, trial: Some(trial) } => {
                write!(f, "t_s goes back from {from_s} to {text}; sort the rows of trial {trial:?} by time")
            }
            Self::PartlyTimed(trial) => {
                write!(f, "some rows of trial {trial:?} have t_s and some none; give it to all or to none")
            }
            Self::ScatteredTrial(trial) => {
                write!(f, "trial {trial:?} goes on here after other rows; put the rows of a trial together")
            }
            // All others are told above.
            _ => Ok(()),
        }
    }
}

/// As much of a cell as a message bears.
pub(super) fn short(cell: &str) -> String {
    cell.chars().take(40).collect()
}

const fn gap(unit: &str) -> &str {
    if unit.is_empty() { "" } else { " " }
}

/// What a table begins with.
struct ExpectedHeader(TableKind);

impl fmt::Display for ExpectedHeader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a line of the columns' names: t_s if times are known, {}", LABEL.join(", "))?;
        if self.0 == TableKind::Measured { f.write_str(", m0x_uv to m2z_uv") } else { Ok(()) }
    }
}
