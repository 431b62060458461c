//! Events as lines of a file or a stream.

use std::io::{self, Write};
use std::path::Path;

use super::queued::QueuedGroups;
use super::{Sink, SinkError};
use crate::destination::Destination;
use crate::queue::{OnWritten, WriteQueue};
use tactpad_core::pipeline::control::{OutputDevice, OutputEvent};
use tactpad_core::pipeline::output::event_log;

/// So much may wait to be written: some thousand groups.
const QUEUE_BYTES_MAX: usize = 128 << 10;

/// Writes the event log, each group in one piece, behind a queue. Where groups were dropped, the log goes on with what leads from
/// what its readers know to what is held.
pub struct LogSink {
    groups: QueuedGroups<u8>,
    place: String,
    /// Whether the log waits for somebody to read it.
    waits_for_reader: bool,
}

impl LogSink {
    /// Logs to a new file, replacing one that is there already, or to a named pipe, whether or not somebody reads it yet.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn create(path: &Path) -> Result<Self, SinkError> {
        let place = path.display().to_string();
        let to = Destination::create(path).map_err(|error| refused(&place, &error))?;
        let waits_for_reader = to.waits_for_reader();
        Ok(Self { waits_for_reader, ..Self::new(to, place)? })
    }

    /// Logs to `out`; `place` is what people call it.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub fn new(out: impl Write + Send + 'static, place: String) -> Result<Self, SinkError> {
        let queue =
            WriteQueue::to_stream("log", out, QUEUE_BYTES_MAX).map_err(|error| refused(&place, &error))?;
        Ok(Self { groups: QueuedGroups::new(queue), place, waits_for_reader: false })
    }

    /// Whether the log is a pipe that nobody read when it was opened.
    pub const fn waits_for_reader(&self) -> bool {
        self.waits_for_reader
    }
}

fn lines(events: &[OutputEvent]) -> io::Result<Vec<u8>> {
    let mut lines = Vec::new();
    event_log::write(&mut lines, events)?;
    Ok(lines)
}

fn refused(place: &str, error: &io::Error) -> SinkError {
    SinkError { message: format!("the event log {place} cannot be written ({error}): name another file") }
}

impl Sink for LogSink {
    fn prepare(&mut self, _device: OutputDevice) -> Result<(), SinkError> {
        Ok(())
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        self.write_then(group, Box::new(|| ()))
    }

    fn write_then(&mut self, group: &[OutputEvent], written: OnWritten) -> Result<(), SinkError> {
        self.groups.write(group, written, lines).map_err(|error| refused(&self.place, &error))
    }

    fn settle(&mut self) -> Result<(), SinkError> {
        self.groups.settle().map_err(|error| refused(&self.place, &error))
    }

    fn dropped(&self) -> u64 {
        self.groups.dropped()
    }

    fn waiting(&self) -> u64 {
        self.groups.waiting()
    }

    fn describe(&self) -> String {
        format!("event log in {}", self.place)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};
    use std::sync::{Arc, Mutex};

    use super::*;
    use tactpad_core::pipeline::control::Code;
    use tactpad_core::time::StreamInstant;

    fn event(t_us: u64, key: u16, value: i32) -> OutputEvent {
        let at = StreamInstant::from_us(t_us);
        OutputEvent { at, device: OutputDevice::Keyboard, code: Code::Key(key), value }
    }

    /// The pieces that reach the other side.
    #[derive(Clone, Default)]
    struct Pieces(Arc<Mutex<Vec<Vec<u8>>>>);

    impl Write for Pieces {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().push(bytes.to_vec());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn each_group_is_written_in_one_piece_and_told_when_it_is_out() {
        let pieces = Pieces::default();
        let mut sink = LogSink::new(pieces.clone(), "memory".into()).unwrap();
        sink.write(&[event(1, 44, 1), event(1, 45, 1)]).unwrap();
        let (tell, told) = channel();
        let seen = pieces.clone();
        let written = move || tell.send(seen.0.lock().unwrap().len()).unwrap();
        sink.write_then(&[event(2, 44, 0)], Box::new(written)).unwrap();
        sink.settle().unwrap();
        let lines: Vec<_> =
            pieces.0.lock().unwrap().iter().map(|piece| piece.split(|b| *b == b'\n').count() - 1).collect();
        assert_eq!((lines, told.try_recv()), (vec![2, 1], Ok(2)));
        assert!(pieces.0.lock().unwrap().iter().all(|piece| piece.ends_with(b"}\n")));
    }

    /// A reader who takes nothing until the other end of the channel is gone.
    struct Stalled(Receiver<()>, Pieces);

    impl Write for Stalled {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let _ = self.0.recv();
            self.1.write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// The controls that a reader of the log takes for held, and how many lines there are.
    fn believed(pieces: &Pieces) -> (Vec<String>, usize) {
        let (mut held, mut lines) = (Vec::new(), 0);
        for line in pieces.0.lock().unwrap().concat().split(|b| *b == b'\n').filter(|line| !line.is_empty()) {
            let line: serde_json::Value = serde_json::from_slice(line).unwrap();
            let code = line["code"].to_string();
            let is_down = line["value"] != 0;
            assert_ne!(is_down, held.contains(&code), "{line} says what was said before");
            held.retain(|held| *held != code);
            held.extend(is_down.then_some(code));
            lines += 1;
        }
        (held, lines)
    }

    #[test]
    fn a_reader_that_stalls_learns_afterwards_what_is_held_and_no_more() {
        for presses_after in [0, 1, 2] {
            let (reads, stalled) = channel();
            let pieces = Pieces::default();
            let mut sink = LogSink::new(Stalled(stalled, pieces.clone()), "pipe".into()).unwrap();
            let mut written = 0;
            let mut keys =
                (0..).map(|press| event(press, 44 + (press / 2 % 2) as u16, 1 - (press % 2) as i32));
            // Until a group is dropped that a key went down in; then some that are dropped, too.
            while sink.dropped() == 0 || sink.groups.releases().is_empty() {
                sink.write(&[keys.next().unwrap()]).unwrap();
                written += 1;
            }
            for key in keys.by_ref().take(presses_after) {
                sink.write(&[key]).unwrap();
                written += 1;
            }
            drop(reads);
            sink.settle().unwrap();
            let (held, lines) = believed(&pieces);
            assert_eq!(held.len(), (presses_after + 1) % 2, "after {written} groups: {held:?}");
            assert!(lines as u64 <= written - sink.dropped() + 2);
            let dropped = sink.dropped();
            sink.write(&[keys.next().unwrap()]).unwrap();
            sink.settle().unwrap();
            assert_eq!(
                (sink.dropped(), believed(&pieces).0.len()),
                (dropped, presses_after % 2),
                "it goes on"
            );
        }
    }

    #[test]
    fn file_holds_one_line_for_each_event() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let mut sink = LogSink::create(&path).unwrap();
        sink.prepare(OutputDevice::Keyboard).unwrap();
        sink.write(&[event(5, 103, 1)]).unwrap();
        sink.settle().unwrap();
        let expected = "{\"t_us\":5,\"device\":\"keyboard\",\"code\":\"KEY_UP\",\"value\":1}\n";
        assert_eq!(std::fs::read_to_string(&path).unwrap(), expected);
        assert!(sink.describe().contains(path.to_str().unwrap()));
    }

    #[test]
    fn file_that_cannot_be_made_is_named() {
        let error = LogSink::create(Path::new("/no-such-folder/events.jsonl")).err().unwrap();
        assert!(error.message.contains("/no-such-folder/events.jsonl"), "{error}");
    }

    #[test]
    fn full_disk_is_an_error_and_no_panic() {
        let mut sink = LogSink::create(Path::new("/dev/full")).unwrap();
        sink.write(&[event(0, 44, 1)]).unwrap();
        assert!(sink.settle().unwrap_err().message.contains("/dev/full"));
        assert!(sink.write(&[event(0, 44, 0)]).unwrap_err().message.contains("/dev/full"));
    }
}
