//! A HID pad made with uhid: the kernel takes it for a USB device.

use std::fs::{self, read_dir};
use std::path::Path;

use evdev::KeyCode;
use firmware_proto::command::Command;
use firmware_proto::frame::Message;
use firmware_proto::hid;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::sample::{Sample, Status};

use crate::bridge::TACTPAD;
use crate::clock::{MS, monotonic_ns, readable_before, stamp_ns, wait_until};
use crate::joystick::Joystick;
use crate::pad::{NONE, PRESS, PRESS_RIGHT, RIGHT, Touch, period_ns};
use crate::program::Running;
use crate::reader::{Reader, find};
use crate::sdl;
use crate::uhid::{Bus, Told, Uhid};

/// How long the kernel may take to make a device.
const DEVICE_LIMIT_MS: u64 = 5_000;

/// A pad without noise, 0.01 µV per count, that answers the question who it is.
pub(crate) struct HidPad {
    uhid: Uhid,
    serial_number: String,
    sequence: u32,
    started_ns: u64,
}

impl HidPad {
    /// Plugs a pad in.
    pub(crate) fn plug_in(serial_number: &str) -> Self {
        let uhid = Uhid::plug_in(&Told {
            name: "tactpad test pad",
            serial_number,
            bus: Bus::Usb,
            vendor: hid::VENDOR_ID,
            product: hid::PRODUCT_ID,
            descriptor: hid::REPORT_DESCRIPTOR,
        });
        let pad = Self { uhid, serial_number: serial_number.into(), sequence: 0, started_ns: monotonic_ns() };
        pad.wait_until_known();
        pad
    }

    /// Waits until the system has its device: the kernel makes that on a thread of its own.
    fn wait_until_known(&self) {
        let limit_ns = monotonic_ns() + DEVICE_LIMIT_MS * MS;
        while !self.is_known() {
            assert!(monotonic_ns() < limit_ns, "the kernel makes no device of {}", self.serial_number);
            wait_until(monotonic_ns() + MS);
        }
    }

    fn is_known(&self) -> bool {
        let serial_number = format!("HID_UNIQ={}", self.serial_number);
        read_dir("/sys/class/hidraw").is_ok_and(|nodes| {
            nodes.flatten().any(|node| {
                let told = fs::read_to_string(node.path().join("device/uevent")).unwrap_or_default();
                told.lines().any(|line| line == serial_number)
                    && Path::new("/dev").join(node.file_name()).exists()
            })
        })
    }

    /// Pulls the plug; returns the stamp of that moment.
    pub(crate) fn unplug(self) -> u64 {
        let stamp = stamp_ns();
        self.uhid.unplug();
        stamp
    }

    /// Reports `touch` for `for_ms` milliseconds, as often as [`period_ns`] says, and answers the bridge.
    pub(crate) fn hold(&mut self, touch: Touch, for_ms: u64) {
        let (start_ns, period_ns) = (monotonic_ns(), period_ns());
        for report in 1..=for_ms * MS / period_ns {
            self.report_one(touch);
            self.answer_until(start_ns + report * period_ns);
        }
    }

    /// Reports `touch` until `done` says so.
    fn hold_until(&mut self, what: &str, touch: Touch, limit_ms: u64, mut done: impl FnMut() -> bool) {
        let limit_ns = monotonic_ns() + limit_ms * MS;
        while !done() {
            assert!(monotonic_ns() < limit_ns, "{what}: not within {limit_ms} ms");
            self.hold(touch, 10);
        }
    }

    fn report_one(&mut self, touch: Touch) {
        let status = if self.sequence == 0 { Status::OK.with_restarted() } else { Status::OK };
        self.sequence += 1;
        let time_us = (monotonic_ns() - self.started_ns) / 1_000;
        let counts = touch.counts();
        let sample = Sample { sequence: self.sequence, time_us, counts, temperature_centi_c: 2_100, status };
        self.send(&Message::Sample(sample));
    }

    fn send(&mut self, message: &Message) {
        self.uhid.report(&hid::encode_message(message));
    }

    fn answer_until(&mut self, until_ns: u64) {
        while readable_before(until_ns, self.uhid.fd()) {
            let command = self.uhid.hear().map(|report| hid::decode_command(&report));
            if command == Some(Ok(Command::Identify)) {
                let identity = Identity {
                    serial_number: SerialNumber::from_ascii(&self.serial_number).expect("a short name"),
                    channels: 9,
                    count_bits: 24,
                    rate_hz: u16::try_from(1_000 * MS / period_ns()).expect("at most a thousand"),
                    picovolts_per_count: 10_000,
                };
                self.send(&Message::Identity(identity));
            }
        }
    }
}

/// The bridge on whatever pad is attached, and a game's view of its gamepad.
struct Played {
    program: Running,
    reader: Reader,
}

fn start(address: &str, pad: &mut HidPad) -> Played {
    let arguments = ["run", "--pad", address, "--profile", "super-mario", "--output", "uinput"];
    let mut program = Running::start(TACTPAD, &arguments);
    pad.hold_until("the bridge's gamepad", NONE, 5_000, || {
        assert!(!program.has_ended(), "the bridge ended");
        find(KeyCode::BTN_SOUTH).is_some()
    });
    let reader = Reader::open(&find(KeyCode::BTN_SOUTH).expect("it was there a moment ago"));
    Played { program, reader }
}

fn status() -> String {
    let output = std::process::Command::new(TACTPAD).args(["ctl", "status", "--json"]).output();
    String::from_utf8(output.expect("ctl runs").stdout).expect("text")
}

/// A HID pad is found, identified, and plays; a game sees it as an event device and as a joystick.
pub(crate) fn plays() {
    let mut pad = HidPad::plug_in("HID-7");
    let listed =
        std::process::Command::new(TACTPAD).args(["devices", "--json"]).output().expect("devices runs");
    let listed = String::from_utf8(listed.stdout).expect("text");
    assert!(listed.contains("hid:1209:0001:HID-7"), "{listed}");
    let mut played = start("auto", &mut pad);
    let mut joystick = Joystick::beside(&find(KeyCode::BTN_SOUTH).expect("the gamepad"));
    pad.hold(NONE, 600);
    for touch in [RIGHT, NONE, PRESS, NONE] {
        pad.hold(touch, 150);
    }
    played.reader.read_available();
    let edges = [("ABS_HAT0X", 1), ("ABS_HAT0X", 0), ("BTN_SOUTH", 1), ("BTN_SOUTH", 0)];
    println!("events: {:?}", played.reader.seen);
    assert_eq!(played.reader.edges(), edges);
    let as_joystick = [("A6", i16::MAX), ("A6", 0), ("B0", 1), ("B0", 0)];
    assert_eq!(joystick.changes(), as_joystick.map(|(name, value)| (name.to_owned(), value)));
    assert!(status().contains(r#""pad":"HID-7""#), "{}", status());
}

/// A HID pad plays a game that asks SDL.
pub(crate) fn seen_by_sdl() {
    let mut pad = HidPad::plug_in("HID-S");
    let _played = start("auto", &mut pad);
    sdl::check(|touch, for_ms| pad.hold(touch, for_ms));
}

/// With two pads the serial number chooses; without it the bridge does not guess.
pub(crate) fn chosen_by_serial_number() {
    let mut other = HidPad::plug_in("HID-A");
    let mut pad = HidPad::plug_in("HID-B");
    let guess =
        std::process::Command::new(TACTPAD).args(["run", "--output", "none"]).output().expect("it runs");
    let told = String::from_utf8_lossy(&guess.stderr).into_owned();
    assert_eq!(guess.status.code(), Some(2), "{told}");
    assert!(told.contains("HID-A") && told.contains("HID-B") && told.contains("auto:SERIAL"), "{told}");
    let mut played = start("auto:HID-B", &mut pad);
    pad.hold(NONE, 600);
    other.hold(PRESS, 100);
    pad.hold(RIGHT, 150);
    pad.hold(NONE, 150);
    played.reader.read_available();
    assert_eq!(played.reader.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)]);
}

/// Rounds of plugging in, pressing and pulling out: 4, or as many as `TACTPAD_REPLUG_ROUNDS` says.
pub(crate) fn replugged() {
    let rounds: u32 =
        std::env::var("TACTPAD_REPLUG_ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(4);
    let mut pad = HidPad::plug_in("HID-R");
    let mut played = start("auto", &mut pad);
    for round in 0..rounds {
        played.reader.seen.clear();
        let reader = &mut played.reader;
        // Found within 250 ms, tared within 400 ms. Nothing is asked meanwhile: the pad must not fall silent.
        pad.hold(NONE, 1_200);
        pad.hold(PRESS_RIGHT, 600);
        reader.read_available();
        assert_eq!(reader.edges(), [("ABS_HAT0X", 1), ("BTN_EAST", 1)], "round {round}");
        reader.seen.clear();
        let unplugged_ns = pad.unplug();
        wait_until(monotonic_ns() + 200 * MS);
        reader.read_available();
        let mut released = reader.edges();
        released.sort_unstable();
        assert_eq!(released, [("ABS_HAT0X", 0), ("BTN_EAST", 0)], "round {round}");
        let last_ns = reader.seen.iter().map(|change| change.at_ns).max().unwrap_or(u64::MAX);
        assert!(last_ns.saturating_sub(unplugged_ns) <= 200 * MS, "round {round}: too late");
        assert!(!played.program.has_ended(), "round {round}: the bridge ended");
        pad = HidPad::plug_in("HID-R");
    }
    println!("{rounds} rounds, nothing held 200 ms after any");
}
