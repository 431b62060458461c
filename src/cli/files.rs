//! The files of a live verb, checked while all of them are still whole.

use std::fs::{self, File};
use std::io::BufReader;
use std::os::unix::fs::MetadataExt;
use std::path::{self, Path};

use super::live::Output;
use super::{Failure, say};
use crate::capture::{CaptureError, CaptureReader};
use crate::mapping::shipped;
use crate::transport::address::PadAddress;

/// What a live verb reads and writes.
pub(super) struct Files<'a> {
    pub(super) pad: &'a PadAddress,
    pub(super) profile: &'a str,
    pub(super) output: &'a Output,
    /// The capture that is written.
    pub(super) capture: Option<&'a Path>,
}

impl Files<'_> {
    /// Refuses a capture that does not play to its end, and files that would be written over although they are
    /// read, or are written twice. A capture that is only cut off is told about.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let source = match self.pad {
            PadAddress::Capture { file } => Some(file.as_path()),
            _ => None,
        };
        self.keep_apart(source)?;
        source.map_or(Ok(()), check_capture)
    }

    fn keep_apart(&self, source: Option<&Path>) -> Result<(), Failure> {
        let log = match self.output {
            Output::Log(path) => Some(path.as_path()),
            _ => None,
        };
        let profile = shipped::text(self.profile).is_none().then(|| Path::new(self.profile));
        for written in [self.capture, log].into_iter().flatten() {
            for (read, what) in [(source, "is what is played"), (profile, "is the profile")] {
                if read.is_some_and(|read| is_same(read, written)) {
                    return Err(refused(written, what));
                }
            }
        }
        match (self.capture, log) {
            (Some(capture), Some(log)) if is_same(capture, log) => Err(refused(log, "is the capture")),
            _ => Ok(()),
        }
    }
}

fn refused(written: &Path, what: &str) -> Failure {
    Failure::Unusable(format!("{} {what} and would be written over: name another file", written.display()))
}

/// Whether both names lead to one file. Devices do not count: nothing is lost if `/dev/null` is written twice.
fn is_same(left: &Path, right: &Path) -> bool {
    match (fs::metadata(left), fs::metadata(right)) {
        (Ok(left), Ok(right)) => left.is_file() && (left.dev(), left.ino()) == (right.dev(), right.ino()),
        (Err(_), Err(_)) => {
            path::absolute(left).ok().is_some_and(|left| path::absolute(right).ok() == Some(left))
        }
        _ => false,
    }
}

/// Reads a capture to its end, if that does not use it up. What cannot even be opened is told by who opens it.
fn check_capture(path: &Path) -> Result<(), Failure> {
    let Some(file) = File::open(path).ok().filter(|file| file.metadata().is_ok_and(|file| file.is_file()))
    else {
        return Ok(());
    };
    let error = match CaptureReader::new(BufReader::new(file)) {
        Ok(calls) => calls.filter_map(Result::err).next(),
        Err(error) => Some(error),
    };
    match error {
        None => Ok(()),
        Some(error @ CaptureError::CutOff { .. }) => {
            say(format_args!("{} {error}", path.display()));
            Ok(())
        }
        Some(error) => Err(Failure::Unusable(format!("{} {error}", path.display()))),
    }
}
