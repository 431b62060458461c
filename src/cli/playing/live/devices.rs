//! `tactpad devices`: what is attached.

use std::io::{self, Write};
use std::path::Path;

use clap::Args;
use serde::Serialize;

use crate::cli::failure::Failure;
use crate::cli::printing::written::{print_json, printable, stdout};
use tactpad::bridge::transport::evdev::battery::Battery;
use tactpad::bridge::transport::evdev::beside::raw_node;
use tactpad::bridge::transport::evdev::found::{self, FoundDevice, reading_command};
use tactpad::bridge::transport::pads::{Attachment, FoundPad, attached, usb_serial_ports};
use tactpad::bridge::transport::serial;
use tactpad::source::read::read;
use tactpad::source::{Evdev, Origin, Source, shipped};

/// Arguments of `tactpad devices`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad devices")]
pub(crate) struct Arguments {
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, PartialEq, Eq, Serialize)]
pub(super) struct Listed {
    pub(super) address: String,
    pub(super) path: String,
    pub(super) serial_number: Option<String>,
    /// The address by its place, which stays when names and serial numbers do not tell pads apart.
    pub(super) place: Option<String>,
    /// The version of its firmware, and why that restarted, if it is one of ours.
    pub(super) firmware: Option<String>,
}

/// An input device that fits a description inside the program.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct ListedDevice {
    pub(super) address: String,
    pub(super) path: String,
    /// What it calls itself.
    pub(super) name: String,
    /// The description that fits.
    pub(super) source: String,
    /// Whether this user may read it.
    pub(super) is_readable: bool,
    /// Where its own reports come, if the description takes them and this user may not read them.
    pub(super) unreadable_reports: Option<String>,
    pub(super) battery: Option<Battery>,
}

impl ListedDevice {
    /// The command that lets this user read all of it; `None` where that is so.
    pub(super) fn mend(&self) -> Option<String> {
        let device = (!self.is_readable).then_some(&self.path);
        let nodes: Vec<&Path> = device.into_iter().chain(&self.unreadable_reports).map(Path::new).collect();
        (!nodes.is_empty()).then(|| reading_command(&nodes))
    }

    /// What this user cannot have of it as it is; `None` where nothing is missing.
    pub(super) fn lack(&self) -> Option<&'static str> {
        if !self.is_readable {
            Some("may not be read by you")
        } else if self.unreadable_reports.is_some() {
            Some(
                "plays without what only its own reports tell, which may not be read by you: what lies on a cell below that cell's zero",
            )
        } else {
            None
        }
    }
}

#[derive(Serialize)]
pub(super) struct DevicesReport {
    pub(super) pads: Vec<Listed>,
    /// Input devices that can be played with.
    pub(super) input_devices: Vec<ListedDevice>,
    /// Serial ports that do not say that they are a pad, but may be one.
    pub(super) serial_ports: Vec<String>,
    /// Those of them that are on the USB.
    pub(super) usb_ports: Vec<Listed>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let report = found_here();
    if arguments.json { print_json(&report) } else { Ok(print(&report)?) }
}

/// What is attached to this machine.
pub(super) fn found_here() -> DevicesReport {
    let pads = listed(&attached());
    let is_pad = |name: &String| pads.iter().any(|pad| pad.path == *name);
    let serial_ports: Vec<_> =
        serial::ports().into_iter().map(|port| port.port_name).filter(|name| !is_pad(name)).collect();
    let mut usb_ports = listed(&usb_serial_ports());
    usb_ports.retain(|port| serial_ports.contains(&port.path));
    let input_devices = input_devices();
    DevicesReport { pads, input_devices, serial_ports, usb_ports }
}

/// The input devices that fit a shipped description, each with the first that does: names come before what others may have, too.
pub(super) fn input_devices() -> Vec<ListedDevice> {
    let sources = shipped::names().filter_map(|name| read(shipped::text(name)?).0);
    let (named, others): (Vec<Source>, Vec<Source>) =
        sources.partition(|source| matches!(&source.origin, Origin::Evdev(evdev) if !evdev.names.is_empty()));
    let mut found = found::attached(&[]);
    let mut devices: Vec<ListedDevice> = Vec::new();
    for source in named.iter().chain(&others) {
        devices.extend(
            found
                .extract_if(.., |device| device.fits(source))
                .filter_map(|device| listed_device(&device, source)),
        );
    }
    devices
}

fn listed_device(device: &FoundDevice, source: &Source) -> Option<ListedDevice> {
    let path = device.path.display().to_string();
    let Origin::Evdev(Evdev { reports, .. }) = source.origin else { return None };
    let raw = reports.and_then(|_| raw_node(&device.path)).filter(|raw| !raw.is_readable);
    Some(ListedDevice {
        address: format!("{}:{path}", source.name),
        path,
        name: device.name.clone(),
        source: source.name.clone(),
        is_readable: device.is_readable(),
        unreadable_reports: raw.map(|raw| raw.path.display().to_string()),
        battery: Battery::of(&device.path, reports),
    })
}

fn listed(found: &[FoundPad]) -> Vec<Listed> {
    found.iter().map(|pad| listed_among(pad, found)).collect()
}

/// A pad as it is listed beside the others: its address is one that means no other.
fn listed_among(pad: &FoundPad, all: &[FoundPad]) -> Listed {
    let (vendor, product) = pad.ids;
    let path = pad.path.display().to_string();
    let number = pad.serial_number.as_ref().map(|number| format!(":{number}")).unwrap_or_default();
    let is_alone_at = |port: &&str| all.iter().filter(|other| other.usb_port() == Some(port)).count() == 1;
    let place = pad.usb_port().filter(is_alone_at).or(pad.usb_interface.as_deref());
    let place = place.map(|place| format!("usb:{place}"));
    let is_alike = |other: &&FoundPad| (other.ids, &other.serial_number) == (pad.ids, &pad.serial_number);
    let address = match (pad.attachment, &place) {
        (Attachment::Serial, _) => format!("serial:{path}"),
        (Attachment::Hid, Some(place)) if all.iter().filter(is_alike).count() > 1 => place.clone(),
        (Attachment::Hid, _) => format!("hid:{vendor:04x}:{product:04x}{number}"),
    };
    let firmware = pad.firmware.as_ref().map(ToString::to_string);
    Listed { address, path, serial_number: pad.serial_number.clone(), place, firmware }
}

fn print(report: &DevicesReport) -> io::Result<()> {
    let mut out = stdout();
    match &report.pads[..] {
        [] => writeln!(out, "no pad is attached; play without one: tactpad demo")?,
        pads => {
            for pad in pads {
                let firmware = pad.firmware.as_ref().map(|it| format!("; firmware {it}")).unwrap_or_default();
                let facts = printable(&format!("{}{firmware}{}", pad.path, at(pad)));
                writeln!(out, "pad   --pad {}   ({facts})", printable(&pad.address))?;
            }
        }
    }
    for device in &report.input_devices {
        let (address, name) = (printable(&device.address), printable(&device.name));
        let battery = device.battery.map(|battery| format!("; {battery}")).unwrap_or_default();
        let lack = device.lack().zip(device.mend());
        let lack = lack.map(|(lack, mend)| format!("; {lack}: {mend}")).unwrap_or_default();
        writeln!(out, "input --pad {address}   ({name}{battery}{lack})")?;
    }
    for port in &report.serial_ports {
        let place = report.usb_ports.iter().find(|usb| usb.path == *port).map(at).unwrap_or_default();
        writeln!(
            out,
            "port  --pad serial:{port}   (does not say what it is{place}; --pad load-cells:{port} if it prints lines of numbers)"
        )?;
    }
    Ok(())
}

/// The place, behind other facts.
fn at(listed: &Listed) -> String {
    listed.place.as_ref().map(|place| format!("; by its place: --pad {place}")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use tactpad::bridge::transport::firmware::Firmware;

    use super::*;

    fn pad(interface: &str, number: &str) -> FoundPad {
        FoundPad {
            attachment: Attachment::Hid,
            path: "/dev/hidraw0".into(),
            ids: (0x1209, 0x0001),
            serial_number: Some(number.into()),
            usb_interface: Some(interface.into()),
            firmware: Firmware::of("tactpad pad 0.1.0"),
        }
    }

    fn addresses(pads: &[FoundPad]) -> Vec<String> {
        listed(pads).into_iter().map(|pad| pad.address).collect()
    }

    #[test]
    fn pads_of_one_serial_number_are_listed_by_their_place() {
        let [one, other] = [pad("1-1:1.0", "A"), pad("1-2:1.0", "B")];
        assert_eq!(addresses(&[one, other.clone()]), ["hid:1209:0001:A", "hid:1209:0001:B"]);
        assert_eq!(addresses(&[pad("1-1:1.0", "B"), other.clone()]), ["usb:1-1", "usb:1-2"]);
        assert_eq!(addresses(&[pad("1-2:1.1", "B"), other]), ["usb:1-2:1.1", "usb:1-2:1.0"]);
    }
}
