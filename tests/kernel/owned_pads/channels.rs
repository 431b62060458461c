//! Devices whose axes are channels: a board of four cells, a cap of six axes.

use evdev::uinput::VirtualDevice;
use evdev::{AbsInfo, AbsoluteAxisCode, AttributeSet, EventType, InputEvent, KeyCode, UinputAbsSetup};

use super::{comes_true, pause, start};
use crate::bridge::TACTPAD;
use crate::clock::MS;
use crate::program::Running;
use crate::reader::{Reader, find};

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
