//! Profiles as the dashboard reads and keeps them: by names alone, in the user's own folder.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use super::history::verbs::{self, ListedSave};
use super::history::{bundle, edits};
use super::{chosen, own};
use crate::cli::failure::Failure;
use crate::cli::files::{decoder_file, text_file};
use tactpad::dashboard::host::{Overwrite, ProfileEntry, SaveError, SavedProfile, StoredProfile};
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::mapping::read::shipped;

/// All profiles that have names.
pub(crate) fn entries() -> Vec<ProfileEntry> {
    chosen::known().into_iter().map(entry).collect()
}

fn entry(name: String) -> ProfileEntry {
    ProfileEntry { own: own::file(&name).is_some(), shipped: shipped::text(&name).is_some(), name }
}

/// The profile of this name; `None` if there is none, or if it is no name.
pub(crate) fn stored(name: &str) -> Option<StoredProfile> {
    let text = match own::file(name) {
        Some(path) => text_file::read(&path).ok()?,
        None => shipped::text(name)?.to_owned(),
    };
    Some(StoredProfile { version: version(&text), text, entry: entry(name.to_owned()) })
}

/// Tells one text from another.
fn version(text: &str) -> String {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

/// Keeps a profile in the user's own folder, where it stands before one of its name inside the program.
pub(crate) fn save(name: &str, text: &str, over: &Overwrite) -> Result<SavedProfile, SaveError> {
    let file = own::file(name);
    if file.is_none() {
        own::check_name(name).map_err(|failure| SaveError::Name(failure.sentence()))?;
    }
    let (read, diagnostics) = ReadProfile::read(text, OutputChoice::AsWritten);
    if read.is_none() {
        return Err(SaveError::Errors(diagnostics));
    }
    let there = stored(name).map(|stored| stored.version);
    match (over, &there) {
        (Overwrite::Nothing, _) if file.is_some() => {
            return Err(SaveError::Changed(format!(
                "there is a profile {name:?} already: choose another name"
            )));
        }
        (Overwrite::Version(wanted), _) if there.as_ref() != Some(wanted) => {
            let error = "the file was changed meanwhile: load it anew, or write over it";
            return Err(SaveError::Changed(error.into()));
        }
        _ => {}
    }
    let path = edits::put(name, text);
    let path = path.map_err(|failure| SaveError::Failed(failure.sentence()))?;
    Ok(SavedProfile { version: version(text), path: path.display().to_string() })
}

/// The saves of a profile, the newest first.
pub(crate) fn listed(name: &str) -> Vec<ListedSave> {
    verbs::listed(name)
}

/// The text of a save.
pub(crate) fn saved(name: &str, id: u64) -> Option<String> {
    verbs::saved(name, id)
}

/// Removes a profile of the user's own.
pub(crate) fn delete(name: &str) -> Result<(), SaveError> {
    edits::remove(name).map(drop).map_err(refused)
}

/// Gives a profile of the user's own another name.
pub(crate) fn rename(from: &str, to: &str) -> Result<(), SaveError> {
    edits::rename(from, to).map(drop).map_err(refused)
}

/// The user's own decoders: their names and files.
pub(crate) fn decoders() -> Vec<(String, PathBuf)> {
    bundle::decoders()
}

/// A profile as a file for export, with the user's own decoder of this name if one is named.
pub(crate) fn exported(name: &str, decoder: Option<&str>) -> Option<String> {
    let text = stored(name)?.text;
    let path = |wanted: &str| decoders().into_iter().find(|(name, _)| name == wanted);
    let decoder = match decoder {
        Some(wanted) => Some(decoder_file::whole(&path(wanted)?.1).ok()?),
        None => None,
    };
    bundle::document(name, &text, decoder.as_deref()).ok()
}

/// Makes the profile of an exported file the user's own; the path of its decoder, if one is in it.
pub(crate) fn import(document: &str, name: &str) -> Result<Option<String>, SaveError> {
    let imported = bundle::import(document, Some(name)).map_err(refused)?;
    Ok(imported.decoder.map(|path| path.display().to_string()))
}

/// What cannot be done as it was asked for, and what failed.
fn refused(failure: Failure) -> SaveError {
    match failure {
        Failure::Unusable(why) => SaveError::Name(why),
        failed => SaveError::Failed(failed.sentence()),
    }
}
