//! A device's own reports, read beside its driver.

use std::fs;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::path::Path;
use std::thread;

use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::pipe::{PipeFlags, pipe_with};

use super::balance_board::{AXES, Calibration};
use super::beside;

/// Reports that the kernel keeps for a reader. Where so many wait, others are lost.
const KEPT: usize = 63;

/// Bytes of the longest report.
pub(super) const REPORT_LEN: usize = 64;

/// A driver's file with the factory's numbers of a board.
const CALIBRATION_FILE: &str = "bboard_calib";

/// The board is asked so often for them: an answer may be lost.
const CALIBRATION_TRIES: u32 = 3;

/// Bytes of that file, and more.
const CALIBRATION_LEN: usize = 128;

/// The reports of an open device.
#[derive(Debug)]
pub(super) struct ReportReader {
    node: OwnedFd,
    calibration: Told,
    /// Whether a report has come since the reader was opened, and since reports were lost.
    is_heard: bool,
}

/// What is known of the device's own numbers.
#[derive(Debug)]
enum Told {
    /// They will come here.
    Asked(OwnedFd),
    Known(Calibration),
}

/// What a device told.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Heard {
    /// Nothing that counts.
    Nothing,
    /// What the driver's axes would say if they said all.
    Axes([(u16, i32); AXES.len()]),
    /// It does not tell its own numbers: what its reports mean is not known.
    Unknown,
}

impl ReportReader {
    /// Opens the reports of the Balance Board whose input device is at `node`; `None` where that is not possible or not allowed.
    ///
    /// The driver asks the board for its numbers each time, which may take seconds, so a thread waits for them.
    pub(super) fn open(node: &Path) -> Option<Self> {
        let file = beside::folder(node)?.join(CALIBRATION_FILE);
        let node = open(&beside::raw_node(node)?.path)?;
        let (asked, teller) = pipe_with(PipeFlags::CLOEXEC | PipeFlags::NONBLOCK).ok()?;
        let tell = move || {
            let told = (0..CALIBRATION_TRIES).find_map(|_| fs::read(&file).ok()).unwrap_or_default();
            // Who asked may have gone, and an end without a word says that there are no numbers.
            let _ =
                rustix::io::write(&teller, told.get(..CALIBRATION_LEN.min(told.len())).unwrap_or_default());
        };
        thread::Builder::new().name("calibration".into()).spawn(tell).ok()?;
        Some(Self { node, calibration: Told::Asked(asked), is_heard: false })
    }

    /// The descriptors that are readable when there is something to hear.
    pub(super) fn fds(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        let asked = match &self.calibration {
            Told::Asked(asked) => Some(asked.as_fd()),
            Told::Known(_) => None,
        };
        [self.node.as_fd()].into_iter().chain(asked)
    }

    /// Whether the device's state is not known: nothing is to be sent.
    pub(super) const fn is_unheard(&self) -> bool {
        !self.is_heard
    }

    /// What was heard counts no more: the device's state was taken from its driver.
    pub(super) const fn forget(&mut self) {
        self.is_heard = false;
    }

    /// Takes what came. Of several reports only the last counts; after more than the kernel keeps only the next one does.
    ///
    /// # Errors
    /// The device is gone.
    pub(super) fn hear(&mut self) -> io::Result<Heard> {
        if let Told::Asked(asked) = &self.calibration {
            let mut text = [0; CALIBRATION_LEN];
            match rustix::io::read(asked, &mut text) {
                Ok(length) => {
                    let text = String::from_utf8_lossy(text.get(..length).unwrap_or_default());
                    let Some(calibration) = Calibration::read(&text) else { return Ok(Heard::Unknown) };
                    self.calibration = Told::Known(calibration);
                }
                Err(Errno::AGAIN | Errno::INTR) => {}
                Err(_) => return Ok(Heard::Unknown),
            }
        }
        let mut last = Heard::Nothing;
        for _ in 0..KEPT {
            let mut report = [0; REPORT_LEN];
            match rustix::io::read(&self.node, &mut report) {
                Ok(length) => {
                    if let Some(axes) = self.axes(report.get(..length).unwrap_or_default()) {
                        self.is_heard = true;
                        last = Heard::Axes(axes);
                    }
                }
                Err(Errno::AGAIN | Errno::INTR) => return Ok(last),
                Err(error) => return Err(error.into()),
            }
        }
        self.is_heard = false;
        Ok(Heard::Nothing)
    }

    fn axes(&self, report: &[u8]) -> Option<[(u16, i32); AXES.len()]> {
        let Told::Known(calibration) = &self.calibration else { return None };
        let mut weights = calibration.weights(report)?.into_iter();
        Some(AXES.map(|axis| (axis, weights.next().unwrap_or_default())))
    }
}

/// Opens a raw node without waiting for anything.
pub(super) fn open(path: &Path) -> Option<OwnedFd> {
    rustix::fs::open(path, OFlags::RDONLY | OFlags::NONBLOCK | OFlags::CLOEXEC, Mode::empty()).ok()
}
