//! What people ask of a running bridge: by a signal, through the control socket, or in the program around it.

use std::fs::{self, Permissions};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2};
use signal_hook::{flag, low_level};

/// A client that says nothing for this long is sent away.
const CLIENT_LIMIT: Duration = Duration::from_secs(1);

/// The bridge answers in well under a millisecond; one that does not has ended.
const ANSWER_LIMIT: Duration = Duration::from_secs(2);

/// The longest request.
const REQUEST_BYTES_MAX: u64 = 4_096;

/// What is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Release everything and end.
    End,
    /// Release everything (the panic button) and go on.
    ReleaseAll,
    /// Release everything and ignore contacts.
    Pause,
    /// Go on.
    Resume,
    /// Pause, or go on.
    TogglePause,
    /// Measure the zero again.
    Retare,
    /// Go over to another profile; `None` reads the one in use again.
    Profile(Option<String>),
    /// Tell what the bridge is doing.
    Status,
}

impl Request {
    /// The request that a line of the control socket states.
    fn parse(line: &str) -> Option<Self> {
        match line.trim_end_matches(['\r', '\n']).split_once(' ') {
            Some(("profile", name)) if !name.is_empty() => Some(Self::Profile(Some(name.into()))),
            Some(_) => None,
            None => match line.trim_end() {
                "status" => Some(Self::Status),
                "pause" => Some(Self::Pause),
                "resume" => Some(Self::Resume),
                "panic" => Some(Self::ReleaseAll),
                "tare" => Some(Self::Retare),
                "quit" => Some(Self::End),
                _ => None,
            },
        }
    }
}

/// A request and whoever waits for its answer.
#[derive(Debug)]
pub struct Asked {
    /// What is asked for.
    pub request: Request,
    answer: Option<SyncSender<String>>,
}

impl Asked {
    /// Answers with one line of JSON. A signal gets no answer.
    pub fn answer(&self, line: String) {
        if let Some(answer) = &self.answer {
            // A client that went away needs no answer.
            let _ = answer.try_send(line);
        }
    }
}

const SIGNALS: [(i32, Request); 5] = [
    (SIGINT, Request::End),
    (SIGTERM, Request::End),
    (SIGUSR1, Request::ReleaseAll),
    (SIGUSR2, Request::TogglePause),
    (SIGHUP, Request::Profile(None)),
];

/// Asks the bridge from any thread of its program.
#[derive(Debug)]
pub struct Asker {
    ask: Sender<Asked>,
    wake: UnixStream,
}

impl Asker {
    /// Asks, and does not wait for an answer.
    ///
    /// # Errors
    /// The bridge has ended.
    pub fn ask(&self, request: Request) -> io::Result<()> {
        self.send(Asked { request, answer: None })
    }

    fn send(&self, asked: Asked) -> io::Result<()> {
        self.ask.send(asked).map_err(|_| io::Error::from(io::ErrorKind::BrokenPipe))?;
        (&self.wake).write_all(&[1])
    }
}

/// Requests as a descriptor to poll and a queue to take from.
#[derive(Debug)]
pub struct Requests {
    woken: UnixStream,
    wake: UnixStream,
    flags: Vec<(Arc<AtomicBool>, Request)>,
    queue: Receiver<Asked>,
    ask: Sender<Asked>,
    /// Held while a client gets its answer.
    answering: Arc<Mutex<()>>,
    socket: Option<PathBuf>,
}

impl Requests {
    /// Nobody asks yet: see [`Requests::asker`], [`Requests::catch_signals`] and [`Requests::listen`].
    ///
    /// # Errors
    /// The system has no descriptor to give.
    pub fn new() -> io::Result<Self> {
        let (woken, wake) = UnixStream::pair()?;
        woken.set_nonblocking(true)?;
        let (ask, queue) = channel();
        Ok(Self { woken, wake, flags: Vec::new(), queue, ask, answering: Arc::default(), socket: None })
    }

    /// Takes the process's signals as requests from now on. A program that has its own use for them does not call this.
    ///
    /// # Errors
    /// The system refuses to.
    pub fn catch_signals(&mut self) -> io::Result<()> {
        for (signal, request) in SIGNALS {
            let flag = Arc::new(AtomicBool::new(false));
            // The flag first: when the descriptor wakes the loop, the flag already stands.
            flag::register(signal, Arc::clone(&flag))?;
            low_level::pipe::register(signal, self.wake.try_clone()?)?;
            self.flags.push((flag, request));
        }
        Ok(())
    }

    /// Asks this bridge from another thread.
    ///
    /// # Errors
    /// The system has no descriptor to give.
    pub fn asker(&self) -> io::Result<Asker> {
        Ok(Asker { ask: self.ask.clone(), wake: self.wake.try_clone()? })
    }

    /// Listens at `path` too. A socket that nobody listens at any more is taken over.
    ///
    /// # Errors
    /// `AddrInUse` if another bridge listens there; or the socket cannot be made.
    pub fn listen(&mut self, path: &Path) -> io::Result<()> {
        if UnixStream::connect(path).is_ok() {
            return Err(io::ErrorKind::AddrInUse.into());
        }
        let _ = fs::remove_file(path);
        let listener = UnixListener::bind(path)?;
        fs::set_permissions(path, Permissions::from_mode(0o600))?;
        self.socket = Some(path.to_owned());
        let asker = self.asker()?;
        let answering = Arc::clone(&self.answering);
        thread::Builder::new().name("control".into()).spawn(move || {
            for client in listener.incoming().flatten() {
                // A client that misbehaves harms nobody but itself.
                let _ = serve(client, &asker, &answering);
            }
        })?;
        Ok(())
    }

    /// Polls readable when something was asked.
    pub fn fd(&self) -> BorrowedFd<'_> {
        self.woken.as_fd()
    }

    /// The next request, if there is one.
    pub fn take(&mut self) -> Option<Asked> {
        while matches!(self.woken.read(&mut [0; 64]), Ok(read) if read > 0) {}
        let raised = self.flags.iter().find(|(flag, _)| flag.swap(false, Ordering::AcqRel));
        match raised {
            Some((_, request)) => Some(Asked { request: request.clone(), answer: None }),
            None => self.queue.try_recv().ok(),
        }
    }
}

impl Drop for Requests {
    fn drop(&mut self) {
        // Who asked the bridge to end still gets the answer; the process takes the control thread with it.
        while self.queue.try_recv().is_ok() {}
        drop(self.answering.lock());
        if let Some(socket) = &self.socket {
            let _ = fs::remove_file(socket);
        }
    }
}

fn serve(client: UnixStream, asker: &Asker, answering: &Mutex<()>) -> io::Result<()> {
    client.set_read_timeout(Some(CLIENT_LIMIT))?;
    client.set_write_timeout(Some(CLIENT_LIMIT))?;
    let mut line = String::new();
    BufReader::new((&client).take(REQUEST_BYTES_MAX)).read_line(&mut line)?;
    let Some(request) = Request::parse(&line) else {
        return writeln!(&client, r#"{{"ok":false,"error":"unknown request"}}"#);
    };
    let (answer, answered) = sync_channel(1);
    let _answering = answering.lock();
    asker.send(Asked { request, answer: Some(answer) })?;
    let answer = answered.recv_timeout(ANSWER_LIMIT).map_err(io::Error::other)?;
    writeln!(&client, "{answer}")
}

/// Asks the bridge that listens at `path`; gives its line of JSON.
///
/// # Errors
/// Nobody listens there, or no answer came.
pub fn ask(path: &Path, request: &str) -> io::Result<String> {
    let client = UnixStream::connect(path)?;
    client.set_read_timeout(Some(ANSWER_LIMIT + CLIENT_LIMIT))?;
    writeln!(&client, "{request}")?;
    let mut answer = String::new();
    BufReader::new(&client).read_line(&mut answer)?;
    if answer.is_empty() {
        Err(io::ErrorKind::UnexpectedEof.into())
    } else {
        Ok(answer.trim_end().to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_state_requests() {
        for (line, request) in [
            ("status\n", Some(Request::Status)),
            ("panic\r\n", Some(Request::ReleaseAll)),
            ("profile my game.toml\n", Some(Request::Profile(Some("my game.toml".into())))),
            ("profile \n", None),
            ("profile\n", None),
            ("status now\n", None),
            ("", None),
        ] {
            assert_eq!(Request::parse(line), request, "{line:?}");
        }
    }

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
        let asked = requests.take().unwrap();
        assert_eq!(asked.request, Request::Pause);
        asked.answer("{}".into());
        assert_eq!(asking.join().unwrap().unwrap(), "{}");
        assert!(Requests::new().unwrap().listen(&path).is_err(), "two bridges at one socket");
        drop(requests);
        assert!(!path.exists());
    }
    #[test]
    fn a_program_asks_its_own_bridge_from_another_thread() {
        let mut requests = Requests::new().unwrap();
        assert!(requests.take().is_none());
        let asker = requests.asker().unwrap();
        thread::spawn(move || asker.ask(Request::TogglePause)).join().unwrap().unwrap();
        let mut fds = [rustix::event::PollFd::from_borrowed_fd(requests.fd(), rustix::event::PollFlags::IN)];
        rustix::event::poll(&mut fds, None).unwrap();
        assert_eq!(requests.take().map(|asked| asked.request), Some(Request::TogglePause));
        let asker = requests.asker().unwrap();
        drop(requests);
        assert!(asker.ask(Request::End).is_err(), "nobody is there to ask");
    }
}
