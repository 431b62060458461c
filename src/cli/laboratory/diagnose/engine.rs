//! The diagnosis of a table with the program's own model of the pad.

use crate::cli::failure::Failure;
use crate::cli::files::field::{PadModel, changes_of, field_of};
use crate::cli::printing::written::say;
use tactpad::lab::diagnosis::report::Diagnosis;
use tactpad::lab::diagnosis::{self, DiagnosisError};
use tactpad::lab::effect::Effect;
use tactpad::pad::changes::FieldChange;
use tactpad::pad::device::Device;
use tactpad::tables::measured::Table;

/// Diagnoses a table: compares it with the model of the pad. `without` names causes that are left out.
pub(crate) fn diagnosed(
    table: &Table,
    model: PadModel<'_>,
    without: &[Effect],
) -> Result<Diagnosis, DiagnosisError> {
    let PadModel { device, field, flaws } = model;
    let solve = |device: &Device| field_of(device).ok();
    let pad = diagnosis::Pad { device, field, flaws, solve: &solve, without };
    diagnosis::diagnose(table, &pad)
}

/// The changes of the field by flaws of a module; empty where they cannot be computed.
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
