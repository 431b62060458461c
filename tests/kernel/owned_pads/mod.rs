//! Pads that people own, on a real input stack: devices of software with the axes and ranges of such pads, and strokes of ours.

pub(crate) mod channels;
pub(crate) mod device;
pub(crate) mod grab;
pub(crate) mod histories;
pub(crate) mod playing;

use evdev::KeyCode;

use crate::bridge::TACTPAD;
use crate::clock::{MS, monotonic_ns, wait_until};
use crate::program::Running;
use crate::reader::{Reader, find};

/// How long a device, or a state of the bridge, may take to come.
const LIMIT_MS: u64 = 5_000;

pub(crate) fn pause(ms: u64) {
    wait_until(monotonic_ns() + ms * MS);
}

pub(crate) fn comes_true(what: &str, mut holds: impl FnMut() -> bool) {
    let limit_ns = monotonic_ns() + LIMIT_MS * MS;
    while !holds() {
        assert!(monotonic_ns() < limit_ns, "{what}: not within {LIMIT_MS} ms");
        pause(10);
    }
}

/// Starts the program on a device that fits; waits for its gamepad.
pub(crate) fn start(address: &str, more: &[&str]) -> (Running, Reader) {
    let arguments =
        [&["run", "--pad", address, "--profile", "super-mario", "--output", "uinput"], more].concat();
    let mut program = Running::start(TACTPAD, &arguments);
    comes_true("the bridge's gamepad", || {
        assert!(!program.has_ended(), "the bridge ended: {}", program.complaints());
        find(KeyCode::BTN_SOUTH).is_some()
    });
    let reader = Reader::open(&find(KeyCode::BTN_SOUTH).expect("it was there a moment ago"));
    // The first frames must have come.
    pause(200);
    (program, reader)
}

pub(crate) fn ask(request: &str) {
    let status = std::process::Command::new(TACTPAD).args(["ctl", request]).status();
    assert!(status.expect("ctl runs").success(), "{request}");
}

pub(crate) fn status() -> String {
    let output = std::process::Command::new(TACTPAD).args(["ctl", "status", "--json"]).output();
    String::from_utf8(output.expect("ctl runs").stdout).expect("text")
}

pub(crate) fn devices() -> String {
    let output = std::process::Command::new(TACTPAD).args(["devices", "--json"]).output();
    String::from_utf8(output.expect("devices runs").stdout).expect("text")
}
