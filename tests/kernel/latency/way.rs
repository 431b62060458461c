//! Ways from a cause to an event that can be read: what causes it, the program between, what a game reads.

use std::os::fd::AsFd;
use std::path::{Path, PathBuf};

use evdev::raw_stream::enumerate;
use evdev::uinput::VirtualDevice;
use evdev::{AttributeSet, BusType, EventType, InputEvent, InputId, KeyCode};

use super::report::{Cause, ECHO, OURS};
use crate::bridge::{Bridge, TACTPAD};
use crate::clock::{MS, monotonic_ns, readable_before, stamp_ns, wait_until};
use crate::owned_pads::comes_true;
use crate::owned_pads::device::{Device, SHAPES, node};
use crate::pad::{NONE, Pad, RIGHT, Touch};
use crate::program::{Running, path};
use crate::reader::{Reader, find_besides};

/// No smoothing and no minimum press: what is left is the way itself.
const PROFILE: &str = r#"
schema = 1
name = "latency"
output = "gamepad"
filter_samples = 1
min_press_ms = 0

[dpad]
mode = "4way"
"#;

/// The key of which programs make another one, and that.
const KEY: KeyCode = KeyCode::KEY_ESC;
const OTHER_KEY: KeyCode = KeyCode::KEY_CAPSLOCK;

/// Vendor and product of the keyboard.
pub(super) const KEYBOARD_ID: [u16; 2] = [0x1209, 2];

/// A pad that was kept from writing for so long may pass for silent, at 80 ms, by no fault of the bridge.
const STALL_MS: u64 = 40;

/// An edge that takes longer is lost.
const EDGE_LIMIT_MS: u64 = 500;

/// A program that has just begun may take so long for an edge, or not hear it yet.
const FIRST_EDGE_MS: u64 = 100;

/// One of those that are measured.
pub(super) struct Contender {
    pub(super) cause: Cause,
    pub(super) name: &'static str,
    make: Box<dyn Fn() -> Way>,
}

/// The bridge by both causes, and the least that there can be.
pub(super) fn ours_and_echoes() -> [Contender; 4] {
    [
        Contender::new(Cause::Frame, ECHO, Way::echo),
        Contender::new(Cause::Frame, OURS, Way::bridge),
        Contender::new(Cause::Event, ECHO, || Way::of_keys(start_echo)),
        Contender::new(Cause::Event, OURS, Way::bridge_of_a_touchpad),
    ]
}

impl Contender {
    pub(super) fn new(cause: Cause, name: &'static str, make: impl Fn() -> Way + 'static) -> Self {
        Self { cause, name, make: Box::new(make) }
    }

    /// Its way, once that of whoever had the turn before is gone.
    pub(super) fn start(&self) -> Way {
        comes_true("all devices are gone", || enumerate().next().is_none());
        (self.make)()
    }
}

/// What causes events.
enum Source {
    /// A pad's frames on a serial line.
    Wire(Pad),
    /// A keyboard's key.
    Keyboard(VirtualDevice),
    /// A touchpad that somebody owns.
    Touchpad(Device),
}

/// A cause, what makes events of it, and the device that they are of.
pub(super) struct Way {
    source: Source,
    reader: Reader,
    _program: Running,
    held: bool,
    /// How many events a frame makes that changes nothing.
    events_per_rest: usize,
}

/// The whole machine stood still for so long that what was measured means nothing.
#[derive(Debug)]
pub(super) struct Stalled;

impl Way {
    fn new(source: Source, program: Running, reader: Reader) -> Self {
        Self { source, reader, _program: program, held: false, events_per_rest: 0 }
    }

    /// The bridge, by frames.
    pub(super) fn bridge() -> Self {
        let Bridge { pad, program, reader } = Bridge::start(&profile(), KeyCode::BTN_SOUTH);
        Self::new(Source::Wire(pad), program, reader)
    }

    /// The bridge, by a touchpad that somebody owns.
    fn bridge_of_a_touchpad() -> Self {
        let device = Device::plug_in(SHAPES[2]);
        let arguments = ["run", "--pad", device.shape.source, "--profile", &profile(), "--output", "uinput"];
        let program = Running::start(TACTPAD, &arguments);
        let reader = reader_of(KeyCode::BTN_SOUTH, None);
        // The first frames must have come.
        wait_until(monotonic_ns() + FIRST_EDGE_MS * MS);
        Self::new(Source::Touchpad(device), program, reader)
    }

    /// An event for each frame.
    fn echo() -> Self {
        let pad = Pad::plug_in();
        let program = start_echo(pad.path());
        let reader = reader_of(OTHER_KEY, None);
        Self { events_per_rest: 1, ..Self::new(Source::Wire(pad), program, reader) }
    }

    /// What `start` starts on the node of a keyboard to make one key of another.
    pub(super) fn of_keys(start: impl FnOnce(&str) -> Running) -> Self {
        let (keyboard, node) = keyboard();
        let program = start(node.to_str().expect("an ASCII path"));
        let reader = reader_of(OTHER_KEY, Some(&node));
        let mut way = Self::new(Source::Keyboard(keyboard), program, reader);
        comes_true("the key does something", || {
            [true, false].into_iter().for_each(|held| {
                way.source.change(held);
            });
            readable_before(monotonic_ns() + FIRST_EDGE_MS * MS, way.reader.device.as_fd())
        });
        // Whatever else is on its way.
        while readable_before(monotonic_ns() + FIRST_EDGE_MS * MS, way.reader.device.as_fd()) {
            way.reader.read_available();
        }
        way.reader.seen.clear();
        way
    }

    /// Nothing changes for `rest_ns`, then one thing: how long that takes until it can be read, in ns.
    pub(super) fn edge(&mut self, rest_ns: u64) -> Result<u64, Stalled> {
        let rests = self.source.rest(self.held, rest_ns)?;
        let events = rests * self.events_per_rest;
        self.reader.read_until(EDGE_LIMIT_MS, |seen| seen.len() >= events);
        self.reader.read_available();
        self.source.check_running()?;
        assert_eq!(self.reader.seen.len(), events, "nothing changed: {:?}", self.reader.seen);
        self.reader.seen.clear();
        self.held = !self.held;
        let written_ns = self.source.change(self.held);
        let arrived = readable_before(written_ns + EDGE_LIMIT_MS * MS, self.reader.device.as_fd());
        let readable_ns = monotonic_ns();
        assert!(arrived, "an edge never came");
        self.reader.read_available();
        assert_eq!(self.reader.seen.len(), 1, "one cause, one event: {:?}", self.reader.seen);
        self.reader.seen.clear();
        Ok(readable_ns - written_ns)
    }
}

impl Source {
    /// Nothing changes for `rest_ns`. How many frames say so.
    fn rest(&mut self, held: bool, rest_ns: u64) -> Result<usize, Stalled> {
        self.check_running()?;
        let frames = if matches!(self, Self::Wire(_)) { rest_ns / MS } else { 0 };
        let mut next_ns = monotonic_ns() + rest_ns - frames * MS;
        wait_until(next_ns);
        if let Self::Wire(pad) = self {
            for _ in 0..frames {
                next_ns += MS;
                pad.stream_one(touch(held), next_ns);
            }
        }
        self.check_running()?;
        Ok(usize::try_from(frames).expect("a short rest"))
    }

    /// One change. When writing it began.
    fn change(&mut self, held: bool) -> u64 {
        match self {
            Self::Wire(pad) => {
                let frame = pad.next_frame(touch(held));
                let begun_ns = monotonic_ns();
                pad.write(&frame);
                begun_ns
            }
            Self::Keyboard(device) => {
                let begun_ns = monotonic_ns();
                let change = InputEvent::new(EventType::KEY.0, KEY.0, i32::from(held));
                device.emit(&[change]).expect("an event");
                begun_ns
            }
            Self::Touchpad(device) => {
                let begun_ns = monotonic_ns();
                if held {
                    device.touch(0.75, 0.5, 1.0);
                } else {
                    device.lift();
                }
                begun_ns
            }
        }
    }

    fn check_running(&self) -> Result<(), Stalled> {
        let Self::Wire(pad) = self else { return Ok(()) };
        let last_ns = pad.last_write_ns();
        if last_ns == 0 || stamp_ns() - last_ns < STALL_MS * MS { Ok(()) } else { Err(Stalled) }
    }
}

const fn touch(held: bool) -> Touch {
    if held { RIGHT } else { NONE }
}

/// The path of a file with the profile.
fn profile() -> String {
    let profile = std::env::temp_dir().join("latency.toml");
    std::fs::write(&profile, PROFILE).expect("a profile");
    profile.to_str().expect("an ASCII path").to_owned()
}

/// A reader of the device that comes and has `key`, and is not the one at `besides`.
fn reader_of(key: KeyCode, besides: Option<&Path>) -> Reader {
    comes_true("the program's device", || find_besides(key, besides).is_some());
    Reader::open(&find_besides(key, besides).expect("it was there a moment ago"))
}

fn start_echo(path_of_cause: &str) -> Running {
    Running::start(path("echo"), &[path_of_cause])
}

/// A keyboard and its node.
fn keyboard() -> (VirtualDevice, PathBuf) {
    let keys: AttributeSet<KeyCode> = (1..=KeyCode::KEY_COMPOSE.0).map(KeyCode).collect();
    let built = || {
        let builder = VirtualDevice::builder()?.name("Test keyboard");
        let [vendor, product] = KEYBOARD_ID;
        builder.input_id(InputId::new(BusType::BUS_USB, vendor, product, 1)).with_keys(&keys)?.build()
    };
    let mut device = built().expect("a device by uinput");
    let node = node(&mut device);
    (device, node)
}
