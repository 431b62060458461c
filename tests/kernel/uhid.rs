//! HID devices of software: the kernel takes them for devices that are plugged in or paired.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::fd::{AsFd, BorrowedFd};

// Kinds of events on /dev/uhid. Source: Linux, include/uapi/linux/uhid.h.
const UHID_DESTROY: u32 = 1;
const UHID_OUTPUT: u32 = 6;
const UHID_CREATE2: u32 = 11;
const UHID_INPUT2: u32 = 12;

/// Bytes of a report, or of a report descriptor, in an event.
const DATA_LEN: usize = 4_096;

/// Bytes of the longest event: its kind and the request to create a device.
const EVENT_LEN: usize = 4 + 128 + 64 + 64 + 2 + 2 + 4 * 4 + DATA_LEN;

/// How a device is attached.
#[derive(Clone, Copy)]
pub(crate) enum Bus {
    Usb = 3,
    Bluetooth = 5,
}

/// What a device tells of itself.
pub(crate) struct Told<'a> {
    pub(crate) name: &'a str,
    pub(crate) serial_number: &'a str,
    pub(crate) bus: Bus,
    pub(crate) vendor: u16,
    pub(crate) product: u16,
    pub(crate) descriptor: &'a [u8],
}

/// A HID device of software.
pub(crate) struct Uhid(File);

impl Uhid {
    /// Plugs it in. The kernel makes the device on a thread of its own: it is there some time later.
    pub(crate) fn plug_in(told: &Told<'_>) -> Self {
        let mut file = OpenOptions::new().read(true).write(true).open("/dev/uhid").expect("uhid");
        let mut event = Vec::with_capacity(EVENT_LEN);
        event.extend(UHID_CREATE2.to_ne_bytes());
        for (text, length) in [(told.name, 128), ("test/0", 64), (told.serial_number, 64)] {
            event.extend(text.bytes().chain(std::iter::repeat(0)).take(length));
        }
        event.extend(u16::try_from(told.descriptor.len()).expect("a short descriptor").to_ne_bytes());
        event.extend((told.bus as u16).to_ne_bytes());
        for number in [u32::from(told.vendor), u32::from(told.product), 1, 0] {
            event.extend(number.to_ne_bytes());
        }
        event.extend(told.descriptor);
        event.resize(EVENT_LEN, 0);
        file.write_all(&event).expect("a HID device");
        Self(file)
    }

    /// Pulls it out, or ends its connection.
    pub(crate) fn unplug(mut self) {
        self.0.write_all(&UHID_DESTROY.to_ne_bytes()).expect("the device goes");
    }

    /// Sends a report to the system.
    pub(crate) fn report(&mut self, report: &[u8]) {
        let mut event = Vec::with_capacity(6 + report.len());
        event.extend(UHID_INPUT2.to_ne_bytes());
        event.extend(u16::try_from(report.len()).expect("a short report").to_ne_bytes());
        event.extend(report);
        self.0.write_all(&event).expect("a report");
    }

    /// Readable when the system has something to say.
    pub(crate) fn fd(&self) -> BorrowedFd<'_> {
        self.0.as_fd()
    }

    /// Takes what the system says: a report that it sends, or nothing that concerns a device of software.
    pub(crate) fn hear(&mut self) -> Option<Vec<u8>> {
        let mut event = [0; EVENT_LEN];
        let length = self.0.read(&mut event).expect("an event");
        let (kind, rest) = event[..length].split_at(4);
        let size = rest.get(DATA_LEN..DATA_LEN + 2)?;
        let size = usize::from(u16::from_ne_bytes(size.try_into().ok()?));
        (kind == UHID_OUTPUT.to_ne_bytes()).then(|| rest[..size.min(DATA_LEN)].to_vec())
    }
}
