//! `tactpad doctor`: what stands in the way on this machine, and the exact command that mends it.

use std::env;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use clap::Args;
use rustix::fs::{Access, access};
use serde::Serialize;
use serde_json::Value;

use super::devices::{ListedDevice, input_devices};
use super::runtime::BridgeName;
use super::{ctl, left_keys};
use crate::cli::failure::{Failure, if_read};
use crate::cli::printing::written::{print_json, printable, stdout};
use tactpad::bridge::control::ask;
use tactpad::bridge::sink::uinput;
use tactpad::bridge::sink::x11::LeftDown;
use tactpad::bridge::transport::firmware::{OLDEST, dotted};
use tactpad::bridge::transport::pads::{self, Attachment, FoundPad};

/// The rules that give the player access; a test holds their number below that of the seat's.
const RULES: &str = include_str!("../../../../docs/linux/70-tactpad.rules");

/// Where the rules belong.
const RULES_FILE: &str = "/etc/udev/rules.d/70-tactpad.rules";

/// Seats are given out by a file of this number; what a later file tags has no effect.
const SEAT_NUMBER: u32 = 73;

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

/// How a check came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Finding {
    /// In order.
    Good,
    /// Worth knowing; nothing needs to be done.
    Note,
    /// Stands in the way.
    Bad,
}

/// One check.
#[derive(Debug, PartialEq, Eq, Serialize)]
struct Check {
    name: &'static str,
    finding: Finding,
    message: String,
    /// The command that mends it.
    mend: Option<String>,
}

impl Check {
    fn good(name: &'static str, message: impl Into<String>) -> Self {
        Self { name, finding: Finding::Good, message: message.into(), mend: None }
    }

    fn note(name: &'static str, message: impl Into<String>) -> Self {
        Self { name, finding: Finding::Note, message: message.into(), mend: None }
    }

    fn bad(name: &'static str, message: impl Into<String>, mend: impl Into<String>) -> Self {
        Self { name, finding: Finding::Bad, message: message.into(), mend: Some(mend.into()) }
    }
}

/// All findings of the doctor.
#[derive(Serialize)]
pub(super) struct DoctorReport {
    ok: bool,
    checks: Vec<Check>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.udev_rules {
        return Ok(stdout().write_all(RULES.as_bytes())?);
    }
    let report = examine(None);
    let printed = if arguments.json { print_json(&report) } else { print(&report).map_err(Failure::from) };
    if_read(printed)?;
    if report.ok { Ok(()) } else { Err(Failure::Failed("something stands in the way".into())) }
}

/// Looks at this machine, and at the bridge of this name.
pub(super) fn examine(name: Option<&BridgeName>) -> DoctorReport {
    let root = Path::new("/");
    let mut checks = vec![check_uinput(), check_rules(root)];
    checks.extend(check_pads(&pads::attached()));
    checks.extend(check_input_devices(&input_devices()));
    let bridge = match ctl::reached(name) {
        Ok(path) => ask(&path, "status"),
        Err(failure) => Err(io::Error::new(io::ErrorKind::PermissionDenied, failure.sentence())),
    };
    let own = bridge.as_deref().map(own_nodes).unwrap_or_default();
    checks.extend(check_port_users(root));
    checks.extend(check_other_gamepads(&read(root, "proc/bus/input/devices"), &own));
    checks.push(check_joydev(root));
    checks.extend(check_sdl(|name| env::var(name).ok()));
    checks.extend(check_session(|name| env::var(name).ok()));
    checks.push(check_bridge(&bridge, name));
    checks.extend(left_keys::found().iter().map(check_left_down));
    DoctorReport { ok: checks.iter().all(|check| check.finding != Finding::Bad), checks }
}

/// Input devices that can be played with, whether they may be read, and whether their batteries will last.
fn check_input_devices(fitting: &[ListedDevice]) -> Vec<Check> {
    let check = |device: &ListedDevice| {
        let what = printable(&format!("{}, which fits {},", device.name, device.source));
        match (device.lack(), device.mend()) {
            (Some(lack), mend) => Check {
                mend,
                ..Check::note("input device", format!("{what} {lack}; until it is unplugged this lets you"))
            },
            (None, _) => Check::good(
                "input device",
                printable(&format!("{} plays with --pad {}", device.name, device.address)),
            ),
        }
    };
    fitting.iter().flat_map(|device| [Some(check(device)), check_battery(device)]).flatten().collect()
}

/// The battery of an input device, if it has one that says how it is.
fn check_battery(device: &ListedDevice) -> Option<Check> {
    let (name, battery) = ("battery", device.battery?);
    let message = printable(&format!("{} has its {battery}", device.name));
    Some(if battery.is_low() {
        Check::note(
            name,
            format!("{message}, which is low: put fresh ones in before the device leaves the game"),
        )
    } else {
        Check::good(name, message)
    })
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

fn read(root: &Path, path: &str) -> String {
    fs::read_to_string(root.join(path)).unwrap_or_default()
}

fn install_rules() -> String {
    format!(
        "tactpad doctor --udev-rules | sudo tee {RULES_FILE} && sudo udevadm control --reload && sudo udevadm trigger"
    )
}

fn check_uinput() -> Check {
    let name = "virtual devices";
    match uinput::available() {
        Ok(()) => Check::good(name, "/dev/uinput can be written"),
        Err(_) if !Path::new("/dev/uinput").exists() => Check::bad(
            name,
            "/dev/uinput is not there: the kernel's module is not loaded",
            "sudo modprobe uinput && echo uinput | sudo tee /etc/modules-load.d/tactpad.conf",
        ),
        Err(_) => Check::bad(name, "/dev/uinput cannot be written by you", install_rules()),
    }
}

/// Rules that come after the seat's are the classic mistake: they look right and do nothing.
fn check_rules(root: &Path) -> Check {
    let name = "udev rules";
    let folders = ["etc/udev/rules.d", "usr/lib/udev/rules.d", "lib/udev/rules.d"];
    let files =
        folders.iter().flat_map(|folder| fs::read_dir(root.join(folder)).into_iter().flatten().flatten());
    let mut ours: Vec<_> = files
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|file| file.contains("tactpad"))
        .collect();
    ours.sort();
    match ours.first() {
        None => Check {
            mend: Some(install_rules()),
            ..Check::note(name, "none are installed; this lets you play without root")
        },
        Some(file) if number(file).is_none_or(|number| number >= SEAT_NUMBER) => Check::bad(
            name,
            format!("{file} comes after {SEAT_NUMBER}-seat-late.rules, so its uaccess tags have no effect"),
            format!("sudo rm /etc/udev/rules.d/{file} && {}", install_rules()),
        ),
        Some(file) => Check::good(name, format!("{file} is installed")),
    }
}

fn number(file: &str) -> Option<u32> {
    file.split('-').next()?.parse().ok()
}

fn check_pads(pads: &[FoundPad]) -> Vec<Check> {
    if pads.is_empty() {
        let mend = Some("tactpad demo".into());
        return vec![Check { mend, ..Check::note("pad", "none is attached; this plays without one") }];
    }
    let check = |pad: &FoundPad| {
        let path = pad.path.display();
        // Not opened: that would reset some boards, and disturb a bridge that plays on it.
        match access(&pad.path, Access::READ_OK | Access::WRITE_OK) {
            Ok(()) => Check::good("pad", format!("{path} may be opened")),
            Err(_) => Check::bad("pad", format!("{path} may not be opened by you"), install_rules()),
        }
    };
    let of_pad = |pad: &FoundPad| [Some(check(pad)), check_firmware(pad)];
    pads.iter().flat_map(of_pad).flatten().collect()
}

/// The firmware of a pad, if it is one of ours.
fn check_firmware(pad: &FoundPad) -> Option<Check> {
    let (name, path, firmware) = ("firmware", pad.path.display(), pad.firmware.as_ref()?);
    let message = printable(&format!("{path} has {firmware}"));
    if firmware.is_old() {
        let begin = match pad.attachment {
            Attachment::Serial => format!(" && stty -F {path} 1200"),
            Attachment::Hid => "   (and hold BOOTSEL while you plug the board in)".into(),
        };
        let message = format!(
            "{message}, which is older than the wire's specification, all of which {} has; build a new one, and copy tactpad-pico.uf2 to \
             the drive that appears",
            dotted(OLDEST)
        );
        return Some(Check::bad(name, message, format!("firmware-proto/pico/build{begin}")));
    }
    Some(match &firmware.restarted {
        Some(_) => Check::note(name, format!("{message}: it began anew by itself")),
        None => Check::good(name, message),
    })
}

/// Programs that open serial ports of their own accord.
fn check_port_users(root: &Path) -> Vec<Check> {
    let processes = fs::read_dir(root.join("proc")).into_iter().flatten().flatten();
    let names: Vec<String> = processes
        .filter_map(|process| fs::read_to_string(process.path().join("comm")).ok())
        .map(|name| name.trim_end().to_owned())
        .collect();
    let is_running = |name: &str| names.iter().any(|it| it == name);
    let mut checks = Vec::new();
    if is_running("ModemManager") {
        checks.push(Check::note(
            "serial ports",
            "ModemManager opens new ones for some seconds; the udev rules keep it from tactpad's pads. For another board add \
             a line with its numbers and ENV{ID_MM_DEVICE_IGNORE}=\"1\"",
        ));
    }
    if is_running("brltty") {
        checks.push(Check::note(
            "serial ports",
            "brltty takes adapters of some chips (CH340, CP210x) for Braille displays: if a pad's port goes away at once, \
             and nobody here needs brltty, remove it",
        ));
    }
    checks
}

/// Xbox 360 pads that are there already, but for those of a running bridge, which has these nodes. One of version 1 is a trap: SDL's database turns its D-pad upside
/// down.
fn check_other_gamepads(devices: &str, own_nodes: &[String]) -> Vec<Check> {
    let name = "other gamepads";
    let is_own = |device: &str| {
        let handlers = device.lines().find_map(|line| line.strip_prefix("H: Handlers="));
        handlers.is_some_and(|it| it.split_whitespace().any(|node| own_nodes.iter().any(|own| own == node)))
    };
    let others = devices.split("\n\n").filter(|device| !is_own(device));
    let lines = others.flat_map(str::lines).filter(|line| line.starts_with("I:"));
    let pads: Vec<_> = lines.filter(|line| line.contains("Vendor=045e Product=028e")).collect();
    let mut checks = Vec::new();
    if pads.iter().any(|line| line.contains("Version=0001")) {
        checks.push(Check::note(
            name,
            "an Xbox 360 pad of version 0001 is there: SDL turns its D-pad upside down. Ours has version 0114",
        ));
    }
    if !pads.is_empty() {
        checks.push(Check::note(
            name,
            "an Xbox 360 pad is there already: games may give it the first place, and browsers may merge two virtual \
             ones",
        ));
    }
    checks
}

fn check_joydev(root: &Path) -> Check {
    let name = "browsers";
    if root.join("sys/module/joydev").exists() || root.join("dev/input/js0").exists() {
        Check::good(name, "joydev is there, through which Chromium reads gamepads")
    } else {
        let mend = Some("sudo modprobe joydev".into());
        Check { mend, ..Check::note(name, "joydev is not loaded; Chromium reads gamepads through it") }
    }
}

/// Environment variables that make SDL hide or change our gamepad.
fn check_sdl(variable: impl Fn(&str) -> Option<String>) -> Vec<Check> {
    let mut checks = Vec::new();
    let mapping = variable("SDL_GAMECONTROLLERCONFIG").unwrap_or_default();
    if mapping.contains("5e0400008e020000") {
        checks.push(Check::bad(
            "SDL",
            "SDL_GAMECONTROLLERCONFIG maps Xbox 360 pads anew; ours needs no mapping",
            "unset SDL_GAMECONTROLLERCONFIG",
        ));
    }
    for name in ["SDL_GAMECONTROLLER_IGNORE_DEVICES", "SDL_JOYSTICK_BLACKLIST_DEVICES"] {
        if variable(name).is_some_and(|list| list.to_lowercase().contains("0x045e/0x028e")) {
            checks.push(Check::bad(
                "SDL",
                format!("{name} hides Xbox 360 pads, and so ours"),
                format!("unset {name}"),
            ));
        }
    }
    checks
}

fn check_session(variable: impl Fn(&str) -> Option<String>) -> Vec<Check> {
    let name = "keys without uinput";
    match (variable("WAYLAND_DISPLAY"), variable("DISPLAY")) {
        (Some(_), _) => vec![Check::note(
            name,
            "this is a Wayland session: --output x11 reaches only programs that run on XWayland",
        )],
        (None, Some(display)) => vec![Check::note(name, format!("--output x11 types on display {display}"))],
        (None, None) => Vec::new(),
    }
}

/// The nodes of a bridge's devices, as `event7`, by its status.
fn own_nodes(status: &str) -> Vec<String> {
    let status: Value = serde_json::from_str(status).unwrap_or_default();
    let output = status.get("output").and_then(Value::as_str).unwrap_or_default();
    let words = output.split([' ', ',']);
    words.filter_map(|word| word.strip_prefix("/dev/input/")).map(str::to_owned).collect()
}

fn check_bridge(answer: &io::Result<String>, name: Option<&BridgeName>) -> Check {
    match answer {
        Ok(status) => {
            let name = name.map(|name| format!(" --name {name}")).unwrap_or_default();
            Check {
                mend: Some(format!("tactpad ctl status{name}")),
                ..Check::good("bridge", bridge_message(status))
            }
        }
        Err(error) if error.kind() == io::ErrorKind::TimedOut => Check::note(
            "bridge",
            "one is there and does not answer: if it was stopped, continue it with `fg`",
        ),
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            Check::note("bridge", format!("none can be asked: {error}"))
        }
        Err(_) => Check { mend: Some("tactpad run".into()), ..Check::note("bridge", "none is running") },
    }
}

/// What a killed bridge left down. The next start lifts it, too.
fn check_left_down(left: &LeftDown) -> Check {
    let name = "X11 keys";
    match left {
        LeftDown::Held { .. } => Check::bad(name, left.to_string(), "tactpad ctl panic"),
        LeftDown::Unanswered { .. } | LeftDown::Damaged { .. } => Check::note(name, left.to_string()),
    }
}

/// The status of a bridge in a sentence.
fn bridge_message(status: &str) -> String {
    let status: Value = serde_json::from_str(status).unwrap_or_default();
    let text = |key: &str| status.get(key).and_then(Value::as_str).unwrap_or("unknown");
    let warning = ctl::warning(&status).map(|warning| format!(" ({warning})")).unwrap_or_default();
    let (profile, decoder) = (text("profile"), text("decoder"));
    format!("one is running, profile {profile}, decoder {decoder}{warning}")
}

#[cfg(test)]
mod tests {
    use tactpad::bridge::transport::evdev::battery::Battery;
    use tactpad::bridge::transport::firmware::Firmware;

    use super::*;

    #[test]
    fn input_devices_that_play_are_named_and_hidden_ones_are_told_of() {
        let device = |is_readable: bool, unreadable_reports: Option<&str>| ListedDevice {
            address: "tablet:/dev/input/event5".into(),
            path: "/dev/input/event5".into(),
            name: "Pen".into(),
            source: "tablet".into(),
            is_readable,
            unreadable_reports: unreadable_reports.map(str::to_owned),
            battery: None,
        };
        let raw = Some("/dev/hidraw3");
        let checks = check_input_devices(&[
            device(true, None),
            device(false, None),
            device(true, raw),
            device(false, raw),
        ]);
        let told: Vec<_> = checks.iter().map(|check| check.message.as_str()).collect();
        assert_eq!(told[0], "Pen plays with --pad tablet:/dev/input/event5");
        let hidden = "Pen, which fits tablet, may not be read by you; until it is unplugged this lets you";
        assert_eq!([told[1], told[3]], [hidden; 2]);
        assert!(told[2].contains("its own reports"), "{}", told[2]);
        let mends: Vec<_> = checks.iter().map(|check| check.mend.as_deref()).collect();
        let command = |nodes: &str| Some(format!("sudo setfacl -m u:$USER:r {nodes}"));
        let wanted = [
            None,
            command("/dev/input/event5"),
            command("/dev/hidraw3"),
            command("/dev/input/event5 /dev/hidraw3"),
        ];
        assert_eq!(mends, wanted.each_ref().map(Option::as_deref));
        assert_eq!(check_input_devices(&[]), []);
        let found = |battery| {
            let checks =
                check_input_devices(&[ListedDevice { battery: Some(battery), ..device(true, None) }]);
            checks.into_iter().map(|check| (check.name, check.finding)).collect::<Vec<_>>()
        };
        assert_eq!(found(Battery::Volts(5.2))[1], ("battery", Finding::Good));
        assert_eq!(found(Battery::Percent(9))[1], ("battery", Finding::Note));
    }

    #[test]
    fn an_old_firmware_is_told_with_the_way_to_a_new_one() {
        let pad = |attachment, product: &str| FoundPad {
            attachment,
            path: "/dev/ttyACM0".into(),
            ids: (0x1209, 0x0001),
            serial_number: None,
            usb_interface: None,
            firmware: Firmware::of(product),
        };
        let check = |attachment, product: &str| check_firmware(&pad(attachment, product));
        let found = |product: &str| check(Attachment::Serial, product).map(|it| it.finding);
        assert_eq!(found("Pico"), None);
        assert_eq!(found("tactpad pad 0.1.0"), Some(Finding::Good));
        assert_eq!(found("tactpad pad 0.1.0 (restarted: stood still)"), Some(Finding::Note));
        for (attachment, way) in
            [(Attachment::Serial, "stty -F /dev/ttyACM0 1200"), (Attachment::Hid, "BOOTSEL")]
        {
            let old = check(attachment, "tactpad pad 0.0.9").unwrap();
            assert_eq!(old.finding, Finding::Bad);
            assert!(old.message.contains("0.0.9, which is older") && old.mend.unwrap().contains(way));
        }
    }

    #[test]
    fn programs_that_open_ports_are_named() {
        let root = tempfile::tempdir().unwrap();
        for (process, name) in [("1", "systemd"), ("42", "ModemManager"), ("77", "brltty")] {
            fs::create_dir_all(root.path().join("proc").join(process)).unwrap();
            fs::write(root.path().join("proc").join(process).join("comm"), format!("{name}\n")).unwrap();
        }
        let checks = check_port_users(root.path());
        assert!(checks[0].message.contains("ModemManager") && checks[1].message.contains("brltty"));
        assert_eq!(check_port_users(Path::new("/nowhere")).len(), 0);
    }

    #[test]
    fn the_shipped_rules_come_before_the_seats() {
        let file = Path::new(RULES_FILE).file_name().unwrap().to_str().unwrap();
        assert!(number(file).unwrap() < SEAT_NUMBER);
        assert_eq!(RULES.matches("TAG+=\"uaccess\"").count(), 4);
    }

    #[test]
    fn what_a_bridge_warns_of_is_told() {
        let message = bridge_message(r#"{"warning": {"kind": "silent_channel", "channel": "m1z"}}"#);
        assert!(message.contains("channel m1z does not answer"), "{message}");
        assert!(!bridge_message(r#"{"warning": null}"#).contains('('));
    }

    #[test]
    fn rules_that_come_too_late_are_found() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("etc/udev/rules.d");
        fs::create_dir_all(&folder).unwrap();
        assert_eq!(check_rules(root.path()).finding, Finding::Note);
        for (file, finding) in [("99-tactpad.rules", Finding::Bad), ("70-tactpad.rules", Finding::Good)] {
            fs::write(folder.join(file), "").unwrap();
            assert_eq!(check_rules(root.path()).finding, finding, "{file}");
            fs::remove_file(folder.join(file)).unwrap();
        }
    }

    #[test]
    fn a_pad_with_the_trap_version_is_told_from_one_without() {
        let device =
            |version| format!("I: Bus=0003 Vendor=045e Product=028e Version={version}\nN: Name=\"X\"\n");
        assert_eq!(check_other_gamepads("", &[]).len(), 0);
        assert_eq!(check_other_gamepads(&device("0114"), &[]).len(), 1);
        assert_eq!(check_other_gamepads(&device("0001"), &[]).len(), 2);
    }

    #[test]
    fn our_own_pad_is_no_other_one() {
        let device = |node| {
            format!(
                "I: Bus=0003 Vendor=045e Product=028e Version=0114\nN: Name=\"Microsoft X-Box 360 pad\"\n\
                 S: Sysfs=/devices/virtual/input/input9\nH: Handlers={node} js0 \n\n"
            )
        };
        let own = own_nodes(
            r#"{"output":"virtual gamepad at /dev/input/event7, virtual pointer at /dev/input/event8"}"#,
        );
        assert_eq!(own, ["event7", "event8"]);
        assert_eq!(check_other_gamepads(&device("event7"), &own).len(), 0);
        assert_eq!(check_other_gamepads(&device("event70"), &own).len(), 1);
        assert_eq!(check_other_gamepads(&(device("event7") + &device("event3")), &own).len(), 1);
    }

    #[test]
    fn an_environment_that_hides_our_pad_is_found() {
        let with = |set: &'static str, value: &'static str| {
            check_sdl(move |name| (name == set).then(|| value.to_owned())).len()
        };
        assert_eq!(with("SDL_GAMECONTROLLERCONFIG", "030000005e0400008e02000014010000,X,a:b1"), 1);
        assert_eq!(with("SDL_GAMECONTROLLERCONFIG", "030000004c050000cc09000000000000,Y,a:b1"), 0);
        assert_eq!(with("SDL_GAMECONTROLLER_IGNORE_DEVICES", "0x045E/0x028E"), 1);
    }
}
