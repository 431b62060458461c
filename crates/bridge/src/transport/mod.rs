//! Where pad bytes come from.

pub mod address;
pub mod evdev;
pub mod fault;
pub mod firmware;
mod framed;
pub mod hid;
pub mod lines;
pub mod opener;
mod pacing;
pub mod pads;
pub mod playback;
pub mod rewired;
pub mod serial;
mod usb;
pub mod virtual_pad;

use std::io;
use std::os::fd::BorrowedFd;

use firmware_proto::command::Command;
use tactpad_core::pipeline::line_check::LineFinding;

/// One pad: a stream of serial frames from it, whatever way they came, and commands to it. Reading never blocks for long after `fd` polls readable.
pub trait Transport {
    /// The descriptor to poll for readable bytes.
    fn fd(&self) -> BorrowedFd<'_>;

    /// Takes what is there.
    ///
    /// # Errors
    /// `BrokenPipe` or `UnexpectedEof` when the pad is gone; `WouldBlock` when nothing is there.
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize>;

    /// Sends a command to the pad.
    ///
    /// # Errors
    /// The command did not get out whole.
    fn send(&mut self, command: &Command) -> io::Result<()>;

    /// The player paused, or went on: a device that was taken from the desktop is given back meanwhile.
    fn pause(&mut self, _is_paused: bool) {}

    /// Whether the player asked on the pad itself to pause it; tells it once.
    fn asks_pause(&mut self) -> bool {
        false
    }

    /// What is wrong with what the pad sends, where it is no frames that are sent; the pipeline finds the rest.
    fn finding(&self) -> Option<LineFinding> {
        None
    }
}
