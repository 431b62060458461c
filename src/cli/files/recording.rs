//! A capture that a verb reads from its begin to its end.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use crate::cli::failure::Failure;
use crate::cli::files::decoder_file::DecoderChoice;
use crate::cli::printing::written::say;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::reader::{CaptureError, CaptureReader};
use tactpad::pipeline::contact::{Decoder, read};
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::time::HostInstant;

/// The policy for profiles that were chosen while the recording went on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Profiles {
    /// They are calls like others.
    Followed,
    /// They are passed over: another profile is asked about.
    Skipped,
}

/// A capture that was opened.
pub(crate) struct Recording {
    path: PathBuf,
    capture: CaptureReader<BufReader<File>>,
}

impl Recording {
    /// Opens it and reads what it begins with.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let file = File::open(path).map_err(|error| unusable(path, &CaptureError::Io(error)))?;
        let capture = CaptureReader::new(BufReader::new(file)).map_err(|error| unusable(path, &error))?;
        Ok(Self { path: path.to_owned(), capture })
    }

    /// The profile that it was recorded with.
    pub(crate) fn profile(&self) -> Result<Profile, Failure> {
        self.capture.head().profile.as_ref().map(|read| read.profile().clone()).ok_or_else(|| {
            let path = self.path.display();
            Failure::Unusable(format!("{path} names no usable profile; choose one with --profile"))
        })
    }

    /// The decoder that is chosen, else the recorded one.
    pub(crate) fn decoder(&self, chosen: &DecoderChoice) -> Result<Decoder, Failure> {
        if chosen.is_given() {
            // What it plays is looked at, not felt: one that cannot play will do.
            return Ok(chosen.read_by(read::tared)?.0);
        }
        self.capture.head().read_decoder().map_err(|why| {
            let path = self.path.display();
            Failure::Unusable(format!(
                "{path} was recorded with a decoder that cannot be read: {why}; replay it with the tactpad that \
                 recorded it, or choose a decoder with --decoder"
            ))
        })
    }

    /// Hands on its calls. One that is only cut off is told about.
    pub(crate) fn each(
        &mut self,
        profiles: Profiles,
        mut see: impl FnMut(HostInstant, Call<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        while let Some(call) = self.capture.next_call() {
            match call {
                Ok((_, Call::Profile(_))) | Err(CaptureError::Profile { .. })
                    if profiles == Profiles::Skipped => {}
                Ok((now, call)) => see(now, call)?,
                Err(error @ (CaptureError::CutOff { .. } | CaptureError::Missing { .. })) => {
                    say(format_args!("{} {error}", self.path.display()));
                }
                Err(error) => return Err(unusable(&self.path, &error)),
            }
        }
        Ok(())
    }
}

fn unusable(path: &Path, error: &CaptureError) -> Failure {
    Failure::Unusable(format!("{} {error}", path.display()))
}
