//! What Unix signals ask of the bridge.

use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2};
use signal_hook::{flag, low_level};

/// What a signal asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// SIGINT, SIGTERM: release everything and end.
    End,
    /// SIGUSR1: release everything (the panic button) and go on.
    ReleaseAll,
    /// SIGUSR2: pause, or go on.
    TogglePause,
    /// SIGHUP: read the profile again.
    ReloadProfile,
}

const REQUESTS: [(i32, Request); 5] = [
    (SIGINT, Request::End),
    (SIGTERM, Request::End),
    (SIGUSR1, Request::ReleaseAll),
    (SIGUSR2, Request::TogglePause),
    (SIGHUP, Request::ReloadProfile),
];

/// Signals as a descriptor to poll and requests to take.
#[derive(Debug)]
pub struct Signals {
    wake: UnixStream,
    flags: Vec<(Arc<AtomicBool>, Request)>,
}

impl Signals {
    /// Catches the signals from now on.
    ///
    /// # Errors
    /// The system refuses to.
    pub fn catch() -> io::Result<Self> {
        let (wake, woken) = UnixStream::pair()?;
        wake.set_nonblocking(true)?;
        let mut flags = Vec::new();
        for (signal, request) in REQUESTS {
            let flag = Arc::new(AtomicBool::new(false));
            // The flag first: when the descriptor wakes the loop, the flag already stands.
            flag::register(signal, Arc::clone(&flag))?;
            low_level::pipe::register(signal, woken.try_clone()?)?;
            flags.push((flag, request));
        }
        Ok(Self { wake, flags })
    }

    /// Polls readable after a signal.
    pub fn fd(&self) -> BorrowedFd<'_> {
        self.wake.as_fd()
    }

    /// The next request, if a signal came.
    pub fn take(&mut self) -> Option<Request> {
        while matches!(io::Read::read(&mut self.wake, &mut [0; 64]), Ok(read) if read > 0) {}
        let raised = self.flags.iter().find(|(flag, _)| flag.swap(false, Ordering::AcqRel));
        raised.map(|&(_, request)| request)
    }
}
