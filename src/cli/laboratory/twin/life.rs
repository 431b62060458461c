//! `--state`: the file that keeps a pad's life from one run to the next.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::printing::written::{is_stdout, reason};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::twin::life::Life;
use tactpad::tables::measured::Table;

/// Far more than any state needs.
const BYTES_MAX: u64 = 1_000_000;

/// Where a life is kept.
pub(super) struct LifeFile {
    path: PathBuf,
    to: Destination,
}

impl LifeFile {
    /// Tries whether it can be written.
    pub(super) fn of(path: &Path) -> Result<Self, Failure> {
        if is_stdout(path) {
            return Err(Failure::Unusable(
                "--state is read and written, and - can only be written: name a file".into(),
            ));
        }
        Ok(Self { path: path.to_owned(), to: Destination::of(path)? })
    }

    /// The life that it keeps; `None` if there is no such file yet.
    fn read(&self, device: &Device) -> Result<Option<Life>, Failure> {
        let unusable = |why: &str| {
            let path = self.path.display();
            Failure::Unusable(format!(
                "state {path} cannot be taken up: {why}; name another file, one that is not there yet for a new pad"
            ))
        };
        // Asked before it is opened: opening a pipe would wait for its other end.
        match fs::metadata(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Ok(there) if !there.is_file() => return Err(unusable("it is a device or a pipe")),
            _ => {}
        }
        let file = File::open(&self.path).map_err(|error| unusable(&reason(&error)))?;
        let mut bytes = Vec::new();
        file.take(BYTES_MAX).read_to_end(&mut bytes).map_err(|error| unusable(&reason(&error)))?;
        Life::from_bytes(&bytes, device).map(Some).map_err(|error| unusable(&error.to_string()))
    }

    /// Keeps it.
    pub(super) fn write(&self, life: &Life, device: &Device) -> Result<(), Failure> {
        self.to.write(&life.to_bytes(device))
    }
}

/// The life that goes on: the one that is kept, else a new one that the seed draws.
pub(super) fn begun(kept: Option<&LifeFile>, device: &Device, seed: u64) -> Result<Life, Failure> {
    let known = kept.map_or(Ok(None), |kept| kept.read(device))?;
    Ok(known.unwrap_or_else(|| Life::new(device, seed)))
}

/// The pad's age and cycles, in words.
pub(super) fn told(life: &Life) -> String {
    let (age_s, cycles) = (life.state.age_s(), life.around.cycles);
    format!("; the pad is {age_s:.0} s old and has {cycles} cycles behind it")
}

/// The same after so many cycles of load.
pub(super) fn after(cycles: Option<u32>, life: Life, device: &Device, field: &PadField) -> Life {
    match cycles {
        Some(cycles) => life.after_cycles(f64::from(cycles), device, field),
        None => life,
    }
}

/// Refuses a plan that wants the pad younger than it will be.
pub(super) fn fits(plan: &Table, path: &Path, life: &Life, cycles: Option<u32>) -> Result<(), Failure> {
    let behind = life.around.cycles + f64::from(cycles.unwrap_or(0));
    let younger =
        plan.rows.iter().find_map(|row| Some((row.line, row.cycle.filter(|cycle| *cycle < behind)?)));
    younger.map_or(Ok(()), |(line, cycle)| {
        Err(Failure::Unusable(format!(
            "{}:{line}: cycle is {cycle}, and the pad has {behind} cycles of load behind it already; plan more, or begin \
             another pad",
            path.display()
        )))
    })
}
