//! The files of a live verb, checked while all of them are still whole.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use super::output::Output;
use crate::cli::failure::Failure;
use crate::cli::playing::profile;
use crate::cli::printing::written::{is_same, is_stdout, say, written_over};
use tactpad::bridge::transport::address::PadAddress;
use tactpad::pipeline::capture::reader::{CaptureError, CaptureReader};

/// The files that a live verb reads and writes.
pub(super) struct Files<'a> {
    pub(super) pad: &'a PadAddress,
    pub(super) profile: &'a str,
    pub(super) output: &'a Output,
    /// The decoder that is read.
    pub(super) decoder: Option<&'a Path>,
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
        if let Output::Log(log) = self.output {
            keep_capture(log, "")?;
        }
        source.map_or(Ok(()), check_capture)
    }

    fn keep_apart(&self, source: Option<&Path>) -> Result<(), Failure> {
        let log = match self.output {
            Output::Log(path) => Some(path.as_path()),
            _ => None,
        };
        let profile = profile::file(self.profile);
        for written in [self.capture, log].into_iter().flatten() {
            let read = [
                (source, "is what is played"),
                (profile.as_deref(), "is the profile"),
                (self.decoder, "is the decoder"),
            ];
            for (read, what) in read {
                if read.is_some_and(|read| is_same(read, written)) {
                    return Err(written_over(written, what));
                }
            }
        }
        if self.capture.is_some_and(is_stdout) && *self.output == Output::Stdout {
            return Err(Failure::Unusable("the capture and --output log:- both print: name a file".into()));
        }
        match (self.capture, log) {
            (Some(capture), Some(log)) if is_same(capture, log) => Err(written_over(log, "is the capture")),
            _ => Ok(()),
        }
    }
}

/// Refuses to write over a capture that holds play; `way_out` goes on where another name is the first way out.
pub(super) fn keep_capture(written: &Path, way_out: &str) -> Result<(), Failure> {
    if is_stdout(written) || !holds_play(written) {
        return Ok(());
    }
    Err(Failure::Unusable(format!("{} is a capture: name another file{way_out}", written.display())))
}

/// Refuses to record over a file that holds anything but a capture without play.
pub(super) fn keep_file(written: &Path, way_out: &str) -> Result<(), Failure> {
    keep_capture(written, way_out)?;
    let has_something = fs::metadata(written).is_ok_and(|it| it.is_file() && it.len() > 0);
    if is_stdout(written)
        || !has_something
        || matches!(begun(written), None | Some(Err(CaptureError::NoPlay)))
    {
        return Ok(());
    }
    Err(Failure::Unusable(format!(
        "{} is there already, and no capture: name another file{way_out}",
        written.display()
    )))
}

/// Whether it is a capture, be it damaged.
pub(super) fn holds_play(path: &Path) -> bool {
    begun(path).is_some_and(|begun| {
        !matches!(begun, Err(CaptureError::NotACapture | CaptureError::NoPlay | CaptureError::Io(_)))
    })
}

/// A file's beginning, read as a capture; `None` for what is no file or cannot be read.
fn begun(path: &Path) -> Option<Result<CaptureReader<BufReader<File>>, CaptureError>> {
    // Asked before it is opened: opening a pipe would wait for its other end.
    let file = fs::metadata(path).is_ok_and(|it| it.is_file()).then(|| File::open(path).ok()).flatten();
    file.map(|file| CaptureReader::new(BufReader::new(file)))
}

/// Reads a capture to its end, if that does not use it up. What cannot even be opened is told by who opens it.
fn check_capture(path: &Path) -> Result<(), Failure> {
    let Some(file) = File::open(path).ok().filter(|file| file.metadata().is_ok_and(|file| file.is_file()))
    else {
        return Ok(());
    };
    let error = CaptureReader::new(BufReader::new(file)).map_or_else(Some, first_error);
    match error {
        None => Ok(()),
        Some(error @ (CaptureError::CutOff { .. } | CaptureError::Missing { .. })) => {
            say(format_args!("{} {error}", path.display()));
            Ok(())
        }
        Some(error) => Err(Failure::Unusable(format!("{} {error}", path.display()))),
    }
}

/// The first error of a capture. A pad that is played needs none of the profiles in it.
fn first_error(mut capture: CaptureReader<BufReader<File>>) -> Option<CaptureError> {
    loop {
        match capture.next_call()? {
            Ok(_) | Err(CaptureError::Profile { .. }) => {}
            Err(error) => return Some(error),
        }
    }
}
