//! The firmware as a running program.

use std::io::Read;
use std::os::fd::{AsFd, BorrowedFd};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::OnceLock;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::process::{Pid, Signal, kill_process};
use rustix::time::{ClockId, clock_gettime};

use crate::c_compiler::compile;
use crate::guest::{in_guest, inside, scratch};

/// Far longer than anything here takes on a loaded machine.
const DEADLINE_MS: u64 = 120_000;

/// The firmware on its host board, compiled once. A guest finds what its host compiled.
fn program() -> Option<&'static Path> {
    static PROGRAM: OnceLock<Option<PathBuf>> = OnceLock::new();
    let sources = [
        "firmware-proto/c/firmware/host_board.c",
        "firmware-proto/c/firmware/pad_firmware.c",
        "firmware-proto/c/tactpad_proto.c",
    ];
    let find = || {
        if inside() { Some(scratch().join(NAME)) } else { compile(NAME, &sources, &["-O2"]) }
    };
    PROGRAM.get_or_init(find).as_deref()
}

/// Of the compiled firmware.
const NAME: &str = "host-pad";

/// Runs `body` in a guest, where this machine has a compiler for the firmware.
pub(crate) fn in_guest_with_firmware(name: &str, body: impl FnOnce()) {
    if program().is_some() {
        in_guest(name, body);
    }
}

/// A running firmware; it is killed when this value goes.
pub(crate) struct HostPad {
    child: Child,
    said: ChildStdout,
    unread: Vec<u8>,
    /// The terminal to open as a serial port.
    pub(crate) path: String,
}

/// What the firmware counted.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) samples: u64,
    pub(crate) bytes_not_taken: u64,
    pub(crate) stalls: u64,
}

impl HostPad {
    /// Starts it; `None` where there is no compiler.
    pub(crate) fn start(rate_hz: u64) -> Option<Self> {
        let program = program()?;
        let mut child = Command::new(program)
            .arg(rate_hz.to_string())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let said = child.stdout.take().unwrap();
        let mut pad = Self { child, said, unread: Vec::new(), path: String::new() };
        pad.path = pad.line();
        Some(pad)
    }

    /// The next line that it prints.
    pub(crate) fn line(&mut self) -> String {
        loop {
            if let Some(end) = self.unread.iter().position(|byte| *byte == b'\n') {
                let line = self.unread.drain(..=end).collect();
                return String::from_utf8(line).unwrap().trim_end().to_owned();
            }
            let mut bytes = [0; 256];
            assert!(is_readable(self.said.as_fd()), "the firmware says nothing");
            let count = self.said.read(&mut bytes).unwrap();
            assert!(count > 0, "the firmware has ended");
            self.unread.extend(&bytes[..count]);
        }
    }

    /// Ends it by a signal and reads its counts.
    pub(crate) fn end(mut self) -> Counts {
        kill_process(Pid::from_child(&self.child), Signal::TERM).unwrap();
        let mut line = self.line();
        while line.starts_with("light") {
            line = self.line();
        }
        assert!(self.child.wait().unwrap().success());
        let numbers = line.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok());
        let [samples, bytes_not_taken, stalls] = numbers.collect::<Vec<_>>()[..] else { panic!("{line}") };
        Counts { samples, bytes_not_taken, stalls }
    }
}

impl Drop for HostPad {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Waits until there is something to read; false if nothing comes.
pub(crate) fn is_readable(fd: BorrowedFd<'_>) -> bool {
    let deadline_ms = monotonic_ms() + DEADLINE_MS;
    loop {
        let rest_ms = deadline_ms.saturating_sub(monotonic_ms());
        let limit = Timespec {
            tv_sec: i64::try_from(rest_ms / 1_000).unwrap(),
            tv_nsec: i64::try_from(rest_ms % 1_000 * 1_000_000).unwrap(),
        };
        match poll(&mut [PollFd::from_borrowed_fd(fd, PollFlags::IN)], Some(&limit)) {
            Err(Errno::INTR) => {}
            ready => return ready == Ok(1),
        }
    }
}

fn monotonic_ms() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    u64::try_from(now.tv_sec * 1_000 + now.tv_nsec / 1_000_000).unwrap()
}
