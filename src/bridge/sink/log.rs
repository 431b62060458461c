//! Events as lines of a file or a stream.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use super::{Sink, SinkError};
use crate::pipeline::control::{OutputDevice, OutputEvent};
use crate::pipeline::output::event_log::LogLine;

/// Writes the event log; each group is out before `write` returns.
#[derive(Debug)]
pub struct LogSink<W> {
    out: W,
    place: String,
    lines: Vec<u8>,
}

impl LogSink<File> {
    /// Logs to a new file; one that is there already is replaced.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn create(path: &Path) -> Result<Self, SinkError> {
        let place = path.display().to_string();
        match File::create(path) {
            Ok(file) => Ok(Self::new(file, place)),
            Err(error) => Err(refused(&place, &error)),
        }
    }
}

impl<W: Write> LogSink<W> {
    /// Logs to `out`; `place` is what people call it.
    pub fn new(out: W, place: String) -> Self {
        Self { out, place, lines: Vec::new() }
    }

    fn write_lines(&mut self, group: &[OutputEvent]) -> io::Result<()> {
        self.lines.clear();
        for event in group {
            writeln!(self.lines, "{}", LogLine(event))?;
        }
        self.out.write_all(&self.lines)?;
        self.out.flush()
    }
}

fn refused(place: &str, error: &io::Error) -> SinkError {
    SinkError { message: format!("the event log {place} cannot be written ({error}): name another file") }
}

impl<W: Write> Sink for LogSink<W> {
    fn prepare(&mut self, _device: OutputDevice) -> Result<(), SinkError> {
        Ok(())
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        self.write_lines(group).map_err(|error| refused(&self.place, &error))
    }

    fn describe(&self) -> String {
        format!("event log in {}", self.place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::control::Code;
    use crate::time::StreamInstant;

    fn event(t_us: u64, key: u16, value: i32) -> OutputEvent {
        let at = StreamInstant::from_us(t_us);
        OutputEvent { at, device: OutputDevice::Keyboard, code: Code::Key(key), value }
    }

    /// Counts what reaches the other side only at a flush.
    #[derive(Default)]
    struct Slow {
        pending: Vec<u8>,
        groups: Vec<Vec<u8>>,
    }

    impl Write for Slow {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let count = bytes.len().min(7);
            self.pending.extend_from_slice(&bytes[..count]);
            Ok(count)
        }

        fn flush(&mut self) -> io::Result<()> {
            self.groups.push(std::mem::take(&mut self.pending));
            Ok(())
        }
    }

    #[test]
    fn each_group_is_flushed_whole() {
        let mut sink = LogSink::new(Slow::default(), "memory".into());
        sink.write(&[event(1, 44, 1), event(1, 45, 1)]).unwrap();
        sink.write(&[event(2, 44, 0)]).unwrap();
        let groups: Vec<usize> =
            sink.out.groups.iter().map(|group| group.split(|b| *b == b'\n').count() - 1).collect();
        assert_eq!(groups, [2, 1]);
        assert!(sink.out.groups.iter().all(|group| group.ends_with(b"}\n")));
    }

    #[test]
    fn file_holds_one_line_for_each_event() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let mut sink = LogSink::create(&path).unwrap();
        sink.prepare(OutputDevice::Keyboard).unwrap();
        sink.write(&[event(5, 103, 1)]).unwrap();
        let expected = "{\"t_us\":5,\"device\":\"keyboard\",\"code\":\"KEY_UP\",\"value\":1}\n";
        assert_eq!(std::fs::read_to_string(&path).unwrap(), expected);
        assert!(sink.describe().contains(path.to_str().unwrap()));
    }

    #[test]
    fn file_that_cannot_be_made_is_named() {
        let error = LogSink::create(Path::new("/no-such-folder/events.jsonl")).unwrap_err();
        assert!(error.message.contains("/no-such-folder/events.jsonl"), "{error}");
    }

    #[test]
    fn full_disk_is_an_error_and_no_panic() {
        let mut sink = LogSink::create(Path::new("/dev/full")).unwrap();
        assert!(sink.write(&[event(0, 44, 1)]).unwrap_err().message.contains("/dev/full"));
    }
}
