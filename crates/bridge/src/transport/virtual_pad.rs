//! A pad made of software behind a real pseudo-terminal, so that the bridge opens it like any serial pad.
//!
//! The firmware is a pure type that is told the time; this file gives it a clock, a thread and a wire.
//! Closing the terminal is what pulling the plug is: the reader sees a hang-up.

use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::thread::{self, JoinHandle};

use rustix::event::{PollFd, PollFlags, poll};
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use tactpad_core::virtual_pad::firmware;

use super::pacing::{
    RETRY_US, StopSignal, WaitOutcome, WriteOutcome, limit, monotonic_us, wait, write_whole,
};

/// The program of a pad, as its wire sees it. Times are microseconds since the pad was started.
pub trait PadFirmware {
    /// Takes bytes from the host.
    fn receive(&mut self, bytes: &[u8]);

    /// When there is something to send next; may lie in the past.
    fn due_us(&self) -> u64;

    /// Appends to `bytes` everything due up to `now_us`; afterwards [`due_us`](Self::due_us) lies later than
    /// that.
    fn emit(&mut self, now_us: u64, bytes: &mut Vec<u8>);
}

impl PadFirmware for firmware::VirtualPad {
    fn receive(&mut self, bytes: &[u8]) {
        Self::receive(self, bytes);
    }

    fn due_us(&self) -> u64 {
        Self::due_us(self)
    }

    fn emit(&mut self, now_us: u64, bytes: &mut Vec<u8>) {
        Self::emit(self, now_us, bytes);
    }
}

/// A running virtual pad. Dropping it pulls the plug.
#[derive(Debug)]
pub struct VirtualPadPort {
    path: String,
    stop: StopSignal,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl VirtualPadPort {
    /// Makes the terminal and starts the pad's clock.
    ///
    /// While nobody has the terminal open the pad talks to nobody, like a port that no program reads. While
    /// it is open nothing is lost: when the reader falls so far behind that the terminal is full, the pad's
    /// clock stands.
    ///
    /// # Errors
    /// The system has no pseudo-terminal or no thread to give.
    pub fn start<F: PadFirmware + Send + 'static>(firmware: F) -> io::Result<Self> {
        let (master, path) = open_terminal()?;
        let stop = StopSignal::new()?;
        let mut wire = Wire { firmware, master, stop: stop.clone(), origin_us: monotonic_us() };
        let thread = thread::Builder::new().name("virtual pad".into()).spawn(move || wire.run())?;
        Ok(Self { path, stop, thread: Some(thread) })
    }

    /// The path of the terminal to open as a serial port.
    pub fn path(&self) -> &str {
        &self.path
    }
}

impl Drop for VirtualPadPort {
    fn drop(&mut self) {
        self.stop.raise();
        if let Some(thread) = self.thread.take() {
            // A wire that broke has hung up already, and the reader saw that.
            let _ = thread.join();
        }
    }
}

/// The master's end and the path of a new terminal in raw mode.
///
/// The mode belongs to the terminal and outlives this first opening; without it the line discipline would
/// echo the pad's bytes and rewrite some of them before the reader sets its own mode.
pub(super) fn open_terminal() -> io::Result<(OwnedFd, String)> {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    rustix::io::ioctl_fionbio(&master, true)?;
    let path = ptsname(&master, Vec::new())?;
    let slave = rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
    let mut mode = tcgetattr(&slave)?;
    mode.make_raw();
    tcsetattr(&slave, OptionalActions::Now, &mode)?;
    Ok((master, path.to_string_lossy().into_owned()))
}

/// A pad's firmware on its wire.
struct Wire<F> {
    firmware: F,
    master: OwnedFd,
    stop: StopSignal,
    origin_us: u64,
}

impl<F: PadFirmware> Wire<F> {
    fn run(&mut self) -> io::Result<()> {
        let mut bytes = Vec::new();
        loop {
            let open = self.is_open()?;
            if self.wait_for_work(open)? == WaitOutcome::Stopped {
                return Ok(());
            }
            if open {
                self.take_commands()?;
            }
            bytes.clear();
            let now_us = monotonic_us().saturating_sub(self.origin_us);
            if self.firmware.due_us() <= now_us {
                self.firmware.emit(now_us, &mut bytes);
            }
            if open && self.write(&bytes)? == WaitOutcome::Stopped {
                return Ok(());
            }
        }
    }

    fn wait_for_work(&self, open: bool) -> io::Result<WaitOutcome> {
        let due_us = self.origin_us.saturating_add(self.firmware.due_us());
        if open {
            return wait(&self.stop, Some((self.master.as_fd(), PollFlags::IN)), due_us);
        }
        // A terminal that nobody has open reports its hang-up without end, so it is looked at now and then
        // instead.
        wait(&self.stop, None, due_us.min(monotonic_us().saturating_add(RETRY_US)))
    }

    fn is_open(&self) -> io::Result<bool> {
        let mut fds = [PollFd::new(&self.master, PollFlags::empty())];
        rustix::io::retry_on_intr(|| poll(&mut fds, Some(&limit(0))))?;
        Ok(!fds[0].revents().contains(PollFlags::HUP))
    }

    fn take_commands(&mut self) -> io::Result<()> {
        let mut bytes = [0; 256];
        match rustix::io::read(&self.master, &mut bytes) {
            Ok(count) => self.firmware.receive(bytes.get(..count).unwrap_or_default()),
            // Input/output error is how the master hears that the last reader has left.
            Err(Errno::AGAIN | Errno::INTR | Errno::IO) => {}
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<WaitOutcome> {
        match write_whole(&self.stop, self.master.as_fd(), bytes)? {
            WriteOutcome::Whole { blocked_us } => self.origin_us = self.origin_us.saturating_add(blocked_us),
            WriteOutcome::Gone => {}
            WriteOutcome::Stopped => return Ok(WaitOutcome::Stopped),
        }
        Ok(WaitOutcome::Ready)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::sync::{Arc, Mutex};

    use super::super::Transport;
    use super::super::serial::Serial;
    use super::*;

    /// Sends numbered chunks at a fixed pace and keeps what it hears.
    struct Fake {
        period_us: u64,
        chunks: u32,
        chunk_len: usize,
        sent: Arc<AtomicU32>,
        heard: Arc<Mutex<Vec<u8>>>,
    }

    impl Fake {
        fn new(period_us: u64, chunks: u32, chunk_len: usize) -> Self {
            Self { period_us, chunks, chunk_len, sent: Arc::default(), heard: Arc::default() }
        }
    }

    /// A chunk of `len` bytes: its number, then every byte value in turn, starting from one that depends on
    /// it.
    fn chunk(number: u32, len: usize) -> Vec<u8> {
        let filling = (0..).map(|i: u32| number.wrapping_add(i) as u8);
        number.to_le_bytes().into_iter().chain(filling).take(len).collect()
    }

    impl PadFirmware for Fake {
        fn receive(&mut self, bytes: &[u8]) {
            self.heard.lock().unwrap().extend_from_slice(bytes);
        }

        fn due_us(&self) -> u64 {
            let sent = self.sent.load(Ordering::SeqCst);
            if sent < self.chunks { u64::from(sent) * self.period_us } else { u64::MAX }
        }

        fn emit(&mut self, now_us: u64, bytes: &mut Vec<u8>) {
            while self.due_us() <= now_us {
                bytes.extend(chunk(self.sent.fetch_add(1, Ordering::SeqCst), self.chunk_len));
            }
        }
    }

    fn polls(port: &Serial) -> bool {
        let fd = port.fd();
        poll(&mut [PollFd::new(&fd, PollFlags::IN)], Some(&limit(60_000_000))) == Ok(1)
    }

    fn read_exactly(port: &mut Serial, count: usize) -> Vec<u8> {
        let mut all = Vec::new();
        while all.len() < count {
            assert!(polls(port), "silent after {} of {count} bytes", all.len());
            let mut bytes = vec![0; count - all.len()];
            let taken = port.read(&mut bytes).unwrap();
            all.extend_from_slice(&bytes[..taken]);
        }
        all
    }

    /// Waits until `condition` holds.
    fn eventually(condition: impl Fn() -> bool) {
        let stop = StopSignal::new().unwrap();
        let until_us = monotonic_us() + 60_000_000;
        while !condition() {
            assert!(monotonic_us() < until_us, "never happened");
            wait(&stop, None, monotonic_us() + 200).unwrap();
        }
    }

    /// How many whole chunks of `len` bytes, numbered without a gap, `bytes` holds. Opening a terminal clears it, which may
    /// cut the first chunk: the first whole one is looked for.
    fn whole_chunks(bytes: &[u8], len: usize) -> usize {
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let start = (0..len).find(|&at| bytes[at..at + len] == chunk(number(at), len)).unwrap();
        let chunks = bytes[start..].chunks_exact(len);
        let count = chunks.len();
        for (number, bytes) in (number(start)..).zip(chunks) {
            assert!(bytes == chunk(number, len), "chunk {number}");
        }
        count
    }

    fn open(pad: &VirtualPadPort) -> Serial {
        Serial::open(pad.path(), 2_000_000).unwrap()
    }

    #[test]
    fn a_thousand_chunks_arrive_unchanged_and_in_order() {
        const LEN: usize = 260;
        let pad = VirtualPadPort::start(Fake::new(200, u32::MAX, LEN)).unwrap();
        let mut port = open(&pad);
        let bytes = read_exactly(&mut port, 1001 * LEN);
        assert!(whole_chunks(&bytes, LEN) >= 1000);
    }

    #[test]
    fn commands_reach_the_firmware_unchanged() {
        let fake = Fake::new(0, 0, 0);
        let heard = Arc::clone(&fake.heard);
        let pad = VirtualPadPort::start(fake).unwrap();
        let port = open(&pad);
        let every_byte: Vec<u8> = (0..=255).collect();
        for _ in 0..10 {
            port.write_whole(&every_byte).unwrap();
        }
        eventually(|| heard.lock().unwrap().len() == 2560);
        assert_eq!(*heard.lock().unwrap(), every_byte.repeat(10));
    }

    #[test]
    fn full_terminal_loses_nothing_and_stops_the_clock() {
        const LEN: usize = 20_000;
        let fake = Fake::new(20_000, u32::MAX, LEN);
        let sent = Arc::clone(&fake.sent);
        let pad = VirtualPadPort::start(fake).unwrap();
        let mut port = open(&pad);
        let from_us = monotonic_us();
        // 400 ms without a reader: twenty chunks are due, the terminal holds fewer than five.
        let stop = StopSignal::new().unwrap();
        while monotonic_us() < from_us + 400_000 {
            wait(&stop, None, from_us + 400_000).unwrap();
        }
        assert!(sent.load(Ordering::SeqCst) < 10, "{sent:?} chunks");
        let bytes = read_exactly(&mut port, 9 * LEN);
        assert!(whole_chunks(&bytes, LEN) >= 8);
    }

    #[test]
    fn unopened_pad_talks_to_nobody() {
        let fake = Fake::new(500, u32::MAX, 4);
        let sent = Arc::clone(&fake.sent);
        let pad = VirtualPadPort::start(fake).unwrap();
        eventually(|| sent.load(Ordering::SeqCst) >= 20);
        let mut port = open(&pad);
        let first = u32::from_le_bytes(read_exactly(&mut port, 4).try_into().unwrap());
        assert!(first >= 19, "chunk {first} waited for a reader");
    }

    #[test]
    fn pad_can_be_opened_again() {
        let pad = VirtualPadPort::start(Fake::new(500, u32::MAX, 4)).unwrap();
        let number = |port: &mut Serial| u32::from_le_bytes(read_exactly(port, 4).try_into().unwrap());
        let first = number(&mut open(&pad));
        let second = number(&mut open(&pad));
        assert!(second > first, "{second} after {first}");
    }

    #[test]
    fn dropping_is_pulling_the_plug() {
        let pad = VirtualPadPort::start(Fake::new(0, 0, 0)).unwrap();
        let mut port = open(&pad);
        drop(pad);
        assert!(polls(&port));
        assert_eq!(port.read(&mut [0; 8]).unwrap_err().kind(), io::ErrorKind::BrokenPipe);
    }

    #[test]
    fn dropping_ends_a_pad_that_waits_for_room() {
        let fake = Fake::new(0, 1, 1_000_000);
        let sent = Arc::clone(&fake.sent);
        let pad = VirtualPadPort::start(fake).unwrap();
        let _port = open(&pad);
        eventually(|| sent.load(Ordering::SeqCst) == 1);
        drop(pad);
    }
}
