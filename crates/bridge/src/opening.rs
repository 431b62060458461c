//! Opens pads: devices, the virtual pad behind a terminal, captures that play as a pad.

use std::fmt;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use rustix::event::{Timespec, poll};

use crate::transport::Transport;
use crate::transport::address::PadAddress;
use crate::transport::evdev::EvdevOpener;
use crate::transport::fault::{FaultPlan, FaultyLine};
use crate::transport::lines;
use crate::transport::opener::{Opener, PadError};
use crate::transport::playback::Playback;
use crate::transport::rewired::RewiredPad;
use crate::transport::virtual_pad::{PadFirmware, VirtualPadPort};
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::capture::reader::{CaptureError, CaptureReader};
use tactpad_core::source::Lines;
use tactpad_core::time::HostInstant;

/// A pad whose permissions are not set yet is tried again this often, …
const PERMISSION_TRIES: u32 = 20;

/// … with this pause between.
const PERMISSION_WAIT: Timespec = Timespec { tv_sec: 0, tv_nsec: 250_000_000 };

/// Opens the pad, again and again if need be.
pub type Reopen = Box<dyn FnMut() -> Result<Box<dyn Transport>, PadError>>;

/// The policy for a pad that is not there at the start, or sends no valid frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// Give up with a sentence.
    Limited,
    /// Wait.
    Endless,
}

/// Why no pad was opened. As text: what is wrong, and the way out.
#[derive(Debug)]
#[non_exhaustive]
pub enum OpenError {
    /// It is a device that cannot be opened.
    Pad(PadError),
    /// It is a capture that cannot be read; with its path.
    Capture(String, CaptureError),
    /// The system has no thread or terminal to give.
    Io(io::Error),
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pad(error) => error.fmt(f),
            Self::Capture(path, error) => write!(f, "{path} {error}"),
            Self::Io(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for OpenError {}

/// An opened pad: its first opening, and how to open it again.
#[derive(Default)]
pub struct OpenedPad {
    pub(super) pad: Option<Box<dyn Transport>>,
    /// Opens it again after it was unplugged; `None` for a pad that ends, as a capture does.
    pub(super) opener: Option<Reopen>,
    /// The virtual pad behind the terminal, if it is one; it ends when this is dropped.
    _virtual_pad: Option<VirtualPadPort>,
}

impl OpenedPad {
    /// Opens a pad that is a device. With endless patience one that is not there yet is waited for.
    ///
    /// # Errors
    /// [`OpenError::Pad`].
    pub fn device(address: PadAddress, patience: Patience) -> Result<Self, OpenError> {
        let mut opener = Opener::new(address);
        Self::opened_by(move || opener.open(), patience)
    }

    /// Opens an input device of the system, in the same way.
    ///
    /// # Errors
    /// [`OpenError::Pad`].
    pub fn input_device(mut opener: EvdevOpener, patience: Patience) -> Result<Self, OpenError> {
        Self::opened_by(move || opener.open(), patience)
    }

    fn opened_by(
        mut open: impl FnMut() -> Result<Box<dyn Transport>, PadError> + 'static,
        patience: Patience,
    ) -> Result<Self, OpenError> {
        let pad = match open_when_allowed(&mut open, patience) {
            Ok(pad) => Some(pad),
            Err(PadError::NotThere(_) | PadError::Denied(_)) if patience == Patience::Endless => None,
            Err(error) => return Err(OpenError::Pad(error)),
        };
        Ok(Self { pad, opener: Some(Box::new(open)), _virtual_pad: None })
    }

    /// A pad that is not there yet; the bridge looks for it with `opener`.
    pub fn absent(opener: Reopen) -> Self {
        Self { opener: Some(opener), ..Self::default() }
    }

    /// Starts a virtual pad and opens its terminal like any pad's port.
    ///
    /// # Errors
    /// [`OpenError::Io`] if there is no terminal for it, [`OpenError::Pad`] if that cannot be opened.
    pub fn simulated<F: PadFirmware + Send + 'static>(pad: F) -> Result<Self, OpenError> {
        let pad = VirtualPadPort::start(pad).map_err(OpenError::Io)?;
        let terminal = PadAddress::Serial { path: pad.path().to_owned(), baud: firmware_proto::DEFAULT_BAUD };
        Ok(Self { _virtual_pad: Some(pad), ..Self::device(terminal, Patience::Limited)? })
    }

    /// Plays the bytes of a capture at the pace at which they were recorded.
    ///
    /// # Errors
    /// [`OpenError::Capture`] if the beginning cannot be read, [`OpenError::Io`] if nothing can play it.
    pub fn capture(path: &Path) -> Result<Self, OpenError> {
        let unusable = |error| OpenError::Capture(path.display().to_string(), error);
        let file = File::open(path).map_err(|error| unusable(CaptureError::Io(error)))?;
        let capture = CaptureReader::new(BufReader::new(file)).map_err(unusable)?;
        let pad: Box<dyn Transport> = Box::new(Playback::start(chunks(capture)).map_err(OpenError::Io)?);
        Ok(Self { pad: Some(pad), ..Self::default() })
    }

    /// The same pad, which prints lines of text, each time it is opened.
    ///
    /// # Errors
    /// The system has no more descriptors.
    pub fn with_lines(self, lines: &Lines) -> io::Result<Self> {
        let described = lines.clone();
        let read = move |port| lines::framed(port, &described);
        let pad = self.pad.map(&read).transpose()?;
        let opener = self.opener.map(|mut open| -> Reopen {
            Box::new(move || read(open()?).map_err(|error| PadError::Unusable(error.to_string())))
        });
        Ok(Self { pad, opener, ..self })
    }

    /// The same pad with its channels as this wiring says, each time it is opened.
    #[must_use]
    pub fn with_wiring(self, wiring: Option<SignedPermutation>) -> Self {
        let Some(wiring) = wiring else { return self };
        let rewired = move |pad| -> Box<dyn Transport> { Box::new(RewiredPad::new(pad, wiring)) };
        let opener = self.opener.map(|mut open| -> Reopen { Box::new(move || Ok(rewired(open()?))) });
        Self { pad: self.pad.map(rewired), opener, ..self }
    }

    /// The same pad on a bad line, each time it is opened. Without a plan it stays as it is.
    ///
    /// # Errors
    /// The system has no thread or pipe for the line.
    pub fn with_faults(self, plan: Option<FaultPlan>) -> io::Result<Self> {
        let Some(plan) = plan else { return Ok(self) };
        let faulty =
            move |line| -> io::Result<Box<dyn Transport>> { Ok(Box::new(FaultyLine::new(line, &plan)?)) };
        let pad = self.pad.map(faulty).transpose()?;
        let opener = self.opener.map(|mut open| -> Reopen {
            Box::new(move || faulty(open()?).map_err(|error| PadError::Unusable(error.to_string())))
        });
        Ok(Self { pad, opener, ..self })
    }
}

/// Opens the pad. One that was plugged in just now may still be waiting for its permissions: tries for five seconds.
fn open_when_allowed(
    open: &mut impl FnMut() -> Result<Box<dyn Transport>, PadError>,
    patience: Patience,
) -> Result<Box<dyn Transport>, PadError> {
    let mut opened = open();
    let tries = if patience == Patience::Limited { PERMISSION_TRIES } else { 0 };
    for _ in 0..tries {
        if !matches!(opened, Err(PadError::Denied(_))) {
            break;
        }
        // Lets time pass; nothing plays yet.
        let _ = poll(&mut [], Some(&PERMISSION_WAIT));
        opened = open();
    }
    opened
}

/// The pad's bytes in a capture, each chunk with the time since the one before, in microseconds. Ends at damage.
fn chunks(mut capture: CaptureReader<BufReader<File>>) -> impl Iterator<Item = (u64, Vec<u8>)> + Send {
    let mut last: Option<HostInstant> = None;
    std::iter::from_fn(move || {
        loop {
            match capture.next_call()? {
                Ok((now, Call::Bytes(bytes))) => {
                    let delay_us = last.replace(now).map_or(0, |last| now.us_since(last));
                    return Some((delay_us, bytes.to_vec()));
                }
                // A pad that is played needs no profile.
                Ok(_) | Err(CaptureError::Profile { .. }) => {}
                Err(_) => return None,
            }
        }
    })
}
