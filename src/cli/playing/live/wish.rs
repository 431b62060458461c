//! What people wish to be played, shared by the bridge's host and whoever follows files and programs.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::PathBuf;

use crate::cli::playing::profile;

/// Stands for the profile whose program is in front.
pub(super) const AUTO: &str = "auto";

/// What is played while none is for the program in front, unless people say what.
pub(super) const FALLBACK: &str = "super-mario";

/// What people wish.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wish {
    /// The profile that is played: its name or file.
    pub(super) name: String,
    /// The file that it was read from, as it was then.
    pub(super) stamp: Option<Stamp>,
    /// Where profiles follow the program in front: what is played while none is for it.
    pub(super) fallback: Option<String>,
    /// How often people have asked for a profile.
    pub(super) asked: u64,
}

/// A state of a file. A file that took its place, or was written to, has another one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    path: PathBuf,
    /// Its number, its length, and the times of the last change to what is in it and what is said of it. `None` while it is not there.
    state: Option<(u64, u64, [i64; 4])>,
}

impl Stamp {
    /// The state of the file that is read for the profile `name`; `None` where that is one inside the program.
    pub(super) fn of(name: &str) -> Option<Self> {
        let path = profile::file(name)?;
        let state = fs::metadata(&path)
            .ok()
            .map(|it| (it.ino(), it.len(), [it.mtime(), it.mtime_nsec(), it.ctime(), it.ctime_nsec()]));
        Some(Self { path, state })
    }
}

impl Wish {
    /// A wish that stands on a command line. What its profile is read from is looked at now, so that no change after this is missed.
    pub(super) fn of(asked: &str) -> Self {
        let fallback = fallback(asked).map(str::to_owned);
        let name = fallback.clone().unwrap_or_else(|| asked.to_owned());
        Self { stamp: Stamp::of(&name), name, fallback, asked: 0 }
    }

    /// What a command line says to wish the same, in whatever folder.
    #[cfg(feature = "tray")]
    pub(super) fn as_asked(&self) -> String {
        let path = std::path::absolute(&self.name).ok().filter(|_| !profile::is_known(&self.name));
        let whole = path.and_then(|path| path.into_os_string().into_string().ok());
        let name = whole.unwrap_or_else(|| self.name.clone());
        if self.fallback.is_some() { format!("{AUTO}:{name}") } else { name }
    }

    /// What is wished once somebody asks for another profile, or for the same one again.
    pub(super) fn asked(&self, name: Option<&str>) -> Self {
        let wished = match name {
            Some(name) => Self::of(name),
            None => Self { stamp: Stamp::of(&self.name), ..self.clone() },
        };
        Self { asked: self.asked + 1, ..wished }
    }
}

/// The profile that is read first.
pub(super) fn first(asked: &str) -> &str {
    fallback(asked).unwrap_or(asked)
}

/// What is played while no profile is for the program in front; `None` where `asked` names a profile.
fn fallback(asked: &str) -> Option<&str> {
    match asked.strip_prefix(AUTO)? {
        "" => Some(FALLBACK),
        rest => rest.strip_prefix(':').filter(|name| !name.is_empty()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_has_a_profile_to_fall_back_on() {
        let of = |asked: &str| (first(asked).to_owned(), Wish::of(asked).fallback.is_some());
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
        let wish = Wish::of("auto:tetris");
        let again = wish.asked(None);
        assert_eq!((again.asked, &again.fallback, &*again.name), (1, &Some("tetris".into()), "tetris"));
        let named = again.asked(Some("contra"));
        assert_eq!((named.asked, &named.fallback, &*named.name), (2, &None, "contra"));
        assert_eq!(named.asked(Some("auto")).fallback.as_deref(), Some("super-mario"));
    }

    #[test]
    fn a_file_that_was_written_or_replaced_has_another_state() {
        let folder = tempfile::tempdir().unwrap();
        let [path, other] = ["mine.toml", "other.toml"].map(|name| folder.path().join(name));
        let stamp = || Stamp::of(path.to_str().unwrap()).unwrap();
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
        assert_eq!(Stamp::of("contra").filter(|it| !it.path.is_absolute()), None, "inside the program");
    }
}
