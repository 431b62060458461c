//! Output whose errors name where it was to go, and that spares the input.

use std::fmt;
use std::fs;
use std::io::{self, Stdout, Write};
#[cfg(target_os = "linux")]
use std::os::fd::AsFd;
use std::path::{self, Path};
#[cfg(target_os = "linux")]
use std::sync::OnceLock;

#[cfg(target_os = "linux")]
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::cli::failure::Failure;
#[cfg(target_os = "linux")]
use tactpad::bridge::queue::{WriteGroup, WriteQueue};

/// Writes to `to`, which people call `place`.
pub(crate) struct Named<W> {
    to: W,
    place: String,
}

/// Standard output.
pub(crate) fn stdout() -> Named<Stdout> {
    Named::new(io::stdout(), "stdout".into())
}

/// Prints one JSON document to stdout.
pub(crate) fn print_json(document: &impl serde::Serialize) -> Result<(), Failure> {
    Ok(writeln!(stdout(), "{}", json_text(document)?)?)
}

/// A JSON document on one line.
pub(crate) fn json_text(document: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(document).map_err(|error| Failure::Failed(error.to_string()))
}

/// Stderr behind a queue, in verbs that must not wait for whoever reads it.
#[cfg(target_os = "linux")]
static MESSAGES: OnceLock<WriteQueue> = OnceLock::new();

/// Largest size of the messages that wait to be read, in bytes.
#[cfg(target_os = "linux")]
const MESSAGE_BYTES_MAX: usize = 16 << 10;

/// From now on a terminal that is held with Ctrl-S, or a pipe that nobody reads, keeps the verb from nothing: what is said waits half a
/// second for room there, and is lost then.
///
/// # Errors
/// The system has no thread to give.
#[cfg(target_os = "linux")]
pub(crate) fn wait_for_no_reader() -> io::Result<()> {
    // Once is enough.
    let _ = MESSAGES.set(WriteQueue::to_stream("messages", io::stderr(), MESSAGE_BYTES_MAX)?);
    Ok(())
}

/// Tells people a line, or some, without waiting: they are lost where nobody reads, and before [`wait_for_no_reader`].
#[cfg(target_os = "linux")]
pub(crate) fn tell_in_passing(lines: &str) {
    if let Some(messages) = MESSAGES.get() {
        let items = format!("{}\n", printable(lines)).into_bytes();
        let _ = messages.push(WriteGroup { items, count: 1, written: None });
    }
}

/// Says something to people beside the verb's output. What does not get out must not stop the verb.
pub(crate) fn say(line: impl fmt::Display) {
    let line = line.to_string();
    #[cfg(target_os = "linux")]
    if let Some(messages) = MESSAGES.get() {
        tell_in_passing(&line);
        // Where there is room the thread that writes is only late.
        while messages.settle().is_ok() && messages.waiting() > 0 && has_room(&io::stderr()) {}
        return;
    }
    let _ = writeln!(io::stderr(), "{}", printable(&line));
}

/// Whether a write would not wait.
#[cfg(target_os = "linux")]
fn has_room(to: &impl AsFd) -> bool {
    let mut asked = [PollFd::new(to, PollFlags::OUT)];
    let at_once = Timespec { tv_sec: 0, tv_nsec: 0 };
    poll(&mut asked, Some(&at_once)).is_ok() && asked.iter().any(|it| it.revents().contains(PollFlags::OUT))
}

/// Tells what came of a verb that has written `out`: as a document, to people, or beside the output that it is in.
pub(crate) fn tell<O: fmt::Display + serde::Serialize>(
    outcome: &O,
    out: &Path,
    json: bool,
) -> Result<(), Failure> {
    match (json, is_stdout(out)) {
        (true, _) => print_json(outcome),
        (false, true) => {
            say(outcome);
            Ok(())
        }
        (false, false) => Ok(writeln!(stdout(), "{outcome}\n{} is written", out.display())?),
    }
}

/// The text without what a terminal would obey: names in it may come from files and devices.
pub(crate) fn printable(text: &str) -> String {
    let is_obeyed = |letter: char| letter.is_control() && !matches!(letter, '\n' | '\t');
    let shown = |letter: char| {
        if is_obeyed(letter) { letter.escape_default().to_string() } else { letter.to_string() }
    };
    text.chars().map(shown).collect()
}

/// A word as a shell takes it.
pub(crate) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+".contains(c);
    if word.chars().all(is_plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

impl<W: Write> Named<W> {
    /// Writes to `to` under this name.
    pub(crate) const fn new(to: W, place: String) -> Self {
        Self { to, place }
    }

    /// The writer inside.
    pub(crate) fn into_inner(self) -> W {
        self.to
    }

    /// The error with the place and without the system's number; its kind stays.
    fn placed(&self, error: &io::Error) -> io::Error {
        io::Error::new(error.kind(), format!("cannot write {}: {}", self.place, reason(error)))
    }
}

impl<W: Write> Write for Named<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.to.write(bytes).map_err(|error| self.placed(&error))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush().map_err(|error| self.placed(&error))
    }
}

/// Whether output is to go to standard output.
pub(crate) fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Refuses two documents on standard output, of which `option` asks for one.
pub(crate) fn both_print(option: &str) -> Failure {
    let name = option.split(' ').next().unwrap_or(option);
    Failure::Unusable(format!("--json and {option} both print: let {name} name a file"))
}

/// Refuses to write over what is needed; `what` says what it is.
pub(crate) fn written_over(written: &Path, what: &str) -> Failure {
    Failure::Unusable(format!("{} {what} and would be written over: name another file", written.display()))
}

/// Whether both names lead to one file. Devices do not count: nothing is lost if `/dev/null` is written twice.
pub(crate) fn is_same(left: &Path, right: &Path) -> bool {
    match (fs::metadata(left), fs::metadata(right)) {
        (Ok(file), Ok(_)) => file.is_file() && is_one(left, right).unwrap_or(false),
        (Err(_), Err(_)) => {
            path::absolute(left).ok().is_some_and(|left| path::absolute(right).ok() == Some(left))
        }
        _ => false,
    }
}

#[cfg(unix)]
fn is_one(left: &Path, right: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let (left, right) = (fs::metadata(left)?, fs::metadata(right)?);
    Ok((left.dev(), left.ino()) == (right.dev(), right.ino()))
}

#[cfg(not(unix))]
fn is_one(left: &Path, right: &Path) -> io::Result<bool> {
    Ok(fs::canonicalize(left)? == fs::canonicalize(right)?)
}

/// The system's message, without its number.
pub(crate) fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Refusing(io::ErrorKind);

    impl Write for Refusing {
        fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Err(io::ErrorKind::StorageFull.into())
        }
    }

    #[test]
    fn errors_name_the_place_and_keep_their_kind() {
        let mut named = Named::new(Refusing(io::ErrorKind::BrokenPipe), "game.cap".into());
        assert_eq!(named.write(b"x").unwrap_err().kind(), io::ErrorKind::BrokenPipe);
        let error = named.flush().unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(error.to_string().starts_with("cannot write game.cap: "), "{error}");
        let mut named = Named::new(Refusing(io::ErrorKind::Interrupted), String::new());
        assert_eq!(named.write(b"x").unwrap_err().kind(), io::ErrorKind::Interrupted, "it is tried again");
    }
}
