//! A pad that sends no frames of its own as one that does, so that everything behind hears one language.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

use firmware_proto::command::Command;
use rustix::event::epoll;
use rustix::time::{
    Itimerspec, TimerfdClockId, TimerfdFlags, TimerfdTimerFlags, timerfd_create, timerfd_settime,
};
use tactpad_core::pipeline::line_check::LineFinding;

use super::Transport;
use super::pacing::{limit, monotonic_us};

/// What frames are made of. Times count from when it was opened, µs.
pub(super) trait Framed {
    /// The descriptors to poll for what it says.
    fn fds(&self) -> impl Iterator<Item = BorrowedFd<'_>>;

    /// Appends frames to `out` of what it has said by `now_us`, and of its last state once more if that is due. Does not wait. Fails once it
    /// is gone.
    fn take(&mut self, now_us: u64, out: &mut Vec<u8>) -> io::Result<()>;

    /// When more is to be done if it says nothing before.
    fn due_us(&self) -> Option<u64>;

    /// See [`Transport::finding`].
    fn finding(&self) -> Option<LineFinding> {
        None
    }

    /// See [`Transport::pause`]; fails if it is gone.
    fn pause(&mut self, _now_us: u64, _is_paused: bool) -> io::Result<()> {
        Ok(())
    }

    /// See [`Transport::asks_pause`].
    fn asks_pause(&mut self) -> bool {
        false
    }
}

/// A transport of frames that are made here.
pub(super) struct FramedPort<S> {
    source: S,
    /// When it was opened, by the monotonic clock.
    origin_us: u64,
    /// Frames that were not read yet.
    out: Vec<u8>,
    /// How the source ended.
    ended: Option<io::ErrorKind>,
    /// Readable while the source or the timer is: so a poll sees both.
    either: OwnedFd,
    timer: OwnedFd,
}

impl<S: Framed> FramedPort<S> {
    /// Reads `source`. Fails where the kernel gives no more descriptors, or that of the source cannot be polled together with others.
    pub(super) fn new(source: S) -> io::Result<Self> {
        let either = epoll::create(epoll::CreateFlags::CLOEXEC)?;
        let timer =
            timerfd_create(TimerfdClockId::Monotonic, TimerfdFlags::CLOEXEC | TimerfdFlags::NONBLOCK)?;
        for fd in source.fds().chain([timer.as_fd()]) {
            epoll::add(&either, fd, epoll::EventData::new_u64(0), epoll::EventFlags::IN)?;
        }
        let port = Self { source, origin_us: monotonic_us(), out: Vec::new(), ended: None, either, timer };
        port.set_timer()?;
        Ok(port)
    }

    fn now_us(&self) -> u64 {
        monotonic_us().saturating_sub(self.origin_us)
    }

    /// Ends with `error`, if it is one. A source that is gone is readable for ever.
    fn end(&mut self, done: io::Result<()>) -> io::Result<()> {
        match done {
            Err(error) if self.ended.is_none() => {
                self.ended = Some(error.kind());
                for fd in self.source.fds() {
                    epoll::delete(&self.either, fd)?;
                }
                self.set_timer()
            }
            _ => Ok(()),
        }
    }

    /// Lets the descriptor poll readable when the source is due, or at once if frames or the end are to be told.
    fn set_timer(&self) -> io::Result<()> {
        let is_more = !self.out.is_empty() || self.ended.is_some();
        let due_us = self.source.due_us().map_or(0, |due_us| self.origin_us + due_us);
        // Zero would stop the timer.
        let it_value = limit(if is_more { 1 } else { due_us });
        let timer = Itimerspec { it_interval: limit(0), it_value };
        timerfd_settime(&self.timer, TimerfdTimerFlags::ABSTIME, &timer)?;
        Ok(())
    }
}

impl<S: Framed> Transport for FramedPort<S> {
    fn fd(&self) -> BorrowedFd<'_> {
        self.either.as_fd()
    }

    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let now_us = self.now_us();
        // What is not handed over yet comes first: a source that floods must not fill the memory.
        if self.ended.is_none() && self.out.is_empty() {
            let taken = self.source.take(now_us, &mut self.out);
            self.end(taken)?;
        }
        let count = self.out.len().min(bytes.len());
        bytes.iter_mut().zip(self.out.drain(..count)).for_each(|(to, from)| *to = from);
        self.set_timer()?;
        match (count, self.ended) {
            (0, Some(kind)) => Err(kind.into()),
            (0, None) => Err(io::ErrorKind::WouldBlock.into()),
            (count, _) => Ok(count),
        }
    }

    /// Does nothing: what sends no frames takes no commands of ours.
    fn send(&mut self, _command: &Command) -> io::Result<()> {
        Ok(())
    }

    fn finding(&self) -> Option<LineFinding> {
        self.source.finding()
    }

    fn pause(&mut self, is_paused: bool) {
        let done = self.source.pause(self.now_us(), is_paused);
        // Who reads next is told.
        drop(self.end(done));
    }

    fn asks_pause(&mut self) -> bool {
        self.source.asks_pause()
    }
}
