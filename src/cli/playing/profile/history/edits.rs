//! Edits of the user's own profiles. Each can be undone, as what was there is recorded in the history before, and what is there after.

use std::fs;
use std::path::{Path, PathBuf};

use super::saves;
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::text_file;
use crate::cli::playing::profile::own;
use crate::cli::printing::written::{reason, say};

/// Writes a new profile; what is there stays. It says where.
pub(crate) fn create(name: &str, text: &str) -> Result<PathBuf, Failure> {
    let path = own::write(name, text)?;
    record_written(name, text);
    Ok(path)
}

/// Writes over the profile that stands in `path`.
pub(crate) fn write_over(path: &Path, text: &str) -> Result<(), Failure> {
    let name = own::name_in_folder(path);
    name.as_deref().map_or(Ok(()), saves::record_present)?;
    Destination::of(path)?.write(text.as_bytes())?;
    if let Some(name) = name {
        record_written(&name, text);
    }
    Ok(())
}

/// Writes the profile of this name, new or not.
pub(crate) fn put(name: &str, text: &str) -> Result<PathBuf, Failure> {
    match own::file(name) {
        Some(path) => write_over(&path, text).map(|()| path),
        None => create(name, text),
    }
}

/// Removes a profile of the user's own; its history stays. One inside the program of the same name plays from then on.
pub(crate) fn remove(name: &str) -> Result<PathBuf, Failure> {
    let path = own::existing(name)?;
    saves::record_present(name)?;
    fs::remove_file(&path).map_err(|error| {
        Failure::Failed(format!("{} cannot be removed: {}", path.display(), reason(&error)))
    })?;
    Ok(path)
}

/// Gives a profile of the user's own another name, under which there is none yet. Its history goes along.
pub(crate) fn rename(from: &str, to: &str) -> Result<PathBuf, Failure> {
    let old = own::existing(from)?;
    own::check_name(to)?;
    saves::record_present(from)?;
    let text = text_file::read(&old)
        .map_err(|why| Failure::Failed(format!("{} cannot be read: {why}", old.display())))?;
    // The new one is there before the old one goes.
    let path = own::write(to, &text)?;
    saves::rename(from, to);
    record_written(to, &text);
    fs::remove_file(&old).map_err(|error| {
        Failure::Failed(format!("{} cannot be removed: {}", old.display(), reason(&error)))
    })?;
    Ok(path)
}

/// What was written stands; that it is not in the history is said, and mended by the next save.
fn record_written(name: &str, text: &str) {
    if let Err(Failure::Unusable(why) | Failure::Failed(why)) = saves::record(name, text) {
        say(why);
    }
}
