//! Where a device hangs on the USB: the kernel's name of the socket, which stays the same whatever is plugged into it.

use std::fs;
use std::path::Path;

/// The kernel's name of the USB interface behind a serial port or a hidraw node, such as `1-1.2:1.0`: bus, ports from hub to hub,
/// configuration and interface. `None` for what is not on the USB.
pub(super) fn interface(node: &Path) -> Option<String> {
    let name = node.file_name()?;
    let device =
        |class: &str| fs::canonicalize(Path::new("/sys/class").join(class).join(name).join("device"));
    interface_in(&device("tty").or_else(|_| device("hidraw")).ok()?)
}

/// The last interface on the way to a device.
fn interface_in(device: &Path) -> Option<String> {
    let names = device.iter().filter_map(|name| name.to_str());
    names.rev().find(|name| is_interface(name)).map(str::to_owned)
}

fn is_interface(name: &str) -> bool {
    let is_numbers = |text: &str| text.split('.').all(|part| part.parse::<u8>().is_ok());
    let parts = name.split_once(':').and_then(|(port, interface)| Some((port.split_once('-')?, interface)));
    parts.is_some_and(|((bus, ports), interface)| {
        bus.parse::<u16>().is_ok() && is_numbers(ports) && is_numbers(interface)
    })
}

/// Whether the interface is the one that is named, or one of the device at the port that is named.
pub(super) fn is_at(interface: &str, named: &str) -> bool {
    interface == named || interface.split_once(':').is_some_and(|(port, _)| port == named)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_socket_is_read_from_the_way_to_a_device() {
        let host = "/sys/devices/pci0000:00/0000:00:14.0/usb1/1-1";
        for (way, expected) in [
            ("1-1.2/1-1.2:1.0/tty/ttyACM0", Some("1-1.2:1.0")),
            ("1-1:1.1/ttyUSB0", Some("1-1:1.1")),
            ("1-1.4/1-1.4:1.0/0003:1209:0001.0001", Some("1-1.4:1.0")),
            ("", None),
        ] {
            assert_eq!(interface_in(&Path::new(host).join(way)).as_deref(), expected, "{way}");
        }
        assert_eq!(interface_in(Path::new("/sys/devices/virtual/misc/uhid/0003:1209:0001.0001")), None);
        assert_eq!(interface(Path::new("/dev/null")), None);
    }

    #[test]
    fn a_port_means_all_that_is_plugged_in_there() {
        assert!(is_at("1-1.2:1.0", "1-1.2") && is_at("1-1.2:1.0", "1-1.2:1.0"));
        assert!(!is_at("1-1.2:1.0", "1-1") && !is_at("1-1.2:1.0", "1-1.2:1.1") && !is_at("1-1.2:1.0", ""));
    }
}
