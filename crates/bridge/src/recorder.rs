//! Writes calls down without ever waiting for the capture's file.

use std::io::{self, Write};

use crate::queue::{WriteGroup, WriteQueue};
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::capture::head::Head;
use tactpad_core::pipeline::capture::writer::CaptureWriter;
use tactpad_core::time::HostInstant;

/// Calls are handed on in batches of this many bytes, so that not each of them wakes a thread.
const BATCH_BYTES: usize = 8 << 10;

/// So much may wait for the file: a minute and a half of a pad at 1 kHz.
const QUEUE_BYTES_MAX: usize = 8 << 20;

/// Records calls. A call that finds no room ends the capture with a mark that says so: with calls missing in its middle,
/// it would replay to other events.
pub(super) struct Recorder {
    /// Writes into the batch.
    capture: CaptureWriter<Vec<u8>>,
    in_batch: u64,
    queue: WriteQueue,
    is_over: bool,
    /// Calls made after the capture was over.
    missed: u64,
}

impl Recorder {
    /// Begins a capture at host time `now`.
    ///
    /// # Errors
    /// The system has no thread to give, or the head is longer than a capture can hold.
    pub(super) fn begin(to: Box<dyn Write + Send>, now: HostInstant, head: &Head) -> io::Result<Self> {
        let queue = WriteQueue::to_stream("recorder", to, QUEUE_BYTES_MAX)?;
        let capture = CaptureWriter::begin(Vec::new(), now, head)?;
        Ok(Self { capture, in_batch: 0, queue, is_over: false, missed: 0 })
    }

    /// Adds one call that was made at host time `now`.
    ///
    /// # Errors
    /// Earlier calls cannot be written, or this one carries more than a capture can hold.
    pub(super) fn write(&mut self, now: HostInstant, call: Call<'_>) -> io::Result<()> {
        if self.is_over {
            self.missed += 1;
            return Ok(());
        }
        self.capture.write(now, call)?;
        self.in_batch += 1;
        if self.capture.get_mut().len() < BATCH_BYTES {
            return Ok(());
        }
        if self.queue.has_room(self.capture.get_mut().len())? {
            return self.hand_on();
        }
        self.is_over = true;
        self.capture.write_missing(now)?;
        self.hand_on()
    }

    /// Hands the batch on.
    fn hand_on(&mut self) -> io::Result<()> {
        let bytes = std::mem::take(self.capture.get_mut());
        let group = WriteGroup { items: bytes, count: std::mem::take(&mut self.in_batch), written: None };
        if self.is_over { self.queue.put_last(group) } else { self.queue.push(group).map(|_| ()) }
    }

    /// Waits a little until all that was recorded is in the file.
    ///
    /// # Errors
    /// It cannot be written.
    pub(super) fn settle(&mut self) -> io::Result<()> {
        if !self.capture.get_mut().is_empty() {
            // The end of the run: it is the last group whether there is room or not.
            self.is_over = true;
            self.hand_on()?;
        }
        self.queue.settle()
    }

    /// How many calls are not in the capture because its file did not take them in time.
    pub(super) const fn missed(&self) -> u64 {
        self.missed
    }

    /// How many calls are not in the file yet.
    pub(super) fn waiting(&self) -> u64 {
        self.queue.waiting()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};
    use std::sync::{Arc, Mutex};

    use super::*;
    use tactpad_core::pipeline::capture::reader::{CaptureError, CaptureReader};

    /// A file that takes nothing until the other end of the channel is gone.
    struct Stalled(Receiver<()>, Arc<Mutex<Vec<u8>>>);

    impl Write for Stalled {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let _ = self.0.recv();
            self.1.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// Records `calls` calls of 1 kB to a file that takes nothing meanwhile; the calls in it, and how they end.
    fn recorded(calls: u64) -> (u64, Option<CaptureError>, u64) {
        let ((takes, stalled), file) = (channel(), Arc::<Mutex<Vec<u8>>>::default());
        let to = Box::new(Stalled(stalled, Arc::clone(&file)));
        let mut recorder = Recorder::begin(to, HostInstant::default(), &Head::default()).unwrap();
        for call in 0..calls {
            recorder.write(HostInstant::from_ns(call), Call::Bytes(&[7; 1 << 10])).unwrap();
        }
        drop(takes);
        recorder.settle().unwrap();
        assert_eq!(recorder.waiting(), 0);
        let file = file.lock().unwrap();
        let mut capture = CaptureReader::new(&file[..]).unwrap();
        let mut found = 0;
        while let Some(call) = capture.next_call() {
            match call {
                Ok((now, _)) => assert_eq!(now, HostInstant::from_ns(found)),
                Err(error) => return (found, Some(error), recorder.missed()),
            }
            found += 1;
        }
        (found, None, recorder.missed())
    }

    #[test]
    fn a_file_that_stalls_for_a_while_misses_nothing() {
        assert!(matches!(recorded(8_000), (8_000, None, 0)));
    }

    #[test]
    fn a_file_that_stalls_for_too_long_ends_in_good_order_and_says_so() {
        let (found, error, missed) = recorded(9_000);
        assert!(matches!(error, Some(CaptureError::Missing { .. })), "{error:?}");
        assert_eq!(found + missed, 9_000);
        assert!(found > 7_000 && missed > 0, "{found}");
    }
}
