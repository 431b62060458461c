//! The engine with what the program knows of a pad.

use crate::cli::failure::Failure;
use crate::cli::files::field::{changes_of, field_of};
use crate::cli::printing::written::say;
use tactpad::lab::diagnosis::report::Diagnosis;
use tactpad::lab::diagnosis::{self, DiagnosisError};
use tactpad::pad::changes::FieldChange;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::tables::measured::Table;

/// Holds a table against a device, whose field this is, and whose modules may have these flaws.
pub(crate) fn diagnosed(
    table: &Table,
    (device, field, flaws): (&Device, &PadField, &[FieldChange]),
    without: &[String],
) -> Result<Diagnosis, DiagnosisError> {
    let solve = |device: &Device| field_of(device).ok();
    let pad = diagnosis::Pad { device, field, flaws, solve: &solve, without };
    diagnosis::diagnose(table, &pad)
}

/// What flaws of a module change; none where that cannot be had.
pub(crate) fn flaws(device: &Device) -> Vec<FieldChange> {
    match changes_of(device) {
        Ok(changes) => changes.0,
        Err(Failure::Failed(why) | Failure::Unusable(why)) => {
            say(format_args!("open frames and loose bonds are not looked for: {why}"));
            Vec::new()
        }
        Err(Failure::Unread) => Vec::new(),
    }
}
