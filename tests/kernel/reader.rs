//! What a game would see: an evdev device and its events, with the kernel's stamps.

use std::os::fd::AsFd;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use evdev::raw_stream::{RawDevice, enumerate};
use evdev::{EventSummary, KeyCode, SynchronizationCode};

use crate::clock::{MS, monotonic_ns, readable_before};

/// A key or axis took a value, or the pointer moved by it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Change {
    /// The kernel's name.
    pub(crate) name: String,
    /// The new value.
    pub(crate) value: i32,
    /// The kernel's stamp, on the clock of `clock::stamp_ns`.
    pub(crate) at_ns: u64,
}

/// An open device and everything that happened on it since.
pub(crate) struct Reader {
    /// The device.
    pub(crate) device: RawDevice,
    /// Everything read so far, oldest first.
    pub(crate) seen: Vec<Change>,
    /// Whether the device is gone.
    pub(crate) gone: bool,
}

impl Reader {
    pub(crate) fn open(node: &Path) -> Self {
        let device = RawDevice::open(node).expect("an event device");
        Self { device, seen: Vec::new(), gone: false }
    }

    /// Takes what is there.
    pub(crate) fn read_available(&mut self) {
        while !self.gone && readable_before(0, self.device.as_fd()) {
            self.read_once();
        }
    }

    /// Reads until `done` or the device is gone; panics after `limit_ms`.
    pub(crate) fn read_until(&mut self, limit_ms: u64, done: impl Fn(&[Change]) -> bool) {
        let limit_ns = monotonic_ns() + limit_ms * MS;
        while !self.gone && !done(&self.seen) {
            assert!(
                readable_before(limit_ns, self.device.as_fd()),
                "not within {limit_ms} ms; seen: {:?}",
                self.seen
            );
            self.read_once();
        }
    }

    /// Names and values of everything seen.
    pub(crate) fn edges(&self) -> Vec<(&str, i32)> {
        self.seen.iter().map(|change| (change.name.as_str(), change.value)).collect()
    }

    /// How far the pointer has moved along `axis`, in counts.
    pub(crate) fn moved(&self, axis: &str) -> i32 {
        self.seen.iter().filter(|change| change.name == axis).map(|change| change.value).sum()
    }

    /// When `name` last took `value`, if it did.
    pub(crate) fn stamp_of(&self, name: &str, value: i32) -> Option<u64> {
        let change = self.seen.iter().rev().find(|change| change.name == name && change.value == value);
        change.map(|change| change.at_ns)
    }

    fn read_once(&mut self) {
        let Ok(events) = self.device.fetch_events() else {
            self.gone = true;
            return;
        };
        for event in events {
            let name = match event.destructure() {
                EventSummary::Key(_, key, _) => format!("{key:?}"),
                EventSummary::AbsoluteAxis(_, axis, _) => format!("{axis:?}"),
                EventSummary::RelativeAxis(_, axis, _) => format!("{axis:?}"),
                EventSummary::Synchronization(_, code, _) => {
                    assert_ne!(code, SynchronizationCode::SYN_DROPPED, "the reader was too slow");
                    continue;
                }
                EventSummary::Misc(..) => continue,
                other => panic!("no such event was asked for: {other:?}"),
            };
            let at = event.timestamp().duration_since(UNIX_EPOCH).expect("a stamp after 1970");
            let at_ns = u64::try_from(at.as_nanos()).expect("a stamp before 2554");
            self.seen.push(Change { name, value: event.value(), at_ns });
        }
    }
}

/// The node of the one device that has `key`.
pub(crate) fn find(key: KeyCode) -> Option<PathBuf> {
    find_besides(key, None)
}

/// The node of the one device that has `key`, without that at `besides`.
pub(crate) fn find_besides(key: KeyCode, besides: Option<&Path>) -> Option<PathBuf> {
    let mut nodes = enumerate()
        .filter(|(node, _)| Some(node.as_path()) != besides)
        .filter(|(_, device)| device.supported_keys().is_some_and(|keys| keys.contains(key)))
        .map(|(node, _)| node);
    let node = nodes.next();
    assert_eq!(nodes.next(), None, "two devices have {key:?}");
    node
}
