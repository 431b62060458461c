//! Files that a verb is to write: tried before the work, written beside what is there and put in its place after it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::cli::failure::Failure;
use crate::cli::printing::written::{Named, is_stdout, reason, stdout};

/// More symbolic links after each other are a circle.
const LINKS_MAX: usize = 40;

/// Where output goes. Nothing is changed before [`Destination::begin`], and no unfinished file lies about meanwhile.
#[derive(Debug)]
pub(crate) struct Destination {
    /// Display name.
    place: String,
    way: Way,
}

#[derive(Debug)]
enum Way {
    Stdout,
    /// A device, a pipe, or a file in a folder that takes no other: written as it stands.
    Straight(PathBuf),
    /// A file: written beside it, and renamed.
    Beside(PathBuf),
}

impl Destination {
    /// Tries whether `path` can be written. `-` is standard output.
    pub(crate) fn of(path: &Path) -> Result<Self, Failure> {
        let place = path.display().to_string();
        if is_stdout(path) {
            return Ok(Self { place, way: Way::Stdout });
        }
        let way = way_to(path).map_err(|error| {
            Failure::Unusable(format!("{place} cannot be written: {}; name another file", reason(&error)))
        })?;
        Ok(Self { place, way })
    }

    /// Begins to write.
    pub(crate) fn begin(&self) -> Result<Writing<'_>, Failure> {
        let unwritten = |error| self.unwritten(&error);
        let to = match &self.way {
            Way::Stdout => To::Straight(Box::new(stdout())),
            Way::Straight(path) => To::Straight(Box::new(File::create(path).map_err(unwritten)?)),
            Way::Beside(path) => To::Beside(beside(path).map_err(unwritten)?, path),
        };
        Ok(Writing { to: Named::new(to, self.place.clone()), destination: self })
    }

    /// Writes all of it.
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        let mut writing = self.begin()?;
        writing.write_all(bytes)?;
        writing.finish()
    }

    fn unwritten(&self, error: &io::Error) -> Failure {
        Failure::Failed(format!("{} cannot be written: {}", self.place, reason(error)))
    }
}

/// A file as far as it is written. Dropped before [`Writing::finish`], it leaves what was there.
pub(crate) struct Writing<'d> {
    to: Named<To<'d>>,
    destination: &'d Destination,
}

enum To<'d> {
    Straight(Box<dyn Write>),
    Beside(NamedTempFile, &'d Path),
}

impl Writing<'_> {
    /// Puts the file in its place.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.flush()?;
        let To::Beside(file, path) = self.to.into_inner() else { return Ok(()) };
        file.persist(path).map(drop).map_err(|refused| {
            let why = reason(&refused.error);
            let kept = refused.file.into_temp_path().keep();
            let kept =
                kept.map_or_else(|_| String::new(), |kept| format!("; it is kept as {}", kept.display()));
            Failure::Failed(format!("{} cannot be replaced: {why}{kept}", self.destination.place))
        })
    }
}

impl Write for Writing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.to.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

impl Write for To<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Straight(to) => to.write(bytes),
            Self::Beside(file, _) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Straight(to) => to.flush(),
            Self::Beside(file, _) => file.flush(),
        }
    }
}

/// A folder of output, such as figures.
#[derive(Debug)]
pub(crate) struct Folder(PathBuf);

impl Folder {
    /// Tries whether files can be made in the folder, which is made if there is none.
    pub(crate) fn of(path: &Path) -> Result<Self, Failure> {
        let refused = |what: &str, error: &io::Error| {
            let why = reason(error);
            Failure::Unusable(format!("{} cannot be {what}: {why}; name another folder", path.display()))
        };
        if path.exists() && !path.is_dir() {
            return Err(Failure::Unusable(format!("{} is no folder; name another", path.display())));
        }
        fs::create_dir_all(path).map_err(|error| refused("made", &error))?;
        takes_files(path).map_err(|error| refused("written to", &error))?;
        Ok(Self(path.to_owned()))
    }

    /// Writes one of its files, and says its path.
    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<String, Failure> {
        let path = self.0.join(name);
        Destination::of(&path)?.write(bytes)?;
        Ok(path.display().to_string())
    }
}

/// How to write to `path`, if that can be.
fn way_to(path: &Path) -> io::Result<Way> {
    let target = target(path);
    match fs::metadata(&target) {
        Ok(there) if there.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(there) if !there.is_file() || is_open(&target) => {
            // Opening a pipe would wait for its other end.
            if there.is_file() || is_device(&there) {
                OpenOptions::new().write(true).open(&target)?;
            }
            Ok(Way::Straight(target))
        }
        Ok(_) => {
            OpenOptions::new().write(true).open(&target)?;
            Ok(if takes_files(folder_of(&target)).is_ok() {
                Way::Beside(target)
            } else {
                Way::Straight(target)
            })
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound && !names_a_folder(path) => {
            takes_files(folder_of(&target))?;
            Ok(Way::Beside(target))
        }
        Err(error) => Err(error),
    }
}

/// Where symbolic links lead. One of the program's own open files stays what it is.
fn target(path: &Path) -> PathBuf {
    let mut target = path.to_owned();
    for _ in 0..LINKS_MAX {
        match fs::read_link(&target) {
            Ok(next) if !is_open(&target) => {
                target = target.parent().unwrap_or_else(|| Path::new("")).join(next);
            }
            _ => break,
        }
    }
    target
}

/// Whether the path names a file that is open already, as `/dev/stdout` does.
fn is_open(path: &Path) -> bool {
    path.starts_with("/proc") || path.starts_with("/dev/fd")
}

fn names_a_folder(path: &Path) -> bool {
    path.file_name().is_none() || path.as_os_str().as_encoded_bytes().ends_with(b"/")
}

#[cfg(unix)]
fn is_device(there: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    there.file_type().is_char_device() || there.file_type().is_block_device()
}

#[cfg(not(unix))]
fn is_device(_there: &fs::Metadata) -> bool {
    false
}

/// A new file in the folder of `path`; it is removed when it is dropped. It has the owner and the permissions of
/// what is there.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".tactpad-").suffix(".unfinished");
    as_new_files_are(&mut builder);
    let file = builder.tempfile_in(folder_of(path))?;
    if let Ok(there) = fs::metadata(path) {
        give_to_owner(file.as_file(), &there);
        file.as_file().set_permissions(there.permissions())?;
    }
    Ok(file)
}

/// Makes a file without a name in the folder, which is gone at once.
fn takes_files(folder: &Path) -> io::Result<()> {
    tempfile::tempfile_in(folder).map(drop)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// Everybody may read them, but for what the user's mask takes away.
#[cfg(unix)]
fn as_new_files_are(builder: &mut Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn as_new_files_are(_builder: &mut Builder<'_, '_>) {}

/// Who may not give files away has one that is his own.
#[cfg(unix)]
fn give_to_owner(file: &File, there: &fs::Metadata) {
    use std::os::unix::fs::{MetadataExt, fchown};
    let _ = fchown(file, Some(there.uid()), Some(there.gid()));
}

#[cfg(not(unix))]
fn give_to_owner(_file: &File, _there: &fs::Metadata) {}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names in a folder, in order.
    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<_> = entries.map(|name| name.into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn an_old_file_stays_until_the_new_one_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old");
        fs::write(&path, "precious").unwrap();
        let destination = Destination::of(&path).unwrap();
        assert_eq!(names(folder.path()), ["old"], "nothing lies about while the verb works");
        let mut broken_off = destination.begin().unwrap();
        broken_off.write_all(b"half").unwrap();
        assert_eq!(names(folder.path()).len(), 2);
        drop(broken_off);
        assert_eq!(
            (fs::read(&path).unwrap(), names(folder.path())),
            (b"precious".into(), vec!["old".into()])
        );
        destination.write(b"new").unwrap();
        assert_eq!((fs::read(&path).unwrap(), names(folder.path())), (b"new".into(), vec!["old".into()]));
    }

    #[test]
    fn what_cannot_be_written_is_known_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let (file, taken) = (folder.path().join("file"), folder.path().join("taken"));
        fs::write(&file, "").unwrap();
        fs::create_dir(&taken).unwrap();
        let long = folder.path().join("x".repeat(300));
        let slash = PathBuf::from(format!("{}/", folder.path().join("new").display()));
        for path in
            [&taken, &folder.path().join("no/file"), &file.join("below"), &long, &slash, Path::new("")]
        {
            let Err(Failure::Unusable(why)) = Destination::of(path) else { panic!("{path:?} passes") };
            assert!(why.contains("cannot be written") && why.contains("name another file"), "{why}");
        }
        for path in [&file, &file.join("below"), Path::new("/proc/new")] {
            let Err(Failure::Unusable(why)) = Folder::of(path) else { panic!("{path:?} passes") };
            assert!(why.contains("name another"), "{why}");
        }
        assert_eq!(names(folder.path()), ["file", "taken"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let [file, link, dangling] = ["file", "link", "dangling"].map(|name| folder.path().join(name));
        fs::write(&file, "old").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("file", &link).unwrap();
        symlink("new", &dangling).unwrap();
        for path in [&link, &dangling] {
            Destination::of(path).unwrap().write(b"written").unwrap();
            assert!(path.is_symlink() && fs::read(path).unwrap() == b"written", "{path:?}");
        }
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o7777, 0o640);
        let (new, usual) = (fs::metadata(folder.path().join("new")).unwrap(), folder.path().join("usual"));
        fs::write(&usual, "").unwrap();
        assert_eq!(new.permissions(), fs::metadata(usual).unwrap().permissions());
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_pipes_are_written_as_they_stand() {
        for place in ["/dev/null", "/dev/stdout"] {
            let destination = Destination::of(Path::new(place)).unwrap();
            assert!(matches!(destination.way, Way::Straight(_)), "{place}");
        }
        let full = Destination::of(Path::new("/dev/full")).unwrap();
        let Err(Failure::Failed(why)) = full.write(b"x") else { panic!("a full disk takes it") };
        assert_eq!(why, "cannot write /dev/full: No space left on device");
    }
}
