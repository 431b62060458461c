//! Finding pads, and opening the one that an address means.

use std::fmt;
use std::io;
use std::path::PathBuf;

use firmware_proto::DEFAULT_BAUD;
use firmware_proto::hid::{PRODUCT_ID, VENDOR_ID};
use hidapi::HidApi;
use serialport::SerialPortType;

use super::Transport;
use super::address::PadAddress;
use super::hid::Hid;
use super::serial::{Serial, SerialOpenError};

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
}

/// Why no pad was opened.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PadError {
    /// It is not there; it may come.
    NotThere(String),
    /// It is there, but may not be opened (yet: the system may still be setting its permissions, or be trying it out).
    Denied(String),
    /// It cannot be used, or the address does not say which pad is meant.
    Unusable(String),
}

impl fmt::Display for PadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::NotThere(message) | Self::Denied(message) | Self::Unusable(message)) = self;
        f.write_str(message)
    }
}

impl std::error::Error for PadError {}

/// Every pad that is attached and tells the project's USB numbers, HID first.
pub fn attached() -> Vec<FoundPad> {
    let mut pads = hid_pads(VENDOR_ID, PRODUCT_ID);
    pads.extend(serial_pads());
    pads
}

fn hid_pads(vendor: u16, product: u16) -> Vec<FoundPad> {
    let Ok(api) = HidApi::new() else { return Vec::new() };
    let ours = api.device_list().filter(|device| {
        (device.vendor_id(), device.product_id()) == (vendor, product) && device.usage_page() == USAGE_PAGE
    });
    let mut pads: Vec<_> = ours
        .map(|device| FoundPad {
            attachment: Attachment::Hid,
            path: device.path().to_string_lossy().into_owned().into(),
            ids: (device.vendor_id(), device.product_id()),
            serial_number: device.serial_number().filter(|number| !number.is_empty()).map(Into::into),
        })
        .collect();
    pads.dedup_by(|one, other| one.path == other.path);
    pads
}

fn serial_pads() -> Vec<FoundPad> {
    let ports = serialport::available_ports().unwrap_or_default();
    let pad = |port: serialport::SerialPortInfo| match port.port_type {
        SerialPortType::UsbPort(usb) if (usb.vid, usb.pid) == (VENDOR_ID, PRODUCT_ID) => Some(FoundPad {
            attachment: Attachment::Serial,
            path: port.port_name.into(),
            ids: (usb.vid, usb.pid),
            serial_number: usb.serial_number,
        }),
        _ => None,
    };
    ports.into_iter().filter_map(pad).collect()
}

/// Opens pads of one address again and again, and remembers which one it was.
#[derive(Debug)]
pub struct Opener {
    address: PadAddress,
    /// Serial number of the pad that was opened last: when several could be meant, it is.
    last: Option<String>,
}

impl Opener {
    /// An opener for `address`: `auto`, a HID device or a serial port.
    pub const fn new(address: PadAddress) -> Self {
        Self { address, last: None }
    }

    /// Opens the pad if it is there.
    ///
    /// # Errors
    /// See [`PadError`]; the text is one sentence with the way out.
    pub fn open(&mut self) -> Result<Box<dyn Transport>, PadError> {
        match &self.address {
            PadAddress::Serial { path, baud } => open_serial(path, *baud),
            PadAddress::Auto { serial_number } => {
                let pad = choose(attached(), serial_number.as_deref(), self.last.as_deref())?;
                self.open_found(pad)
            }
            PadAddress::Hid { vendor, product, serial_number } => {
                let pads = hid_pads(*vendor, *product);
                let pad = choose(pads, serial_number.as_deref(), self.last.as_deref())?;
                self.open_found(pad)
            }
            PadAddress::Virtual | PadAddress::Capture { .. } => {
                Err(PadError::Unusable(format!("{} is no device to open", self.address)))
            }
        }
    }

    fn open_found(&mut self, pad: FoundPad) -> Result<Box<dyn Transport>, PadError> {
        let opened = open_found(&pad)?;
        self.last = pad.serial_number;
        Ok(opened)
    }
}

/// The pad that is meant among those attached.
fn choose(
    pads: Vec<FoundPad>,
    serial_number: Option<&str>,
    last: Option<&str>,
) -> Result<FoundPad, PadError> {
    let named =
        |pad: &&FoundPad, number: Option<&str>| number.is_some() && pad.serial_number.as_deref() == number;
    let list = pads.iter().map(name).collect::<Vec<_>>().join(", ");
    if let Some(number) = serial_number {
        let found = pads.iter().find(|pad| named(pad, Some(number))).cloned();
        let others = if list.is_empty() { String::new() } else { format!("; attached: {list}") };
        return found
            .ok_or_else(|| PadError::NotThere(format!("no pad with serial number {number}{others}")));
    }
    if let Some(pad) = pads.iter().find(|pad| named(pad, last)) {
        return Ok(pad.clone());
    }
    match &pads[..] {
        [] => Err(PadError::NotThere(
            "no pad is attached: plug it in, name its port with serial:PATH, or play with --pad virtual"
                .into(),
        )),
        [pad] => Ok(pad.clone()),
        _ => Err(PadError::Unusable(format!("several pads are attached, choose one by auto:SERIAL: {list}"))),
    }
}

/// The name of a pad in a list.
fn name(pad: &FoundPad) -> String {
    let number = pad.serial_number.as_deref().unwrap_or("without serial number");
    format!("{number} at {}", pad.path.display())
}

fn open_found(pad: &FoundPad) -> Result<Box<dyn Transport>, PadError> {
    match pad.attachment {
        Attachment::Serial => open_serial(&pad.path.to_string_lossy(), DEFAULT_BAUD),
        Attachment::Hid => match Hid::open(&pad.path) {
            Ok(hid) => Ok(Box::new(hid)),
            Err(error) => Err(hid_error(pad, &error)),
        },
    }
}

fn hid_error(pad: &FoundPad, error: &io::Error) -> PadError {
    let path = pad.path.display();
    match error.kind() {
        io::ErrorKind::NotFound => PadError::NotThere(format!("{path} is gone: plug the pad in")),
        io::ErrorKind::PermissionDenied => {
            PadError::Denied(format!("no permission to open {path}: `tactpad doctor` says how to get it"))
        }
        _ => PadError::Unusable(format!("{path} cannot be opened ({error}): plug the pad in anew")),
    }
}

fn open_serial(path: &str, baud: u32) -> Result<Box<dyn Transport>, PadError> {
    match Serial::open(path, baud) {
        Ok(serial) => Ok(Box::new(serial)),
        Err(error @ SerialOpenError::NoSuchPort { .. }) => Err(PadError::NotThere(error.to_string())),
        Err(error @ (SerialOpenError::NoPermission { .. } | SerialOpenError::Busy { .. })) => {
            Err(PadError::Denied(error.to_string()))
        }
        Err(error) => Err(PadError::Unusable(error.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pad(path: &str, serial_number: Option<&str>) -> FoundPad {
        FoundPad {
            attachment: Attachment::Hid,
            path: path.into(),
            ids: (VENDOR_ID, PRODUCT_ID),
            serial_number: serial_number.map(Into::into),
        }
    }

    #[test]
    fn the_only_pad_is_meant() {
        assert_eq!(choose(vec![pad("/a", None)], None, None), Ok(pad("/a", None)));
        assert!(matches!(choose(Vec::new(), None, None), Err(PadError::NotThere(_))));
    }

    #[test]
    fn several_pads_are_told_apart_by_serial_number() {
        let both = || vec![pad("/a", Some("A")), pad("/b", Some("B"))];
        assert_eq!(choose(both(), Some("B"), None), Ok(pad("/b", Some("B"))));
        let Err(PadError::Unusable(message)) = choose(both(), None, None) else {
            panic!("it cannot be known")
        };
        assert!(message.contains("A at /a") && message.contains("B at /b"), "{message}");
        assert!(matches!(choose(both(), Some("C"), None), Err(PadError::NotThere(_))));
    }

    #[test]
    fn the_pad_that_was_played_is_meant_when_it_comes_back() {
        let both = vec![pad("/c", Some("B")), pad("/a", Some("A"))];
        assert_eq!(choose(both, None, Some("A")), Ok(pad("/a", Some("A"))));
        assert_eq!(choose(vec![pad("/b", Some("B"))], None, Some("A")), Ok(pad("/b", Some("B"))));
    }

    #[test]
    fn two_pads_without_serial_numbers_are_not_guessed_between() {
        let both = vec![pad("/a", None), pad("/b", None)];
        assert!(matches!(choose(both, None, None), Err(PadError::Unusable(_))));
    }
}
