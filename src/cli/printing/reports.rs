//! Which reports `diagnose` has written, so that they are found again.

use std::fs;
use std::path::{Path, PathBuf};

use crate::cli::files::state_file;

/// The page of a report, in its folder.
pub(crate) const PAGE: &str = "report.html";

/// Its numbers.
pub(crate) const DOCUMENT: &str = "report.json";

/// The file that remembers folders, a line each.
const FILE: &str = "reports";

/// So many are remembered.
const REMEMBERED_MAX: usize = 50;

/// Remembers a report. What cannot be remembered is still written.
pub(crate) fn remember(folder: &Path) {
    let Ok(folder) = fs::canonicalize(folder) else { return };
    let mut folders: Vec<PathBuf> = folders().into_iter().filter(|known| *known != folder).collect();
    folders.push(folder);
    let newest = folders.iter().skip(folders.len().saturating_sub(REMEMBERED_MAX));
    // A name with a newline would be two names.
    let names = newest.filter_map(|path| path.to_str().filter(|name| !name.contains('\n')));
    let lines: String = names.map(|name| format!("{name}\n")).collect();
    let _ = state_file::write(FILE, &lines);
}

/// The folders that are remembered, the oldest first.
pub(crate) fn folders() -> Vec<PathBuf> {
    state_file::read(FILE).lines().map(PathBuf::from).filter(|path| path.is_absolute()).collect()
}
