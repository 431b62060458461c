//! Tables of contacts, plans and measured tables, as files.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::Failure;
use super::written::reason;
use crate::measured::Table;
use crate::measured::columns::Kind;
use crate::measured::error::{Fault, ReadError};
use crate::measured::read;

/// Reads a table whose places lie within ±`place_max_mm`.
pub(super) fn read(path: &Path, kind: Kind, place_max_mm: f64) -> Result<Table, Failure> {
    let refused = |error| refusal(path, kind, error);
    let file = File::open(path).map_err(|error| refused(ReadError { line: 1, fault: Fault::Io(error) }))?;
    read::table(BufReader::new(file), kind, place_max_mm).map_err(refused)
}

fn refusal(path: &Path, kind: Kind, error: ReadError) -> Failure {
    let path = path.display();
    let what = match kind {
        Kind::Contacts => "of contacts",
        Kind::Plan => "that holds a plan",
        Kind::Measured => "of measured contacts",
    };
    Failure::Unusable(match error.fault {
        Fault::Io(error) => format!("{path} cannot be read: {}; name a CSV file {what}", reason(&error)),
        fault => format!("{path}:{}: {fault}", error.line),
    })
}
