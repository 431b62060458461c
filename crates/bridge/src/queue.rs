//! A file, a stream or a server behind a bounded queue, so that one that takes nothing never keeps the bridge waiting.
//!
//! A thread of its own writes whole groups, one after the other. A group that finds no room is refused whole. Behind the
//! queue is one more place, the last: what is put there goes out when all before it is out, and until then it can be
//! replaced. So whoever was refused leaves there what readers have to know.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Callback for the moment at which a group is written.
pub type OnWritten = Box<dyn FnOnce() + Send>;

/// The end of a run waits this long for what is still to be written.
const SETTLE_LIMIT: Duration = Duration::from_millis(400);

/// Bytes, or other items, that belong together.
pub struct WriteGroup<T = u8> {
    /// What to write.
    pub items: Vec<T>,
    /// How many things it holds, for whoever counts those that were not written.
    pub count: u64,
    /// Called by the writing thread once the items are out.
    pub written: Option<OnWritten>,
}

impl<T> From<Vec<T>> for WriteGroup<T> {
    /// A group that nobody counts or waits for.
    fn from(items: Vec<T>) -> Self {
        Self { items, count: 0, written: None }
    }
}

/// A queue with a thread that writes. Dropping it waits a little for what is still to be written.
pub struct WriteQueue<T = u8> {
    shared: Arc<Shared<T>>,
    items_max: usize,
}

struct Shared<T> {
    state: Mutex<QueueState<T>>,
    changed: Condvar,
}

struct QueueState<T> {
    groups: VecDeque<WriteGroup<T>>,
    last: Option<WriteGroup<T>>,
    /// Items in `groups`.
    items: usize,
    /// The count of the group that is being written.
    writing: Option<u64>,
    is_closed: bool,
    /// The end was waited for in vain.
    is_stalled: bool,
    /// The error that ended the writing.
    failed: Option<(io::ErrorKind, String)>,
}

impl<T> Default for QueueState<T> {
    fn default() -> Self {
        Self {
            groups: VecDeque::new(),
            last: None,
            items: 0,
            writing: None,
            is_closed: false,
            is_stalled: false,
            failed: None,
        }
    }
}

impl WriteQueue {
    /// Writes to `to` from a thread called `name`; at most `bytes_max` wait, and one group however long it is.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub fn to_stream(name: &str, mut to: impl Write + Send + 'static, bytes_max: usize) -> io::Result<Self> {
        Self::start(name, bytes_max, move |bytes| to.write_all(bytes).and_then(|()| to.flush()))
    }
}

impl<T: Send + 'static> WriteQueue<T> {
    /// Calls `write` for each group, from a thread called `name`; at most `items_max` wait, and one group however long it is.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub fn start(
        name: &str,
        items_max: usize,
        write: impl FnMut(&[T]) -> io::Result<()> + Send + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared { state: Mutex::default(), changed: Condvar::new() });
        let writer = Arc::clone(&shared);
        thread::Builder::new().name(name.into()).spawn(move || writer.write_by(write))?;
        Ok(Self { shared, items_max })
    }
}

impl<T> WriteQueue<T> {
    /// Takes a group to be written. False if there is no room: then it is gone.
    ///
    /// # Errors
    /// An earlier group could not be written.
    pub fn push(&self, group: WriteGroup<T>) -> io::Result<bool> {
        let mut state = self.shared.sound()?;
        if !state.has_room(group.items.len(), self.items_max) {
            return Ok(false);
        }
        state.items += group.items.len();
        state.groups.push_back(group);
        self.shared.changed.notify_all();
        Ok(true)
    }

    /// Whether a group of so many items would be taken now.
    ///
    /// # Errors
    /// An earlier group could not be written.
    pub fn has_room(&self, items: usize) -> io::Result<bool> {
        Ok(self.shared.sound()?.has_room(items, self.items_max))
    }

    /// Puts a group in the last place, behind everything else. Until it is out no other group is taken.
    ///
    /// # Errors
    /// An earlier group could not be written.
    pub fn put_last(&self, group: WriteGroup<T>) -> io::Result<()> {
        self.shared.sound()?.last = Some(group);
        self.shared.changed.notify_all();
        Ok(())
    }

    /// Replaces the group in the last place. False if none waits there.
    ///
    /// # Errors
    /// An earlier group could not be written.
    pub fn replace_last(&self, group: WriteGroup<T>) -> io::Result<bool> {
        let mut state = self.shared.sound()?;
        Ok(state.last.as_mut().map(|last| *last = group).is_some())
    }

    /// Waits, 0.4 s at most, until everything is out.
    ///
    /// # Errors
    /// A group could not be written.
    pub fn settle(&self) -> io::Result<()> {
        let state = self.shared.sound()?;
        let is_left = |state: &mut QueueState<T>| state.is_busy() && state.failed.is_none();
        let waited = self.shared.changed.wait_timeout_while(state, SETTLE_LIMIT, is_left);
        let (mut state, limit) = waited.unwrap_or_else(PoisonError::into_inner);
        state.is_stalled = limit.timed_out();
        state.check()
    }

    /// How many things wait to be written, as the groups count them.
    pub fn waiting(&self) -> u64 {
        self.shared.lock().waiting()
    }
}

impl<T> Drop for WriteQueue<T> {
    fn drop(&mut self) {
        if !self.shared.lock().is_stalled {
            // Whoever wants to know of errors has settled before.
            let _ = self.settle();
        }
        self.shared.lock().is_closed = true;
        self.shared.changed.notify_all();
    }
}

impl<T> QueueState<T> {
    fn has_room(&self, items: usize, items_max: usize) -> bool {
        self.last.is_none() && (self.groups.is_empty() || self.items + items <= items_max)
    }

    fn waiting(&self) -> u64 {
        self.groups.iter().chain(&self.last).map(|group| group.count).chain(self.writing).sum()
    }

    fn is_busy(&self) -> bool {
        self.writing.is_some() || self.last.is_some() || !self.groups.is_empty()
    }

    fn check(&self) -> io::Result<()> {
        match &self.failed {
            Some((kind, why)) => Err(io::Error::new(*kind, why.clone())),
            None => Ok(()),
        }
    }

    fn next(&mut self) -> Option<WriteGroup<T>> {
        let group = self.groups.pop_front().or_else(|| self.last.take())?;
        self.items = self.groups.iter().map(|group| group.items.len()).sum();
        self.writing = Some(group.count);
        Some(group)
    }
}

impl<T> Shared<T> {
    fn lock(&self) -> MutexGuard<'_, QueueState<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The state, if nothing failed.
    fn sound(&self) -> io::Result<MutexGuard<'_, QueueState<T>>> {
        let state = self.lock();
        state.check()?;
        Ok(state)
    }

    /// Writes groups until the queue is dropped or one cannot be written.
    fn write_by(&self, mut write: impl FnMut(&[T]) -> io::Result<()>) {
        while let Some(WriteGroup { items, written, .. }) = self.next() {
            let done = write(&items);
            if let (Ok(()), Some(written)) = (&done, written) {
                written();
            }
            let mut state = self.lock();
            state.writing = None;
            state.failed = done.err().map(|error| (error.kind(), error.to_string()));
            self.changed.notify_all();
            if state.failed.is_some() {
                return;
            }
        }
    }

    /// Waits for the next group; `None` once the queue is dropped.
    fn next(&self) -> Option<WriteGroup<T>> {
        let mut state = self.lock();
        loop {
            if let Some(group) = state.next() {
                return Some(group);
            }
            if state.is_closed {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, Sender, channel};

    use super::*;

    /// Takes a group only when it may, and passes it on.
    struct Gate {
        may: Receiver<()>,
        out: Sender<Vec<u8>>,
    }

    impl Write for Gate {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.may.recv().map_err(|_| io::ErrorKind::StorageFull)?;
            let _ = self.out.send(bytes.to_vec());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn gated() -> (WriteQueue, Sender<()>, Receiver<Vec<u8>>) {
        let ((open, may), (out, seen)) = (channel(), channel());
        (WriteQueue::to_stream("test", Gate { may, out }, 8).unwrap(), open, seen)
    }

    fn group(bytes: &[u8]) -> WriteGroup {
        WriteGroup { items: bytes.to_vec(), count: 1, written: None }
    }

    /// Waits until everything is out, however late the writing thread has its turn.
    fn settle(queue: &WriteQueue) {
        while queue.waiting() > 0 {
            queue.settle().unwrap();
        }
    }

    #[test]
    fn what_finds_no_room_is_refused_whole_and_the_last_place_comes_behind_all() {
        let (queue, open, seen) = gated();
        // One group is longer than there is room for: alone it may wait, or be written.
        assert!(queue.push(group(b"0123456789")).unwrap());
        let mut taken = 0;
        while queue.push(group(b"abc")).unwrap() {
            taken += 1;
        }
        // Of these two fit, or none while the long one still waits.
        assert!(taken <= 2, "{taken}");
        assert!(!queue.replace_last(group(b"z")).unwrap(), "none waits there");
        queue.put_last(group(b"y")).unwrap();
        assert!(!queue.push(group(b"a")).unwrap(), "nothing is taken behind the last");
        assert!(queue.replace_last(group(b"z")).unwrap());
        assert_eq!(queue.waiting(), taken + 2);
        (0..taken + 2).for_each(|_| open.send(()).unwrap());
        settle(&queue);
        let written: Vec<_> = seen.try_iter().collect();
        let middle = vec![b"abc".to_vec(); taken as usize];
        assert_eq!(written, [vec![b"0123456789".to_vec()], middle, vec![b"z".to_vec()]].concat());
        assert!(queue.push(group(b"a")).unwrap(), "it goes on");
        open.send(()).unwrap();
    }

    #[test]
    fn who_does_not_take_anything_is_waited_for_only_a_little() {
        let (queue, open, seen) = gated();
        assert!(queue.push(group(b"a")).unwrap());
        queue.settle().unwrap();
        assert_eq!(queue.waiting(), 1);
        drop(queue);
        assert!(seen.try_recv().is_err());
        drop(open);
    }

    #[test]
    fn an_error_is_told_to_whoever_writes_next() {
        let (queue, open, _seen) = gated();
        drop(open);
        assert!(queue.push(group(b"a")).unwrap());
        // However late the writing thread has its turn.
        let error = loop {
            if let Err(error) = queue.settle() {
                break error;
            }
        };
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert_eq!(queue.push(group(b"a")).unwrap_err().kind(), io::ErrorKind::StorageFull);
    }

    #[test]
    fn a_group_is_told_when_it_is_out() {
        let (queue, open, seen) = gated();
        let (tell, told) = channel();
        let written: OnWritten = Box::new(move || tell.send(()).unwrap());
        queue.push(WriteGroup { written: Some(written), ..group(b"a") }).unwrap();
        assert!(told.try_recv().is_err(), "it is not out yet");
        open.send(()).unwrap();
        settle(&queue);
        assert_eq!((seen.try_iter().count(), told.try_iter().count()), (1, 1));
    }
}
