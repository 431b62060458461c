//! A pad on a serial port.

use std::fmt;
use std::fs::{File, OpenOptions};
use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

use firmware_proto::ENCODED_MAX;
use firmware_proto::command::Command;
use firmware_proto::link::encode_command;
use rustix::event::{PollFd, PollFlags, poll};
use rustix::fs::OFlags;
use rustix::io::Errno;
use serialport::{ClearBuffer, SerialPort, SerialPortInfo, TTYPort};

use super::Transport;
use super::pacing::limit;

/// How long the port may take to accept the next bytes of a command, in microseconds.
const SEND_LIMIT_US: u64 = 200_000;

/// An open serial port, locked against other programs.
#[derive(Debug)]
pub struct Serial {
    // Sets the line and holds the lock. Its own descriptor blocks and cannot be borrowed, so bytes go through
    // `file`.
    port: TTYPort,
    file: File,
}

impl Serial {
    /// Opens `path` with `baud` bits per second, 8N1, raw, for this program alone, and forgets bytes from
    /// before.
    ///
    /// # Errors
    /// There is no such port, it is no port, it is in use, it may not be opened, or it refuses the settings.
    pub fn open(path: &str, baud: u32) -> Result<Self, SerialOpenError> {
        // Not blocking: an open port without carrier would wait for one.
        let flags = OFlags::NOCTTY | OFlags::NONBLOCK;
        let flags = i32::try_from(flags.bits()).unwrap_or(0);
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .custom_flags(flags)
            .open(path)
            .map_err(|error| SerialOpenError::from_open(path, &error))?;
        if !rustix::termios::isatty(&file) {
            return Err(SerialOpenError::NotATerminal { path: path.into() });
        }
        let port = serialport::new(path, baud).open_native();
        let port = port.map_err(|error| SerialOpenError::from_settings(path, baud, error))?;
        port.clear(ClearBuffer::Input).map_err(|error| SerialOpenError::from_settings(path, baud, error))?;
        Ok(Self { port, file })
    }
}

impl Drop for Serial {
    /// Unsent bytes go: closing a port waits for them, with a pad that hangs for half a minute.
    fn drop(&mut self) {
        let _ = self.port.clear(ClearBuffer::Output);
    }
}

impl Transport for Serial {
    fn fd(&self) -> BorrowedFd<'_> {
        self.file.as_fd()
    }

    /// Takes what is there, in one system call.
    ///
    /// # Errors
    /// `BrokenPipe` when the port is gone; `WouldBlock` when nothing is there.
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if bytes.is_empty() {
            return Ok(0);
        }
        match rustix::io::read(&self.file, bytes) {
            Ok(0) => Err(gone()),
            Ok(count) => Ok(count),
            Err(error) => Err(lost_or(error)),
        }
    }

    fn send(&mut self, command: &Command) -> io::Result<()> {
        let mut frame = [0; ENCODED_MAX];
        let length = encode_command(command, &mut frame);
        self.write_whole(frame.get(..length).unwrap_or_default())
    }
}

impl Serial {
    /// Writes all of `bytes`, waiting for room at most [`SEND_LIMIT_US`].
    pub(super) fn write_whole(&self, bytes: &[u8]) -> io::Result<()> {
        let mut rest = bytes;
        while !rest.is_empty() {
            match rustix::io::write(&self.file, rest) {
                Ok(count) => rest = rest.get(count..).unwrap_or_default(),
                Err(Errno::AGAIN | Errno::INTR) => self.wait_for_room()?,
                Err(error) => return Err(lost_or(error)),
            }
        }
        Ok(())
    }

    fn wait_for_room(&self) -> io::Result<()> {
        let mut fds = [PollFd::new(&self.file, PollFlags::OUT)];
        match poll(&mut fds, Some(&limit(SEND_LIMIT_US))) {
            Ok(0) => Err(io::Error::new(io::ErrorKind::TimedOut, "the pad takes no commands")),
            Ok(_) if fds[0].revents().contains(PollFlags::HUP) => Err(gone()),
            Ok(_) | Err(Errno::INTR) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }
}

fn gone() -> io::Error {
    io::Error::new(io::ErrorKind::BrokenPipe, "the pad was unplugged")
}

/// The errors by which a driver says that its device has left become `BrokenPipe`.
fn lost_or(error: Errno) -> io::Error {
    match error {
        Errno::IO | Errno::NODEV | Errno::NXIO | Errno::PIPE => gone(),
        Errno::INTR => io::ErrorKind::WouldBlock.into(),
        other => other.into(),
    }
}

/// Why a serial port cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SerialOpenError {
    /// Nothing is there.
    NoSuchPort {
        /// The path that was to be opened.
        path: String,
        /// The serial ports of this machine.
        present: Vec<String>,
    },
    /// Something is there, but no serial port.
    NotATerminal {
        /// The path that was to be opened.
        path: String,
    },
    /// Another program has it.
    Busy {
        /// The path that was to be opened.
        path: String,
    },
    /// This user may not open it.
    NoPermission {
        /// The path that was to be opened.
        path: String,
    },
    /// The port is there but does not do what it is asked.
    Refused {
        /// The path that was to be opened.
        path: String,
        /// The rate that was to be set, in bits per second.
        baud: u32,
        /// The system's words.
        cause: String,
    },
    /// The system says something else.
    Other {
        /// The path that was to be opened.
        path: String,
        /// The system's words.
        cause: String,
    },
}

impl SerialOpenError {
    fn from_open(path: &str, error: &io::Error) -> Self {
        let path = path.to_owned();
        match error.kind() {
            // A node that is left over from an unplugged device answers with the last two.
            io::ErrorKind::NotFound => Self::NoSuchPort { path, present: present() },
            _ if is_one_of(error, &[Errno::NXIO, Errno::NODEV]) => {
                Self::NoSuchPort { path, present: present() }
            }
            io::ErrorKind::IsADirectory | io::ErrorKind::NotADirectory => Self::NotATerminal { path },
            io::ErrorKind::ResourceBusy => Self::Busy { path },
            io::ErrorKind::PermissionDenied => Self::NoPermission { path },
            _ => Self::Other { path, cause: error.to_string() },
        }
    }

    fn from_settings(path: &str, baud: u32, error: serialport::Error) -> Self {
        let path = path.to_owned();
        match error.kind {
            serialport::ErrorKind::NoDevice => Self::Busy { path },
            _ => Self::Refused { path, baud, cause: error.description },
        }
    }
}

fn is_one_of(error: &io::Error, codes: &[Errno]) -> bool {
    codes.iter().any(|code| error.raw_os_error() == Some(code.raw_os_error()))
}

/// This machine's serial ports; none where they cannot be listed.
pub fn ports() -> Vec<SerialPortInfo> {
    // serialport panics where the system has no such folder.
    if Path::new("/sys/class/tty").is_dir() {
        serialport::available_ports().unwrap_or_default()
    } else {
        Vec::new()
    }
}

/// Their paths.
fn present() -> Vec<String> {
    ports().into_iter().map(|port| port.port_name).collect()
}

impl fmt::Display for SerialOpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSuchPort { path, present } if present.is_empty() => {
                write!(f, "{path} does not exist and this machine has no serial port: plug the pad in")
            }
            Self::NoSuchPort { path, present } => {
                write!(f, "{path} does not exist: plug the pad in or name one of {}", present.join(", "))
            }
            Self::NotATerminal { path } => {
                write!(f, "{path} is not a serial port: name a port such as serial:/dev/ttyACM0")
            }
            Self::Busy { path } => {
                write!(f, "{path} is in use by another program: end it (`fuser {path}` names it)")
            }
            Self::NoPermission { path } => write!(
                f,
                "no permission to open {path}: join the group that owns it with \
                 `sudo usermod -aG dialout $USER` and log in again, or give it away by a udev rule \
                 with TAG+=\"uaccess\""
            ),
            Self::Refused { path, baud, cause } => {
                write!(
                    f,
                    "{path} does not work as a port with {baud} baud ({cause}): try serial:{path}@115200"
                )
            }
            Self::Other { path, cause } => {
                write!(f, "{path} cannot be opened ({cause}): name another port")
            }
        }
    }
}

impl std::error::Error for SerialOpenError {}

#[cfg(test)]
mod tests {
    use std::os::fd::OwnedFd;

    use super::super::virtual_pad::open_terminal;
    use super::*;

    const BAUD: u32 = 2_000_000;

    fn every_byte() -> Vec<u8> {
        (0..=255).chain((0..=255).rev()).collect()
    }

    fn polls(fd: BorrowedFd<'_>) -> bool {
        poll(&mut [PollFd::from_borrowed_fd(fd, PollFlags::IN)], Some(&limit(60_000_000))) == Ok(1)
    }

    fn read_exactly(port: &mut Serial, count: usize) -> Vec<u8> {
        let mut all = Vec::new();
        while all.len() < count {
            assert!(polls(port.fd()), "silent after {} of {count} bytes", all.len());
            let mut bytes = [0; 1024];
            let taken = port.read(&mut bytes).unwrap();
            all.extend_from_slice(&bytes[..taken]);
        }
        all
    }

    fn write_all(to: &OwnedFd, bytes: &[u8]) {
        assert_eq!(rustix::io::write(to, bytes), Ok(bytes.len()));
    }

    #[test]
    fn every_byte_value_passes_unchanged_both_ways() {
        let (pad, path) = open_terminal().unwrap();
        let mut port = Serial::open(&path, BAUD).unwrap();
        write_all(&pad, &every_byte());
        assert_eq!(read_exactly(&mut port, 512), every_byte());
        port.write_whole(&every_byte()).unwrap();
        let mut bytes = [0; 1024];
        assert!(polls(pad.as_fd()));
        assert_eq!(rustix::io::read(&pad, &mut bytes), Ok(512));
        assert_eq!(bytes[..512], every_byte());
    }

    #[test]
    fn line_is_made_raw_whatever_it_was() {
        let (pad, path) = open_terminal().unwrap();
        let mut mode = rustix::termios::tcgetattr(&pad).unwrap();
        mode.input_modes |= rustix::termios::InputModes::ICRNL | rustix::termios::InputModes::ISTRIP;
        mode.local_modes |= rustix::termios::LocalModes::ECHO | rustix::termios::LocalModes::ICANON;
        rustix::termios::tcsetattr(&pad, rustix::termios::OptionalActions::Now, &mode).unwrap();
        let mut port = Serial::open(&path, BAUD).unwrap();
        write_all(&pad, &every_byte());
        assert_eq!(read_exactly(&mut port, 512), every_byte());
        assert_eq!(rustix::io::read(&pad, &mut [0; 8]), Err(Errno::AGAIN), "echoed");
    }

    #[test]
    fn bytes_from_before_are_forgotten() {
        let (pad, path) = open_terminal().unwrap();
        let earlier = Serial::open(&path, BAUD).unwrap();
        write_all(&pad, b"old");
        assert!(polls(earlier.fd()));
        drop(earlier);
        let mut port = Serial::open(&path, BAUD).unwrap();
        write_all(&pad, b"new");
        assert_eq!(read_exactly(&mut port, 3), b"new");
    }

    #[test]
    fn nothing_there_is_would_block() {
        let (_pad, path) = open_terminal().unwrap();
        let mut port = Serial::open(&path, BAUD).unwrap();
        assert_eq!(port.read(&mut [0; 8]).unwrap_err().kind(), io::ErrorKind::WouldBlock);
        assert_eq!(port.read(&mut []).unwrap(), 0);
    }

    #[test]
    fn hang_up_polls_and_is_broken_pipe_for_reads_and_sends() {
        let (pad, path) = open_terminal().unwrap();
        let mut port = Serial::open(&path, BAUD).unwrap();
        drop(pad);
        assert!(polls(port.fd()));
        for _ in 0..2 {
            assert_eq!(port.read(&mut [0; 8]).unwrap_err().kind(), io::ErrorKind::BrokenPipe);
            assert_eq!(port.write_whole(b"x").unwrap_err().kind(), io::ErrorKind::BrokenPipe);
        }
    }

    #[test]
    fn command_that_nobody_takes_times_out() {
        let (_pad, path) = open_terminal().unwrap();
        let port = Serial::open(&path, BAUD).unwrap();
        assert_eq!(port.write_whole(&vec![0; 1_000_000]).unwrap_err().kind(), io::ErrorKind::TimedOut);
    }

    #[test]
    fn second_opening_is_busy_until_the_first_is_dropped() {
        let (_pad, path) = open_terminal().unwrap();
        let port = Serial::open(&path, BAUD).unwrap();
        assert_eq!(Serial::open(&path, BAUD).unwrap_err(), SerialOpenError::Busy { path: path.clone() });
        drop(port);
        Serial::open(&path, BAUD).unwrap();
    }

    #[test]
    fn files_that_are_no_terminals_are_named() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), b"kept").unwrap();
        for path in [file.path().to_str().unwrap(), "/dev/null", "/tmp"] {
            assert_eq!(
                Serial::open(path, BAUD).unwrap_err(),
                SerialOpenError::NotATerminal { path: path.into() }
            );
        }
        assert_eq!(std::fs::read(file.path()).unwrap(), b"kept");
    }

    #[test]
    fn missingport_is_named_with_those_that_exist() {
        let error = Serial::open("/dev/no-such-pad", BAUD).unwrap_err();
        assert!(matches!(error, SerialOpenError::NoSuchPort { .. }));
        let present = vec!["/dev/ttyACM0".into(), "/dev/ttyS0".into()];
        let text = SerialOpenError::NoSuchPort { path: "/dev/x".into(), present }.to_string();
        assert!(
            text.contains("/dev/x does not exist") && text.contains("/dev/ttyACM0, /dev/ttyS0"),
            "{text}"
        );
    }

    #[test]
    fn refusals_of_the_system_say_the_way_out() {
        let path = || "/dev/ttyACM0".to_owned();
        for (code, expected, way_out) in [
            (Errno::ACCESS, SerialOpenError::NoPermission { path: path() }, "dialout"),
            (Errno::BUSY, SerialOpenError::Busy { path: path() }, "fuser"),
            (
                Errno::NXIO,
                SerialOpenError::NoSuchPort { path: path(), present: present() },
                "plug the pad in",
            ),
        ] {
            let error = SerialOpenError::from_open("/dev/ttyACM0", &code.into());
            assert!(error.to_string().contains(way_out), "{error}");
            assert_eq!(error, expected);
        }
    }
}
