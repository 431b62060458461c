//! A pad that prints lines of text: they become frames here, so that everything behind hears one language.

pub mod frames;
mod look;
mod still;
#[cfg(test)]
mod tests;

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

use firmware_proto::command::Command;
use rustix::event::epoll;
use rustix::time::{
    Itimerspec, TimerfdClockId, TimerfdFlags, TimerfdTimerFlags, timerfd_create, timerfd_settime,
};
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::source::Lines;

use super::Transport;
use super::pacing::{is_readable, limit, monotonic_us};
use frames::LineFrames;

/// A transport of lines, as one of frames.
pub struct LinePort {
    port: Box<dyn Transport>,
    frames: LineFrames,
    /// When the port was opened, by the monotonic clock: frames count from there.
    origin_us: u64,
    /// Frames that were not read yet.
    out: Vec<u8>,
    /// How the port ended.
    ended: Option<io::ErrorKind>,
    /// Readable while `port` or `timer` is: so a poll sees both.
    either: OwnedFd,
    timer: OwnedFd,
}

impl LinePort {
    /// Reads `port`, which sends lines.
    ///
    /// # Errors
    /// The kernel gives no more descriptors, or that of the port cannot be polled together with others.
    pub fn new(port: Box<dyn Transport>, lines: &Lines) -> io::Result<Self> {
        let either = epoll::create(epoll::CreateFlags::CLOEXEC)?;
        let timer =
            timerfd_create(TimerfdClockId::Monotonic, TimerfdFlags::CLOEXEC | TimerfdFlags::NONBLOCK)?;
        for fd in [port.fd(), timer.as_fd()] {
            epoll::add(&either, fd, epoll::EventData::new_u64(0), epoll::EventFlags::IN)?;
        }
        Ok(Self {
            port,
            frames: LineFrames::new(lines),
            origin_us: monotonic_us(),
            out: Vec::new(),
            ended: None,
            either,
            timer,
        })
    }

    /// Takes what the port has sent by `now_us`.
    fn take(&mut self, now_us: u64) -> io::Result<()> {
        // What is not handed over yet comes first: a port that floods must not fill the memory.
        if self.ended.is_some() || !self.out.is_empty() || !is_readable(self.port.fd())? {
            return Ok(());
        }
        let mut bytes = [0; 4096];
        match self.port.read(&mut bytes) {
            Ok(count) if count > 0 => {
                self.frames.take(now_us, bytes.get(..count).unwrap_or_default(), &mut self.out);
            }
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {}
            gone => {
                // A port that is gone is readable for ever.
                epoll::delete(&self.either, self.port.fd())?;
                self.ended = Some(gone.err().map_or(io::ErrorKind::UnexpectedEof, |error| error.kind()));
            }
        }
        Ok(())
    }

    /// Lets the descriptor poll readable when the last state is to be repeated, or at once if frames or the end are to be told.
    fn set_timer(&self) -> io::Result<()> {
        let is_more = !self.out.is_empty() || self.ended.is_some();
        let due_us =
            if is_more { Some(1) } else { self.frames.due_us().map(|due_us| self.origin_us + due_us) };
        // Zero would stop the timer, and so does `None`.
        let it_value = limit(due_us.map_or(0, |due_us| due_us.max(1)));
        let timer = Itimerspec { it_interval: limit(0), it_value };
        timerfd_settime(&self.timer, TimerfdTimerFlags::ABSTIME, &timer)?;
        Ok(())
    }
}

impl Transport for LinePort {
    fn fd(&self) -> BorrowedFd<'_> {
        self.either.as_fd()
    }

    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let now_us = monotonic_us().saturating_sub(self.origin_us);
        self.take(now_us)?;
        if self.ended.is_none() {
            self.frames.repeat(now_us, &mut self.out);
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

    /// Does nothing: what prints lines takes no commands of ours.
    fn send(&mut self, _command: &Command) -> io::Result<()> {
        Ok(())
    }

    fn finding(&self) -> Option<LineFinding> {
        self.frames.finding().copied()
    }
}
