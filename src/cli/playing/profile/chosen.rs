//! The profile that a NAME stands for: the user's own, one inside the program, or a file.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::own;
use crate::cli::failure::Failure;
use crate::cli::files::text_file;
use crate::cli::printing::written::printable;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::mapping::read::shipped;

/// A profile's text and what findings call the place where it stands.
pub(super) struct ProfileSource {
    pub(super) text: String,
    pub(super) place: String,
}

/// The file that is read for the profile `name`; `None` where that is one inside the program.
pub(crate) fn file(name: &str) -> Option<PathBuf> {
    own::file(name).or_else(|| shipped::text(name).is_none().then(|| PathBuf::from(name)))
}

/// Whether it is the name of the user's own profile, or of one inside the program.
#[cfg(target_os = "linux")]
pub(crate) fn is_known(name: &str) -> bool {
    own::file(name).is_some() || shipped::text(name).is_some()
}

/// All names that are known.
pub(crate) fn known() -> Vec<String> {
    let own = own::names();
    let shipped = shipped::names().map(str::to_owned);
    let more: Vec<_> = own.into_iter().filter(|name| shipped::text(name).is_none()).collect();
    shipped.chain(more).collect()
}

/// The error for a name that no profile has.
pub(super) fn unknown(name: &str) -> Failure {
    Failure::Unusable(format!(
        "there is no profile {name:?}: choose one of {}, or give a file",
        known().join(", ")
    ))
}

/// The text of the profile `name`. A name with a dot or a slash is a file's.
pub(super) fn find(name: &str) -> Result<ProfileSource, Failure> {
    let Some(path) = file(name) else {
        let text = shipped::text(name).unwrap_or_default().to_owned();
        return Ok(ProfileSource { text, place: name.to_owned() });
    };
    if path == Path::new(name) && !name.contains(['.', '/']) && !path.exists() {
        return Err(unknown(name));
    }
    let place = printable(&path.display().to_string());
    let text = text_file::read(&path).map_err(|why| {
        let known = known().join(", ");
        Failure::Unusable(format!(
            "profile {place} cannot be read: {why}; name another file, or one of {known}"
        ))
    })?;
    Ok(ProfileSource { text, place })
}

/// The profile after `name`, in the order of `profile list`, that can be used and from which a press leads on, with its name.
#[cfg(target_os = "linux")]
pub(crate) fn next(name: &str, output: OutputChoice) -> Option<(String, ReadProfile)> {
    let known = known();
    let at = known.iter().position(|it| it == name).map_or(0, |at| at + 1);
    let others = known.iter().cycle().skip(at).take(known.len()).filter(|it| *it != name);
    others.cloned().find_map(|name| {
        let read = ReadProfile::read(&find(&name).ok()?.text, output).0?;
        read.profile().leads_on().then_some((name, read))
    })
}

/// Reads a profile that is to be used. Warnings go to stderr; errors make it unusable.
pub(crate) fn read(name: &str, output: OutputChoice) -> Result<ReadProfile, Failure> {
    let (read, messages) = read_aside(name, output)?;
    // Where people cannot be warned, the profile still plays.
    let _ = io::stderr().write_all(messages.as_bytes());
    Ok(read)
}

/// The same, and the warnings for whoever tells them.
pub(crate) fn read_aside(name: &str, output: OutputChoice) -> Result<(ReadProfile, String), Failure> {
    let ProfileSource { text, place } = find(name)?;
    let (read, diagnostics) = ReadProfile::read(&text, output);
    let mut messages: String =
        diagnostics.iter().map(|diagnostic| diagnostic.render(&place) + "\n").collect();
    match read {
        Some(read) => Ok((read, messages)),
        None => {
            messages.insert_str(0, &format!("profile {place} cannot be used\n"));
            Err(Failure::Unusable(messages.trim_end().to_owned()))
        }
    }
}
