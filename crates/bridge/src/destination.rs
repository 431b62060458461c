//! Files and named pipes that a bridge writes to.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use rustix::fs::{OFlags, fcntl_setfl};
use rustix::io::Errno;

/// A new file, or a named pipe. A pipe that nobody reads yet is opened by the first write, which waits for a reader: let
/// a [`crate::queue::WriteQueue`] do that.
#[derive(Debug)]
pub struct Destination {
    path: PathBuf,
    file: Option<File>,
}

impl Destination {
    /// Opens `path` without waiting for anybody. A file that is there already is replaced.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn create(path: &Path) -> io::Result<Self> {
        let is_pipe = fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo());
        let file = if is_pipe { open_read_pipe(path)? } else { Some(File::create(path)?) };
        Ok(Self { path: path.to_owned(), file })
    }

    /// Whether it is a pipe that nobody reads yet.
    pub const fn waits_for_reader(&self) -> bool {
        self.file.is_none()
    }

    fn opened(&mut self) -> io::Result<&mut File> {
        match &mut self.file {
            Some(file) => Ok(file),
            place => Ok(place.insert(OpenOptions::new().write(true).open(&self.path)?)),
        }
    }
}

/// Opens a pipe if somebody reads it.
fn open_read_pipe(path: &Path) -> io::Result<Option<File>> {
    let flags = OFlags::NONBLOCK.bits().cast_signed();
    match OpenOptions::new().write(true).custom_flags(flags).open(path) {
        Ok(file) => {
            // Only the opening was not to wait.
            fcntl_setfl(&file, OFlags::empty())?;
            Ok(Some(file))
        }
        Err(error) if error.raw_os_error() == Some(Errno::NXIO.raw_os_error()) => Ok(None),
        Err(error) => Err(error),
    }
}

impl Write for Destination {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.opened()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.opened()?.flush()
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;
    use std::thread;

    use rustix::fs::{CWD, FileType, Mode, mknodat};

    use super::*;

    #[test]
    fn a_pipe_that_nobody_reads_is_not_waited_for_until_something_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        mknodat(CWD, &path, FileType::Fifo, Mode::RWXU, 0).unwrap();
        let mut early = Destination::create(&path).unwrap();
        assert!(early.waits_for_reader());
        let reading = thread::spawn({
            let path = path.clone();
            move || {
                let mut text = String::new();
                File::open(path).unwrap().read_to_string(&mut text).unwrap();
                text
            }
        });
        early.write_all(b"here").unwrap();
        drop(early);
        assert_eq!(reading.join().unwrap(), "here");
    }

    #[test]
    fn a_file_is_replaced_and_a_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, "old text").unwrap();
        let mut file = Destination::create(&path).unwrap();
        assert!(!file.waits_for_reader());
        file.write_all(b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert!(Destination::create(folder.path()).is_err());
    }
}
