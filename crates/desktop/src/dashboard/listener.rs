//! Connections to the page: a limited number, and none that says nothing for long. The pad and `ctl` need descriptors, too.

use std::fs;
use std::future::{Future, poll_fn};
use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use axum::extract::connect_info::Connected;
use axum::serve::{IncomingStream, Listener};
use rustix::process::getuid;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Sleep, sleep};

/// So many connections at once of this user's programs, and of others': a relay of a virtual machine may be one.
const OWN_MAX: usize = 128;
const OTHERS_MAX: usize = 16;

/// A connection that has asked for nothing by then is closed.
const ASK_LIMIT: Duration = Duration::from_secs(3);

/// A listener that fails, for want of descriptors, is tried again after this pause.
const RETRY: Duration = Duration::from_millis(250);

/// `ESTABLISHED` in the kernel's table of connections.
const ESTABLISHED: &str = "01";

/// Lets connections in, at all addresses of this server.
pub(super) struct LimitedListener {
    listeners: Vec<TcpListener>,
    own: Arc<Semaphore>,
    others: Arc<Semaphore>,
}

/// The other end of a connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peer {
    /// Whether it is a program of the user of this process.
    pub(super) is_own: bool,
}

/// A connection, one of a limited number.
pub(super) struct LimitedStream {
    stream: TcpStream,
    /// Until then it has to ask for something; `None` once it has an answer.
    limit: Option<Pin<Box<Sleep>>>,
    _permit: OwnedSemaphorePermit,
}

impl LimitedListener {
    pub(super) fn new(listeners: Vec<TcpListener>) -> Self {
        let [own, others] = [OWN_MAX, OTHERS_MAX].map(|count| Arc::new(Semaphore::new(count)));
        Self { listeners, own, others }
    }

    /// The next connection at any of them.
    async fn next(&self) -> io::Result<(TcpStream, SocketAddr)> {
        poll_fn(|cx| {
            let mut polled = self.listeners.iter().map(|listener| listener.poll_accept(cx));
            polled.find(Poll::is_ready).unwrap_or(Poll::Pending)
        })
        .await
    }
}

impl Listener for LimitedListener {
    type Io = LimitedStream;
    type Addr = Peer;

    async fn accept(&mut self) -> (LimitedStream, Peer) {
        loop {
            let Ok((stream, address)) = self.next().await else {
                sleep(RETRY).await;
                continue;
            };
            let is_own = stream.local_addr().is_ok_and(|here| is_own(address, here));
            let places = if is_own { &self.own } else { &self.others };
            // One too many is closed.
            if let Ok(permit) = Arc::clone(places).try_acquire_owned() {
                let limit = Some(Box::pin(sleep(ASK_LIMIT)));
                return (LimitedStream { stream, limit, _permit: permit }, Peer { is_own });
            }
        }
    }

    fn local_addr(&self) -> io::Result<Peer> {
        Ok(Peer { is_own: true })
    }
}

impl Connected<IncomingStream<'_, LimitedListener>> for Peer {
    fn connect_info(stream: IncomingStream<'_, LimitedListener>) -> Self {
        *stream.remote_addr()
    }
}

impl AsyncRead for LimitedStream {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buf: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        if let Some(limit) = &mut self.limit
            && limit.as_mut().poll(cx).is_ready()
        {
            return Poll::Ready(Err(io::ErrorKind::TimedOut.into()));
        }
        Pin::new(&mut self.stream).poll_read(cx, buf)
    }
}

impl AsyncWrite for LimitedStream {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let written = ready!(Pin::new(&mut self.stream).poll_write(cx, bytes));
        self.limit = None;
        Poll::Ready(written)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

/// Whether the program at the other end of this connection within the machine is this user's, by the kernel's table.
fn is_own(there: SocketAddr, here: SocketAddr) -> bool {
    let table = fs::read_to_string("/proc/net/tcp").unwrap_or_default();
    owner(&table, there, here) == Some(getuid().as_raw())
}

/// The user whose program has the established connection from `from` to `to`.
fn owner(table: &str, from: SocketAddr, to: SocketAddr) -> Option<u32> {
    let [from, to] = [written(from)?, written(to)?];
    table.lines().find_map(|line| {
        // Number, own address, other address, state, queues, timer, retransmissions, user.
        let words: Vec<&str> = line.split_whitespace().collect();
        let is_it = words.get(1..4)? == [from.as_str(), to.as_str(), ESTABLISHED];
        is_it.then(|| words.get(7)?.parse().ok()).flatten()
    })
}

/// An address as the kernel's table has it: four bytes as the machine's number, and the port.
fn written(address: SocketAddr) -> Option<String> {
    let SocketAddr::V4(address) = address else { return None };
    Some(format!("{:08X}:{:04X}", u32::from_ne_bytes(address.ip().octets()), address.port()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_owner_of_a_connection_stands_in_the_table() {
        let table = "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n   \
            0: 0100007F:1F90 00000000:0000 0A 00000000:00000000 00:00000000 00000000  1000        0 1\n   \
            1: 0100007F:C350 0100007F:1F90 06 00000000:00000000 00:00000000 00000000     0        0 2\n   \
            2: 0100007F:C351 0100007F:1F90 01 00000000:00000000 00:00000000 00000000  1001        0 3\n";
        let at = |port| SocketAddr::from(([127, 0, 0, 1], port));
        if cfg!(target_endian = "little") {
            assert_eq!(owner(table, at(50_001), at(8080)), Some(1001));
        }
        assert_eq!(owner(table, at(50_000), at(8080)), None, "one that was closed is nobody's");
        assert_eq!(owner(table, at(8080), at(50_001)), None);
    }
}
