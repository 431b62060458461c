//! Messages of a live verb to people.

use std::io;
use std::sync::Arc;

use tactpad::bridge::queue::WriteQueue;

/// Largest size of the messages that wait to be read, in bytes.
const MESSAGE_BYTES_MAX: usize = 16 << 10;

/// Stderr behind a queue: a terminal that is held with Ctrl-S, or a pipe that nobody reads, keeps nobody waiting.
#[derive(Clone)]
pub(super) struct MessageQueue(Arc<WriteQueue>);

impl MessageQueue {
    /// # Errors
    /// The system has no thread to give.
    pub(super) fn start() -> io::Result<Self> {
        Ok(Self(Arc::new(WriteQueue::to_stream("messages", io::stderr(), MESSAGE_BYTES_MAX)?)))
    }

    /// Tells people a line, or some. Where nobody reads, they are lost.
    pub(super) fn tell(&self, lines: &str) {
        let _ = self.0.push(format!("{lines}\n").into_bytes().into());
    }
}

impl Drop for MessageQueue {
    fn drop(&mut self) {
        // The last messages get out, if somebody reads.
        let _ = self.0.settle();
    }
}
