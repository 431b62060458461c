//! `tactpad devices`: what is attached.

use std::io::{self, Write};

use clap::Args;
use serde::Serialize;

use crate::cli::failure::Failure;
use crate::cli::printing::written::{print_json, printable, stdout};
use tactpad::bridge::transport::pads::{Attachment, FoundPad, attached};

/// Arguments of `tactpad devices`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad devices")]
pub(crate) struct Arguments {
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Listed {
    address: String,
    path: String,
    serial_number: Option<String>,
}

#[derive(Serialize)]
struct DevicesReport {
    pads: Vec<Listed>,
    /// Serial ports that do not say that they are a pad, but may be one.
    serial_ports: Vec<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pads: Vec<Listed> = attached().iter().map(listed).collect();
    let ports = serialport::available_ports().unwrap_or_default();
    let is_pad = |name: &String| pads.iter().any(|pad| pad.path == *name);
    let serial_ports = ports.into_iter().map(|port| port.port_name).filter(|name| !is_pad(name)).collect();
    let report = DevicesReport { pads, serial_ports };
    if arguments.json { print_json(&report) } else { Ok(print(&report)?) }
}

fn listed(pad: &FoundPad) -> Listed {
    let (vendor, product) = pad.ids;
    let path = pad.path.display().to_string();
    let number = pad.serial_number.as_ref().map(|number| format!(":{number}")).unwrap_or_default();
    let address = match pad.attachment {
        Attachment::Hid => format!("hid:{vendor:04x}:{product:04x}{number}"),
        Attachment::Serial => format!("serial:{path}"),
    };
    Listed { address, path, serial_number: pad.serial_number.clone() }
}

fn print(report: &DevicesReport) -> io::Result<()> {
    let mut out = stdout();
    match &report.pads[..] {
        [] => writeln!(out, "no pad is attached; play without one: tactpad demo")?,
        pads => {
            for pad in pads {
                writeln!(out, "pad   --pad {}   ({})", printable(&pad.address), pad.path)?;
            }
        }
    }
    for port in &report.serial_ports {
        writeln!(out, "port  --pad serial:{port}   (does not say what it is)")?;
    }
    Ok(())
}
