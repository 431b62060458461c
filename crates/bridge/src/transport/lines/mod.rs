//! A pad that prints lines of text.

pub mod frames;
mod look;
mod still;
#[cfg(test)]
mod tests;

use std::io;
use std::os::fd::BorrowedFd;

use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::source::Lines;

use super::Transport;
use super::framed::{Framed, FramedPort};
use super::pacing::is_readable;
use frames::LineFrames;

/// A transport of lines, with what is made of them.
struct LinePort {
    port: Box<dyn Transport>,
    frames: LineFrames,
}

/// `port`, which sends lines, as a transport of frames.
///
/// # Errors
/// The kernel gives no more descriptors, or that of the port cannot be polled together with others.
pub fn framed(port: Box<dyn Transport>, lines: &Lines) -> io::Result<Box<dyn Transport>> {
    Ok(Box::new(FramedPort::new(LinePort { port, frames: LineFrames::new(lines) })?))
}

impl Framed for LinePort {
    fn fds(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        [self.port.fd()].into_iter()
    }

    fn take(&mut self, now_us: u64, out: &mut Vec<u8>) -> io::Result<()> {
        if is_readable(self.port.fd())? {
            let mut bytes = [0; 4096];
            match self.port.read(&mut bytes) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(count) => self.frames.take(now_us, bytes.get(..count).unwrap_or_default(), out),
                Err(error)
                    if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {}
                Err(error) => return Err(error),
            }
        }
        self.frames.repeat(now_us, out);
        Ok(())
    }

    fn due_us(&self) -> Option<u64> {
        self.frames.due_us()
    }

    fn finding(&self) -> Option<LineFinding> {
        self.frames.finding().copied()
    }
}
