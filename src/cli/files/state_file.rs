//! Files that remember something from one run to the next, in `$XDG_STATE_HOME/tactpad`, else in `~/.local/state/tactpad`.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;

use super::destination::Destination;
use crate::cli::failure::Failure;

/// A file of this name, which need not be there; `None` where the user has no home.
pub(crate) fn place(name: &str) -> Option<PathBuf> {
    Some(folder_in(env::var_os("XDG_STATE_HOME"), env::var_os("HOME"))?.join(name))
}

fn folder_in(state: Option<OsString>, home: Option<OsString>) -> Option<PathBuf> {
    // A relative path would be another folder for each place that a program is started at.
    let whole = |path: Option<OsString>| path.map(PathBuf::from).filter(|path| path.is_absolute());
    let state = whole(state).or_else(|| Some(whole(home)?.join(".local").join("state")))?;
    Some(state.join("tactpad"))
}

/// Its text; nothing if it is not there.
pub(crate) fn read(name: &str) -> String {
    place(name).and_then(|file| fs::read_to_string(file).ok()).unwrap_or_default()
}

/// Writes it. A start meanwhile finds this text or the one before it. Where the user has no home nothing is remembered.
pub(crate) fn write(name: &str, text: &str) -> Result<(), Failure> {
    let Some(file) = place(name) else { return Ok(()) };
    file.parent().map_or(Ok(()), fs::create_dir_all)?;
    Destination::of(&file)?.write(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relative_folder_is_no_place() {
        let at =
            |state: Option<&str>, home: Option<&str>| folder_in(state.map(Into::into), home.map(Into::into));
        assert_eq!(at(Some("/s"), Some("/h")), Some("/s/tactpad".into()));
        assert_eq!(at(Some("s"), Some("/h")), Some("/h/.local/state/tactpad".into()));
        assert_eq!(at(None, None), None);
    }
}
