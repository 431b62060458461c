//! The folder for what lives as long as a bridge does: its control socket, and what it holds on an X server.

use std::env;
use std::fmt;
use std::fs::{self, DirBuilder};
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use rustix::process::getuid;

use crate::cli::failure::Failure;

/// The name of one of several bridges on a machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BridgeName(String);

impl FromStr for BridgeName {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_');
        let is_name = (1..=32).contains(&text.len()) && text.chars().all(is_plain);
        is_name.then(|| Self(text.to_owned())).ok_or("take 1 to 32 letters, digits, - and _")
    }
}

/// So many bridges of one user are told apart by a number without being named.
const NUMBERED: usize = 9;

impl BridgeName {
    /// Names for bridges that were given none, after the first: 2, 3 and so on.
    pub(super) fn numbers() -> impl Iterator<Item = Option<Self>> {
        (2..=NUMBERED).map(|number| Some(Self(number.to_string())))
    }

    /// Names for demos: demo, demo-2 and so on.
    pub(super) fn of_demos() -> impl Iterator<Item = Option<Self>> {
        let numbered = (2..=NUMBERED).map(|number| Some(Self(format!("demo-{number}"))));
        [Some(Self("demo".to_owned()))].into_iter().chain(numbered)
    }
}

impl fmt::Display for BridgeName {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(&self.0)
    }
}

/// Names of the bridges that may run; those that were killed leave theirs, too.
pub(super) fn named() -> Result<Vec<BridgeName>, Failure> {
    let files = fs::read_dir(folder()?).into_iter().flatten().flatten();
    let name = |file: String| file.strip_prefix("tactpad-")?.strip_suffix(".sock")?.parse().ok();
    let mut names: Vec<BridgeName> =
        files.filter_map(|entry| name(entry.file_name().into_string().ok()?)).collect();
    names.sort_by(|one, other| one.0.cmp(&other.0));
    Ok(names)
}

/// Where a bridge listens, of this name if it has one.
///
/// # Errors
/// See [`folder`].
pub(super) fn socket_path(name: Option<&BridgeName>) -> Result<PathBuf, Failure> {
    let file =
        name.map_or_else(|| "tactpad.sock".to_owned(), |BridgeName(name)| format!("tactpad-{name}.sock"));
    folder().map(|folder| folder.join(file))
}

/// The state file of the addresses that the page of a bridge had, of this name if it has one.
pub(super) fn page_memory(name: Option<&BridgeName>) -> String {
    name.map_or_else(|| "page-addresses".to_owned(), |BridgeName(name)| format!("page-addresses-{name}"))
}

/// The user's runtime folder, else a folder of the user's own among the temporary files.
///
/// # Errors
/// Somebody else has that folder, who could put there what is not ours.
pub(super) fn folder() -> Result<PathBuf, Failure> {
    let runtime = env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from).filter(|folder| is_own(folder));
    let folder = runtime.unwrap_or_else(|| {
        let folder = env::temp_dir().join(format!("tactpad-{}", getuid().as_raw()));
        // It may be there already, whosever it is.
        let _ = DirBuilder::new().mode(0o700).create(&folder);
        folder
    });
    if is_own(&folder) {
        Ok(folder)
    } else {
        Err(Failure::Failed(format!(
            "{} is not yours alone, so anybody could answer there: set XDG_RUNTIME_DIR to a folder that is",
            folder.display()
        )))
    }
}

/// Whether it is a folder that nobody else can write to.
fn is_own(folder: &Path) -> bool {
    fs::symlink_metadata(folder)
        .is_ok_and(|it| it.is_dir() && it.uid() == getuid().as_raw() && it.mode() & 0o022 == 0)
}
