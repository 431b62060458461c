//! The profile that was played last with the tray, kept in `$XDG_STATE_HOME/tactpad/last-profile`, else below `~/.local/state`.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;

use crate::cli::destination::Destination;
use crate::cli::failure::Failure;

/// The file, which need not be there; `None` where the user has no home.
fn file() -> Option<PathBuf> {
    file_in(env::var_os("XDG_STATE_HOME"), env::var_os("HOME"))
}

fn file_in(state: Option<OsString>, home: Option<OsString>) -> Option<PathBuf> {
    let whole = |path: Option<OsString>| path.map(PathBuf::from).filter(|path| path.is_absolute());
    let state = whole(state).or_else(|| Some(whole(home)?.join(".local").join("state")))?;
    Some(state.join("tactpad").join("last-profile"))
}

/// What was kept, as `run --profile` takes it.
pub(super) fn kept() -> Option<String> {
    let text = fs::read_to_string(file()?).ok()?;
    Some(text.trim_end().to_owned()).filter(|name| !name.is_empty() && !name.contains('\n'))
}

/// Keeps it. A start meanwhile finds this one or the one before it.
pub(super) fn keep(profile: &str) -> Result<(), Failure> {
    let Some(file) = file() else { return Ok(()) };
    file.parent().map_or(Ok(()), fs::create_dir_all)?;
    Destination::of(&file)?.write(format!("{profile}\n").as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relative_folder_is_no_place() {
        let at =
            |state: Option<&str>, home: Option<&str>| file_in(state.map(Into::into), home.map(Into::into));
        assert_eq!(at(Some("/s"), Some("/h")), Some("/s/tactpad/last-profile".into()));
        assert_eq!(at(Some("s"), Some("/h")), Some("/h/.local/state/tactpad/last-profile".into()));
        assert_eq!(at(None, None), None);
    }
}
