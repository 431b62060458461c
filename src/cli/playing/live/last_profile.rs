//! The profile that was played last with the tray.

use crate::cli::failure::Failure;
use crate::cli::files::state_file;

/// The file that remembers it.
const FILE: &str = "last-profile";

/// The saved choice, as `run --profile` takes it.
pub(super) fn kept() -> Option<String> {
    let text = state_file::read(FILE);
    Some(text.trim_end().to_owned()).filter(|name| !name.is_empty() && !name.contains('\n'))
}

/// Keeps it.
pub(super) fn keep(profile: &str) -> Result<(), Failure> {
    state_file::write(FILE, &format!("{profile}\n"))
}
