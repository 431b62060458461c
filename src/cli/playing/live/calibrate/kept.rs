//! The files of a session beside its decoder: a capture of all calls and a table of placements, from which a later one goes on.

use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use tempfile::Builder;

use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::recording::{Profiles, Recording};
use crate::cli::laboratory::adapt::play::read_weights;
use crate::cli::playing::live::files::{holds_play, keep_file};
use tactpad::lab::play::guide::Guide;
use tactpad::lab::play::weights::{Placement, written};
use tactpad::pad::device::Device;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::time::HostInstant;

/// Between what was heard earlier and what is heard now lie so many microseconds of the capture's time.
const BREAK_US: u64 = 1_000_000;

/// How a session begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SessionStart {
    /// Whether what was heard earlier is to be forgotten.
    pub(crate) fresh: bool,
    /// The instruction for people who want that.
    pub(crate) way_to_fresh: &'static str,
}

/// The files of a session.
pub(crate) struct SessionFiles {
    capture: CaptureWriter<BufWriter<File>>,
    weights: PathBuf,
    /// When the session began, in the capture's time.
    begin: HostInstant,
    goes_on: bool,
}

/// The capture of the session that writes this decoder.
pub(crate) fn capture_beside(out: &Path) -> PathBuf {
    beside(out, ".cap")
}

fn beside(out: &Path, ending: &str) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

impl SessionFiles {
    /// Opens the files. What an earlier session heard is told to the guide and stays in them, unless this one is to begin afresh.
    pub(crate) fn begin(
        out: &Path,
        how: SessionStart,
        guide: &mut Guide,
        head: &Head,
    ) -> Result<Self, Failure> {
        let (place, weights) = (capture_beside(out), beside(out, ".weights.csv"));
        let goes_on = spared(&place, &weights, how)?;
        let folder = place.parent().filter(|it| !it.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // As the user's other files; what the user keeps from others is taken off by the system.
        let file = Builder::new().permissions(Permissions::from_mode(0o666)).tempfile_in(folder)?;
        let to = BufWriter::new(file.as_file().try_clone()?);
        let mut capture = CaptureWriter::begin(to, HostInstant::default(), head)?;
        let mut begin = HostInstant::default();
        if goes_on {
            begin = remember(&place, how, guide, &mut capture)?;
            guide.go_on(placements(&weights)?);
        }
        capture.flush()?;
        // The old capture stays until all of it is in the new one.
        file.persist(&place).map_err(|refused| refused.error)?;
        if !goes_on {
            forget(&weights)?;
        }
        Ok(Self { capture, weights, begin, goes_on })
    }

    /// Whether it goes on from an earlier one.
    pub(super) const fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// A moment of the session in the capture's time.
    pub(crate) const fn at(&self, at: HostInstant) -> HostInstant {
        HostInstant::from_ns(self.begin.as_ns().saturating_add(at.as_ns()))
    }

    /// Writes a call down, at the capture's time.
    pub(crate) fn write(&mut self, at: HostInstant, call: Call<'_>) -> io::Result<()> {
        self.capture.write(at, call)
    }

    /// Hands everything to the files, so that it is there whatever comes.
    pub(crate) fn settle(&mut self, placements: &[Placement]) -> Result<(), Failure> {
        self.capture.flush()?;
        if placements.is_empty() {
            return Ok(());
        }
        Destination::of(&self.weights)?.write(written(placements).as_bytes())
    }
}

/// Whether there is a session to go on from. Refuses to write over what is none.
fn spared(place: &Path, weights: &Path, how: SessionStart) -> Result<bool, Failure> {
    if holds_play(place) {
        return Ok(!how.fresh);
    }
    keep_file(place, " for the decoder, so that the session's capture has another name, too")?;
    if weights.exists() && !how.fresh {
        return Err(Failure::Unusable(format!(
            "{} is there, but not the capture {} that it belongs to: {} to begin anew, or name another file",
            weights.display(),
            place.display(),
            how.way_to_fresh
        )));
    }
    Ok(false)
}

/// Tells the guide what an earlier session heard, and writes it down once more. When the new session begins, in the capture's time.
fn remember(
    place: &Path,
    how: SessionStart,
    guide: &mut Guide,
    capture: &mut CaptureWriter<BufWriter<File>>,
) -> Result<HostInstant, Failure> {
    let mut last = HostInstant::default();
    let read = Recording::open(place).and_then(|mut earlier| {
        earlier.each(Profiles::Skipped, |at, call| {
            last = at;
            guide.remember(at, call);
            Ok(capture.write(at, call)?)
        })
    });
    read.map_err(|why| Failure::Unusable(format!("{}; {} to begin anew", why.sentence(), how.way_to_fresh)))?;
    let begin = last.plus_us(BREAK_US);
    // Whatever happened to the pad meanwhile, its zero is looked for anew.
    guide.remember(begin, Call::Unplugged);
    capture.write(begin, Call::Unplugged)?;
    Ok(begin)
}

fn placements(weights: &Path) -> Result<Vec<Placement>, Failure> {
    if !weights.exists() {
        return Ok(Vec::new());
    }
    read_weights(weights, Device::nominal().contact.max_centre_radius_mm)
}

/// Removes the table of a session that is not gone on from.
fn forget(weights: &Path) -> io::Result<()> {
    match fs::remove_file(weights) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
