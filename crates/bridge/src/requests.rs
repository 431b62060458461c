//! The queue of requests to a running bridge. They come by signals, through the control socket, or from other threads of the program.

use std::fs::{self, Permissions};
use std::io::{self, Read};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;

use signal_hook::{flag, low_level};

use crate::control::{Server, is_there};
use crate::request::{PendingRequest, Request, RequestSender};
use crate::signals::StartConditions;
use crate::watchers::Watchers;

/// The queue of requests, with a file descriptor that polls readable while one waits.
#[derive(Debug)]
pub struct Requests {
    woken: UnixStream,
    wake: UnixStream,
    flags: Vec<(Arc<AtomicBool>, Request)>,
    received: Receiver<PendingRequest>,
    queue: Sender<PendingRequest>,
    /// Held while a client gets its answer.
    answering: Arc<Mutex<()>>,
    watchers: Watchers,
    socket: Option<PathBuf>,
}

impl Requests {
    /// An empty queue; for its sources see [`Requests::sender`], [`Requests::catch_signals`] and [`Requests::listen`].
    ///
    /// # Errors
    /// The system has no descriptor to give.
    pub fn new() -> io::Result<Self> {
        let (woken, wake) = UnixStream::pair()?;
        woken.set_nonblocking(true)?;
        let (queue, received) = channel();
        let (flags, answering, watchers) = (Vec::new(), Arc::default(), Watchers::default());
        Ok(Self { woken, wake, flags, received, queue, answering, watchers, socket: None })
    }

    /// Takes the process's signals, and the end of its terminal, as requests from now on. A program that has its own use for them does not call this.
    ///
    /// # Errors
    /// The system refuses to.
    pub fn catch_signals(&mut self) -> io::Result<()> {
        let start = StartConditions::of_this_process();
        for (signal, request) in start.signals() {
            let flag = Arc::new(AtomicBool::new(false));
            // The flag first: when the descriptor wakes the loop, the flag already stands.
            flag::register(signal, Arc::clone(&flag))?;
            low_level::pipe::register(signal, self.wake.try_clone()?)?;
            self.flags.push((flag, request));
        }
        start.watch_terminal(self.sender()?)
    }

    /// A handle that sends requests from another thread.
    ///
    /// # Errors
    /// The system has no descriptor to give.
    pub fn sender(&self) -> io::Result<RequestSender> {
        Ok(RequestSender { queue: self.queue.clone(), wake: self.wake.try_clone()? })
    }

    /// Listens at `path` too. A socket that nobody listens at any more is taken over.
    ///
    /// # Errors
    /// `AddrInUse` if another bridge listens there; or the socket cannot be made.
    pub fn listen(&mut self, path: &Path) -> io::Result<()> {
        if is_there(path) {
            return Err(io::ErrorKind::AddrInUse.into());
        }
        let _ = fs::remove_file(path);
        let listener = UnixListener::bind(path)?;
        fs::set_permissions(path, Permissions::from_mode(0o600))?;
        self.socket = Some(path.to_owned());
        let (answering, watchers) = (Arc::clone(&self.answering), self.watchers.clone());
        let mut server = Server::new(listener, self.sender()?, answering, watchers)?;
        thread::Builder::new().name("control".into()).spawn(move || server.run())?;
        Ok(())
    }

    /// The subscribers to the outcome of presses.
    pub(super) fn watchers(&self) -> Watchers {
        self.watchers.clone()
    }

    /// The file descriptor that polls readable when a request waits.
    pub fn fd(&self) -> BorrowedFd<'_> {
        self.woken.as_fd()
    }

    /// The next request, if there is one.
    pub fn take(&mut self) -> Option<PendingRequest> {
        while matches!(self.woken.read(&mut [0; 64]), Ok(read) if read > 0) {}
        let raised = self.flags.iter().find(|(flag, _)| flag.swap(false, Ordering::AcqRel));
        match raised {
            Some((_, request)) => Some(PendingRequest::unanswered(request.clone())),
            None => self.received.try_recv().ok(),
        }
    }
}

impl Drop for Requests {
    fn drop(&mut self) {
        // Who asked the bridge to end still gets the answer; the process takes the control thread with it.
        while self.received.try_recv().is_ok() {}
        drop(self.answering.lock());
        if let Some(socket) = &self.socket {
            let _ = fs::remove_file(socket);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::ask;

    #[test]
    fn a_question_reaches_the_bridge_and_its_answer_the_client() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let mut requests = Requests::new().unwrap();
        requests.listen(&path).unwrap();
        let asking = {
            let path = path.clone();
            thread::spawn(move || ask(&path, "pause"))
        };
        let mut fds = [rustix::event::PollFd::from_borrowed_fd(requests.fd(), rustix::event::PollFlags::IN)];
        rustix::event::poll(&mut fds, None).unwrap();
        let pending = requests.take().unwrap();
        assert_eq!(pending.request, Request::Pause);
        pending.reply("{}".into());
        assert_eq!(asking.join().unwrap().unwrap(), "{}");
        assert!(Requests::new().unwrap().listen(&path).is_err(), "two bridges at one socket");
        drop(requests);
        assert!(!path.exists());
    }

    #[test]
    fn a_program_asks_its_own_bridge_from_another_thread() {
        let mut requests = Requests::new().unwrap();
        assert!(requests.take().is_none());
        let sender = requests.sender().unwrap();
        thread::spawn(move || sender.send(Request::TogglePause)).join().unwrap().unwrap();
        let mut fds = [rustix::event::PollFd::from_borrowed_fd(requests.fd(), rustix::event::PollFlags::IN)];
        rustix::event::poll(&mut fds, None).unwrap();
        assert_eq!(requests.take().map(|pending| pending.request), Some(Request::TogglePause));
        let sender = requests.sender().unwrap();
        drop(requests);
        assert!(sender.send(Request::End).is_err(), "nobody is there to ask");
    }
}
