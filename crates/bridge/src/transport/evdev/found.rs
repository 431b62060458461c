//! Input devices that are attached, and which description fits. What they are is read from sysfs, so that none is opened for it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use ::evdev::raw_stream::RawDevice;
use rustix::fs::{Access, access};
use tactpad_core::source::codes::{BTN_TOUCH, InputCode, MT_FIRST, MT_SLOT, MT_TRACKING_ID};
use tactpad_core::source::{Evdev, Measures, Origin, Source};

/// Where the kernel lists input devices.
pub(super) const CLASS: &str = "/sys/class/input";

/// An input device, by what it tells of itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FoundDevice {
    /// The node to open.
    pub path: PathBuf,
    /// What the device calls itself.
    pub name: String,
    /// USB or Bluetooth numbers of vendor and product.
    ids: (u16, u16),
    /// Its serial number or address; empty where it has none.
    unique: String,
    /// Where it is plugged in.
    place: String,
    axes: BTreeSet<u16>,
    buttons: BTreeSet<u16>,
}

/// The attached devices, in the order of their nodes, those that may not be read among them. Only those with one of these parts in
/// their name; any where there are no parts.
pub fn attached(names: &[String]) -> Vec<FoundDevice> {
    let entries = fs::read_dir(CLASS).into_iter().flatten().flatten();
    let nodes = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut found: Vec<FoundDevice> = nodes
        .filter(|node| node.starts_with("event"))
        .filter_map(|node| {
            let (folder, path) =
                (Path::new(CLASS).join(&node).join("device"), Path::new("/dev/input").join(node));
            let name = line(&folder.join("name"));
            (is_named(names, &name) && path.exists()).then(|| FoundDevice::by_sysfs(&folder, path, name))
        })
        .collect();
    found.sort_by_key(|device| (device.path.as_os_str().len(), device.path.clone()));
    found
}

/// The command that lets a user read these nodes.
pub fn reading_command(paths: &[&Path]) -> String {
    let list: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    format!("sudo setfacl -m u:$USER:r {}", list.join(" "))
}

impl FoundDevice {
    fn by_sysfs(folder: &Path, path: PathBuf, name: String) -> Self {
        let number = |file: &str| u16::from_str_radix(&line(&folder.join(file)), 16).unwrap_or_default();
        let codes = |file: &str| codes(&line(&folder.join("capabilities").join(file)));
        Self {
            path,
            name,
            ids: (number("id/vendor"), number("id/product")),
            unique: line(&folder.join("uniq")),
            place: line(&folder.join("phys")),
            axes: codes("abs"),
            buttons: codes("key"),
        }
    }

    /// The device that was opened at a node.
    pub(super) fn opened(path: &Path, device: &RawDevice) -> Self {
        let text = |text: Option<&str>| text.unwrap_or_default().to_owned();
        let id = device.input_id();
        let axes = device.supported_absolute_axes().into_iter().flat_map(|axes| axes.iter());
        let buttons = device.supported_keys().into_iter().flat_map(|buttons| buttons.iter());
        Self {
            path: path.to_owned(),
            name: text(device.name()),
            ids: (id.vendor(), id.product()),
            unique: text(device.unique_name()),
            place: text(device.physical_path()),
            axes: axes.map(|axis| axis.0).collect(),
            buttons: buttons.map(|button| button.0).collect(),
        }
    }

    /// Whether it is what a description means, and reports what that needs.
    pub fn fits(&self, source: &Source) -> bool {
        let Origin::Evdev(wanted) = &source.origin else { return false };
        is_named(&wanted.names, &self.name)
            && wanted.has.iter().all(|code| self.reports(*code))
            && !wanted.lacks.iter().any(|code| self.reports(*code))
            && needed(wanted, &source.measures).into_iter().all(|code| self.reports(code))
    }

    /// Whether this user may read it.
    pub fn is_readable(&self) -> bool {
        access(&self.path, Access::READ_OK).is_ok()
    }

    /// Whether both are the same device, at whatever node: by its number if it has one, else by its name and where it is plugged in.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let by_number = !self.unique.is_empty() && self.unique == other.unique;
        let by_place = self.unique.is_empty() && other.unique.is_empty() && self.place == other.place;
        self.ids == other.ids && self.name == other.name && (by_number || by_place)
    }

    fn reports(&self, code: InputCode) -> bool {
        match code {
            InputCode::Axis(axis) => self.axes.contains(&axis),
            InputCode::Button(button) => self.buttons.contains(&button),
        }
    }
}

/// What the frames of a described device are made of.
fn needed(wanted: &Evdev, measures: &Measures) -> Vec<InputCode> {
    let Measures::Contact(touching) = measures else {
        return wanted.channels.iter().map(|axis| InputCode::Axis(*axis)).collect();
    };
    let axes = touching.place.into_iter().chain(touching.force).map(InputCode::Axis);
    let is_of_fingers = touching.place.iter().all(|axis| *axis >= MT_FIRST);
    let touch = if is_of_fingers {
        vec![InputCode::Axis(MT_SLOT), InputCode::Axis(MT_TRACKING_ID)]
    } else {
        vec![InputCode::Button(BTN_TOUCH)]
    };
    axes.chain(touch).collect()
}

fn is_named(parts: &[String], name: &str) -> bool {
    parts.is_empty() || parts.iter().any(|part| name.contains(part.as_str()))
}

/// The one line of a file; empty where it cannot be read.
fn line(path: &Path) -> String {
    let bytes = fs::read(path).unwrap_or_default();
    String::from_utf8_lossy(bytes.strip_suffix(b"\n").unwrap_or(&bytes)).into_owned()
}

/// The codes in a bitmap as sysfs writes it: hexadecimal words of the machine's width, the highest first.
fn codes(bitmap: &str) -> BTreeSet<u16> {
    let words =
        bitmap.split_whitespace().rev().map(|word| usize::from_str_radix(word, 16).unwrap_or_default());
    let bits = words.flat_map(|word| (0..usize::BITS).map(move |bit| word >> bit & 1 == 1));
    (0..=u16::MAX).zip(bits).filter(|(_, is_set)| *is_set).map(|(code, _)| code).collect()
}

#[cfg(test)]
mod tests {
    use tactpad_core::source::{read, shipped};

    use super::*;

    fn source(name: &str) -> Source {
        read::read(shipped::text(name).unwrap()).0.unwrap()
    }

    #[test]
    fn a_bitmap_of_sysfs_is_codes() {
        assert_eq!(codes("b"), BTreeSet::from([0, 1, 3]));
        let high = u16::try_from(usize::BITS).unwrap();
        assert_eq!(codes("1 0 8000"), BTreeSet::from([15, 2 * high]));
        assert!(["", "0", "x"].map(codes).iter().all(BTreeSet::is_empty));
    }

    fn tablet() -> FoundDevice {
        FoundDevice {
            path: "/dev/input/event5".into(),
            name: "Tablet".into(),
            ids: (0x056a, 0x0357),
            axes: [0x00, 0x01, 0x18].into(),
            buttons: [0x140, BTN_TOUCH].into(),
            ..FoundDevice::default()
        }
    }

    #[test]
    fn what_a_contact_is_made_of_must_be_reported() {
        assert!(tablet().fits(&source("tablet")) && !tablet().fits(&source("touchpad")));
        let text = "schema = 1\nname = \"pen\"\ntitle = \"Pen\"\n[evdev]\nnames = [\"Tablet\"]\n[contact]\nx = \"ABS_X\"\n\
            y = \"ABS_Y\"\nforce = \"ABS_PRESSURE\"\n";
        let described = read::read(text).0.unwrap();
        assert!(tablet().fits(&described));
        for axis in [0x00, 0x01, 0x18] {
            let mut lacking = tablet();
            lacking.axes.remove(&axis);
            assert!(!lacking.fits(&described), "{axis:x}");
        }
        let mut lacking = tablet();
        lacking.buttons.remove(&BTN_TOUCH);
        assert!(!lacking.fits(&described));
    }

    #[test]
    fn a_device_is_known_by_its_number_else_by_its_place() {
        let at = |unique: &str, place: &str| FoundDevice {
            path: "/dev/input/event7".into(),
            unique: unique.into(),
            place: place.into(),
            ..tablet()
        };
        assert!(at("1", "usb-1").is_same(&at("1", "usb-2")) && !at("1", "usb-1").is_same(&at("2", "usb-1")));
        assert!(at("", "usb-1").is_same(&at("", "usb-1")) && !at("", "usb-1").is_same(&at("", "usb-2")));
        assert!(!at("", "usb-1").is_same(&at("1", "usb-1")));
        let other = FoundDevice { ids: (0x056a, 0x0358), ..at("1", "usb-1") };
        assert!(!other.is_same(&at("1", "usb-1")));
    }
}
