//! The field of a verb's pad, with a line that says how far its computation is.

use super::failure::Failure;
use super::progress::Progress;
use super::written::{reason, say};
use tactpad::lab::field_cache::{self, FieldError};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;

/// The field of `device`, known or computed.
pub(super) fn field_of(device: &Device) -> Result<PadField, Failure> {
    let mut progress = None;
    let step = |what: std::fmt::Arguments<'_>| {
        progress.get_or_insert_with(|| Progress::begin(what)).step(what);
    };
    let obtained = field_cache::field_of(device, step)?;
    // The line goes before anything else is said.
    drop(progress);
    if let Some((path, error)) = &obtained.not_kept {
        let (path, why) = (path.display(), reason(error));
        say(format_args!("the pad's field is not kept for the next run: {path}: {why}"));
    }
    Ok(obtained.field)
}

impl From<FieldError> for Failure {
    fn from(error: FieldError) -> Self {
        Self::Failed(error.to_string())
    }
}
