//! Profiles as the dashboard reads and keeps them: by names alone, in the user's own folder.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use super::{chosen, own};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::text_file;
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
    let path = match file {
        Some(path) => write_over(&path, text).map(|()| path),
        None => own::write(name, text),
    };
    let path = path.map_err(|failure| SaveError::Failed(failure.sentence()))?;
    Ok(SavedProfile { version: version(text), path: path.display().to_string() })
}

fn write_over(path: &Path, text: &str) -> Result<(), Failure> {
    Destination::of(path)?.write(text.as_bytes())
}
