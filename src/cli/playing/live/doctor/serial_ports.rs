//! Programs that take serial ports of their own accord: ModemManager, brltty.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::check::Check;
use tactpad::bridge::sink::uinput::INSTALL_RULES;
use tactpad::firmware_proto::hid::{PRODUCT_ID, VENDOR_ID};

const NAME: &str = "serial ports";

/// Where udev's rules lie; a file stands before one of the same name in a later folder.
const RULES: [&str; 3] = ["etc/udev/rules.d", "usr/lib/udev/rules.d", "lib/udev/rules.d"];

/// A device on the USB, by its numbers, and its serial port if it has one.
struct UsbDevice {
    vendor: u16,
    product: u16,
    port: Option<String>,
}

/// What is said of ModemManager where it runs beside a port that no rule keeps from it.
pub(super) fn check_modems(root: &Path) -> Vec<Check> {
    if !is_running(root, "ModemManager") {
        return Vec::new();
    }
    let rules = rules(root);
    let with_port = usb_devices(root).into_iter().filter_map(|device| Some((device.port.clone()?, device)));
    let open = with_port.filter(|(_, device)| !rules.iter().any(|(_, text)| keeps_modems_off(text, device)));
    open.map(|(port, UsbDevice { vendor, product, .. })| {
        let mend = if (vendor, product) == (VENDOR_ID, PRODUCT_ID) {
            INSTALL_RULES.to_owned()
        } else {
            format!(
                "echo 'ATTRS{{idVendor}}==\"{vendor:04x}\", ATTRS{{idProduct}}==\"{product:04x}\", ENV{{ID_MM_DEVICE_IGNORE}}=\"1\"' | \
                 sudo tee -a /etc/udev/rules.d/70-no-modems.rules && sudo udevadm control --reload && sudo udevadm trigger"
            )
        };
        let message = format!(
            "ModemManager may open {port} for some seconds whenever it is plugged in, as it may be a modem; this tells it that it is none"
        );
        Check { mend: Some(mend), ..Check::note(NAME, message) }
    })
    .collect()
}

/// Whether a rule tells ModemManager that a device is no modem.
fn keeps_modems_off(rules: &str, device: &UsbDevice) -> bool {
    let names = |line: &str, key: &str, number: u16| line.contains(&format!("{key}}}==\"{number:04x}\""));
    rules.lines().filter(|line| !line.trim_start().starts_with('#')).any(|line| {
        line.contains("ID_MM_DEVICE_IGNORE")
            && names(line, "idVendor", device.vendor)
            && names(line, "idProduct", device.product)
    })
}

/// What is said of brltty where its rules take an adapter that is plugged in for a Braille display.
pub(super) fn check_braille(root: &Path) -> Vec<Check> {
    let rules = rules(root);
    let of_braille = rules.iter().filter(|(file, _)| file.contains("brltty"));
    let devices = usb_devices(root);
    let mut checks = Vec::new();
    for (file, text) in of_braille {
        for UsbDevice { vendor, product, port } in devices.iter().filter(|device| takes(text, device)) {
            let mend =
                format!("sudo ln -s /dev/null /etc/udev/rules.d/{file} && sudo udevadm control --reload");
            let message = format!(
                "brltty takes the adapter {vendor:04x}:{product:04x} for a Braille display; where nobody needs brltty this leaves it alone \
                 from the next time on that it is plugged in"
            );
            checks.push(match port {
                Some(port) => {
                    Check { mend: Some(mend), ..Check::note(NAME, format!("{port} may go away: {message}")) }
                }
                None => Check::bad(NAME, format!("a port has gone away: {message}"), mend),
            });
        }
    }
    checks
}

/// Whether brltty's rules name a device.
fn takes(rules: &str, UsbDevice { vendor, product, .. }: &UsbDevice) -> bool {
    let named = format!("{{PRODUCT}}==\"{vendor:x}/{product:x}/");
    rules.lines().any(|line| !line.trim_start().starts_with('#') && line.contains(&named))
}

/// The rules of this machine: names of files and what is in them.
fn rules(root: &Path) -> BTreeMap<String, String> {
    let mut rules = BTreeMap::new();
    for entry in
        RULES.iter().flat_map(|folder| fs::read_dir(root.join(folder)).into_iter().flatten().flatten())
    {
        let name = entry.file_name().to_string_lossy().into_owned();
        // One that leads to /dev/null is empty.
        rules.entry(name).or_insert_with(|| fs::read_to_string(entry.path()).unwrap_or_default());
    }
    rules
}

/// Whether a process has this name.
fn is_running(root: &Path, name: &str) -> bool {
    let processes = fs::read_dir(root.join("proc")).into_iter().flatten().flatten();
    let mut names = processes.filter_map(|process| fs::read_to_string(process.path().join("comm")).ok());
    names.any(|it| it.trim_end() == name)
}

/// What is on the USB.
fn usb_devices(root: &Path) -> Vec<UsbDevice> {
    let number = |device: &Path, file: &str| {
        u16::from_str_radix(fs::read_to_string(device.join(file)).ok()?.trim(), 16).ok()
    };
    let ports = ports(root);
    let mut folders: Vec<PathBuf> = fs::read_dir(root.join("sys/bus/usb/devices"))
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| fs::canonicalize(entry.path()).ok())
        .collect();
    folders.sort();
    let device = |folder: PathBuf| {
        let port = ports.iter().find(|(way, _)| way.starts_with(&folder)).map(|(_, port)| port.clone());
        Some(UsbDevice { vendor: number(&folder, "idVendor")?, product: number(&folder, "idProduct")?, port })
    };
    folders.into_iter().filter_map(device).filter(|device| !is_hub_of_kernel(device)).collect()
}

/// The kernel's own root hubs hold all others.
fn is_hub_of_kernel(device: &UsbDevice) -> bool {
    device.vendor == 0x1d6b
}

/// The ways to serial ports of devices, and the ports' nodes.
fn ports(root: &Path) -> Vec<(PathBuf, String)> {
    let entries = fs::read_dir(root.join("sys/class/tty")).into_iter().flatten().flatten();
    let port = |entry: fs::DirEntry| {
        let way = fs::canonicalize(entry.path().join("device")).ok()?;
        Some((way, format!("/dev/{}", entry.file_name().to_str()?)))
    };
    entries.filter_map(port).collect()
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use tempfile::TempDir;

    use super::super::check::Finding;
    use super::*;

    fn write(root: &TempDir, path: &str, text: &str) {
        let path = root.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    /// A machine with an adapter on its USB, and a port if that is there; files of `/proc` and `/etc` besides.
    fn machine(ids: [&str; 2], port: Option<&str>, files: &[(&str, &str)]) -> TempDir {
        let root = tempfile::tempdir().unwrap();
        let device = "sys/devices/pci0/usb1/1-1";
        write(&root, &format!("{device}/idVendor"), &format!("{}\n", ids[0]));
        write(&root, &format!("{device}/idProduct"), &format!("{}\n", ids[1]));
        fs::create_dir_all(root.path().join("sys/bus/usb/devices")).unwrap();
        symlink(root.path().join(device), root.path().join("sys/bus/usb/devices/1-1")).unwrap();
        if let Some(port) = port {
            let interface = root.path().join(format!("{device}/1-1:1.0/{port}"));
            let class = root.path().join("sys/class/tty").join(port);
            fs::create_dir_all(&interface).unwrap();
            fs::create_dir_all(&class).unwrap();
            symlink(&interface, class.join("device")).unwrap();
        }
        for (path, text) in files {
            write(&root, path, text);
        }
        root
    }

    const MODEMS: (&str, &str) = ("proc/42/comm", "ModemManager\n");
    const CH340: [&str; 2] = ["1a86", "7523"];

    #[test]
    fn modem_manager_is_told_of_where_it_may_take_a_port() {
        let told = |files: &[(&str, &str)], port| check_modems(machine(CH340, port, files).path());
        assert_eq!(told(&[("proc/42/comm", "systemd\n")], Some("ttyUSB0")), []);
        assert_eq!(told(&[MODEMS], None), [], "nothing that it could take");
        let checks = told(&[MODEMS], Some("ttyUSB0"));
        assert!(checks[0].message.contains("/dev/ttyUSB0"), "{checks:?}");
        let mend = checks[0].mend.clone().unwrap();
        let rule = mend.split('\'').nth(1).unwrap();
        assert_eq!(
            told(&[MODEMS, ("etc/udev/rules.d/70-no-modems.rules", rule)], Some("ttyUSB0")),
            [],
            "{rule}"
        );
        let commented = format!("# {rule}");
        assert_eq!(
            told(&[MODEMS, ("etc/udev/rules.d/70-no-modems.rules", &commented)], Some("ttyUSB0")).len(),
            1
        );
    }

    #[test]
    fn our_own_rules_keep_modem_manager_off_our_pads() {
        let ours = ["1209", "0001"];
        let told = |files: &[(&str, &str)]| check_modems(machine(ours, Some("ttyACM0"), files).path());
        assert!(told(&[MODEMS])[0].mend.as_deref().unwrap().contains("--udev-rules"));
        let rules = include_str!("../../../../../docs/linux/70-tactpad.rules");
        assert_eq!(told(&[MODEMS, ("usr/lib/udev/rules.d/70-tactpad.rules", rules)]), []);
    }

    #[test]
    fn an_adapter_that_brltty_takes_is_told_of_and_one_that_it_leaves_is_not() {
        let rule =
            "ENV{PRODUCT}==\"1a86/7523/*\", ENV{BRLTTY_BRAILLE_DRIVER}=\"bm\", GOTO=\"brltty_usb_run\"\n";
        let file = "usr/lib/udev/rules.d/85-brltty.rules";
        let found = |ids, port, files: &[(&str, &str)]| {
            let checks = check_braille(machine(ids, port, files).path());
            checks.into_iter().map(|check| (check.finding, check.mend.unwrap())).collect::<Vec<_>>()
        };
        let gone = found(CH340, None, &[(file, rule)]);
        assert_eq!(gone[0].0, Finding::Bad);
        assert!(gone[0].1.contains("/etc/udev/rules.d/85-brltty.rules"), "{gone:?}");
        assert_eq!(found(CH340, Some("ttyUSB0"), &[(file, rule)])[0].0, Finding::Note);
        assert_eq!(found(["2341", "0043"], None, &[(file, rule)]), []);
        assert_eq!(found(CH340, None, &[(file, &format!("#{rule}"))]), []);
        assert_eq!(
            found(CH340, None, &[(file, rule), ("etc/udev/rules.d/85-brltty.rules", "")]),
            [],
            "as mended"
        );
    }
}
