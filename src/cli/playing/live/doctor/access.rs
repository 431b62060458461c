//! What this user may open: virtual devices, pads, input devices; and the rules that allow it.

use std::fs;
use std::path::Path;

use rustix::fs::{Access, access};

use super::bridge::RunningBridge;
use super::check::{Check, Finding};
use crate::cli::playing::live::devices::{ListedDevice, input_devices};
use crate::cli::playing::live::output::Output;
use crate::cli::printing::written::{printable, quoted};
use tactpad::bridge::sink::uinput::{self, INSTALL_RULES, UinputObstacle};
use tactpad::bridge::transport::address::PadAddress;
use tactpad::bridge::transport::firmware::{OLDEST, dotted};
use tactpad::bridge::transport::pads::{self, Attachment, FoundPad};

/// The rules that give the player access; a test holds their number below that of the seat's.
pub(super) const RULES: &str = include_str!("../../../../../docs/linux/70-tactpad.rules");

/// Seats are given out by a file of this number; what a later file tags has no effect.
const SEAT_NUMBER: u32 = 73;

pub(super) fn check_uinput() -> Check {
    let name = "virtual devices";
    match uinput::available() {
        Ok(()) => Check::good(name, "/dev/uinput can be written"),
        Err(UinputObstacle { why, mend }) => {
            Check { finding: Finding::Bad, mend: mend.map(str::to_owned), ..Check::note(name, why) }
        }
    }
}

/// Rules that come after the seat's are the classic mistake: they look right and do nothing.
pub(super) fn check_rules(root: &Path) -> Check {
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
            mend: Some(INSTALL_RULES.into()),
            ..Check::note(name, "tactpad's rules are not installed; with them you play without root")
        },
        Some(file) if number(file).is_none_or(|number| number >= SEAT_NUMBER) => Check::bad(
            name,
            format!("{file} comes after {SEAT_NUMBER}-seat-late.rules, so its uaccess tags have no effect"),
            format!("sudo rm /etc/udev/rules.d/{file} && {}", INSTALL_RULES),
        ),
        Some(file) => Check::good(name, format!("{file} is installed")),
    }
}

fn number(file: &str) -> Option<u32> {
    file.split('-').next()?.parse().ok()
}

/// What this user may not open that playing with the pad at `address` into `output` needs, each with the command that mends it.
pub(in crate::cli::playing::live) fn denied(address: &PadAddress, output: &Output) -> Vec<(String, String)> {
    let mut checks: Vec<_> = (*output != Output::X11).then(check_uinput).into_iter().collect();
    match address {
        PadAddress::Auto { .. } | PadAddress::Hid { .. } | PadAddress::Usb { .. } => {
            checks.extend(pads::attached().iter().map(check_pad));
        }
        PadAddress::Described { name, path, .. } if !path.as_deref().is_some_and(is_port) => {
            let is_meant = |device: &ListedDevice| {
                device.source == *name && path.as_ref().is_none_or(|path| *path == device.path)
            };
            checks.extend(check_input_devices(
                &input_devices().into_iter().filter(is_meant).collect::<Vec<_>>(),
            ));
        }
        PadAddress::Serial { path, .. } | PadAddress::Described { path: Some(path), .. } => {
            checks.push(check_port(path));
        }
        PadAddress::Virtual | PadAddress::Described { .. } | PadAddress::Capture { .. } => {}
    }
    checks.into_iter().filter_map(|check| Some((check.message, check.mend?))).collect()
}

fn is_port(path: &str) -> bool {
    !path.starts_with("/dev/input/")
}

/// A serial port of any device, which the rules do not know.
fn check_port(path: &str) -> Check {
    let node = Path::new(path);
    if !node.exists() || access(node, Access::READ_OK | Access::WRITE_OK).is_ok() {
        return Check::good("pad", format!("{path} may be opened, or is not there yet"));
    }
    let message = format!("{path} may not be opened by you; until it is unplugged this lets you");
    Check::bad("pad", message, format!("sudo setfacl -m u:$USER:rw {}", quoted(path)))
}

/// Virtual devices, which a bridge that plays into keys does without, and so does `run` where `chosen` is those.
pub(super) fn check_needed_uinput(running: Option<&RunningBridge>, chosen: &Output) -> Check {
    let check = check_uinput();
    match running.filter(|bridge| bridge.nodes().is_empty() && check.finding == Finding::Bad) {
        None if running.is_none() && check.finding == Finding::Bad && *chosen == Output::X11 => {
            check.noted("`tactpad setup` chose keys of the X server, which do without")
        }
        Some(bridge) if bridge.reaches_games() => {
            check.noted(&format!("the bridge that runs does without: it plays into {}", bridge.output))
        }
        Some(bridge) => {
            let message = format!(
                "{}; the bridge that runs plays into {}, and no game: start it again afterwards",
                check.message, bridge.output
            );
            Check { message, ..check }
        }
        None => check,
    }
}

pub(super) fn check_pads(pads: &[FoundPad], running: Option<&RunningBridge>) -> Vec<Check> {
    if pads.is_empty() {
        return vec![check_missing_pad(running)];
    }
    let of_pad = |pad: &FoundPad| [Some(check_pad(pad)), check_firmware(pad)];
    pads.iter().flat_map(of_pad).flatten().collect()
}

fn check_missing_pad(running: Option<&RunningBridge>) -> Check {
    let name = "pad";
    match running {
        Some(bridge) if bridge.waits() => Check::bad(
            "no pad",
            "none is attached: plug it in; if it is, try another cable and another socket; this command lists what is there",
            "tactpad devices",
        ),
        Some(_) => Check::good(name, "none of our own is attached; the bridge plays with something else"),
        None => Check {
            mend: Some("tactpad demo".into()),
            ..Check::note(name, "no pad is attached; this command plays without one")
        },
    }
}

fn check_pad(pad: &FoundPad) -> Check {
    let path = pad.path.display();
    // Not opened: that would reset some boards, and disturb a bridge that plays on it.
    match access(&pad.path, Access::READ_OK | Access::WRITE_OK) {
        Ok(()) => Check::good("pad", format!("{path} may be opened")),
        Err(_) => Check::bad("pad", format!("{path} may not be opened by you"), INSTALL_RULES),
    }
}

/// The firmware of a pad, if it is one of ours.
pub(super) fn check_firmware(pad: &FoundPad) -> Option<Check> {
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

/// Input devices that can be played with, whether they may be read, and whether their batteries will last.
pub(super) fn check_input_devices(fitting: &[ListedDevice]) -> Vec<Check> {
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
pub(super) fn check_battery(device: &ListedDevice) -> Option<Check> {
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
    fn a_missing_pad_stands_in_the_way_of_a_bridge_that_waits_for_one() {
        let found =
            |status: Option<&str>| check_pads(&[], status.map(RunningBridge::of).as_ref()).remove(0).finding;
        assert_eq!(found(None), Finding::Note);
        assert_eq!(found(Some(r#"{"state":"waiting"}"#)), Finding::Bad);
        assert_eq!(found(Some(r#"{"state":"playing"}"#)), Finding::Good);
    }

    #[test]
    fn who_plays_into_keys_needs_no_virtual_device_and_who_plays_into_a_log_does() {
        let found = |status: Option<&str>| {
            check_needed_uinput(status.map(RunningBridge::of).as_ref(), &Output::Auto).finding
        };
        let unneeded = if check_uinput().finding == Finding::Bad { Finding::Note } else { Finding::Good };
        assert_eq!(found(Some(r#"{"output":"keys on X11 display :0"}"#)), unneeded);
        for without in [None, Some(r#"{"output":"event log in events"}"#), Some(r#"{"output":"no output"}"#)]
        {
            assert_eq!(found(without), check_uinput().finding);
        }
        assert_eq!(check_needed_uinput(None, &Output::X11).finding, unneeded);
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
    fn the_shipped_rules_come_before_the_seats() {
        let (_, file) = INSTALL_RULES.split_once("/etc/udev/rules.d/").unwrap();
        assert!(number(file).unwrap() < SEAT_NUMBER);
        assert_eq!(RULES.matches("TAG+=\"uaccess\"").count(), 4);
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
}
