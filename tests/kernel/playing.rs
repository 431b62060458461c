//! The virtual devices are what games expect, and playing arrives on them.

use evdev::raw_stream::RawDevice;
use evdev::{AbsoluteAxisCode, BusType, EventType, KeyCode, RelativeAxisCode};

use crate::bridge::Bridge;
use crate::clock::{MS, stamp_ns};
use crate::guest::lateness_ms;
use crate::pad::{DOWN, LEFT, NONE, PRESS, RIGHT, Touch, UP, period_ns};
use crate::reader::find;

/// Codes of the eleven buttons of the kernel's driver for this pad (`drivers/input/joystick/xpad.c`).
const GAMEPAD_KEYS: [u16; 11] = [0x130, 0x131, 0x133, 0x134, 0x136, 0x137, 0x13a, 0x13b, 0x13c, 0x13d, 0x13e];

/// Axes of the same driver: number, minimum, maximum, fuzz, flat.
const GAMEPAD_AXES: [(u16, i32, i32, i32, i32); 8] = [
    (0x00, -32_768, 32_767, 16, 128),
    (0x01, -32_768, 32_767, 16, 128),
    (0x02, 0, 255, 0, 0),
    (0x03, -32_768, 32_767, 16, 128),
    (0x04, -32_768, 32_767, 16, 128),
    (0x05, 0, 255, 0, 0),
    (0x10, -1, 1, 0, 0),
    (0x11, -1, 1, 0, 0),
];

/// A long press of the shipped profiles.
const LONG_PRESS_MS: u64 = 400;

/// An output stays down at least this long in the shipped profiles.
const MIN_PRESS_MS: u64 = 40;

/// What the window of the filter, a sample's period and the guest's scheduling may add to a decision at 1 kHz.
const SLACK_MS: u64 = 50;

/// Window of the filter in the shipped profiles.
const FILTER_SAMPLES: u64 = 6;

/// The same at the rate of the test's pad: a slower one fills the window more slowly.
fn slack_ms() -> u64 {
    SLACK_MS + FILTER_SAMPLES * (period_ns() / MS - 1)
}

/// Presses one after the other; a bridge that loses one in fifty loses some of them.
const PRESSES: u64 = 150;

/// From where the finger comes or goes until the game hears of it, at most: the filter's window, and nothing else.
const EDGE_LIMIT_MS: u64 = FILTER_SAMPLES + 1;

/// The virtual gamepad is the wired Xbox 360 pad bit by bit, and plays.
pub(crate) fn gamepad() {
    // The machine may have a keyboard of its own.
    let others = find(KeyCode::KEY_RIGHT);
    let mut bridge = Bridge::start("super-mario", KeyCode::BTN_SOUTH);
    check_identity(&bridge.reader.device);
    let hold_start_ns = play_everything(&mut bridge);
    assert_eq!(
        bridge.reader.edges(),
        [
            ("ABS_HAT0X", 1),
            ("ABS_HAT0X", 0),
            ("ABS_HAT0X", -1),
            ("ABS_HAT0X", 0),
            ("ABS_HAT0Y", -1),
            ("ABS_HAT0Y", 0),
            ("ABS_HAT0Y", 1),
            ("ABS_HAT0Y", 0),
            ("BTN_SOUTH", 1),
            ("BTN_SOUTH", 0),
            ("BTN_EAST", 1),
            ("BTN_EAST", 0),
        ]
    );
    check_durations(&bridge, hold_start_ns, "BTN_SOUTH", "BTN_EAST");
    assert_eq!(find(KeyCode::KEY_RIGHT), others, "a gamepad profile makes no keyboard");
}

/// The virtual keyboard is a device of its own, has keys only, and plays the same touches.
pub(crate) fn keyboard() {
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/mappings/super-mario.toml");
    let shipped = std::fs::read_to_string(shipped).expect("the shipped profile");
    let profile = shipped.replace(r#"output = "gamepad""#, r#"output = "keyboard""#);
    assert_ne!(profile, shipped, "the shipped profile is for the gamepad");
    let file = std::env::temp_dir().join("keyboard.toml");
    std::fs::write(&file, profile).expect("a profile");
    let mut bridge = Bridge::start(file.to_str().expect("an ASCII path"), KeyCode::KEY_RIGHT);
    let device = &bridge.reader.device;
    assert!(device.supported_absolute_axes().is_none_or(|axes| axes.iter().next().is_none()));
    assert!(device.supported_keys().is_some_and(|keys| keys.iter().all(|key| key.code() < 0x100)));
    assert!(
        !device.supported_events().contains(EventType::REPEAT),
        "holding a direction must not repeat keys"
    );
    let hold_start_ns = play_everything(&mut bridge);
    let keys = ["KEY_RIGHT", "KEY_LEFT", "KEY_UP", "KEY_DOWN", "KEY_Z", "KEY_X"];
    let expected: Vec<_> = keys.into_iter().flat_map(|key| [(key, 1), (key, 0)]).collect();
    assert_eq!(bridge.reader.edges(), expected);
    check_durations(&bridge, hold_start_ns, "KEY_Z", "KEY_X");
    assert_eq!(find(KeyCode::BTN_SOUTH), None, "a keyboard profile makes no gamepad");
}

/// Not one press is lost, none is late, and none is let go late, however long they and the pauses between them are.
pub(crate) fn every_press() {
    let mut bridge = Bridge::start("contra", KeyCode::BTN_SOUTH);
    for number in 0..PRESSES {
        bridge.reader.seen.clear();
        let pressed_ns = stamp_ns();
        bridge.pad.hold(PRESS, 50 + 10 * (number % 7));
        let lifted_ns = stamp_ns();
        bridge.pad.hold(NONE, 60 + 10 * (number % 5));
        bridge.reader.read_available();
        assert_eq!(bridge.reader.edges(), [("BTN_SOUTH", 1), ("BTN_SOUTH", 0)], "press {number}");
        for (edge, from_ns) in bridge.reader.seen.iter().zip([pressed_ns, lifted_ns]) {
            let late_us = (edge.at_ns - from_ns) / 1_000;
            assert!(late_us <= 1_000 * EDGE_LIMIT_MS, "press {number}: {edge:?} after {late_us} us");
        }
    }
}

/// The pointer is a mouse of its own: the profile makes nothing else, and touches move it and click.
pub(crate) fn pointer() {
    let mut bridge = Bridge::start("pointer", KeyCode::BTN_LEFT);
    let device = &bridge.reader.device;
    assert_eq!(device.name(), Some("tactpad pointer"));
    let movements: Vec<_> = device.supported_relative_axes().expect("movements").iter().collect();
    assert_eq!(movements, [RelativeAxisCode::REL_X, RelativeAxisCode::REL_Y, RelativeAxisCode::REL_WHEEL]);
    let keys: Vec<_> = device.supported_keys().expect("buttons").iter().collect();
    assert_eq!(keys, [KeyCode::BTN_LEFT, KeyCode::BTN_RIGHT, KeyCode::BTN_MIDDLE]);
    assert!(device.supported_absolute_axes().is_none_or(|axes| axes.iter().next().is_none()));
    let mut before = (0, 0);
    for (touch, right, down) in [(RIGHT, 1, 0), (UP, 0, -1), (LEFT, -1, 0), (DOWN, 0, 1)] {
        touch_for(&mut bridge, touch, 300);
        bridge.reader.read_available();
        let at = (bridge.reader.moved("REL_X"), bridge.reader.moved("REL_Y"));
        let way = (at.0 - before.0, at.1 - before.1);
        assert_eq!((way.0.signum(), way.1.signum()), (right, down), "{way:?}");
        // At 12 mm of 5 to 24 mm the speed is 109 counts per second.
        assert!((24..=40).contains(&(way.0 + way.1).abs()), "{way:?}");
        before = at;
    }
    touch_for(&mut bridge, PRESS, 150);
    bridge.reader.read_available();
    let clicks: Vec<_> =
        bridge.reader.edges().into_iter().filter(|(name, _)| name.starts_with("BTN")).collect();
    assert_eq!(clicks, [("BTN_LEFT", 1), ("BTN_LEFT", 0)]);
    for key in [KeyCode::BTN_SOUTH, KeyCode::KEY_RIGHT] {
        assert_eq!(find(key), None, "a pointer's profile makes no other device");
    }
}

/// An absolute pointer is a device of places and no movements; the pointer stays where the finger left it.
pub(crate) fn tablet() {
    let path = std::env::temp_dir().join("tablet.toml");
    let text = "schema = 1\nname = \"Tablet\"\noutput = \"gamepad\"\n[pointer]\nmode = \"absolute\"\n";
    std::fs::write(&path, text).expect("a profile");
    let mut bridge = Bridge::start(path.to_str().expect("text"), KeyCode::BTN_LEFT);
    let device = &bridge.reader.device;
    assert_eq!(device.name(), Some("tactpad tablet"));
    assert!(device.supported_relative_axes().is_none_or(|axes| axes.iter().next().is_none()));
    let axes: Vec<_> = device.get_absinfo().expect("axes").map(|(axis, _)| axis).collect();
    assert_eq!(axes, [AbsoluteAxisCode::ABS_X, AbsoluteAxisCode::ABS_Y]);
    for (touch, axis, share) in [(RIGHT, "ABS_X", 0.75), (UP, "ABS_Y", 0.25)] {
        touch_for(&mut bridge, touch, 300);
        bridge.reader.read_available();
        let place = bridge.reader.seen.iter().rev().find(|change| change.name == axis);
        let place = f64::from(place.expect("a place").value) / 32_767.0;
        // 12 mm of 24 mm; half a millimetre is a hundredth of the screen.
        assert!((place - share).abs() < 0.02, "{axis} {place}");
    }
}

fn check_identity(device: &RawDevice) {
    let id = device.input_id();
    assert_eq!(device.name(), Some("Microsoft X-Box 360 pad"));
    assert_eq!(id.bus_type(), BusType::BUS_USB);
    assert_eq!((id.vendor(), id.product(), id.version()), (0x045e, 0x028e, 0x0114));
    let keys = device.supported_keys().expect("buttons");
    assert_eq!(keys.iter().map(KeyCode::code).collect::<Vec<_>>(), GAMEPAD_KEYS);
    let axes: Vec<_> = device
        .get_absinfo()
        .expect("axes")
        .map(|(axis, range)| (axis.0, range.minimum(), range.maximum(), range.fuzz(), range.flat()))
        .collect();
    assert_eq!(axes, GAMEPAD_AXES);
    let hat = device.get_absinfo().expect("axes").find(|(axis, _)| *axis == AbsoluteAxisCode::ABS_HAT0X);
    assert_eq!(hat.map(|(_, range)| range.value()), Some(0), "the hat starts neutral");
}

/// Right, left, up, down, a short and a long press. Returns when the long press began.
fn play_everything(bridge: &mut Bridge) -> u64 {
    for touch in [RIGHT, LEFT, UP, DOWN] {
        touch_for(bridge, touch, 100);
    }
    touch_for(bridge, PRESS, 150);
    let hold_start_ns = stamp_ns();
    touch_for(bridge, PRESS, 700);
    bridge.reader.read_available();
    hold_start_ns
}

fn touch_for(bridge: &mut Bridge, touch: Touch, for_ms: u64) {
    bridge.pad.hold(touch, for_ms);
    bridge.pad.hold(NONE, 100);
}

fn check_durations(bridge: &Bridge, hold_start_ns: u64, tap: &str, hold: &str) {
    let at = |name, value| bridge.reader.stamp_of(name, value).expect("seen above");
    // A machine that stood still stamps the start of what it times late: that is missing from what is measured here,
    // and no fault of the bridge.
    let late_ms = lateness_ms();
    // Times are counted in samples of the pad, and the stamp of an edge lies within a period behind its sample.
    let lasts = |wanted_ms: u64, took_ns: u64| {
        let least_ns = (wanted_ms.saturating_sub(late_ms) * MS).saturating_sub(period_ns());
        (least_ns..(wanted_ms + slack_ms()) * MS).contains(&took_ns)
    };
    let tap_ns = at(tap, 0) - at(tap, 1);
    assert!(
        lasts(MIN_PRESS_MS, tap_ns),
        "the tap lasted {tap_ns} ns, the machine stood still for {late_ms} ms"
    );
    let long_ns = at(hold, 1) - hold_start_ns;
    assert!(
        lasts(LONG_PRESS_MS, long_ns),
        "long after {long_ns} ns, the machine stood still for {late_ms} ms"
    );
}
