//! The profile selection: which profile people have chosen. The bridge's host and the thread that follows files and programs share it.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::PathBuf;
use std::sync::Arc;

use crate::cli::playing::profile;
use crate::cli::printing::written::printable;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::shear::bound_to_shear;
use tactpad::source::Source;

/// The name that selects the profile by the program in the foreground.
pub(super) const AUTO: &str = "auto";

/// Default profile while none is for the program in the foreground.
pub(super) const FALLBACK: &str = "super-mario";

/// The profile that people have chosen, and the file that it comes from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ProfileSelection {
    /// Name or file of the profile in play.
    pub(super) name: String,
    /// State of its file at the time of reading.
    pub(super) stamp: Option<FileStamp>,
    /// The profile for programs that have none, where profiles follow the program in the foreground.
    pub(super) fallback: Option<String>,
    /// Number of profile requests by people so far.
    pub(super) request_count: u64,
    /// The description of the pad that it is played on, if it has one.
    pub(super) described: Option<Arc<Source>>,
}

/// The state of a file, from its metadata: it differs after a write or a replacement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FileStamp {
    path: PathBuf,
    /// Its number, its length, and the times of the last change to what is in it and what is said of it. `None` while it is not there.
    state: Option<(u64, u64, [i64; 4])>,
}

impl FileStamp {
    /// The state of the file that is read for the profile `name`; `None` where that is one inside the program.
    pub(super) fn of(name: &str) -> Option<Self> {
        let path = profile::file(name)?;
        let state = fs::metadata(&path)
            .ok()
            .map(|it| (it.ino(), it.len(), [it.mtime(), it.mtime_nsec(), it.ctime(), it.ctime_nsec()]));
        Some(Self { path, state })
    }
}

impl ProfileSelection {
    /// The selection of a command line. The state of the profile's file is read now, so that no later change is missed.
    pub(super) fn of(argument: &str) -> Self {
        let fallback = fallback(argument).map(str::to_owned);
        let name = fallback.clone().unwrap_or_else(|| argument.to_owned());
        Self { stamp: FileStamp::of(&name), name, fallback, request_count: 0, described: None }
    }

    /// The argument of a command line that makes the same selection, in any folder.
    pub(super) fn as_argument(&self) -> String {
        let path = std::path::absolute(&self.name).ok().filter(|_| !profile::is_known(&self.name));
        let whole = path.and_then(|path| path.into_os_string().into_string().ok());
        let name = whole.unwrap_or_else(|| self.name.clone());
        if self.fallback.is_some() { format!("{AUTO}:{name}") } else { name }
    }

    /// The selection after a request for another profile, or for the same one again.
    pub(super) fn requested(&self, name: Option<&str>) -> Self {
        let selection = match name {
            Some(name) => Self::of(name),
            None => Self { stamp: FileStamp::of(&self.name), ..self.clone() },
        };
        Self { request_count: self.request_count + 1, described: self.described.clone(), ..selection }
    }

    /// What of a profile does nothing on the pad, a line and more for each; nothing if that is fine.
    pub(super) fn shear_warnings(&self, named: &str, profile: &ReadProfile) -> String {
        let has_shear = self.described.as_ref().is_none_or(|pad| pad.has_shear());
        let found = if has_shear { Vec::new() } else { bound_to_shear(profile.text()) };
        found.iter().map(|found| found.render(&printable(named)) + "\n").collect()
    }
}

/// The profile that is read at the start.
pub(super) fn first(argument: &str) -> &str {
    fallback(argument).unwrap_or(argument)
}

/// The profile for programs that have none; `None` where `argument` names a profile.
fn fallback(argument: &str) -> Option<&str> {
    match argument.strip_prefix(AUTO)? {
        "" => Some(FALLBACK),
        rest => rest.strip_prefix(':').filter(|name| !name.is_empty()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_has_a_profile_to_fall_back_on() {
        let of = |asked: &str| (first(asked).to_owned(), ProfileSelection::of(asked).fallback.is_some());
        for (asked, name, follows) in [
            ("auto", "super-mario", true),
            ("auto:tetris", "tetris", true),
            ("auto:./mine.toml", "./mine.toml", true),
            ("auto:", "auto:", false),
            ("automatic", "automatic", false),
            ("tetris", "tetris", false),
        ] {
            assert_eq!(of(asked), (name.to_owned(), follows), "{asked}");
        }
    }

    #[test]
    fn a_name_ends_the_following_and_the_same_again_does_not() {
        let selection = ProfileSelection::of("auto:tetris");
        let again = selection.requested(None);
        assert_eq!(
            (again.request_count, &again.fallback, &*again.name),
            (1, &Some("tetris".into()), "tetris")
        );
        let named = again.requested(Some("contra"));
        assert_eq!((named.request_count, &named.fallback, &*named.name), (2, &None, "contra"));
        assert_eq!(named.requested(Some("auto")).fallback.as_deref(), Some("super-mario"));
    }

    #[test]
    fn a_file_that_was_written_or_replaced_has_another_state() {
        let folder = tempfile::tempdir().unwrap();
        let [path, other] = ["mine.toml", "other.toml"].map(|name| folder.path().join(name));
        let stamp = || FileStamp::of(path.to_str().unwrap()).unwrap();
        let gone = stamp();
        fs::write(&path, "a").unwrap();
        let written = stamp();
        assert_eq!(stamp(), written);
        fs::write(&other, "b").unwrap();
        fs::rename(&other, &path).unwrap();
        let replaced = stamp();
        fs::write(&path, "ab").unwrap();
        let all = [gone, written, replaced, stamp()];
        assert!((1..4).all(|last| !all[..last].contains(&all[last])), "{all:?}");
        assert_eq!(FileStamp::of("contra").filter(|it| !it.path.is_absolute()), None, "inside the program");
    }
}
