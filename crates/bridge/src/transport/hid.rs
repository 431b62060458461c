//! A pad that is a HID device, through its hidraw node.
//!
//! hidapi finds the node. Its own open device hides the descriptor, and a bridge that polls needs that, so the node is
//! opened here: one report is one system call.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

use firmware_proto::ENCODED_MAX;
use firmware_proto::command::Command;
use firmware_proto::hid::{REPORT_LEN, encode_command, to_serial_frame};
use rustix::fs::OFlags;
use rustix::io::Errno;

use super::Transport;

/// An open hidraw node.
#[derive(Debug)]
pub struct Hid {
    file: File,
}

impl Hid {
    /// Opens the node at `path`.
    ///
    /// # Errors
    /// The system's error: `NotFound`, `PermissionDenied`.
    pub fn open(path: &Path) -> io::Result<Self> {
        let flags = i32::try_from(OFlags::NONBLOCK.bits()).unwrap_or(0);
        let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path)?;
        Ok(Self { file })
    }
}

impl Transport for Hid {
    fn fd(&self) -> BorrowedFd<'_> {
        self.file.as_fd()
    }

    /// Takes one report and gives it as a serial frame, so that everything behind hears one language.
    ///
    /// # Errors
    /// `BrokenPipe` when the pad is gone; `WouldBlock` when nothing is there.
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut report = [0; REPORT_LEN];
        let length = rustix::io::read(&self.file, &mut report).map_err(gone_or)?;
        let mut frame = [0; ENCODED_MAX];
        let frame_length = to_serial_frame(report.get(..length).unwrap_or_default(), &mut frame);
        let (Some(place), Some(frame)) = (bytes.get_mut(..frame_length), frame.get(..frame_length)) else {
            return Err(io::Error::other("the buffer has no room for a frame"));
        };
        place.copy_from_slice(frame);
        Ok(frame_length)
    }

    fn send(&mut self, command: &Command) -> io::Result<()> {
        let report = encode_command(command);
        match rustix::io::write(&self.file, &report) {
            Ok(written) if written == report.len() => Ok(()),
            Ok(_) => Err(io::ErrorKind::WriteZero.into()),
            Err(error) => Err(gone_or(error)),
        }
    }
}

/// The errors by which hidraw says that its device has left become `BrokenPipe`.
fn gone_or(error: Errno) -> io::Error {
    match error {
        Errno::IO | Errno::NODEV | Errno::PIPE => {
            io::Error::new(io::ErrorKind::BrokenPipe, "the pad was unplugged")
        }
        Errno::INTR => io::ErrorKind::WouldBlock.into(),
        other => other.into(),
    }
}
