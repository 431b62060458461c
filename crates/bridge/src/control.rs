//! The control socket: one line asks, one line of JSON answers.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::sync::{Arc, Mutex};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::net::sockopt::socket_peercred;
use rustix::net::{self, AddressFamily, SocketAddrUnix, SocketFlags, SocketType, socket_with};
use rustix::process::getuid;

use crate::clock::Clock;
use crate::request::{ANSWER_LIMIT, Request, RequestSender};
use crate::watchers::Watchers;
use tactpad_core::time::HostInstant;

/// A client that has not asked for this long is sent away.
const CLIENT_LIMIT_US: u64 = 1_000_000;

/// So many clients may be about to ask. One more, and the oldest is sent away.
const CLIENTS_MAX: usize = 32;

/// The longest request.
const REQUEST_BYTES_MAX: usize = 4_096;

/// Asks for a line for each press from now on.
const WATCH: &str = "watch";

/// How often clients that say nothing are looked at.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 250_000_000 };

/// A client that has not finished its line.
struct Client {
    stream: UnixStream,
    since: HostInstant,
    line: Vec<u8>,
}

/// Answers clients, each when its line is there: nobody waits for another who says nothing.
pub(super) struct Server {
    listener: UnixListener,
    /// The oldest first.
    clients: VecDeque<Client>,
    clock: Clock,
    sender: RequestSender,
    /// Held while a client gets its answer.
    answering: Arc<Mutex<()>>,
    watchers: Watchers,
}

impl Server {
    /// Serves whoever comes to `listener`.
    ///
    /// # Errors
    /// The listener cannot be polled.
    pub(super) fn new(
        listener: UnixListener,
        sender: RequestSender,
        answering: Arc<Mutex<()>>,
        watchers: Watchers,
    ) -> io::Result<Self> {
        listener.set_nonblocking(true)?;
        Ok(Self { listener, clients: VecDeque::new(), clock: Clock::start(), sender, answering, watchers })
    }

    /// Serves until the process ends.
    pub(super) fn run(&mut self) {
        while self.wait().is_ok() {
            let now = self.clock.now();
            self.admit(now);
            for _ in 0..self.clients.len() {
                self.hear_next(now);
            }
        }
    }

    /// Sleeps until somebody comes or says something.
    fn wait(&self) -> io::Result<()> {
        let mut fds = vec![PollFd::new(&self.listener, PollFlags::IN)];
        fds.extend(self.clients.iter().map(|client| PollFd::new(&client.stream, PollFlags::IN)));
        let limit = (!self.clients.is_empty()).then_some(&LOOK);
        match poll(&mut fds, limit) {
            Ok(_) | Err(Errno::INTR) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Takes in all who wait at the door.
    fn admit(&mut self, now: HostInstant) {
        while let Ok((stream, _)) = self.listener.accept() {
            if self.clients.len() == CLIENTS_MAX {
                self.make_room();
            }
            if is_own(&stream) && stream.set_nonblocking(true).is_ok() {
                self.clients.push_back(Client { stream, since: now, line: Vec::new() });
            }
        }
    }

    /// Sends the oldest client away, with its answer if it has asked by now.
    fn make_room(&mut self) {
        if let Some(mut oldest) = self.clients.pop_front()
            && matches!(oldest.read(), Ok(true))
        {
            let _ = self.serve(&oldest);
        }
    }

    /// Hears the oldest client: answers it if its line is whole, and keeps it, in its place, if it may still ask.
    fn hear_next(&mut self, now: HostInstant) {
        let Some(mut client) = self.clients.pop_front() else { return };
        let is_heard = client.read();
        if matches!(is_heard, Ok(true)) {
            // A client that misbehaves harms nobody but itself.
            let _ = self.serve(&client);
        } else if is_heard.is_ok() && now.us_since(client.since) < CLIENT_LIMIT_US {
            self.clients.push_back(client);
        }
    }

    fn serve(&self, client: &Client) -> io::Result<()> {
        if client.line.trim_ascii_end() == WATCH.as_bytes() {
            if self.watchers.add(&client.stream)? {
                return Ok(());
            }
            return writeln!(
                &client.stream,
                r#"{{"ok":false,"error":"too many watch already: end one of them"}}"#
            );
        }
        let Some(request) = Request::parse(&String::from_utf8_lossy(&client.line)) else {
            return writeln!(&client.stream, r#"{{"ok":false,"error":"unknown request"}}"#);
        };
        let _answering = self.answering.lock();
        let answer = self.sender.send_and_wait(request)?;
        // An answer has room in the socket; who leaves none is not waited for.
        (&client.stream).write_all(format!("{answer}\n").as_bytes())
    }
}

impl Client {
    /// Takes what is there of the line. True when the line is whole.
    ///
    /// # Errors
    /// The client went away, or asks for more than there is to ask.
    fn read(&mut self) -> io::Result<bool> {
        let mut bytes = [0; 512];
        loop {
            match (&self.stream).read(&mut bytes) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(read) => self.line.extend_from_slice(bytes.get(..read).unwrap_or_default()),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(false),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
            if self.line.contains(&b'\n') {
                return Ok(true);
            }
            if self.line.len() > REQUEST_BYTES_MAX {
                return Err(io::ErrorKind::InvalidData.into());
            }
        }
    }
}

/// Whether the other end belongs to the user of this process. The socket's permissions say the same, from the moment on at which they are set.
fn is_own(stream: &UnixStream) -> bool {
    socket_peercred(stream).is_ok_and(|peer| peer.uid == getuid())
}

/// A connection to the bridge that listens at `path`, which must be the same user's.
fn connect(path: &Path) -> io::Result<UnixStream> {
    let stream = connect_at_once(path)?;
    if is_own(&stream) { Ok(stream) } else { Err(io::ErrorKind::PermissionDenied.into()) }
}

/// A connection to whoever listens at `path`.
///
/// # Errors
/// Nobody listens, or who listens lets nobody in: then the kind is `TimedOut`, though nobody is waited for.
fn connect_at_once(path: &Path) -> io::Result<UnixStream> {
    let flags = SocketFlags::CLOEXEC | SocketFlags::NONBLOCK;
    let socket = socket_with(AddressFamily::UNIX, SocketType::STREAM, flags, None)?;
    match net::connect(&socket, &SocketAddrUnix::new(path)?) {
        Ok(()) => {}
        Err(Errno::AGAIN) => return Err(io::ErrorKind::TimedOut.into()),
        Err(error) => return Err(error.into()),
    }
    let stream = UnixStream::from(socket);
    stream.set_nonblocking(false)?;
    Ok(stream)
}

/// Whether a bridge listens at `path`, be it one that does not answer.
pub fn is_there(path: &Path) -> bool {
    connect_at_once(path).map_or_else(|error| error.kind() == io::ErrorKind::TimedOut, |_| true)
}

/// Asks the bridge that listens at `path`; gives its line of JSON.
///
/// # Errors
/// Nobody listens there, or no answer came: then the kind is `TimedOut`.
pub fn ask(path: &Path, request: &str) -> io::Result<String> {
    let client = connect(path)?;
    client.set_read_timeout(Some(2 * ANSWER_LIMIT))?;
    client.set_write_timeout(Some(ANSWER_LIMIT))?;
    let mut answer = String::new();
    let asked = writeln!(&client, "{request}").and_then(|()| BufReader::new(&client).read_line(&mut answer));
    match asked {
        Ok(_) if !answer.is_empty() => Ok(answer.trim_end().to_owned()),
        Ok(_) => Err(io::ErrorKind::TimedOut.into()),
        Err(error) if is_no_answer(error.kind()) => Err(io::ErrorKind::TimedOut.into()),
        Err(error) => Err(error),
    }
}

/// Watches what becomes of each press at the bridge that listens at `path`, until that ends or `each` fails: first its answer, then a line of
/// JSON for each press.
///
/// # Errors
/// Nobody listens there, or no answer came: then the kind is `TimedOut`; or what `each` gave.
pub fn watch(path: &Path, mut each: impl FnMut(&str) -> io::Result<()>) -> io::Result<()> {
    let client = connect(path)?;
    client.set_read_timeout(Some(2 * ANSWER_LIMIT))?;
    writeln!(&client, "{WATCH}")?;
    let mut lines = BufReader::new(&client).lines();
    let answer = lines.next().transpose().map_err(|error| match is_no_answer(error.kind()) {
        true => io::ErrorKind::TimedOut.into(),
        false => error,
    })?;
    each(&answer.ok_or(io::ErrorKind::TimedOut)?)?;
    // From here on it says something only when somebody presses.
    client.set_read_timeout(None)?;
    lines.try_for_each(|line| each(&line?))
}

/// Whether somebody listened, and did not answer.
const fn is_no_answer(kind: io::ErrorKind) -> bool {
    use io::ErrorKind::{BrokenPipe, ConnectionReset, TimedOut, WouldBlock};
    matches!(kind, WouldBlock | TimedOut | BrokenPipe | ConnectionReset)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    /// A server that nobody runs, and how to reach it.
    fn server(folder: &Path) -> (Server, std::path::PathBuf) {
        let path = folder.join("socket");
        let (ask, _) = channel();
        let wake = UnixStream::pair().unwrap().0;
        let listener = UnixListener::bind(&path).unwrap();
        let watchers = Watchers::default();
        (Server::new(listener, RequestSender { queue: ask, wake }, Arc::default(), watchers).unwrap(), path)
    }

    /// The answer to the client; `None` if it was sent away.
    fn answer(mut client: &UnixStream) -> Option<String> {
        let mut answer = String::new();
        client.read_to_string(&mut answer).ok().filter(|read| *read > 0).map(|_| answer)
    }

    #[test]
    fn a_listener_that_lets_nobody_in_is_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let _listener = UnixListener::bind(&path).unwrap();
        let mut waiting = Vec::new();
        let error = loop {
            match connect_at_once(&path) {
                Ok(stream) => waiting.push(stream),
                Err(error) => break error,
            }
        };
        assert_eq!(error.kind(), io::ErrorKind::TimedOut, "after {}", waiting.len());
        assert_eq!(ask(&path, "status").unwrap_err().kind(), io::ErrorKind::TimedOut);
    }

    #[test]
    fn the_oldest_makes_room_and_is_answered_if_it_has_asked() {
        let folder = tempfile::tempdir().unwrap();
        let (mut server, path) = server(folder.path());
        let clients: Vec<_> = (0..CLIENTS_MAX + 2).map(|_| UnixStream::connect(&path).unwrap()).collect();
        writeln!(&clients[1], "what?").unwrap();
        server.admit(HostInstant::default());
        assert_eq!(server.clients.len(), CLIENTS_MAX);
        assert_eq!(answer(&clients[0]), None);
        assert!(answer(&clients[1]).unwrap().contains("unknown request"));
    }

    #[test]
    fn who_says_nothing_or_too_much_is_sent_away() {
        let folder = tempfile::tempdir().unwrap();
        let (mut server, path) = server(folder.path());
        let [silent, endless, slow] = std::array::from_fn(|_| UnixStream::connect(&path).unwrap());
        (&endless).write_all(&[b'x'; REQUEST_BYTES_MAX + 1]).unwrap();
        (&slow).write_all(b"stat").unwrap();
        let start = HostInstant::default();
        server.admit(start);
        (0..3).for_each(|_| server.hear_next(start));
        assert_eq!(server.clients.len(), 2, "the endless one is gone");
        (0..2).for_each(|_| server.hear_next(start.plus_us(CLIENT_LIMIT_US)));
        assert!(server.clients.is_empty());
        drop(server);
        assert!([silent, slow].iter().all(|client| answer(client).is_none()));
    }
}
