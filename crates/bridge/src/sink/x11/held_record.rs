//! The record of what a bridge holds on an X server. The kernel releases what a dead process held on its devices; an X server does
//! not, so the next bridge has to know.
//!
//! A record is a file of its own for each bridge, locked as long as that lives: the kernel gives the lock away when a process dies,
//! however it dies.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{FileExt, MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use rustix::fs::OFlags;

/// What is down on an X server: its numbers of keys, which begin at 8, and of the pointer's buttons, which are lower.
pub(super) type Down = BTreeSet<u8>;

/// The first line of a record.
const MAGIC: &str = "tactpad x11 1";

/// How the names of records begin.
const PREFIX: &str = "tactpad-x11-";

/// So many records there may be: more than bridges that anybody runs.
const RECORDS_MAX: u32 = 64;

/// A record is shorter, whatever its display is called.
const BYTES_MAX: u64 = 4_096;

/// The record that a living bridge writes.
#[derive(Debug)]
pub(super) struct HeldRecord {
    /// Locked.
    file: File,
    path: PathBuf,
    /// Where in the file it says what is down.
    at: u64,
    written: Down,
}

/// A record that was found.
#[derive(Debug)]
pub(super) struct FoundRecord {
    pub(super) path: PathBuf,
    /// Whether its bridge lives. If not, it is locked here.
    pub(super) is_alive: bool,
    /// What it says; `None` if it is damaged.
    pub(super) content: Option<Content>,
    /// Keeps the lock.
    _file: File,
}

/// What a record says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Content {
    pub(super) display: String,
    pub(super) down: Down,
}

impl HeldRecord {
    /// Makes a record in `folder`, of a bridge that holds nothing yet.
    ///
    /// # Errors
    /// The folder takes no file.
    pub(super) fn create(folder: &Path, display: &str) -> io::Result<Self> {
        for number in 0..RECORDS_MAX {
            let path = folder.join(format!("{PREFIX}{number}"));
            let file = match OpenOptions::new().write(true).create_new(true).mode(0o600).open(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                opened => opened?,
            };
            // Who looks for records of the dead may have taken it for one.
            if !is_locked(&file, &path) {
                continue;
            }
            let head = format!("{MAGIC}\n{}\n", server(display));
            let (at, written) = (head.len() as u64, Down::new());
            file.write_all_at(format!("{head}{}", marks(&written)).as_bytes(), 0)?;
            return Ok(Self { file, path, at, written });
        }
        Err(io::Error::other("there are too many records of bridges"))
    }

    /// Its file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes down what is down: a line of one length, in one write.
    ///
    /// # Errors
    /// The file takes no bytes.
    pub(super) fn write(&mut self, down: &Down) -> io::Result<()> {
        if self.written != *down {
            self.file.write_all_at(marks(down).as_bytes(), self.at)?;
            self.written.clone_from(down);
        }
        Ok(())
    }

    /// What it says.
    pub(super) const fn written(&self) -> &Down {
        &self.written
    }

    /// Removes the record of a bridge that ends and holds nothing any more.
    pub(super) fn remove(self) {
        // One that stays says that nothing is down.
        let _ = fs::remove_file(&self.path);
    }
}

impl FoundRecord {
    /// Removes the record of a dead bridge.
    pub(super) fn remove(self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// All records in `folder`. As long as one of a dead bridge is kept, nobody else finds it dead.
pub(super) fn records(folder: &Path) -> Vec<FoundRecord> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_record = |path: &PathBuf| {
        path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.starts_with(PREFIX))
    };
    let mut paths: Vec<_> = entries.map(|entry| entry.path()).filter(is_record).collect();
    paths.sort();
    paths.into_iter().filter_map(found).collect()
}

fn found(path: PathBuf) -> Option<FoundRecord> {
    // Whatever lies there under the name of a record: nothing waits for it, and nothing is followed.
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
    let file = OpenOptions::new().read(true).custom_flags(flags).open(&path).ok()?;
    if !file.metadata().ok()?.is_file() {
        return None;
    }
    let is_alive = !is_locked(&file, &path);
    let mut text = Vec::new();
    let read = (&file).take(BYTES_MAX).read_to_end(&mut text);
    // An empty one was begun and never used.
    let content = if text.is_empty() { Some(Content::default()) } else { content(&text) };
    let content = read.ok().and(content);
    Some(FoundRecord { path, is_alive, content, _file: file })
}

/// Locks the file. False if somebody else has it, or if it is not any more what is found at `path`.
fn is_locked(file: &File, path: &Path) -> bool {
    let is_there = || {
        let (here, there) = (file.metadata()?, fs::symlink_metadata(path)?);
        io::Result::Ok((here.dev(), here.ino()) == (there.dev(), there.ino()))
    };
    file.try_lock().is_ok() && is_there().unwrap_or(false)
}

/// The server of a display: `:0` and `:0.0` are screens of one, and have the same keys.
fn server(display: &str) -> &str {
    let end = display.rfind(':').and_then(|colon| Some(colon + display.get(colon..)?.find('.')?));
    end.and_then(|end| display.get(..end)).unwrap_or(display)
}

fn marks(down: &Down) -> String {
    (0..=u8::MAX).map(|number| if down.contains(&number) { '1' } else { '0' }).chain(['\n']).collect()
}

fn content(text: &[u8]) -> Option<Content> {
    let lines: Vec<&str> = std::str::from_utf8(text).ok()?.lines().collect();
    let [MAGIC, display, marks] = lines[..] else { return None };
    let is_whole = marks.len() == 256 && marks.bytes().all(|mark| matches!(mark, b'0' | b'1'));
    let down = (0..=u8::MAX).zip(marks.bytes()).filter(|(_, mark)| *mark == b'1').map(|(number, _)| number);
    is_whole.then(|| Content { display: display.to_owned(), down: down.collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn only(folder: &Path) -> FoundRecord {
        let mut records = records(folder);
        assert_eq!(records.len(), 1, "{records:?}");
        records.remove(0)
    }

    #[test]
    fn a_record_belongs_to_the_living_until_it_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let mut record = HeldRecord::create(folder.path(), ":7").unwrap();
        record.write(&Down::from([1, 52, 255])).unwrap();
        record.write(&Down::from([1, 255])).unwrap();
        assert!(only(folder.path()).is_alive);
        drop(record);
        let dead = only(folder.path());
        let content = Content { display: ":7".into(), down: Down::from([1, 255]) };
        assert!(!dead.is_alive && dead.content.as_ref() == Some(&content), "{dead:?}");
        assert!(only(folder.path()).is_alive, "who found it has it");
        dead.remove();
        assert_eq!(records(folder.path()).len(), 0);
    }

    #[test]
    fn each_bridge_has_its_own_record_and_takes_it_away() {
        let folder = tempfile::tempdir().unwrap();
        let [one, other] = [":0", ":1"].map(|display| HeldRecord::create(folder.path(), display).unwrap());
        assert_eq!(records(folder.path()).len(), 2);
        one.remove();
        assert_eq!(only(folder.path()).content.unwrap().display, ":1");
        // The place that was left is taken again.
        let third = HeldRecord::create(folder.path(), ":2").unwrap();
        assert_eq!(records(folder.path()).len(), 2);
        third.remove();
        other.remove();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_record_that_was_taken_away_meanwhile_is_not_locked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tactpad-x11-0");
        let file = File::create(&path).unwrap();
        fs::remove_file(&path).unwrap();
        assert!(!is_locked(&file, &path));
        let _another = File::create(&path).unwrap();
        assert!(!is_locked(&file, &path));
    }

    #[test]
    fn screens_of_one_server_are_one() {
        for (display, expected) in [
            (":0", ":0"),
            (":0.1", ":0"),
            ("a.b:10.0", "a.b:10"),
            ("a.b:1", "a.b:1"),
            ("/a.b/X0", "/a.b/X0"),
            ("", ""),
        ] {
            assert_eq!(server(display), expected);
        }
    }

    #[test]
    fn what_is_no_record_says_nothing() {
        let whole = format!("{MAGIC}\n:0\n{}", marks(&Down::from([9])));
        assert_eq!(content(whole.as_bytes()).unwrap().down, Down::from([9]));
        let damaged = [
            "",
            MAGIC,
            &whole[1..],
            &whole[..whole.len() - 2],
            &whole.replace('1', "2"),
            &whole.replace(":0", ":0\n:1"),
        ];
        for text in damaged {
            assert_eq!(content(text.as_bytes()), None, "{text}");
        }
        assert_eq!(content(&[0xff; 300]), None);
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("tactpad-x11-3")).unwrap();
        std::os::unix::fs::symlink("/dev/zero", folder.path().join("tactpad-x11-4")).unwrap();
        assert_eq!(records(folder.path()).len(), 0);
        assert_eq!(records(Path::new("/nowhere")).len(), 0);
        File::create(folder.path().join("tactpad-x11-5")).unwrap();
        assert_eq!(only(folder.path()).content, Some(Content::default()), "it was begun and never used");
    }
}
