//! The field of a verb's pad, with a line that says how far its computation is.

use std::fmt;

use crate::cli::failure::Failure;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{reason, say};
use tactpad::lab::field_cache::{self, FieldError, Obtained};
use tactpad::pad::changes::{FieldChange, FieldChanges};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;

/// The field of `device`, known or computed.
pub(crate) fn field_of(device: &Device) -> Result<PadField, Failure> {
    obtained(|step| field_cache::field_of(device, step))
}

/// The same of a pad that a search comes to; none where it cannot be had.
pub(crate) fn solve(device: &Device) -> Option<PadField> {
    field_of(device).ok()
}

/// The changes of the field of `device` by flaws of a module; empty where they cannot be computed.
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

/// The changes of the field of `device` by flaws, known or computed.
fn changes_of(device: &Device) -> Result<FieldChanges, Failure> {
    obtained(|step| field_cache::changes_of(device, step))
}

fn obtained<T>(
    obtain: impl FnOnce(&mut dyn FnMut(fmt::Arguments<'_>)) -> Result<Obtained<T>, FieldError>,
) -> Result<T, Failure> {
    let mut progress = None;
    let mut step = |what: fmt::Arguments<'_>| {
        progress.get_or_insert_with(|| Progress::begin(what)).step(what);
    };
    let obtained = obtain(&mut step)?;
    // The line goes before anything else is said.
    drop(progress);
    if let Some((path, error)) = &obtained.not_kept {
        let (path, why) = (path.display(), reason(error));
        say(format_args!("the pad's field is not kept for the next run: {path}: {why}"));
    }
    Ok(obtained.known)
}

impl From<FieldError> for Failure {
    fn from(error: FieldError) -> Self {
        Self::Failed(error.to_string())
    }
}
