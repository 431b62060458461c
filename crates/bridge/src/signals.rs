//! The table of signals and the request that each makes; and the end of the terminal, which not every shell passes on as a signal.

use std::fs::{self, File};
use std::io;
use std::thread;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use signal_hook::consts::{
    SIGABRT, SIGALRM, SIGHUP, SIGINT, SIGQUIT, SIGSTOP, SIGTERM, SIGTSTP, SIGUSR1, SIGUSR2, SIGXCPU,
};
use signal_hook::low_level;

use crate::request::{Request, RequestSender};

/// The conditions at the start of the process that decide the meaning of signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StartConditions {
    /// Whether there is a controlling terminal, whose end is a hang-up.
    has_terminal: bool,
    /// The signals that were ignored then, as `nohup` has it: bit 0 is signal 1.
    ignored: u64,
}

impl StartConditions {
    /// The conditions of this process, if nobody has changed them yet.
    pub(super) fn of_this_process() -> Self {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        Self { has_terminal: terminal().is_some(), ignored: ignored(&status) }
    }

    /// Asks the bridge to end when its terminal is gone, if it has one and is to end with it.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub(super) fn watch_terminal(self, sender: RequestSender) -> io::Result<()> {
        let ends = self.signals().any(|(signal, request)| signal == SIGHUP && request == Request::End);
        if let Some(terminal) = terminal().filter(|_| ends) {
            thread::Builder::new().name("terminal".into()).spawn(move || {
                await_hang_up(&terminal);
                // A bridge that has ended already needs not be asked.
                let _ = sender.send(Request::End);
            })?;
        }
        Ok(())
    }

    /// The signals to catch, and what each asks for.
    pub(super) fn signals(self) -> impl Iterator<Item = (i32, Request)> {
        // A hang-up says that the terminal is gone. Where there is none, it is the custom to read settings again.
        let hang_up = if self.has_terminal { Request::End } else { Request::Profile(None) };
        #[rustfmt::skip]
        let table = [
            // signal  asks for               and if it was ignored at the start
            (SIGINT,  Request::End,          WhenIgnored::Counts),
            (SIGTERM, Request::End,          WhenIgnored::Counts),
            (SIGQUIT, Request::End,          WhenIgnored::Counts),
            // Limits of time, and watchdogs that ask for a core file.
            (SIGALRM, Request::End,          WhenIgnored::Counts),
            (SIGXCPU, Request::End,          WhenIgnored::Counts),
            (SIGABRT, Request::End,          WhenIgnored::Counts),
            (SIGHUP,  hang_up,               WhenIgnored::Stays),
            (SIGTSTP, Request::Stop,         WhenIgnored::Stays),
            (SIGUSR1, Request::ReleaseAll,   WhenIgnored::Counts),
            (SIGUSR2, Request::TogglePause,  WhenIgnored::Counts),
        ];
        let is_ignored = move |signal: i32| self.ignored >> (signal - 1) & 1 == 1;
        let caught = table
            .into_iter()
            .filter(move |(signal, _, ignored)| *ignored == WhenIgnored::Counts || !is_ignored(*signal));
        caught.map(|(signal, request, _)| (signal, request))
    }
}

/// The policy for a signal that was ignored when the process was started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum WhenIgnored {
    /// It counts all the same: a shell that runs a script ignores some for programs in the background.
    Counts,
    /// It stays ignored: whoever started the bridge wants it so.
    Stays,
}

/// The controlling terminal; without one there is no such device.
fn terminal() -> Option<File> {
    File::open("/dev/tty").ok()
}

/// Not every terminal wakes those who wait for its end: it is looked at this often.
const LOOK: Timespec = Timespec { tv_sec: 1, tv_nsec: 0 };

fn await_hang_up(terminal: &File) {
    loop {
        let mut fds = [PollFd::new(terminal, PollFlags::empty())];
        // A signal may break it off: then it is looked at again.
        let _ = poll(&mut fds, Some(&LOOK));
        if fds[0].revents().intersects(PollFlags::HUP | PollFlags::ERR) {
            return;
        }
    }
}

/// The ignored signals in the text of `/proc/self/status`; none if it does not say.
fn ignored(status: &str) -> u64 {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// Stops this process, all of its threads, until it is continued.
///
/// # Errors
/// The system refuses to.
pub(super) fn stop_process() -> io::Result<()> {
    low_level::raise(SIGSTOP)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOREGROUND: StartConditions = StartConditions { has_terminal: true, ignored: 0 };

    fn asked_by(signal: i32, start: StartConditions) -> Option<Request> {
        start.signals().find(|(caught, _)| *caught == signal).map(|(_, request)| request)
    }

    #[test]
    fn a_hang_up_ends_reloads_or_stays_ignored() {
        assert_eq!(asked_by(SIGHUP, FOREGROUND), Some(Request::End));
        let service = StartConditions { has_terminal: false, ..FOREGROUND };
        assert_eq!(asked_by(SIGHUP, service), Some(Request::Profile(None)));
        for start in [FOREGROUND, service] {
            assert_eq!(asked_by(SIGHUP, StartConditions { ignored: 1, ..start }), None);
        }
    }

    #[test]
    fn what_ends_a_bridge_ends_it_also_where_a_shell_ignores_it() {
        let in_background = StartConditions { ignored: 0b110, ..FOREGROUND };
        for signal in [SIGINT, SIGQUIT, SIGTERM, SIGALRM, SIGXCPU, SIGABRT] {
            assert_eq!(asked_by(signal, in_background), Some(Request::End));
        }
    }

    #[test]
    fn ignored_signals_are_read_from_the_status() {
        assert_eq!(ignored("SigBlk:\t0000000000000000\nSigIgn:\t0000000000001001\nSigCgt:\t0"), 0x1001);
        assert_eq!(ignored(""), 0);
    }
}
