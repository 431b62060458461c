//! Play as a verb reads it: a capture, or what `tactpad run` has kept.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::decoder_file;
use super::recording::{Profiles, Recording};
use crate::cli::failure::Failure;
use crate::cli::playing::profile;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::reason;
use firmware_proto::identity::SerialNumber;
use tactpad::lab::play::kept::{BYTES_MAX, KIND, KeptPlay};
use tactpad::lab::play::reader::Reader;
use tactpad::lab::play::windows::Window;
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::shipped;

/// Recorded play.
pub(crate) struct Played {
    /// In order of time.
    pub(crate) windows: Vec<Window>,
    /// The pad, if it told.
    pub(crate) pad: Option<SerialNumber>,
}

/// Reads a capture or kept play. Touches of a capture are known by the earlier decoder, else by the nominal one.
pub(crate) fn read(path: &Path, earlier: Option<&Decoder>) -> Result<Played, Failure> {
    if let Some(bytes) = kept_bytes(path) {
        let kept = bytes.and_then(|bytes| KeptPlay::from_bytes(&bytes).map_err(|why| why.to_string()));
        let kept = kept.map_err(|why| Failure::Unusable(format!("{} {why}", path.display())))?;
        return Ok(Played { windows: kept.windows().to_vec(), pad: Some(kept.pad) });
    }
    let reader = heard(path, earlier)?;
    Ok(Played { pad: reader.serial_number(), windows: reader.finish() })
}

/// The bytes of a file that begins as kept play does; `None` for any other.
pub(crate) fn kept_bytes(path: &Path) -> Option<Result<Vec<u8>, String>> {
    // Asked before it is opened: opening a pipe would wait for its other end, and reading it would use it up.
    let is_file = std::fs::metadata(path).is_ok_and(|it| it.is_file());
    let mut file = is_file.then(|| File::open(path).ok()).flatten()?;
    let mut bytes = vec![0; KIND.len()];
    file.read_exact(&mut bytes).ok().filter(|()| bytes == KIND)?;
    let read = file.take(BYTES_MAX as u64 + 1).read_to_end(&mut bytes);
    Some(match read {
        Err(error) => Err(format!("cannot be read: {}", reason(&error))),
        Ok(_) if bytes.len() > BYTES_MAX => Err("is larger than any kept play; delete it".into()),
        Ok(_) => Ok(bytes),
    })
}

/// A capture that was read to its end.
fn heard(path: &Path, earlier: Option<&Decoder>) -> Result<Reader, Failure> {
    let _progress = Progress::begin("reading the capture");
    let mut capture = Recording::open(path)?;
    let decoder = match earlier {
        Some(decoder) => decoder.clone(),
        None => decoder_file::read(Path::new(shipped::INVERSE))?,
    };
    // Only its filter counts, so any will do.
    let profile = capture.profile().or_else(|_| any_profile())?;
    let mut reader = Reader::new(decoder, profile);
    capture.each(Profiles::Skipped, |now, call| {
        reader.apply(now, call);
        Ok(())
    })?;
    Ok(reader)
}

fn any_profile() -> Result<Profile, Failure> {
    profile::read("super-mario", OutputChoice::AsWritten).map(|read| read.profile().clone())
}
