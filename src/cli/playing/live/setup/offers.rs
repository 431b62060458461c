//! What somebody could play with here: pads, what else is attached and fits a description, and a pad of software.

use std::fs;
use std::path::Path;

use crate::cli::playing::live::devices::{DevicesReport, Listed, ListedDevice};
use crate::cli::playing::live::last_choice::ChosenPad;
use tactpad::bridge::transport::address::PadAddress;

/// Links to serial ports by what their plugs tell, which stay when the kernel gives ports other names.
const BY_ID: &str = "/dev/serial/by-id";

/// A pad to choose, in words.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Offer {
    pub(super) pad: ChosenPad,
    pub(super) words: String,
}

impl Offer {
    /// The offer of what is at an address; `None` where that is none.
    fn of(address: &str, words: String) -> Option<Self> {
        let address = address.parse().ok()?;
        Some(Self { pad: ChosenPad { address, source: None }, words })
    }
}

/// The offers, the likeliest first; the last is a pad of software.
pub(super) fn of(found: &DevicesReport) -> Vec<Offer> {
    let pads = found.pads.iter().map(|pad| {
        let words = format!("the pad at {}", pad.path);
        Offer::of(&lasting(pad, &found.pads), words)
    });
    let devices = found.input_devices.iter().map(|device| {
        let words = format!("{} (it plays as {})", device.name, device.source);
        Offer::of(alone(device, &found.input_devices), words)
    });
    let ports = found.usb_ports.iter().flat_map(|port| {
        let path = by_id(Path::new(BY_ID), &port.path).unwrap_or_else(|| port.path.clone());
        [
            Offer::of(
                &format!("load-cells:{path}"),
                format!("load cells that print numbers at {}", port.path),
            ),
            Offer::of(
                &format!("serial:{path}"),
                format!("a pad of your own at {}, which sends frames", port.path),
            ),
        ]
    });
    let software = [Offer::of("virtual", "a pad of software: nothing needs to be attached".to_owned())];
    pads.chain(devices).chain(ports).chain(software).flatten().collect()
}

/// The address of a pad that still means it after it was plugged in anew.
fn lasting(pad: &Listed, all: &[Listed]) -> String {
    let is_alike = |other: &&Listed| other.serial_number == pad.serial_number;
    match (&pad.serial_number, &pad.place) {
        _ if all.len() == 1 && pad.serial_number.is_none() => "auto".to_owned(),
        (Some(number), _) if all.iter().filter(is_alike).count() == 1 => format!("auto:{number}"),
        (_, Some(place)) => place.clone(),
        _ => pad.address.clone(),
    }
}

/// The address of an input device: without its node where it is the only one of its kind.
fn alone<'a>(device: &'a ListedDevice, all: &[ListedDevice]) -> &'a str {
    let is_only = all.iter().filter(|other| other.source == device.source).count() == 1;
    if is_only { &device.source } else { &device.address }
}

/// The link in this folder that leads to a port.
fn by_id(folder: &Path, port: &str) -> Option<String> {
    let port = fs::canonicalize(port).ok()?;
    let mut links = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    links.find(|link| fs::canonicalize(link).ok().as_ref() == Some(&port))?.to_str().map(str::to_owned)
}

/// The offer that an answer means: by its number, or by an address, which need not be offered.
pub(super) fn chosen(answer: &str, offers: &[Offer]) -> Option<ChosenPad> {
    if let Ok(number) = answer.parse::<usize>() {
        return offers.get(number.checked_sub(1)?).map(|offer| offer.pad.clone());
    }
    let address: PadAddress = answer.parse().ok()?;
    Some(ChosenPad { address, source: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(path: &str, serial_number: Option<&str>, place: Option<&str>) -> Listed {
        Listed {
            address: format!("serial:{path}"),
            path: path.into(),
            serial_number: serial_number.map(str::to_owned),
            place: place.map(str::to_owned),
            firmware: None,
        }
    }

    fn device(node: u8) -> ListedDevice {
        ListedDevice {
            address: format!("tablet:/dev/input/event{node}"),
            path: format!("/dev/input/event{node}"),
            name: "Pen".into(),
            source: "tablet".into(),
            is_readable: true,
            unreadable_reports: None,
            battery: None,
        }
    }

    fn addresses(pads: Vec<Listed>, input_devices: Vec<ListedDevice>, usb_ports: Vec<Listed>) -> Vec<String> {
        let found = DevicesReport { pads, input_devices, serial_ports: Vec::new(), usb_ports };
        of(&found).iter().map(|offer| offer.pad.address.to_string()).collect()
    }

    #[test]
    fn what_is_chosen_still_means_the_same_after_it_was_unplugged() {
        let [one, other] = ["/dev/ttyACM0", "/dev/ttyACM1"];
        assert_eq!(addresses(vec![listed(one, None, Some("usb:1-1"))], vec![], vec![]), ["auto", "virtual"]);
        let two = |[first, second]: [Option<&str>; 2]| {
            vec![listed(one, first, Some("usb:1-1@115200")), listed(other, second, None)]
        };
        assert_eq!(addresses(two([Some("A"), Some("B")]), vec![], vec![])[..2], ["auto:A", "auto:B"]);
        let alike = addresses(two([Some("A"), Some("A")]), vec![], vec![]);
        assert_eq!(alike[0], "usb:1-1@115200");
        assert!(alike[1].starts_with("serial:/dev/ttyACM1@"), "{alike:?}");
        assert_eq!(addresses(vec![], vec![device(5)], vec![]), ["tablet", "virtual"]);
        assert_eq!(addresses(vec![], vec![device(5), device(6)], vec![])[1], "tablet:/dev/input/event6");
    }

    #[test]
    fn a_port_is_chosen_by_what_its_plug_tells() {
        let folder = tempfile::tempdir().unwrap();
        let [port, link] = ["ttyUSB0", "usb-Board_7A"].map(|name| folder.path().join(name));
        fs::write(&port, "").unwrap();
        let links = folder.path().join("by-id");
        fs::create_dir(&links).unwrap();
        assert_eq!(by_id(&links, port.to_str().unwrap()), None);
        let link = links.join(link.file_name().unwrap());
        std::os::unix::fs::symlink(&port, &link).unwrap();
        assert_eq!(by_id(&links, port.to_str().unwrap()).as_deref(), link.to_str());
    }

    #[test]
    fn an_answer_is_a_number_of_the_list_or_an_address() {
        let offers = of(&DevicesReport {
            pads: vec![],
            input_devices: vec![device(5)],
            serial_ports: vec![],
            usb_ports: vec![],
        });
        let meant = |answer: &str| chosen(answer, &offers).map(|pad| pad.address.to_string());
        assert_eq!(meant("1").as_deref(), Some("tablet"));
        assert_eq!(meant("2").as_deref(), Some("virtual"));
        assert_eq!(meant("hid:1209:0001").as_deref(), Some("hid:1209:0001"));
        for answer in ["0", "3", "", "nonsense"] {
            assert_eq!(meant(answer), None, "{answer}");
        }
    }
}
