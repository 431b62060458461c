//! The fields of pads, kept from run to run: `$XDG_CACHE_HOME/tactpad`, else `$HOME/.cache/tactpad`.
//!
//! A file is named by its device's fingerprint and holds the numbers that the fingerprint is taken from, so a stale or
//! damaged one is found out and replaced. The folder may be deleted at any time.

use std::ffi::OsString;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process;

use crate::mesh::Fineness;
use crate::simulator::Simulator;
use crate::system::SolveError;
use tactpad_core::pad::changes::FieldChanges;
use tactpad_core::pad::changes::Flaw;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::{FieldFileError, PadField};
use tactpad_core::quantity::MODULES;

/// What the computation of a field takes at most: it was seen to take 1.15 GB.
const MEMORY: u64 = 1_300 << 20;

/// A pad's field or the like, and whether the next run finds it.
#[derive(Debug)]
pub struct Obtained<T> {
    /// What was asked for.
    pub known: T,
    /// The file in which it could not be kept, and why.
    pub not_kept: Option<(PathBuf, io::Error)>,
}

/// Why there is no field.
#[derive(Debug)]
#[non_exhaustive]
pub enum FieldError {
    /// The pad's equations have no answer here.
    Unsolved(SolveError),
    /// It is not known yet, and to compute it takes more memory than this process may have.
    NoMemory {
        /// What it may have, MB.
        allowed_mb: u64,
    },
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsolved(error) => write!(f, "the pad cannot be computed: {error}"),
            Self::NoMemory { allowed_mb } => write!(
                f,
                "this pad's field is not known yet, and to compute it takes {} MB, where this process may have {allowed_mb} MB; \
                 make it once where there is more: tactpad simulate --dataset paper --out /dev/null, with the same --device",
                MEMORY >> 20
            ),
        }
    }
}

impl std::error::Error for FieldError {}

/// The field of `device`: the program's own for the nominal pad, else the one that is kept, else computed and kept.
///
/// While it is computed, which takes some seconds, `progress` hears what is done.
///
/// # Errors
/// The pad cannot be computed. A field that cannot be kept is no error.
pub fn field_of(
    device: &Device,
    progress: impl FnMut(fmt::Arguments<'_>),
) -> Result<Obtained<PadField>, FieldError> {
    if is_nominal(device) {
        return Ok(Obtained { known: PadField::nominal(), not_kept: None });
    }
    let form = Form { extension: "field", to_bytes: PadField::to_bytes, from_bytes: PadField::from_bytes };
    obtained(device, &form, |device| computed(device, progress))
}

/// The field of `device` in the same way, and nobody hears how far it is; `None` where it cannot be had.
pub fn solve(device: &Device) -> Option<PadField> {
    field_of(device, |_| ()).ok().map(|obtained| obtained.known)
}

/// What flaws change in the field of `device`, in the same way.
///
/// # Errors
/// As for [`field_of`].
pub fn changes_of(
    device: &Device,
    progress: impl FnMut(fmt::Arguments<'_>),
) -> Result<Obtained<FieldChanges>, FieldError> {
    if is_nominal(device) {
        return Ok(Obtained { known: FieldChanges::nominal(), not_kept: None });
    }
    let form =
        Form { extension: "changes", to_bytes: FieldChanges::to_bytes, from_bytes: FieldChanges::from_bytes };
    obtained(device, &form, |device| computed_changes(device, progress))
}

fn is_nominal(device: &Device) -> bool {
    device.field_text() == Device::nominal().field_text()
}

/// What is kept of a device in a file.
struct Form<T> {
    extension: &'static str,
    to_bytes: fn(&T, &Device) -> Vec<u8>,
    from_bytes: fn(&[u8], &Device) -> Result<T, FieldFileError>,
}

/// What is kept, else what is computed, which is then kept.
fn obtained<T>(
    device: &Device,
    form: &Form<T>,
    compute: impl FnOnce(&Device) -> Result<T, FieldError>,
) -> Result<Obtained<T>, FieldError> {
    let path =
        folder(|name| std::env::var_os(name)).map(|folder| folder.join(file_name(device, form.extension)));
    if let Some(known) = path.as_deref().and_then(|path| kept(path, device, form)) {
        return Ok(Obtained { known, not_kept: None });
    }
    if let Some(allowed) = memory_max(Path::new("/")).filter(|allowed| *allowed < MEMORY) {
        // Killed by the system, it could not say so.
        return Err(FieldError::NoMemory { allowed_mb: allowed >> 20 });
    }
    let computed = compute(device)?;
    let bytes = (form.to_bytes)(&computed, device);
    let not_kept = path.and_then(|path| Some((keep(&path, &bytes).err()?, path)));
    // The file's numbers are rounded. What this run computes with is what the next one will find.
    let known = (form.from_bytes)(&bytes, device).unwrap_or(computed);
    Ok(Obtained { known, not_kept: not_kept.map(|(error, path)| (path, error)) })
}

/// Where fields are kept, by the environment's variables; the base must be an absolute path (XDG Base Directory
/// Specification, version 0.8).
fn folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let absolute = |name| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let base = absolute("XDG_CACHE_HOME").or_else(|| absolute("HOME").map(|home| home.join(".cache")));
    base.map(|base| base.join("tactpad"))
}

fn file_name(device: &Device, extension: &str) -> String {
    format!("{:016x}.{extension}", device.fingerprint())
}

/// A file that cannot be used is as good as none.
fn kept<T>(path: &Path, device: &Device, form: &Form<T>) -> Option<T> {
    (form.from_bytes)(&fs::read(path).ok()?, device).ok()
}

/// Writes a file that others see whole or not at all.
fn keep(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let unfinished = path.with_extension(process::id().to_string());
    let kept = fs::write(&unfinished, bytes).and_then(|()| fs::rename(&unfinished, path));
    if kept.is_err() {
        // It may not even be there.
        let _ = fs::remove_file(&unfinished);
    }
    kept
}

/// What the system lets this process have: the least limit of its control group and of those around it (cgroup v2), as
/// systemd's `MemoryMax` sets it. `None` without a limit, and where there are no such groups.
fn memory_max(root: &Path) -> Option<u64> {
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let group = groups.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let folder = root.join("sys/fs/cgroup");
    let limit = |group: &Path| fs::read_to_string(folder.join(group).join("memory.max")).ok();
    Path::new(group).ancestors().filter_map(limit).filter_map(|text| text.trim().parse().ok()).min()
}

fn computed(device: &Device, mut progress: impl FnMut(fmt::Arguments<'_>)) -> Result<PadField, FieldError> {
    let mut simulator = Simulator::new(Fineness::STANDARD);
    for module in 0..MODULES {
        progress(format_args!("computing the pad's field: module {} of {MODULES}", module + 1));
        simulator.solve(device, module).map_err(FieldError::Unsolved)?;
    }
    progress(format_args!("computing the pad's field: plate"));
    simulator.field(device).map_err(FieldError::Unsolved)
}

fn computed_changes(
    device: &Device,
    mut progress: impl FnMut(fmt::Arguments<'_>),
) -> Result<FieldChanges, FieldError> {
    let mut simulator = Simulator::new(Fineness::STANDARD);
    progress(format_args!("computing the pad's field"));
    let whole = simulator.pad(device).map_err(FieldError::Unsolved)?.signals();
    let change = |flaw| {
        progress(format_args!("computing the pad's field where module 0 is flawed: {flaw}"));
        simulator.change(device, &whole, flaw).map_err(FieldError::Unsolved)
    };
    Flaw::all().map(change).collect::<Result<_, _>>().map(FieldChanges)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_for(variables: &[(&str, &str)]) -> Option<PathBuf> {
        folder(|name| variables.iter().find(|(known, _)| *known == name).map(|(_, value)| value.into()))
    }

    #[test]
    fn the_folder_is_the_users_cache() {
        let wanted = |path: &str| Some(PathBuf::from(path));
        assert_eq!(folder_for(&[("XDG_CACHE_HOME", "/c"), ("HOME", "/h")]), wanted("/c/tactpad"));
        assert_eq!(folder_for(&[("HOME", "/h")]), wanted("/h/.cache/tactpad"));
        assert_eq!(folder_for(&[("XDG_CACHE_HOME", ""), ("HOME", "/h")]), wanted("/h/.cache/tactpad"));
        assert_eq!(folder_for(&[("XDG_CACHE_HOME", "c"), ("HOME", "")]), None);
    }

    #[test]
    fn a_kept_file_reads_back_and_another_devices_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let (device, field) = (Device::nominal(), PadField::nominal());
        let form =
            Form { extension: "field", to_bytes: PadField::to_bytes, from_bytes: PadField::from_bytes };
        let path = folder.path().join("new/folder").join(file_name(&device, form.extension));
        assert!(kept(&path, &device, &form).is_none());
        keep(&path, b"damaged").unwrap();
        assert!(kept(&path, &device, &form).is_none());
        keep(&path, &field.to_bytes(&device)).unwrap();
        assert!(kept(&path, &device, &form).is_some_and(|read| read.signals == field.signals));
        let mut other = device;
        other.plate.thickness_mm = 1.5;
        assert!(kept(&path, &other, &form).is_none());
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "nothing unfinished is left");
    }

    #[test]
    fn the_least_limit_of_all_groups_counts() {
        let root = tempfile::tempdir().unwrap();
        let groups = root.path().join("sys/fs/cgroup");
        fs::create_dir_all(groups.join("user.slice/tactpad.service")).unwrap();
        fs::create_dir_all(root.path().join("proc/self")).unwrap();
        assert_eq!(memory_max(root.path()), None);
        fs::write(root.path().join("proc/self/cgroup"), "0::/user.slice/tactpad.service\n").unwrap();
        fs::write(groups.join("user.slice/memory.max"), "max\n").unwrap();
        assert_eq!(memory_max(root.path()), None);
        fs::write(groups.join("user.slice/tactpad.service/memory.max"), "67108864\n").unwrap();
        assert_eq!(memory_max(root.path()), Some(64 << 20));
        let told = FieldError::NoMemory { allowed_mb: 64 }.to_string();
        assert!(
            told.contains("may have 64 MB") && told.contains("tactpad simulate --dataset paper"),
            "{told}"
        );
    }

    #[test]
    fn what_cannot_be_written_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("taken.field");
        fs::create_dir_all(taken.join("full")).unwrap();
        assert!(keep(&taken, b"bytes").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
