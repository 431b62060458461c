//! The files of calibrations from the page, in the user's own folder: decoders, and beside each the recording of its session.

use std::fs;
use std::path::PathBuf;

use super::calibrate::kept::{SessionFiles, SessionStart, capture_beside};
use super::files::holds_play;
use crate::cli::failure::Failure;
use crate::cli::files::config_folder;
use crate::cli::files::destination::Destination;
use crate::cli::printing::written::quoted;
use tactpad::dashboard::host::{KeptDecoder, SessionStore};
use tactpad::lab::play::guide::Guide;
use tactpad::lab::play::weights::Placement;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::head::Head;
use tactpad::time::HostInstant;

/// Whether a session of this name was begun.
pub(super) fn has_session(name: &str) -> bool {
    place(name).is_ok_and(|decoder| holds_play(&capture_beside(&decoder)))
}

/// Opens a session of this name.
pub(super) fn open(
    name: &str,
    fresh: bool,
    guide: &mut Guide,
    head: &Head,
) -> Result<Box<dyn SessionStore>, Failure> {
    let decoder = place(name)?;
    decoder.parent().map_or(Ok(()), fs::create_dir_all)?;
    let how = SessionStart { fresh, way_to_fresh: "choose to forget what was heard earlier" };
    Ok(Box::new(SessionFiles::begin(&decoder, how, guide, head)?))
}

/// Writes the decoder of this name.
pub(super) fn write(name: &str, bytes: &[u8]) -> Result<KeptDecoder, Failure> {
    let decoder = place(name)?;
    Destination::of(&decoder)?.write(bytes)?;
    let path = decoder.display().to_string();
    Ok(KeptDecoder { command: format!("tactpad run --decoder {}", quoted(&path)), path })
}

/// The decoder of this name, which need not be there. No name leaves the folder.
fn place(name: &str) -> Result<PathBuf, Failure> {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_');
    if name.is_empty() || !name.chars().all(is_plain) {
        return Err(Failure::Unusable(format!("{name:?} cannot be the name of a decoder")));
    }
    let folder = config_folder::folder("decoders").ok_or_else(|| {
        let why = "there is no folder for your own decoders: set HOME or XDG_CONFIG_HOME to a whole path";
        Failure::Unusable(why.into())
    })?;
    Ok(folder.join(format!("{name}.decoder")))
}

impl SessionStore for SessionFiles {
    fn at(&self, at: HostInstant) -> HostInstant {
        Self::at(self, at)
    }

    fn write(&mut self, at: HostInstant, call: Call<'_>) -> Result<(), String> {
        Self::write(self, at, call).map_err(|error| Failure::from(error).sentence())
    }

    fn settle(&mut self, placements: &[Placement]) -> Result<(), String> {
        Self::settle(self, placements).map_err(Failure::sentence)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leaves_the_folder() {
        for name in ["", ".", "..", "../x", "/etc/passwd", "a/b", "a\\b", "x.decoder", "a b", "a\0b"] {
            assert!(place(name).is_err() && !has_session(name), "{name:?}");
        }
        assert!(place("TP-0042_b").is_ok_and(|path| path.ends_with("tactpad/decoders/TP-0042_b.decoder")));
    }
}
