//! A pad that is an input device of the system: its events become frames here, so that everything behind hears one language.

mod axis;
mod balance_board;
pub mod battery;
pub mod beside;
mod fingers;
pub mod found;
mod frames;
pub mod leave;
mod reports;
mod tip;

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::path::{Path, PathBuf};

use ::evdev::raw_stream::RawDevice;
use ::evdev::{AbsInfo, AbsoluteAxisCode, EventType, InputEvent, SynchronizationCode};
use rustix::fs::{Mode, OFlags};
use tactpad_core::source::{Evdev, Origin, Reports, Source};

use super::Transport;
use super::framed::{Framed, FramedPort};
use super::opener::PadError;
use super::pacing::is_readable;
use axis::AxisRange;
use found::{FoundDevice, attached, reading_command};
use frames::{Change, EvdevFrames};
use reports::{Heard, ReportReader};

/// Reads at once after events were lost: more than the kernel's queue of a device holds.
const DRAIN_READS_MAX: usize = 64;

/// While something is down and nothing is reported, the kernel is asked for the true state so often, µs: another program may have taken
/// the device, and the lift with it.
const CHECK_US: u64 = 100_000;

/// An open input device.
struct EvdevPort {
    device: RawDevice,
    /// The device's own reports, which say what its axes would say if they said all.
    reports: Option<ReportReader>,
    frames: EvdevFrames,
    /// Whether it is taken from the desktop while it plays.
    grabs: bool,
    /// Whether events were lost and the state was not taken anew since.
    is_lost: bool,
    /// Whether it is to be taken from the desktop as soon as nothing on it is down: who takes it gets the releases.
    wants_grab: bool,
    /// When the true state was asked last, and whether it was another one than what was told.
    checked_us: u64,
    is_suspected: bool,
}

/// Opens a described device again and again, and remembers which one it was.
#[derive(Debug)]
pub struct EvdevOpener {
    source: Source,
    path: Option<PathBuf>,
    grabs: bool,
    /// The device that was opened last.
    last: Option<FoundDevice>,
}

impl EvdevOpener {
    /// An opener for the device at `path`, or the only one that fits. With `keeps_pointer` it goes on moving the pointer.
    pub fn new(source: Source, path: Option<PathBuf>, keeps_pointer: bool) -> Self {
        let grabs = matches!(&source.origin, Origin::Evdev(evdev) if evdev.grabs) && !keeps_pointer;
        Self { source, path, grabs, last: None }
    }

    /// Opens the device if it is there.
    ///
    /// # Errors
    /// See [`PadError`]; the text is one sentence with the way out.
    pub fn open(&mut self) -> Result<Box<dyn Transport>, PadError> {
        let Origin::Evdev(wanted) = &self.source.origin else {
            return Err(PadError::Unusable(format!("{} is no input device", self.source.name)));
        };
        let path = self.node(wanted)?;
        let device = open_device(&path).map_err(|error| open_error(&path, &error))?;
        let found = FoundDevice::opened(&path, &device);
        if !found.fits(&self.source) {
            return Err(PadError::Unusable(self.is_another(&found)));
        }
        let reports = wanted.reports.and_then(|Reports::BalanceBoard| ReportReader::open(&path));
        let port = EvdevPort::new(device, reports, &self.source, wanted, self.grabs);
        match port.and_then(FramedPort::new) {
            Ok(port) => {
                // A link that is named, as those in /dev/input/by-id, says by itself which device is meant.
                self.last = (!path.is_symlink()).then_some(found);
                Ok(Box::new(port))
            }
            Err(error) if error.raw_os_error() == Some(rustix::io::Errno::BUSY.raw_os_error()) => {
                Err(PadError::Denied(format!(
                    "{} is taken by another program: end that, or play beside it with --no-grab",
                    path.display()
                )))
            }
            Err(error) => Err(open_error(&path, &error)),
        }
    }

    /// The node to open. The kernel numbers devices as they come, so one that was open is known by what it tells.
    fn node(&self, wanted: &Evdev) -> Result<PathBuf, PadError> {
        if let (Some(path), None) = (&self.path, &self.last) {
            return Ok(path.clone());
        }
        let mut fitting = attached(&wanted.names);
        fitting.retain(|found| found.fits(&self.source));
        self.choose(&fitting)
    }

    /// The node of the device that is meant among those that fit.
    fn choose(&self, fitting: &[FoundDevice]) -> Result<PathBuf, PadError> {
        if let Some(last) = &self.last {
            let same = fitting.iter().filter(|found| found.is_same(last));
            if let Some(found) = same.max_by_key(|found| found.path == last.path) {
                return Ok(found.path.clone());
            }
        }
        let name = &self.source.name;
        match (&self.path, fitting) {
            (Some(path), _) => Err(PadError::NotThere(format!(
                "the device that was {name}:{} is gone: plug it in",
                path.display()
            ))),
            (None, [found]) => Ok(found.path.clone()),
            (None, []) => Err(PadError::NotThere(format!(
                "no device is attached that fits {name}: plug it in, and see `tactpad devices`"
            ))),
            (None, several) => {
                let told = |found: &FoundDevice| format!("{name}:{} ({})", found.path.display(), found.name);
                let list = several.iter().map(told).collect::<Vec<_>>().join(", ");
                Err(PadError::Unusable(format!("several devices fit, choose one with --pad: {list}")))
            }
        }
    }

    fn is_another(&self, found: &FoundDevice) -> String {
        let (name, path, is) = (&self.source.name, found.path.display(), &found.name);
        format!(
            "{path} ({is}) is no {name}: `tactpad devices` lists what fits, `tactpad source show {name}` says what it must report"
        )
    }
}

/// Opens a node without waiting for anything.
fn open_device(path: &Path) -> io::Result<RawDevice> {
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    RawDevice::from_fd(rustix::fs::open(path, flags, Mode::empty())?)
}

fn open_error(path: &Path, error: &io::Error) -> PadError {
    let (path, command) = (path.display(), reading_command(&[path]));
    match error.kind() {
        io::ErrorKind::NotFound => PadError::NotThere(format!("{path} is gone: plug the device in")),
        io::ErrorKind::PermissionDenied => PadError::Denied(format!(
            "no permission to read {path}: `{command}` gives it until the device is unplugged"
        )),
        _ if error.raw_os_error() == Some(rustix::io::Errno::NODEV.raw_os_error()) => {
            PadError::NotThere(format!("{path} is gone: plug the device in"))
        }
        _ => PadError::Unusable(format!(
            "{path} cannot be opened as an input device ({error}): name another one"
        )),
    }
}

impl EvdevPort {
    fn new(
        device: RawDevice,
        reports: Option<ReportReader>,
        source: &Source,
        wanted: &Evdev,
        grabs: bool,
    ) -> io::Result<Self> {
        let mut port = Self {
            device,
            reports,
            frames: EvdevFrames::new(source, wanted),
            grabs,
            is_lost: true,
            wants_grab: grabs,
            checked_us: 0,
            is_suspected: false,
        };
        port.synchronize()?;
        port.grab_if_untouched(0)?;
        Ok(port)
    }

    fn hear(&mut self, now_us: u64, out: &mut Vec<u8>) -> io::Result<()> {
        self.hear_reports(now_us, out)?;
        if !self.is_lost && is_readable(self.device.as_fd())? {
            self.is_suspected = false;
            for event in available(&mut self.device)? {
                match change(event) {
                    Some(Change::Lost) => {
                        self.is_lost = true;
                        break;
                    }
                    Some(Change::Axis(..) | Change::End) if self.reports.is_some() => {}
                    Some(change) => self.frames.take(now_us, change, out),
                    None => {}
                }
            }
        } else if !self.frames.down().is_empty() && self.checked_us + CHECK_US <= now_us {
            self.checked_us = now_us;
            let is_unlike = self.frames.is_unlike(&self.down()?, &self.ranges()?);
            // What is being reported just now is true before it can be read: only what stays unlike was lost.
            self.is_lost |= is_unlike && self.is_suspected;
            self.is_suspected = is_unlike;
        }
        if self.is_lost {
            self.synchronize()?;
            if !self.is_lost && !self.is_unheard() {
                self.frames.take(now_us, Change::End, out);
            }
        }
        self.grab_if_untouched(now_us)
    }

    /// Takes what the device's own reports say by `now_us`. Where they say nothing that can be used, its axes are taken.
    fn hear_reports(&mut self, now_us: u64, out: &mut Vec<u8>) -> io::Result<()> {
        match self.reports.as_mut().map(ReportReader::hear).transpose()? {
            Some(Heard::Axes(axes)) => {
                let changes = axes.map(|(axis, value)| Change::Axis(axis, value));
                let state = changes.into_iter().chain([Change::End]);
                state.for_each(|change| self.frames.take(now_us, change, out));
            }
            Some(Heard::Unknown) => {
                self.reports = None;
                self.is_lost = true;
            }
            Some(Heard::Nothing) | None => {}
        }
        Ok(())
    }

    /// Whether nothing may be sent before the device's next report.
    fn is_unheard(&self) -> bool {
        self.reports.as_ref().is_some_and(ReportReader::is_unheard)
    }

    /// Takes the device from the desktop, if that is wanted and nothing on it is down.
    fn grab_if_untouched(&mut self, now_us: u64) -> io::Result<()> {
        let is_due = self.wants_grab && !self.device.is_grabbed();
        if !is_due || self.is_lost || self.frames.is_in_use(now_us) || is_readable(self.device.as_fd())? {
            return Ok(());
        }
        // The kernel may know better than what was read.
        self.is_lost = self.down()? != *self.frames.down();
        if self.is_lost { Ok(()) } else { self.device.grab() }
    }

    /// Throws away what was reported, and takes the state as it is. While a device floods it stays lost, and nothing is sent.
    fn synchronize(&mut self) -> io::Result<()> {
        for _ in 0..DRAIN_READS_MAX {
            if is_readable(self.device.as_fd())? {
                available(&mut self.device)?;
                continue;
            }
            let (down, ranges) = (self.down()?, self.ranges()?);
            // Reports that came meanwhile may be older than what was asked.
            if !is_readable(self.device.as_fd())? {
                self.frames.set_state(down, ranges);
                self.reports.iter_mut().for_each(ReportReader::forget);
                self.is_lost = false;
                break;
            }
        }
        Ok(())
    }

    /// The buttons that are down, by the kernel. Asking throws away those reports of buttons that were not read yet.
    fn down(&self) -> io::Result<BTreeSet<u16>> {
        Ok(self.device.get_key_state()?.iter().map(|button| button.0).collect())
    }

    fn ranges(&self) -> io::Result<BTreeMap<u16, AxisRange>> {
        let range = |(axis, info): (AbsoluteAxisCode, AbsInfo)| {
            let (value, minimum) = (info.value(), info.minimum());
            let range = AxisRange { value, minimum, maximum: info.maximum(), resolution: info.resolution() };
            (axis.0, range)
        };
        Ok(self.device.get_absinfo()?.map(range).collect())
    }
}

/// The events that can be read at once; none where another reader was faster.
fn available(device: &mut RawDevice) -> io::Result<Vec<InputEvent>> {
    match device.fetch_events() {
        Ok(events) => Ok(events.collect()),
        Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {
            Ok(Vec::new())
        }
        Err(error) => Err(error),
    }
}

fn change(event: InputEvent) -> Option<Change> {
    match event.event_type() {
        EventType::ABSOLUTE => Some(Change::Axis(event.code(), event.value())),
        EventType::KEY => Some(Change::Button(event.code(), event.value() != 0)),
        EventType::SYNCHRONIZATION => match SynchronizationCode(event.code()) {
            SynchronizationCode::SYN_REPORT => Some(Change::End),
            SynchronizationCode::SYN_DROPPED => Some(Change::Lost),
            _ => None,
        },
        _ => None,
    }
}

impl Framed for EvdevPort {
    fn fds(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        std::iter::once(self.device.as_fd()).chain(self.reports.iter().flat_map(ReportReader::fds))
    }

    fn take(&mut self, now_us: u64, out: &mut Vec<u8>) -> io::Result<()> {
        self.hear(now_us, out)?;
        if !self.is_lost && !self.is_unheard() {
            self.frames.repeat(now_us, out);
        }
        Ok(())
    }

    fn due_us(&self) -> Option<u64> {
        if self.is_lost { Some(0) } else { self.frames.due_us().filter(|_| !self.is_unheard()) }
    }

    fn pause(&mut self, now_us: u64, is_paused: bool) -> io::Result<()> {
        self.wants_grab = self.grabs && !is_paused;
        if is_paused { self.device.ungrab() } else { self.grab_if_untouched(now_us) }
    }

    fn asks_pause(&mut self) -> bool {
        self.frames.take_leave() && self.grabs
    }
}

#[cfg(test)]
mod tests {
    use tactpad_core::source::{read, shipped};

    use super::*;

    fn at(node: &str, name: &str) -> FoundDevice {
        let mut found = FoundDevice::default();
        (found.path, found.name) = (node.into(), name.into());
        found
    }

    #[test]
    fn a_device_is_found_again_at_another_node_and_a_strangers_is_left_alone() {
        let source = read::read(shipped::text("tablet").unwrap()).0.unwrap();
        let (old, moved, other) = (at("event5", "Mine"), at("event7", "Mine"), at("event5", "Other"));
        let mut opener = EvdevOpener::new(source, None, false);
        assert_eq!(opener.choose(std::slice::from_ref(&old)), Ok("event5".into()));
        assert!(matches!(opener.choose(&[]), Err(PadError::NotThere(_))));
        assert!(matches!(opener.choose(&[moved.clone(), other.clone()]), Err(PadError::Unusable(_))));
        opener.last = Some(old.clone());
        assert_eq!(opener.choose(&[other.clone(), moved.clone()]), Ok("event7".into()));
        assert_eq!(opener.choose(&[moved.clone(), old]), Ok("event5".into()));
        opener.path = Some("event5".into());
        assert_eq!(opener.choose(&[moved]), Ok("event7".into()));
        assert!(matches!(opener.choose(&[other]), Err(PadError::NotThere(_))));
    }
}
