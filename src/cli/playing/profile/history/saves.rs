//! The last saves of each of the user's own profiles, so that each of them can be restored.
//!
//! Each is a file of its own beside the others, put in its place whole. What stands in a profile is recorded before it is written over, whoever wrote
//! it: so a kill between two steps loses nothing.

use std::fs;
use std::path::PathBuf;
use std::time::UNIX_EPOCH;

use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::{config_folder, text_file};
use crate::cli::playing::profile::own;
use crate::cli::printing::written::reason;

/// So many saves of a profile are kept.
pub(super) const SAVES_MAX: usize = 20;

/// The folder of all histories, beside that of the profiles.
const FOLDER: &str = "profile-history";

/// Digits of a save's number, so that names are in order.
const DIGITS: usize = 8;

/// One save of a profile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Save {
    /// Its number among all saves of the profile that there ever were.
    pub(super) id: u64,
    /// When, by its file, in milliseconds since 1970.
    pub(super) at_ms: u64,
    pub(super) text: String,
}

/// The saves of a profile, the newest first. What an editor wrote since is recorded first.
pub(super) fn of(name: &str) -> Vec<Save> {
    // Who can only read sees what there is.
    let _ = record_present(name);
    saves(name)
}

/// Records what stands in the profile now, if it is not the newest that is kept.
pub(crate) fn record_present(name: &str) -> Result<(), Failure> {
    let present = own::file(name).and_then(|path| text_file::read(&path).ok());
    present.map_or(Ok(()), |text| record(name, &text))
}

/// Records a text as the newest save, unless it is that already.
pub(super) fn record(name: &str, text: &str) -> Result<(), Failure> {
    let Some(folder) = folder(name) else { return Ok(()) };
    let saves = saves(name);
    if saves.first().is_some_and(|newest| newest.text == text) {
        return Ok(());
    }
    let unmade = |error: &std::io::Error| {
        Failure::Failed(format!("{} cannot be made: {}", folder.display(), reason(error)))
    };
    fs::create_dir_all(&folder).map_err(|error| unmade(&error))?;
    // A clock that was set back does not change the order.
    let id = saves.first().map_or(1, |newest| newest.id + 1);
    Destination::of(&folder.join(file_name(id)))?.write(text.as_bytes())?;
    for old in saves.iter().skip(SAVES_MAX - 1) {
        let _ = fs::remove_file(folder.join(file_name(old.id)));
    }
    Ok(())
}

/// The profile has another name from now on.
pub(super) fn rename(from: &str, to: &str) {
    let (Some(from), Some(to)) = (folder(from), folder(to)) else { return };
    // Where that name had a history of its own, both stay as they are.
    let _ = fs::rename(from, to);
}

fn folder(name: &str) -> Option<PathBuf> {
    own::is_name(name).then(|| config_folder::folder(FOLDER)).flatten().map(|folder| folder.join(name))
}

fn file_name(id: u64) -> String {
    format!("{id:0DIGITS$}.toml")
}

fn saves(name: &str) -> Vec<Save> {
    let entries = folder(name).and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let read = entries.filter_map(|entry| {
        let id = entry.file_name().to_str()?.strip_suffix(".toml")?.parse().ok()?;
        let written = entry.metadata().ok()?.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        let at_ms = u64::try_from(written.as_millis()).ok()?;
        Some(Save { id, at_ms, text: text_file::read(&entry.path()).ok()? })
    });
    let mut saves: Vec<Save> = read.collect();
    saves.sort_by_key(|save| std::cmp::Reverse(save.id));
    saves
}
