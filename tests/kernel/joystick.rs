//! What an older game would see: the device through the kernel's joystick interface.

use std::fs::{File, read_dir};
use std::io::Read;
use std::os::fd::AsFd;
use std::path::{Path, PathBuf};

use crate::clock::readable_before;

// Kinds of events, and the mark of those that tell the state at opening.
// Source: Linux, include/uapi/linux/joystick.h.
const BUTTON: u8 = 0x01;
const AXIS: u8 = 0x02;
const AT_OPENING: u8 = 0x80;

/// Bytes of an event: time, value, kind, number.
const EVENT_LEN: usize = 8;

/// A change of a joystick: `B` or `A` for button or axis with its number, and the new value.
pub(crate) type Change = (String, i16);

/// An open joystick.
pub(crate) struct Joystick(File);

impl Joystick {
    /// Opens the joystick that the kernel made beside the event device `node`.
    pub(crate) fn beside(node: &Path) -> Self {
        let name = node.file_name().expect("a node's name");
        let siblings = Path::new("/sys/class/input").join(name).join("device");
        let joystick = read_dir(siblings)
            .expect("an input device in sysfs")
            .map(|entry| entry.expect("an entry of sysfs").file_name())
            .find(|name| name.to_string_lossy().starts_with("js"))
            .expect("the kernel takes the gamepad for a joystick");
        let path = PathBuf::from("/dev/input").join(joystick);
        let mut joystick = Self(File::open(path).expect("a joystick"));
        // The kernel keeps no change for a reader that has not read the state at opening.
        assert_eq!(joystick.changes(), [], "nothing happened yet");
        joystick
    }

    /// Takes the changes that are there.
    pub(crate) fn changes(&mut self) -> Vec<Change> {
        let mut changes = Vec::new();
        while readable_before(0, self.0.as_fd()) {
            let mut event = [0; EVENT_LEN];
            self.0.read_exact(&mut event).expect("whole events");
            let [_, _, _, _, low, high, kind, number] = event;
            let letter = match kind {
                BUTTON => 'B',
                AXIS => 'A',
                _ if kind & AT_OPENING != 0 => continue,
                _ => panic!("no such joystick event: {event:?}"),
            };
            changes.push((format!("{letter}{number}"), i16::from_ne_bytes([low, high])));
        }
        changes
    }
}
