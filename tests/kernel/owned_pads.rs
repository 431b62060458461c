//! Pads that people own, on a real input stack: devices of software with the axes and ranges of such pads, and strokes of ours.

use std::path::PathBuf;

use evdev::raw_stream::RawDevice;
use evdev::uinput::VirtualDevice;
use evdev::{
    AbsInfo, AbsoluteAxisCode, AttributeSet, BusType, EventType, InputEvent, InputId, KeyCode, PropType,
    UinputAbsSetup,
};
use rustix::process::Signal;

use crate::bridge::TACTPAD;
use crate::clock::{MS, monotonic_ns, wait_until};
use crate::program::Running;
use crate::reader::{Reader, find};

/// How long a device, or a state of the bridge, may take to come.
const LIMIT_MS: u64 = 5_000;

const MT: [AbsoluteAxisCode; 3] = [
    AbsoluteAxisCode::ABS_MT_POSITION_X,
    AbsoluteAxisCode::ABS_MT_POSITION_Y,
    AbsoluteAxisCode::ABS_MT_PRESSURE,
];
const PEN: [AbsoluteAxisCode; 3] =
    [AbsoluteAxisCode::ABS_X, AbsoluteAxisCode::ABS_Y, AbsoluteAxisCode::ABS_PRESSURE];

/// What a device tells of itself.
#[derive(Clone, Copy)]
struct Shape {
    name: &'static str,
    /// The description that must fit.
    source: &'static str,
    /// Minimum, maximum and resolution of x, y and the pressure.
    ranges: [(i32, i32, i32); 3],
    /// The pressure that is 1 N for a profile.
    one_n: i32,
}

/// Axes as such devices have them: two tablets, two touchpads, one of which says what its numbers weigh, and a trackpad.
const SHAPES: [Shape; 5] = [
    Shape {
        name: "Tablet 250 mm Pen",
        source: "tablet",
        ranges: [(0, 40_000, 157), (0, 25_000, 157), (0, 8_191, 0)],
        one_n: 1_311,
    },
    Shape {
        name: "Tablet 224 mm Pen",
        source: "tablet",
        ranges: [(0, 44_704, 200), (0, 27_940, 200), (0, 2_047, 0)],
        one_n: 328,
    },
    Shape {
        name: "Touchpad",
        source: "touchpad",
        ranges: [(1_024, 5_112, 42), (2_024, 4_832, 42), (0, 255, 0)],
        one_n: 31,
    },
    Shape {
        name: "Haptic Touchpad",
        source: "touchpad",
        ranges: [(0, 1_416, 12), (0, 888, 12), (0, 4_096, 10)],
        one_n: 612,
    },
    Shape {
        name: "Magic Trackpad",
        source: "magic-trackpad",
        ranges: [(-3_678, 3_934, 48), (-2_478, 2_587, 45), (0, 253, 0)],
        one_n: 30,
    },
];

/// A device of software.
struct Device {
    shape: Shape,
    device: VirtualDevice,
    node: PathBuf,
    tracking_id: i32,
}

impl Device {
    fn plug_in(shape: Shape) -> Self {
        let is_pen = shape.source == "tablet";
        let axes = if is_pen { PEN } else { MT };
        let mut keys = AttributeSet::<KeyCode>::new();
        keys.insert(KeyCode::BTN_TOUCH);
        keys.insert(if is_pen { KeyCode::BTN_TOOL_PEN } else { KeyCode::BTN_TOOL_FINGER });
        keys.insert(if is_pen { KeyCode::BTN_STYLUS } else { KeyCode::BTN_LEFT });
        let mut properties = AttributeSet::<PropType>::new();
        properties.insert(PropType::POINTER);
        let built = || {
            let mut builder = VirtualDevice::builder()?
                .name(shape.name)
                .input_id(InputId::new(BusType::BUS_USB, 0x1234, 0x5678, 1))
                .with_keys(&keys)?
                .with_properties(&properties)?;
            for (axis, (minimum, maximum, resolution)) in axes.into_iter().zip(shape.ranges) {
                let info = AbsInfo::new(0, minimum, maximum, 0, 0, resolution);
                builder = builder.with_absolute_axis(&UinputAbsSetup::new(axis, info))?;
            }
            if !is_pen {
                for (axis, maximum) in
                    [(AbsoluteAxisCode::ABS_MT_SLOT, 4), (AbsoluteAxisCode::ABS_MT_TRACKING_ID, 65_535)]
                {
                    let info = AbsInfo::new(0, 0, maximum, 0, 0, 0);
                    builder = builder.with_absolute_axis(&UinputAbsSetup::new(axis, info))?;
                }
            }
            builder.build()
        };
        let mut device = built().expect("a device by uinput");
        let mut nodes = device.enumerate_dev_nodes_blocking().expect("its nodes");
        let is_event = |path: &PathBuf| path.to_string_lossy().contains("/event");
        let node = nodes.find_map(|node| node.ok().filter(is_event)).expect("its event node");
        drop(nodes);
        Self { shape, device, node, tracking_id: 0 }
    }

    fn is_pen(&self) -> bool {
        self.shape.source == "tablet"
    }

    fn emit(&mut self, changes: &[(EventType, u16, i32)]) {
        let events: Vec<InputEvent> =
            changes.iter().map(|(kind, code, value)| InputEvent::new(kind.0, *code, *value)).collect();
        self.device.emit(&events).expect("events");
    }

    /// Something touches it at shares of its width and height, with a force for the profile in N.
    fn touch(&mut self, x_share: f64, y_share: f64, fz_n: f64) {
        let axes = if self.is_pen() { PEN } else { MT };
        let at = |k: usize, share: f64| {
            let (minimum, maximum, _) = self.shape.ranges[k];
            f64::from(minimum) + share * (f64::from(maximum) - f64::from(minimum))
        };
        let values = [at(0, x_share), at(1, y_share), fz_n * f64::from(self.shape.one_n)];
        let mut changes: Vec<_> = axes
            .iter()
            .zip(values)
            .map(|(axis, value)| (EventType::ABSOLUTE, axis.0, value as i32))
            .collect();
        if self.is_pen() {
            changes.insert(0, (EventType::KEY, KeyCode::BTN_TOOL_PEN.0, 1));
        } else {
            self.tracking_id += 1;
            changes
                .insert(0, (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_MT_TRACKING_ID.0, self.tracking_id));
        }
        changes.push((EventType::KEY, KeyCode::BTN_TOUCH.0, 1));
        self.emit(&changes);
    }

    fn hover(&mut self, x_share: f64) {
        let (minimum, maximum, _) = self.shape.ranges[0];
        let x = f64::from(minimum) + x_share * f64::from(maximum - minimum);
        self.emit(&[
            (EventType::KEY, KeyCode::BTN_TOOL_PEN.0, 1),
            (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_X.0, x as i32),
        ]);
    }

    /// A pen leaves the range.
    fn leave(&mut self) {
        self.emit(&[(EventType::KEY, KeyCode::BTN_TOOL_PEN.0, 0)]);
    }

    fn lift(&mut self) {
        if self.is_pen() {
            let pressure = AbsoluteAxisCode::ABS_PRESSURE.0;
            self.emit(&[(EventType::ABSOLUTE, pressure, 0), (EventType::KEY, KeyCode::BTN_TOUCH.0, 0)]);
        } else {
            let id = AbsoluteAxisCode::ABS_MT_TRACKING_ID.0;
            self.emit(&[(EventType::ABSOLUTE, id, -1), (EventType::KEY, KeyCode::BTN_TOUCH.0, 0)]);
        }
    }
}

fn pause(ms: u64) {
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

/// Each shape is recognised, strokes give the events that they mean, and a still finger gives the long press when it is due.
pub(crate) fn strokes() {
    for shape in SHAPES {
        let mut device = Device::plug_in(shape);
        let listed = devices();
        assert!(listed.contains(&format!("\"source\":\"{}\"", shape.source)), "{}: {listed}", shape.name);
        let (program, mut reader) = start(shape.source, &[]);
        if device.is_pen() {
            device.hover(0.9);
            pause(100);
        }
        device.touch(0.75, 0.5, 1.0);
        pause(150);
        device.lift();
        pause(150);
        device.touch(0.5, 0.1, 1.0);
        pause(150);
        device.lift();
        pause(150);
        reader.read_available();
        let right_and_up = [("ABS_HAT0X", 1), ("ABS_HAT0X", 0), ("ABS_HAT0Y", -1), ("ABS_HAT0Y", 0)];
        assert_eq!(reader.edges(), right_and_up, "{}", shape.name);
        reader.seen.clear();
        device.touch(0.5, 0.5, 3.0);
        pause(120);
        device.lift();
        pause(200);
        reader.read_available();
        assert_eq!(reader.edges(), [("BTN_SOUTH", 1), ("BTN_SOUTH", 0)], "{}", shape.name);
        reader.seen.clear();
        // The device says nothing for two seconds.
        let begin_ns = crate::clock::stamp_ns();
        device.touch(0.5, 0.5, 3.0);
        pause(2_000);
        device.lift();
        pause(200);
        reader.read_available();
        assert_eq!(reader.edges(), [("BTN_EAST", 1), ("BTN_EAST", 0)], "{}", shape.name);
        let [down_ms, up_ms] = [0, 1].map(|k| (reader.seen[k].at_ns - begin_ns) / MS);
        assert!(
            (400..=415).contains(&down_ms) && (2_000..=2_015).contains(&up_ms),
            "{}: {down_ms} {up_ms}",
            shape.name
        );
        println!("{}: long press after {down_ms} ms, let go after {} ms", shape.name, up_ms - 2_000);
        drop(program);
        comes_true("the gamepad goes", || find(KeyCode::BTN_SOUTH).is_none());
    }
}

/// A device that is played with moves no pointer, but while it is paused, and once the bridge is gone however it went.
pub(crate) fn grabbed() {
    let mut device = Device::plug_in(SHAPES[0]);
    let mut desktop = Reader::open(&device.node);
    let mut moves = |device: &mut Device, what: &str, is_heard: bool| {
        desktop.seen.clear();
        device.touch(0.3, 0.4, 0.1);
        device.lift();
        device.leave();
        pause(20);
        desktop.read_available();
        assert_eq!(!desktop.seen.is_empty(), is_heard, "{what}: {:?}", desktop.seen);
    };
    moves(&mut device, "before", true);
    let (program, _gamepad) = start("tablet", &[]);
    moves(&mut device, "while it plays", false);
    ask("pause");
    pause(100);
    moves(&mut device, "while it is paused", true);
    ask("resume");
    pause(100);
    moves(&mut device, "when it goes on", false);
    program.signal(Signal::TSTP);
    pause(100);
    moves(&mut device, "while it is stopped", true);
    program.signal(Signal::CONT);
    pause(200);
    moves(&mut device, "once it is continued", false);
    program.signal(Signal::KILL);
    pause(100);
    moves(&mut device, "after a kill", true);
    drop(program);
    comes_true("the gamepad goes", || find(KeyCode::BTN_SOUTH).is_none());
    let (_program, _gamepad) = start("tablet", &["--no-grab"]);
    moves(&mut device, "with --no-grab", true);
}

/// Whatever is lifted while the bridge is stopped, and more is reported than the kernel keeps, is not held after it goes on; the next
/// touch plays.
pub(crate) fn overflowed() {
    for shape in SHAPES {
        let mut device = Device::plug_in(shape);
        let (program, mut reader) = start(shape.source, &[]);
        // The lift comes before the queue is full, then when it is full, then last.
        for (at, y_share, fz_n) in [(0, 0.45, 1.0), (150, 0.5, 1.1), (299, 0.55, 1.2)] {
            reader.seen.clear();
            // What is as it was, the kernel does not say again.
            device.touch(0.9, y_share, fz_n);
            pause(150);
            program.signal(Signal::STOP);
            pause(20);
            for k in 0..300 {
                if k == at {
                    device.lift();
                }
                let (x, axis) = (0.69 + f64::from(k) * 1e-3, if device.is_pen() { PEN[0] } else { MT[0] });
                let (minimum, maximum, _) = shape.ranges[0];
                let x = f64::from(minimum) + x * f64::from(maximum - minimum);
                device.emit(&[(EventType::ABSOLUTE, axis.0, x as i32)]);
            }
            program.signal(Signal::CONT);
            pause(200);
            reader.read_available();
            let edges = [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)];
            assert_eq!(reader.edges(), edges, "{}: {at}: {}", shape.name, program.complaints());
            pause(500);
            reader.read_available();
            assert_eq!(reader.seen.len(), 2, "{}: {at}: {:?}", shape.name, reader.seen);
        }
        drop(program);
        comes_true("the gamepad goes", || find(KeyCode::BTN_SOUTH).is_none());
    }
}

/// A lift that another program got ends the contact, and a device that another program took is no pad until it is given back.
pub(crate) fn taken() {
    let mut device = Device::plug_in(SHAPES[0]);
    let (program, mut reader) = start("tablet", &["--no-grab"]);
    device.touch(0.9, 0.5, 1.0);
    pause(150);
    let mut other = RawDevice::open(&device.node).expect("the device");
    other.grab().expect("it is free");
    device.lift();
    pause(300);
    reader.read_available();
    assert_eq!(reader.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)], "without a grab");
    other.ungrab().expect("it is given back");
    device.leave();
    drop(program);
    comes_true("the gamepad goes", || find(KeyCode::BTN_SOUTH).is_none());
    let (mut program, mut reader) = start("tablet", &[]);
    ask("pause");
    pause(100);
    other.grab().expect("it is free while it is paused");
    ask("resume");
    comes_true("the pad is denied", || status().contains("denied"));
    other.ungrab().expect("it is given back");
    comes_true("the pad is back", || !status().contains("denied"));
    pause(600);
    device.touch(0.9, 0.5, 1.0);
    pause(150);
    device.lift();
    pause(150);
    reader.read_available();
    assert_eq!(reader.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)], "once it is given back");
    assert!(!program.has_ended());
}

/// What is down when the bridge comes is let go for the desktop, too; then the device is taken from it.
pub(crate) fn down_at_the_start() {
    let mut device = Device::plug_in(SHAPES[0]);
    let mut desktop = Reader::open(&device.node);
    device.touch(0.3, 0.4, 0.1);
    let (_program, mut gamepad) = start("tablet", &[]);
    device.lift();
    device.leave();
    pause(100);
    desktop.read_available();
    assert!(desktop.stamp_of("BTN_TOUCH", 0).is_some(), "{:?}", desktop.seen);
    desktop.seen.clear();
    device.touch(0.9, 0.5, 1.0);
    pause(150);
    // A pause in the middle of a touch.
    ask("pause");
    pause(100);
    ask("resume");
    pause(100);
    device.lift();
    device.leave();
    pause(100);
    device.touch(0.1, 0.5, 1.0);
    pause(150);
    device.lift();
    pause(150);
    desktop.read_available();
    gamepad.read_available();
    let names: Vec<_> = desktop.edges().into_iter().filter(|(name, _)| name.starts_with("BTN")).collect();
    assert!(names.iter().all(|(_, value)| *value == 0), "the desktop gets no press: {names:?}");
    // The pause lets go, and what still touches presses again.
    let wanted = [1, 0, 1, 0, -1, 0].map(|value| ("ABS_HAT0X", value));
    assert_eq!(gamepad.edges(), wanted);
}

/// A device that leaves lets go within 200 ms, and plays on when it comes back.
pub(crate) fn replugged() {
    let mut device = Device::plug_in(SHAPES[0]);
    let (mut program, mut reader) = start("tablet", &[]);
    for round in 0..3 {
        reader.seen.clear();
        device.touch(0.8, 0.5, 1.0);
        pause(100);
        let unplugged_ns = crate::clock::stamp_ns();
        drop(device);
        pause(200);
        reader.read_available();
        assert_eq!(reader.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)], "round {round}");
        let let_go_ns = reader.seen[1].at_ns as i64 - unplugged_ns as i64;
        // Stamps have whole microseconds.
        assert!((-1_000..200 * MS as i64).contains(&let_go_ns), "round {round}: let go after {let_go_ns} ns");
        assert!(!program.has_ended(), "round {round}: the bridge ended");
        device = Device::plug_in(SHAPES[0]);
        // It is looked for four times a second.
        pause(600);
    }
}

/// A device that comes back at another node plays on, and a stranger's that has its old node is left alone.
pub(crate) fn moved() {
    let device = Device::plug_in(SHAPES[0]);
    let old_node = device.node.clone();
    let (mut program, mut reader) = start(&format!("tablet:{}", old_node.display()), &[]);
    drop(device);
    pause(200);
    let mut stranger = Device::plug_in(SHAPES[1]);
    assert_eq!(stranger.node, old_node);
    pause(600);
    let mut device = Device::plug_in(SHAPES[0]);
    assert_ne!(device.node, old_node);
    pause(800);
    stranger.touch(0.1, 0.5, 1.0);
    pause(150);
    device.touch(0.9, 0.5, 1.0);
    pause(150);
    device.lift();
    stranger.lift();
    pause(150);
    reader.read_available();
    assert_eq!(reader.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)], "{}", program.complaints());
    assert!(!program.has_ended());
}

/// A board of four cells that the system reports as axes: it is leaned on in four directions, and stamped on.
pub(crate) fn board() {
    let axes = [
        (AbsoluteAxisCode::ABS_HAT1X, [-216.5, 119.0]),
        (AbsoluteAxisCode::ABS_HAT0X, [216.5, 119.0]),
        (AbsoluteAxisCode::ABS_HAT1Y, [-216.5, -119.0]),
        (AbsoluteAxisCode::ABS_HAT0Y, [216.5, -119.0]),
    ];
    let mut keys = AttributeSet::<KeyCode>::new();
    // As the driver has it; its own button, which is no gamepad's here.
    keys.insert(KeyCode::BTN_1);
    let built = || {
        let mut builder =
            VirtualDevice::builder()?.name("Nintendo Wii Remote Balance Board").with_keys(&keys)?;
        for (axis, _) in axes {
            let info = AbsInfo::new(0, 0, 65_535, 2, 4, 0);
            builder = builder.with_absolute_axis(&UinputAbsSetup::new(axis, info))?;
        }
        builder.build()
    };
    let mut device = built().expect("a device by uinput");
    // A force in N at shares of the board's half width and height.
    let mut load = |fz_n: f64, x: f64, y: f64| {
        let events: Vec<InputEvent> = axes
            .iter()
            .map(|(axis, [cell_x, cell_y])| {
                let share = (1.0 + x * f64::signum(*cell_x) + y * f64::signum(*cell_y)) / 4.0;
                let counts = (share * fz_n / 0.098_066_5).max(0.0) as i32;
                InputEvent::new(EventType::ABSOLUTE.0, axis.0, counts)
            })
            .collect();
        device.emit(&events).expect("events");
    };
    let (_program, mut reader) = start("balance-board", &[]);
    // Its zero is measured.
    pause(600);
    for (x, y, wanted) in [
        (0.5, 0.0, ("ABS_HAT0X", 1)),
        (-0.5, 0.0, ("ABS_HAT0X", -1)),
        (0.0, 0.5, ("ABS_HAT0Y", -1)),
        (0.0, -0.5, ("ABS_HAT0Y", 1)),
    ] {
        reader.seen.clear();
        load(50.0, x, y);
        pause(200);
        load(0.0, 0.0, 0.0);
        pause(200);
        reader.read_available();
        assert_eq!(reader.edges(), [wanted, (wanted.0, 0)], "{x} {y}");
    }
    reader.seen.clear();
    load(150.0, 0.0, 0.0);
    pause(150);
    load(0.0, 0.0, 0.0);
    pause(300);
    reader.read_available();
    assert_eq!(reader.edges(), [("BTN_SOUTH", 1), ("BTN_SOUTH", 0)], "a stamp");
    // It stalls under a load: the direction is let go, and plays again when it is back.
    reader.seen.clear();
    load(50.0, 0.5, 0.0);
    pause(2_000);
    reader.read_available();
    assert_eq!(reader.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)], "a stall");
    let held_ms = (reader.seen[1].at_ns - reader.seen[0].at_ns) / MS;
    assert!((900..1_200).contains(&held_ms), "held {held_ms} ms");
    println!("a board that stalls lets go after {held_ms} ms");
    load(0.0, 0.0, 0.0);
    pause(600);
    reader.seen.clear();
    load(50.0, -0.5, 0.0);
    pause(200);
    load(0.0, 0.0, 0.0);
    pause(200);
    reader.read_available();
    assert_eq!(reader.edges(), [("ABS_HAT0X", -1), ("ABS_HAT0X", 0)], "after a stall");
}

/// What a pen did is recorded as frames, and replays to the same events, the long press of a still pen among them.
pub(crate) fn recorded() {
    let mut device = Device::plug_in(SHAPES[1]);
    let folder = tempfile::tempdir().expect("a folder");
    let record = ["record", "pen.cap", "--pad", "tablet", "--output", "log:live", "--seconds", "4"];
    let mut program =
        Running::start_command(std::process::Command::new(TACTPAD).args(record).current_dir(folder.path()));
    let capture = folder.path().join("pen.cap");
    comes_true("the capture", || capture.metadata().is_ok_and(|file| file.len() > 0));
    pause(300);
    for (x_share, fz_n, ms) in [(0.8, 1.0, 150), (0.5, 3.0, 120), (0.2, 3.0, 1_000)] {
        device.touch(x_share, 0.5, fz_n);
        pause(ms);
        device.lift();
        pause(200);
    }
    assert!(program.wait(LIMIT_MS).success(), "{}", program.complaints());
    let live = std::fs::read_to_string(folder.path().join("live")).expect("a log");
    let replayed =
        std::process::Command::new(TACTPAD).args(["replay", "pen.cap"]).current_dir(folder.path()).output();
    let replayed = String::from_utf8(replayed.expect("replay runs").stdout).expect("text");
    assert!(live.contains("BTN_EAST") && live.contains("BTN_SOUTH") && live.lines().count() >= 8, "{live}");
    assert_eq!(replayed, live);
}

/// A cap of six axes: pressed at sides, pushed away, and pressed alone.
pub(crate) fn six_axes() {
    let axes = [
        AbsoluteAxisCode::ABS_X,
        AbsoluteAxisCode::ABS_Y,
        AbsoluteAxisCode::ABS_Z,
        AbsoluteAxisCode::ABS_RX,
        AbsoluteAxisCode::ABS_RY,
        AbsoluteAxisCode::ABS_RZ,
    ];
    let mut keys = AttributeSet::<KeyCode>::new();
    keys.insert(KeyCode::BTN_1);
    let built = || {
        let mut builder =
            VirtualDevice::builder()?.name("3Dconnexion SpaceMouse Compact").with_keys(&keys)?;
        for axis in axes {
            builder = builder
                .with_absolute_axis(&UinputAbsSetup::new(axis, AbsInfo::new(0, -350, 350, 0, 0, 0)))?;
        }
        builder.build()
    };
    let mut device = built().expect("a device by uinput");
    let mut push = |counts: [i32; 6]| {
        let event =
            |(axis, count): (AbsoluteAxisCode, i32)| InputEvent::new(EventType::ABSOLUTE.0, axis.0, count);
        let events: Vec<InputEvent> = axes.into_iter().zip(counts).map(event).collect();
        device.emit(&events).expect("events");
        pause(200);
    };
    let arguments = ["run", "--pad", "spacemouse", "--profile", "contra", "--output", "uinput"];
    let program = Running::start(TACTPAD, &arguments);
    comes_true("the bridge's gamepad", || find(KeyCode::BTN_SOUTH).is_some());
    let mut reader = Reader::open(&find(KeyCode::BTN_SOUTH).expect("it was there a moment ago"));
    pause(800);
    // Down is +z; a tilt to the right turns about the axis away from oneself, which the device counts the other way.
    for (counts, wanted) in [
        ([0, 0, 60, 0, -60, 0], ("ABS_HAT0X", 1)),
        ([0, 0, 60, 0, 60, 0], ("ABS_HAT0X", -1)),
        ([0, 0, 60, -60, 0, 0], ("ABS_HAT0Y", -1)),
        ([0, 0, 60, 60, 0, 0], ("ABS_HAT0Y", 1)),
        ([0, 0, 150, 0, 0, 0], ("BTN_SOUTH", 1)),
        // Away from oneself is -y.
        ([0, -90, 60, 0, 0, 0], ("BTN_EAST", 1)),
    ] {
        reader.seen.clear();
        push(counts);
        push([0; 6]);
        reader.read_available();
        assert_eq!(reader.edges(), [wanted, (wanted.0, 0)], "{counts:?}: {}", program.complaints());
    }
}
