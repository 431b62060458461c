//! The files of kept play: private, in the state folder, one for each pad and decoder.

use std::fs::{self, DirBuilder, Permissions};
use std::io::{self, Write};
use std::os::unix::fs::{DirBuilderExt, PermissionsExt};
use std::path::{Path, PathBuf};

use crate::cli::files::played;
use crate::cli::files::state_file;
use firmware_proto::identity::SerialNumber;
use tactpad::lab::play::kept::{KeptPlay, mark};

/// The folder.
const FOLDER: &str = "play";
/// The ending of their names.
const ENDING: &str = "play";
/// Of more the oldest are deleted.
const FILES_MAX: usize = 8;

/// The file of this pad and decoder; `None` where the user has no home.
pub(super) fn place(pad: SerialNumber, decoder: u64) -> Option<PathBuf> {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = pad.as_str().chars().map(plain).collect();
    // Two pads may be alike but for signs that are no part of a name.
    let both = mark(&[pad.as_str().as_bytes(), &[0], &decoder.to_le_bytes()].concat());
    state_file::place(FOLDER).map(|folder| folder.join(format!("{name}-{both:016x}.{ENDING}")))
}

/// The recorded play of this pad under this decoder. A damaged file, or another pad's, counts as empty.
pub(super) fn read(path: &Path, pad: SerialNumber, decoder: u64) -> KeptPlay {
    let bytes = played::kept_bytes(path).and_then(Result::ok);
    let kept = bytes.and_then(|bytes| KeptPlay::from_bytes(&bytes).ok());
    kept.filter(|kept| (kept.pad, kept.decoder) == (pad, decoder)).unwrap_or(KeptPlay::new(pad, decoder))
}

/// Writes it so that nobody else can read it. Who reads meanwhile finds this or what was there before.
pub(super) fn write(path: &Path, kept: &KeptPlay) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    fs::set_permissions(folder, Permissions::from_mode(0o700))?;
    let private = Permissions::from_mode(0o600);
    let mut file = tempfile::Builder::new().permissions(private).tempfile_in(folder)?;
    file.write_all(&kept.to_bytes())?;
    file.persist(path)?;
    delete_oldest(folder)
}

fn delete_oldest(folder: &Path) -> io::Result<()> {
    let mut files: Vec<_> = fs::read_dir(folder)?
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|it| it == ENDING))
        .filter_map(|path| Some((fs::metadata(&path).ok()?.modified().ok()?, path)))
        .collect();
    files.sort();
    let over = files.len().saturating_sub(FILES_MAX);
    files[..over].iter().try_for_each(|(_, path)| fs::remove_file(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pad(number: usize) -> SerialNumber {
        SerialNumber::from_ascii(&format!("A/{number}")).unwrap()
    }

    #[test]
    fn files_are_private_few_and_found_again() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("play");
        for number in 0..FILES_MAX + 3 {
            let path = folder.join(format!("{number}.{ENDING}"));
            write(&path, &KeptPlay::new(pad(number), 7)).unwrap();
            assert_eq!(read(&path, pad(number), 7), KeptPlay::new(pad(number), 7));
        }
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let files: Vec<_> = fs::read_dir(&folder).unwrap().map(|it| it.unwrap().path()).collect();
        assert_eq!((mode(&folder), files.len()), (0o700, FILES_MAX));
        assert!(files.iter().all(|path| mode(path) == 0o600));
    }

    #[test]
    fn what_is_damaged_is_begun_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.play");
        fs::write(&path, "tactpad play 1\nnonsense").unwrap();
        assert!(read(&path, pad(1), 7).windows().is_empty());
    }
}
