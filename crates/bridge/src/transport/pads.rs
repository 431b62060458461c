//! Pads that are attached, and ports that may lead to one.

use std::path::{Path, PathBuf};

use firmware_proto::hid::{PRODUCT_ID, VENDOR_ID};
use hidapi::HidApi;
use serialport::{SerialPortInfo, SerialPortType};

use super::firmware::Firmware;
use super::serial::ports;
use super::usb;

/// The usage page of the pad's report descriptor: vendor-defined.
const USAGE_PAGE: u16 = 0xFF00;

/// How a pad is attached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attachment {
    /// A HID device.
    Hid,
    /// A USB serial port.
    Serial,
}

/// A pad that is attached, as far as its plug tells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundPad {
    /// How it is attached.
    pub attachment: Attachment,
    /// The node to open.
    pub path: PathBuf,
    /// USB vendor and product.
    pub ids: (u16, u16),
    /// The serial number that the plug tells, if it does.
    pub serial_number: Option<String>,
    /// The kernel's name of its USB interface, such as `1-1.2:1.0`.
    pub usb_interface: Option<String>,
    /// The firmware that the plug tells, if it is one of ours.
    pub firmware: Option<Firmware>,
}

impl FoundPad {
    /// Whether it tells the project's USB numbers.
    pub(super) fn is_ours(&self) -> bool {
        self.ids == (VENDOR_ID, PRODUCT_ID)
    }

    /// The USB port at which it is plugged in, such as `1-1.2`.
    pub fn usb_port(&self) -> Option<&str> {
        self.usb_interface.as_deref()?.split(':').next()
    }

    /// Whether it is plugged in at this port, or is this interface.
    pub(super) fn is_at(&self, place: &str) -> bool {
        self.usb_interface.as_deref().is_some_and(|interface| usb::is_at(interface, place))
    }

    /// Whether the plug tells the same of both: numbers, serial number and, of a device with several, the interface.
    pub(super) fn tells_the_same(&self, other: &Self) -> bool {
        let number =
            |pad: &Self| pad.usb_interface.as_deref().and_then(|it| Some(it.split_once(':')?.1.to_owned()));
        self.serial_number.is_some()
            && (self.ids, &self.serial_number) == (other.ids, &other.serial_number)
            && number(self) == number(other)
    }
}

/// Every pad that is attached and tells the project's USB numbers, HID first.
pub fn attached() -> Vec<FoundPad> {
    let mut pads = hid_pads(VENDOR_ID, PRODUCT_ID);
    pads.extend(usb_serial_ports().into_iter().filter(FoundPad::is_ours));
    pads
}

pub(super) fn hid_pads(vendor: u16, product: u16) -> Vec<FoundPad> {
    let Ok(api) = HidApi::new() else { return Vec::new() };
    let ours = api.device_list().filter(|device| {
        (device.vendor_id(), device.product_id()) == (vendor, product) && device.usage_page() == USAGE_PAGE
    });
    let mut pads: Vec<_> = ours
        .map(|device| {
            let path = PathBuf::from(device.path().to_string_lossy().into_owned());
            FoundPad {
                attachment: Attachment::Hid,
                ids: (device.vendor_id(), device.product_id()),
                serial_number: device.serial_number().filter(|number| !number.is_empty()).map(Into::into),
                usb_interface: usb::interface(&path),
                firmware: device.product_string().and_then(Firmware::of),
                path,
            }
        })
        .collect();
    pads.dedup_by(|one, other| one.path == other.path);
    pads
}

/// Every serial port on the USB, whatever is behind it.
pub fn usb_serial_ports() -> Vec<FoundPad> {
    let port = |port: SerialPortInfo| match port.port_type {
        SerialPortType::UsbPort(usb) => Some(FoundPad {
            attachment: Attachment::Serial,
            usb_interface: usb::interface(Path::new(&port.port_name)),
            path: port.port_name.into(),
            ids: (usb.vid, usb.pid),
            firmware: usb.product.as_deref().and_then(Firmware::of),
            serial_number: usb.serial_number.filter(|number| !number.is_empty()),
        }),
        _ => None,
    };
    ports().into_iter().filter_map(port).collect()
}
