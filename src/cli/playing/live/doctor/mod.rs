//! `tactpad doctor`: what stands in the way on this machine, and the exact command that mends it.

mod access;
mod bridge;
mod check;
mod flatpak;
mod gamepads;
mod sdl;
mod serial_ports;
mod session;

use std::env;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use clap::Args;
use serde::Serialize;

use self::bridge::RunningBridge;
use self::check::{Check, Finding};
use super::devices::input_devices;
use super::runtime::BridgeName;
use super::{ctl, last_choice, left_keys};
use crate::cli::failure::{Failure, if_read};
use crate::cli::printing::written::{print_json, printable, stdout};
use tactpad::bridge::control::ask;
use tactpad::bridge::foreground::WindowSystem;
use tactpad::bridge::transport::address::PadAddress;
use tactpad::bridge::transport::pads;

pub(super) use self::access::denied;

/// Arguments of `tactpad doctor`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad doctor")]
pub(crate) struct Arguments {
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
    /// Print the udev rules instead, to be put in place.
    #[arg(long, conflicts_with = "json")]
    udev_rules: bool,
}

/// All findings of the doctor.
#[derive(Serialize)]
pub(super) struct DoctorReport {
    ok: bool,
    checks: Vec<Check>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.udev_rules {
        return Ok(stdout().write_all(access::RULES.as_bytes())?);
    }
    let report = examine(None);
    let printed = if arguments.json { print_json(&report) } else { print(&report).map_err(Failure::from) };
    if_read(printed)?;
    if report.ok { Ok(()) } else { Err(Failure::Failed("something stands in the way".into())) }
}

/// Looks at this machine, and at the bridge of this name.
pub(super) fn examine(name: Option<&BridgeName>) -> DoctorReport {
    let root = Path::new("/");
    let variable = |name: &str| env::var(name).ok();
    let bridge = match ctl::reached(name) {
        Ok(path) => ask(&path, "status"),
        Err(failure) => Err(io::Error::new(io::ErrorKind::PermissionDenied, failure.sentence())),
    };
    let running = bridge.as_deref().ok().map(RunningBridge::of);
    let own = running.as_ref().map(RunningBridge::nodes).unwrap_or_default();
    let mut checks = vec![
        check_setup(),
        access::check_needed_uinput(running.as_ref(), &last_choice::kept_output()),
        access::check_rules(root),
    ];
    checks.extend(access::check_pads(&pads::attached(), running.as_ref()));
    checks.extend(access::check_input_devices(&input_devices()));
    checks.extend(serial_ports::check_modems(root));
    checks.extend(serial_ports::check_braille(root));
    let devices = fs::read_to_string(root.join("proc/bus/input/devices")).unwrap_or_default();
    checks.extend(gamepads::check_other_gamepads(&devices, &own));
    checks.push(gamepads::check_joydev(root));
    let home = env::home_dir();
    checks.extend(sdl::check_variables(&sdl::places(root, home.as_deref(), variable)));
    checks.extend(gamepads::check_proton(home.as_deref()));
    checks.extend(flatpak::check(root, home.as_deref()));
    checks.extend(session::check_keys(variable));
    checks.extend(session::check_foreground(variable, || WindowSystem::open().map(|_| ())));
    checks.push(bridge::check_bridge(&bridge, name));
    checks.extend(left_keys::found().iter().map(bridge::check_left_down));
    DoctorReport { ok: checks.iter().all(|check| check.finding != Finding::Bad), checks }
}

/// What was chosen here, or the way to choose.
fn check_setup() -> Check {
    let name = "set-up";
    let (pad, profile) = (last_choice::pad(), last_choice::kept_profile());
    let mend = Some("tactpad setup".into());
    if pad.is_none() && profile.is_none() {
        return Check { mend, ..Check::note(name, "not done yet; a few questions lead to the first game") };
    }
    let pad_words = pad
        .as_ref()
        .map_or_else(|| "whatever pad comes".to_owned(), |pad| format!("the pad {}", pad.address));
    let profile = profile.map(|profile| format!(", profile {profile}")).unwrap_or_default();
    let message =
        format!("`tactpad run` plays with {pad_words}{profile}, output {}", last_choice::kept_output());
    let check = Check::good(name, printable(&message));
    if pad.is_some_and(|pad| pad.address == PadAddress::Virtual) && !pads::attached().is_empty() {
        return Check { mend, ..check.noted("a pad is attached, and this chooses it") };
    }
    check
}

fn print(report: &DoctorReport) -> io::Result<()> {
    let mut out = stdout();
    for Check { name, finding, message, mend } in &report.checks {
        let mark = match finding {
            Finding::Good => "good",
            Finding::Note => "note",
            Finding::Bad => "BAD ",
        };
        writeln!(out, "{mark}  {name}: {message}")?;
        if let Some(mend) = mend {
            writeln!(out, "      {mend}")?;
        }
    }
    Ok(())
}
