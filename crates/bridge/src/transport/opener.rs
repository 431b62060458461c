//! Opening the pad that an address means, again and again.

use std::collections::BTreeSet;
use std::fmt;
use std::io;
use std::path::Path;

use firmware_proto::DEFAULT_BAUD;

use super::Transport;
use super::address::PadAddress;
use super::hid::Hid;
use super::pads::{Attachment, FoundPad, attached, hid_pads, usb_serial_ports};
use super::serial::{Serial, SerialOpenError};

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

/// Opens pads of one address again and again, and remembers which one it was.
#[derive(Debug)]
pub struct Opener {
    address: PadAddress,
    /// What the plug of the pad told that was opened last.
    last: Option<FoundPad>,
}

impl Opener {
    /// An opener for `address`: `auto`, a HID device, a serial port or a USB port.
    pub const fn new(address: PadAddress) -> Self {
        Self { address, last: None }
    }

    /// Opens the pad if it is there.
    ///
    /// # Errors
    /// See [`PadError`]; the text is one sentence with the way out.
    pub fn open(&mut self) -> Result<Box<dyn Transport>, PadError> {
        let last = self.last.as_ref();
        match &self.address {
            PadAddress::Serial { path, baud } => {
                let ports = usb_serial_ports();
                let path = port_of(path, last, &ports)?;
                let opened = open_serial(&path, *baud)?;
                // Once known it stays known, whatever else is plugged in.
                self.last = known_by_its_number(&path, &ports).or(self.last.take());
                Ok(opened)
            }
            PadAddress::Usb { place, baud } => {
                let mut all = attached();
                all.extend(usb_serial_ports().into_iter().filter(|port| !port.is_ours()));
                open_found(&at_place(place, &all)?, *baud)
            }
            PadAddress::Auto { serial_number } => {
                let pad = choose(attached(), serial_number.as_deref(), last)?;
                self.open_remembered(pad)
            }
            PadAddress::Hid { vendor, product, serial_number } => {
                let pad = choose(hid_pads(*vendor, *product), serial_number.as_deref(), last)?;
                self.open_remembered(pad)
            }
            PadAddress::Virtual | PadAddress::Described { .. } | PadAddress::Capture { .. } => {
                Err(PadError::Unusable(format!("{} is no device to open", self.address)))
            }
        }
    }

    fn open_remembered(&mut self, pad: FoundPad) -> Result<Box<dyn Transport>, PadError> {
        let opened = open_found(&pad, DEFAULT_BAUD)?;
        self.last = Some(pad);
        Ok(opened)
    }
}

/// What the plug at `path` tells, if it tells it from all others. A path that leads elsewhere, as those in `/dev/serial` do, names what
/// it stands for by itself.
fn known_by_its_number(path: &str, ports: &[FoundPad]) -> Option<FoundPad> {
    let port = ports.iter().find(|port| port.path == Path::new(path))?;
    let alike = ports.iter().filter(|other| other.tells_the_same(port)).count();
    (alike == 1).then(|| port.clone())
}

/// The port at which the pad is that was named by `path`. The kernel gives ports their numbers as they come, so a pad that was there is
/// known by its serial number.
fn port_of(path: &str, last: Option<&FoundPad>, ports: &[FoundPad]) -> Result<String, PadError> {
    let Some(last) = last else { return Ok(path.to_owned()) };
    let alike: Vec<&FoundPad> = ports.iter().filter(|port| port.tells_the_same(last)).collect();
    let at_its_place = alike.iter().find(|port| port.usb_interface == last.usb_interface);
    match &alike[..] {
        [port] => Ok(port.path.to_string_lossy().into_owned()),
        [] => Err(PadError::NotThere(format!(
            "the pad with serial number {} is gone: plug it in",
            last.serial_number.as_deref().unwrap_or_default()
        ))),
        several => at_its_place
            .map(|port| port.path.to_string_lossy().into_owned())
            .ok_or_else(|| PadError::Unusable(same_number(several.iter().copied()))),
    }
}

/// What is plugged in at a place. A pad that is told by its USB numbers comes before a port that may be anything.
fn at_place(place: &str, all: &[FoundPad]) -> Result<FoundPad, PadError> {
    let here: Vec<&FoundPad> = all.iter().filter(|pad| pad.is_at(place)).collect();
    match (here.iter().find(|pad| pad.is_ours()), &here[..]) {
        (Some(pad), _) | (None, [pad]) => Ok((*pad).clone()),
        (None, []) => Err(PadError::NotThere(format!(
            "no pad and no serial port is at the USB port {place}: plug it in there; `tactpad devices` lists the ports"
        ))),
        (None, several) => {
            let places = several.iter().filter_map(|pad| pad.usb_interface.as_deref());
            let places = places.map(|place| format!("usb:{place}")).collect::<Vec<_>>().join(", ");
            Err(PadError::Unusable(format!(
                "several serial ports are at the USB port {place}: choose one of {places}"
            )))
        }
    }
}

/// The pad that is meant among those attached.
fn choose(
    pads: Vec<FoundPad>,
    serial_number: Option<&str>,
    last: Option<&FoundPad>,
) -> Result<FoundPad, PadError> {
    let pads = one_of_each(pads);
    let list = list(pads.iter());
    let named: Vec<FoundPad> = match serial_number {
        Some(number) => pads.into_iter().filter(|pad| pad.serial_number.as_deref() == Some(number)).collect(),
        None => pads,
    };
    if let [pad] = &named[..] {
        return Ok(pad.clone());
    }
    let alike: Vec<&FoundPad> =
        named.iter().filter(|pad| last.is_some_and(|last| pad.tells_the_same(last))).collect();
    let at_its_place =
        alike.iter().find(|pad| last.is_some_and(|last| pad.usb_interface == last.usb_interface));
    match (&alike[..], at_its_place, serial_number) {
        ([pad], _, _) | (_, Some(pad), _) => Ok((*pad).clone()),
        _ if !named.is_empty() => Err(PadError::Unusable(match serial_number {
            Some(_) => same_number(named.iter()),
            None => format!("several pads are attached, choose one by auto:SERIAL or by its place: {list}"),
        })),
        (_, _, Some(number)) => {
            let others = if list.is_empty() { String::new() } else { format!("; attached: {list}") };
            Err(PadError::NotThere(format!("no pad with serial number {number}{others}")))
        }
        (_, _, None) => Err(PadError::NotThere(
            "no pad is attached: plug it in, name its port with serial:PATH, or play with --pad virtual"
                .into(),
        )),
    }
}

/// The first way to each device that can be reached in several.
fn one_of_each(mut pads: Vec<FoundPad>) -> Vec<FoundPad> {
    let mut ports = BTreeSet::new();
    pads.retain(|pad| pad.usb_port().is_none_or(|port| ports.insert(port.to_owned())));
    pads
}

/// Why a serial number chooses none of them.
fn same_number<'a>(pads: impl Iterator<Item = &'a FoundPad>) -> String {
    format!("several pads tell this serial number, choose one by its place: {}", list(pads))
}

fn list<'a>(pads: impl Iterator<Item = &'a FoundPad>) -> String {
    pads.map(name).collect::<Vec<_>>().join(", ")
}

/// The name of a pad in a list.
fn name(pad: &FoundPad) -> String {
    let number = pad.serial_number.as_deref().unwrap_or("without serial number");
    let place = pad.usb_port().map(|port| format!(" (usb:{port})")).unwrap_or_default();
    format!("{number} at {}{place}", pad.path.display())
}

fn open_found(pad: &FoundPad, baud: u32) -> Result<Box<dyn Transport>, PadError> {
    match pad.attachment {
        Attachment::Serial => open_serial(&pad.path.to_string_lossy(), baud),
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
    use firmware_proto::hid::{PRODUCT_ID, VENDOR_ID};

    use super::super::virtual_pad::open_terminal;
    use super::*;

    fn pad(path: &str, serial_number: Option<&str>) -> FoundPad {
        let port = path.bytes().last().unwrap();
        at(&format!("1-{port}:1.0"), path, serial_number)
    }

    fn at(interface: &str, path: &str, serial_number: Option<&str>) -> FoundPad {
        FoundPad {
            attachment: Attachment::Hid,
            path: path.into(),
            ids: (VENDOR_ID, PRODUCT_ID),
            serial_number: serial_number.map(Into::into),
            usb_interface: Some(interface.into()),
            firmware: None,
        }
    }

    fn refused(opened: Result<impl fmt::Debug, PadError>) -> String {
        match opened {
            Err(PadError::Unusable(message)) => message,
            other => panic!("it cannot be known: {other:?}"),
        }
    }

    #[test]
    fn the_only_pad_is_meant() {
        assert_eq!(choose(vec![pad("/a", None)], None, None), Ok(pad("/a", None)));
        assert!(matches!(choose(Vec::new(), None, None), Err(PadError::NotThere(_))));
    }

    #[test]
    fn a_pad_that_is_a_hid_device_and_a_port_is_one_pad() {
        let [hid, port] = [at("1-1:1.0", "/hid", Some("A")), at("1-1:1.1", "/port", Some("A"))];
        for number in [None, Some("A")] {
            assert_eq!(choose(vec![hid.clone(), port.clone()], number, None), Ok(hid.clone()));
        }
    }

    #[test]
    fn several_pads_are_told_apart_by_serial_number() {
        let both = || vec![pad("/a", Some("A")), pad("/b", Some("B"))];
        assert_eq!(choose(both(), Some("B"), None), Ok(pad("/b", Some("B"))));
        let message = refused(choose(both(), None, None));
        assert!(message.contains("A at /a") && message.contains("B at /b"), "{message}");
        assert!(matches!(choose(both(), Some("C"), None), Err(PadError::NotThere(_))));
    }

    #[test]
    fn the_pad_that_was_played_is_meant_when_it_comes_back() {
        let last = pad("/z", Some("A"));
        let both = vec![pad("/c", Some("B")), pad("/a", Some("A"))];
        assert_eq!(choose(both, None, Some(&last)), Ok(pad("/a", Some("A"))));
        assert_eq!(choose(vec![pad("/b", Some("B"))], None, Some(&last)), Ok(pad("/b", Some("B"))));
    }

    #[test]
    fn two_pads_without_serial_numbers_are_not_guessed_between() {
        let both = vec![pad("/a", None), pad("/b", None)];
        assert!(matches!(choose(both, None, Some(&pad("/a", None))), Err(PadError::Unusable(_))));
    }

    #[test]
    fn two_pads_of_one_serial_number_are_told_apart_by_their_place() {
        let both = || vec![at("1-1:1.0", "/a", Some("A")), at("1-2.4:1.0", "/b", Some("A"))];
        for number in [None, Some("A")] {
            let message = refused(choose(both(), number, None));
            assert!(message.contains("usb:1-1)") && message.contains("usb:1-2.4)"), "{message}");
            let last = at("1-2.4:1.0", "/c", Some("A"));
            assert_eq!(choose(both(), number, Some(&last)), Ok(both().remove(1)), "where it was");
        }
        assert_eq!(at_place("1-2.4", &both()), Ok(both().remove(1)));
        assert!(matches!(at_place("1-2", &both()), Err(PadError::NotThere(_))));
    }

    #[test]
    fn at_a_place_a_pad_comes_before_a_port_that_may_be_anything() {
        let other = FoundPad { ids: (0x1a86, 0x7523), ..at("1-1:1.0", "/other", None) };
        assert_eq!(at_place("1-1", std::slice::from_ref(&other)), Ok(other.clone()));
        let ours = at("1-1:1.2", "/ours", None);
        assert_eq!(at_place("1-1", &[other.clone(), ours.clone()]), Ok(ours));
        let second_line = FoundPad { usb_interface: Some("1-1:1.2".into()), ..other.clone() };
        let message = refused(at_place("1-1", &[other.clone(), second_line.clone()]));
        assert!(message.contains("usb:1-1:1.0, usb:1-1:1.2"), "{message}");
        assert_eq!(at_place("1-1:1.2", &[other, second_line.clone()]), Ok(second_line));
    }

    #[test]
    fn a_port_is_found_again_by_its_serial_number_whatever_it_is_called_then() {
        let was = at("1-9:1.0", "/dev/ttyACM0", Some("A"));
        let found = |ports: &[FoundPad]| port_of("/dev/ttyACM0", Some(&was), ports);
        assert_eq!(found(&[pad("/dev/ttyACM1", Some("A"))]), Ok("/dev/ttyACM1".into()));
        let taken = [pad("/dev/ttyACM0", Some("B")), at("1-2:1.0", "/dev/ttyACM1", Some("A"))];
        assert_eq!(found(&taken), Ok("/dev/ttyACM1".into()), "another pad has the name now");
        assert!(matches!(found(&taken[..1]), Err(PadError::NotThere(_))), "another pad is not this one");
        let twins = [at("1-2:1.0", "/dev/ttyACM1", Some("A")), at("1-3:1.0", "/dev/ttyACM2", Some("A"))];
        let message = refused(found(&twins));
        assert!(message.contains("usb:1-2)") && message.contains("usb:1-3)"), "{message}");
        let [_, second] = twins;
        assert_eq!(
            found(&[second, at("1-9:1.0", "/dev/ttyACM3", Some("A"))]),
            Ok("/dev/ttyACM3".into()),
            "where it was"
        );
    }

    #[test]
    fn a_port_that_its_serial_number_does_not_tell_from_others_is_known_by_its_path() {
        let known = |path: &str, ports: &[FoundPad]| known_by_its_number(path, ports);
        let [a, b] =
            [at("1-1:1.0", "/dev/ttyUSB0", Some("0001")), at("1-2:1.0", "/dev/ttyUSB1", Some("0001"))];
        assert_eq!(known("/dev/ttyUSB0", &[a.clone(), b.clone()]), None, "boards of one make");
        assert_eq!(known("/dev/ttyUSB0", std::slice::from_ref(&a)), Some(a.clone()));
        let second_line = at("1-1:1.2", "/dev/ttyUSB1", Some("0001"));
        assert_eq!(
            known("/dev/ttyUSB0", &[a.clone(), second_line]),
            Some(a.clone()),
            "two lines of one board"
        );
        assert_eq!(known("/dev/serial/by-path/x", &[a]), None, "who names a place means the place");
        assert_eq!(known("/dev/ttyUSB1", &[FoundPad { serial_number: None, ..b }]), None);
        assert_eq!(port_of("/dev/ttyUSB0", None, &[]), Ok("/dev/ttyUSB0".into()));
    }

    #[test]
    fn what_was_opened_by_path_is_remembered_by_its_number() {
        let (_master, path) = open_terminal().unwrap();
        let mut opener = Opener::new(PadAddress::Serial { path: path.clone(), baud: DEFAULT_BAUD });
        assert!(opener.open().is_ok() && opener.last.is_none(), "a terminal tells nothing");
        opener.last = Some(pad(&path, Some("A")));
        let Err(PadError::NotThere(message)) = opener.open().map(|_| ()) else {
            panic!("it is not that pad")
        };
        assert!(message.contains("serial number A"), "{message}");
    }
}
