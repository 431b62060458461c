//! Changes of the user's own profiles. Each can be taken back, as what was there is kept before and what is there after.

use std::fs;
use std::path::{Path, PathBuf};

use super::{history, own};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::text_file;
use crate::cli::printing::written::{reason, say};

/// Writes a new profile; what is there stays. It says where.
pub(super) fn create(name: &str, text: &str) -> Result<PathBuf, Failure> {
    let path = own::write(name, text)?;
    kept_after(name, text);
    Ok(path)
}

/// Writes over the profile that stands in `path`.
pub(super) fn write_over(path: &Path, text: &str) -> Result<(), Failure> {
    let name = own::name_in_folder(path);
    name.as_deref().map_or(Ok(()), history::keep_present)?;
    Destination::of(path)?.write(text.as_bytes())?;
    if let Some(name) = name {
        kept_after(&name, text);
    }
    Ok(())
}

/// Writes the profile of this name, new or not.
pub(super) fn put(name: &str, text: &str) -> Result<PathBuf, Failure> {
    match own::file(name) {
        Some(path) => write_over(&path, text).map(|()| path),
        None => create(name, text),
    }
}

/// Removes a profile of the user's own; its history stays. One inside the program of the same name plays from then on.
pub(super) fn remove(name: &str) -> Result<PathBuf, Failure> {
    let path = own::existing(name)?;
    history::keep_present(name)?;
    fs::remove_file(&path).map_err(|error| {
        Failure::Failed(format!("{} cannot be removed: {}", path.display(), reason(&error)))
    })?;
    Ok(path)
}

/// Gives a profile of the user's own another name, under which there is none yet. Its history goes along.
pub(super) fn rename(from: &str, to: &str) -> Result<PathBuf, Failure> {
    let old = own::existing(from)?;
    own::check_name(to)?;
    history::keep_present(from)?;
    let text = text_file::read(&old)
        .map_err(|why| Failure::Failed(format!("{} cannot be read: {why}", old.display())))?;
    // The new one is there before the old one goes.
    let path = own::write(to, &text)?;
    history::rename(from, to);
    kept_after(to, &text);
    fs::remove_file(&old).map_err(|error| {
        Failure::Failed(format!("{} cannot be removed: {}", old.display(), reason(&error)))
    })?;
    Ok(path)
}

/// What was written stands; that it is not in the history is said, and mended by the next save.
fn kept_after(name: &str, text: &str) {
    if let Err(Failure::Unusable(why) | Failure::Failed(why)) = history::keep(name, text) {
        say(why);
    }
}
