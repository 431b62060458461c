//! Input devices that are attached, and which description fits.

use std::path::PathBuf;

use ::evdev::raw_stream::{RawDevice, enumerate};
use ::evdev::{AbsoluteAxisCode, KeyCode};
use tactpad_core::source::codes::InputCode;
use tactpad_core::source::{Evdev, Origin, Source};

/// An input device that fits a description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundDevice {
    /// The node to open.
    pub path: PathBuf,
    /// What the device calls itself.
    pub name: String,
}

/// The attached devices that fit, in the order of their nodes. Those that may not be opened are not among them.
pub fn fitting(source: &Source) -> Vec<FoundDevice> {
    let Origin::Evdev(wanted) = &source.origin else { return Vec::new() };
    let mut found: Vec<FoundDevice> = enumerate()
        .filter(|(_, device)| fits(wanted, device))
        .map(|(path, device)| FoundDevice { path, name: device.name().unwrap_or_default().to_owned() })
        .collect();
    found.sort_by_key(|device| (device.path.as_os_str().len(), device.path.clone()));
    found
}

/// Whether a device is what a description means.
pub(super) fn fits(wanted: &Evdev, device: &RawDevice) -> bool {
    let name = device.name().unwrap_or_default();
    let is_named = wanted.names.is_empty() || wanted.names.iter().any(|part| name.contains(part.as_str()));
    let reports = |code: &InputCode| match code {
        InputCode::Axis(axis) => {
            device.supported_absolute_axes().is_some_and(|axes| axes.contains(AbsoluteAxisCode(*axis)))
        }
        InputCode::Button(button) => {
            device.supported_keys().is_some_and(|buttons| buttons.contains(KeyCode(*button)))
        }
    };
    let channels = wanted.channels.iter().map(|axis| InputCode::Axis(*axis));
    is_named && wanted.has.iter().all(reports) && !wanted.lacks.iter().any(reports) && { channels }
        .all(|channel| reports(&channel))
}
