//! Which reports `diagnose` has written, so that they are found again: a list of folders, in the user's folder of states.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use super::destination::Destination;

/// So many are remembered.
const REMEMBERED_MAX: usize = 50;

/// Where the list is; `None` where the user has no home.
fn list() -> Option<PathBuf> {
    let whole = |name| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let state = whole("XDG_STATE_HOME").or_else(|| Some(whole("HOME")?.join(".local/state")))?;
    Some(state.join("tactpad").join("reports"))
}

/// Remembers a report. What cannot be remembered is still written.
pub(super) fn remember(folder: &Path) {
    let (Some(list), Ok(folder)) = (list(), fs::canonicalize(folder)) else { return };
    let mut folders: Vec<PathBuf> = folders().into_iter().filter(|known| *known != folder).collect();
    folders.push(folder);
    let newest = folders.iter().skip(folders.len().saturating_sub(REMEMBERED_MAX));
    // A name with a newline would be two names.
    let lines: String = newest
        .filter_map(|path| path.to_str().filter(|it| !it.contains('\n')))
        .map(|it| format!("{it}\n"))
        .collect();
    if let Some(parent) = list.parent()
        && fs::create_dir_all(parent).is_ok()
    {
        let _ = Destination::of(&list).and_then(|to| to.write(lines.as_bytes()));
    }
}

/// The folders on the list, the oldest first.
pub(super) fn folders() -> Vec<PathBuf> {
    let text = list().and_then(|list| fs::read_to_string(list).ok()).unwrap_or_default();
    text.lines().map(PathBuf::from).filter(|path| path.is_absolute()).collect()
}
