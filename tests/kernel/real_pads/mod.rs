//! Real tablets and touchpads: names, numbers, axes, ranges, buttons and reports as libinput's own tests know them. The strokes are ours.

mod hand;
pub(crate) mod litest;
pub(crate) mod quirks;

use std::fs;
use std::path::Path;

use evdev::{AbsInfo, AbsoluteAxisCode, BusType, EventType, InputId, KeyCode, PropType};
use firmware_proto::frame::Message;
use firmware_proto::link::MessageReceiver;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::reader::CaptureReader;

use crate::bridge::TACTPAD;
use crate::owned_pads::{ask, comes_true, devices, pause, start, status};
use crate::program::Running;
use crate::reader::{Reader, find};
use crate::support::leave_out;
use hand::{Hand, Pose};
use litest::{RealDevice, Told};

/// Pads that can be played with, with the description that must fit and the share of the full scale that is 5 N there.
const PADS: [(&str, &str, f64); 12] = [
    ("wacom-intuos5-pen", "tablet", 0.8),
    ("wacom-cintiq-13hdt-pen", "tablet", 0.8),
    ("wacom-cintiq-pro-16-pen", "tablet", 0.8),
    ("wacom-bamboo-16fg-pen", "tablet", 0.8),
    ("huion-pentablet", "tablet", 0.8),
    ("waltop-tablet", "tablet", 0.8),
    ("synaptics-t440", "touchpad", 0.6),
    ("synaptics-rmi4", "touchpad", 0.6),
    ("atmel-hover", "touchpad", 0.6),
    // Without a unit of its pressure, and with one: 40 units per gram, by which the whole scale would be 0.06 N.
    ("synaptics-pressurepad", "touchpad", 0.6),
    ("generic-pressurepad", "touchpad", 0.6),
    (TRACKPAD, "magic-trackpad", 0.6),
];

/// The one whose axes libinput does not know; its driver does.
const TRACKPAD: &str = "Magic Trackpad 2";

/// What tells no pressure, and nodes of tablets that are no pen.
const OTHERS: [&str; 8] = [
    "magic-trackpad",
    "synaptics-i2c",
    "bcm5974",
    "elantech-touchpad",
    "wacom-intuos5-finger",
    "wacom-intuos5-pad",
    "wacom-bamboo-2fg-pad",
    "huion-q620m-dial",
];

/// A point of a stroke: shares of width and height, and of the full scale of the pressure.
const STROKE: [[f64; 3]; 6] = [
    [0.5, 0.5, 0.2],
    [0.92, 0.5, 0.35],
    [0.7, 0.08, 0.6],
    [0.03, 0.4, 0.05],
    [0.0, 1.0, 1.0],
    [0.31, 0.77, 0.45],
];

/// Whether the devices were fetched.
pub(crate) fn are_there() -> bool {
    let is_there = litest::folder().is_some();
    if !is_there {
        leave_out("what libinput knows of real tablets and touchpads", litest::FETCH);
    }
    is_there
}

fn device(name: &str) -> RealDevice {
    let folder = litest::folder().expect("it was there a moment ago");
    if name == TRACKPAD { trackpad(&folder) } else { litest::device(&folder, name) }
}

/// The Magic Trackpad 2: numbers and size by libinput's quirks, axes and ranges by the kernel's driver hid-magicmouse.
fn trackpad(folder: &Path) -> RealDevice {
    let (vendor, product, [width_mm, height_mm]) = litest::quirk(folder, "Apple Magic Trackpad v2 (2015)");
    let info = |minimum, maximum, fuzz, resolution| AbsInfo::new(0, minimum, maximum, fuzz, 0, resolution);
    let (x, y) = (info(-3_678, 3_934, 4, 47), info(-2_478, 2_587, 4, 44));
    for (axis, mm) in [(x, width_mm), (y, height_mm)] {
        let range_mm = f64::from(axis.maximum() - axis.minimum()) / f64::from(axis.resolution());
        assert!((range_mm - mm).abs() < 0.03 * mm, "{range_mm} mm of the driver, {mm} mm of the quirks");
    }
    let size = info(0, 1_020, 4, 0);
    use AbsoluteAxisCode as Axis;
    let axes = vec![
        (Axis::ABS_X, x),
        (Axis::ABS_Y, y),
        (Axis::ABS_PRESSURE, info(0, 253, 0, 0)),
        (Axis::ABS_MT_SLOT, info(0, 15, 0, 0)),
        (Axis::ABS_MT_TOUCH_MAJOR, size),
        (Axis::ABS_MT_TOUCH_MINOR, size),
        (Axis::ABS_MT_ORIENTATION, info(-31, 32, 1, 0)),
        (Axis::ABS_MT_POSITION_X, x),
        (Axis::ABS_MT_POSITION_Y, y),
        (Axis::ABS_MT_TRACKING_ID, info(0, 65_535, 0, 0)),
        (Axis::ABS_MT_PRESSURE, info(0, 253, 0, 0)),
    ];
    let told = |axis: &Axis| Told { kind: EventType::ABSOLUTE, code: Some(axis.0), value: None };
    let reported = [
        Axis::ABS_MT_SLOT,
        Axis::ABS_MT_TRACKING_ID,
        Axis::ABS_MT_TOUCH_MAJOR,
        Axis::ABS_MT_TOUCH_MINOR,
        Axis::ABS_MT_ORIENTATION,
        Axis::ABS_MT_PRESSURE,
        Axis::ABS_MT_POSITION_X,
        Axis::ABS_MT_POSITION_Y,
    ];
    let report: Vec<Told> = reported.iter().map(told).collect();
    let keys = vec![
        KeyCode::BTN_LEFT,
        KeyCode::BTN_TOOL_FINGER,
        KeyCode::BTN_TOUCH,
        KeyCode::BTN_TOOL_DOUBLETAP,
        KeyCode::BTN_TOOL_TRIPLETAP,
        KeyCode::BTN_TOOL_QUADTAP,
        KeyCode::BTN_TOOL_QUINTTAP,
    ];
    RealDevice {
        name: "Apple Inc. Magic Trackpad 2".into(),
        id: InputId::new(BusType::BUS_USB, vendor, product, 0x110),
        axes,
        keys,
        relative: Vec::new(),
        misc: Vec::new(),
        properties: vec![PropType::POINTER, PropType::BUTTONPAD],
        reports: [("down".into(), report.clone()), ("move".into(), report)].into(),
    }
}

/// A contact on the plate: place in mm, force in N.
type Touch = Option<[f64; 3]>;

/// What a pose on the device means, by the numbers that were reported, and how far off an axis' unit is.
fn meant(hand: &Hand, pose: &Pose, full_share: f64) -> ([f64; 3], [f64; 3]) {
    let axes = if hand.is_pen() {
        [AbsoluteAxisCode::ABS_X, AbsoluteAxisCode::ABS_Y, AbsoluteAxisCode::ABS_PRESSURE]
    } else {
        [
            AbsoluteAxisCode::ABS_MT_POSITION_X,
            AbsoluteAxisCode::ABS_MT_POSITION_Y,
            AbsoluteAxisCode::ABS_MT_PRESSURE,
        ]
    };
    let units = axes.map(|axis| {
        let info = hand.axis(axis).expect("its axis");
        let range = f64::from(info.maximum()) - f64::from(info.minimum());
        (f64::from(hand.value(axis, pose)) - f64::from(info.minimum()), range)
    });
    let [(x, width), (y, height), (pressure, full)] = units;
    // The whole of it is 60 mm; downwards is minus.
    let touch = [60.0 * x / width - 30.0, 30.0 - 60.0 * y / height, 5.0 * pressure / full / full_share];
    (touch, [60.0 / width, 60.0 / height, 5.0 / full / full_share])
}

/// Strokes on a device: what each report means.
fn strokes(hand: &mut Hand, full_share: f64) -> Vec<(Touch, [f64; 3])> {
    let mut meanings = Vec::new();
    for round in 0..2 {
        let poses: Vec<Pose> = STROKE
            .iter()
            .map(|[x, y, pressure]| Pose { x: *x, y: *y, pressure: *pressure, distance: 0.0 })
            .collect();
        if hand.is_pen() {
            hand.come(&Pose { x: 0.4, y: 0.6, pressure: 0.0, distance: 0.9 });
            pause(8);
            hand.hover(&Pose { x: 0.45, y: 0.55, pressure: 0.0, distance: 0.4 }, 0);
            pause(8);
        }
        for (number, pose) in poses.iter().enumerate().skip(round) {
            hand.touch(pose, number == round);
            let (touch, unit) = meant(hand, pose, full_share);
            meanings.push((Some(touch), unit));
            pause(8);
        }
        hand.lift(&poses[poses.len() - 1]);
        meanings.push((None, [0.0; 3]));
        pause(8);
        if hand.is_pen() {
            hand.leave();
            pause(8);
        }
    }
    meanings
}

/// The contacts of a capture, each once.
fn contacts(capture: &Path) -> Vec<Touch> {
    let bytes = fs::read(capture).expect("a capture");
    let mut reader = CaptureReader::new(&bytes[..]).expect("a capture");
    let (mut receiver, mut contacts) = (MessageReceiver::new(), vec![None]);
    while let Some(call) = reader.next_call() {
        let (_, Call::Bytes(frames)) = call.expect("a sound capture") else { continue };
        for message in frames.iter().filter_map(|byte| receiver.push(*byte)) {
            let Ok(Message::Contact(sample)) = message else { panic!("no contact: {message:?}") };
            let [x_um, y_um] = sample.place_um;
            let touch = [x_um, y_um, sample.force_mn[2]].map(|number| f64::from(number) * 1e-3);
            let touch = sample.is_touched.then_some(touch);
            if contacts.last() != Some(&touch) {
                contacts.push(touch);
            }
        }
    }
    contacts.remove(0);
    contacts
}

/// Each is listed with the description that fits it, its strokes are the contacts that its numbers say, none is lost, and nothing of it
/// reaches the desktop meanwhile.
pub(crate) fn contacts_are_those_of_the_numbers() {
    for (name, source, full_share) in PADS {
        let mut hand = Hand::plug_in(device(name));
        let listed = devices();
        let is_listed =
            listed.contains(&format!("\"source\":\"{source}\"")) && listed.contains(&hand.device.name);
        assert!(is_listed, "{name}: {listed}");
        let mut desktop = Reader::open(&hand.node);
        let folder = tempfile::tempdir().expect("a folder");
        let record = ["record", "real.cap", "--pad", source, "--output", "none", "--seconds", "2"];
        let mut program = Running::start_command(
            std::process::Command::new(TACTPAD).args(record).current_dir(folder.path()),
        );
        let capture = folder.path().join("real.cap");
        comes_true("the capture", || capture.metadata().is_ok_and(|file| file.len() > 0));
        pause(300);
        let meant = strokes(&mut hand, full_share);
        desktop.read_available();
        assert_eq!(desktop.edges(), [], "{name}: the desktop hears nothing");
        assert!(program.wait(5_000).success(), "{name}: {}", program.complaints());
        let told = contacts(&capture);
        assert_eq!(told.len(), meant.len(), "{name}: {told:?} {meant:?}");
        let mut worst = [0.0_f64; 3];
        for (told, (meant, unit)) in told.iter().zip(&meant) {
            let (Some(told), Some(mut meant)) = (*told, *meant) else {
                assert_eq!((told.is_some(), meant.is_some()), (false, false), "{name}");
                continue;
            };
            // What lies beyond the round plate is moved to its rim by the pipeline, not here.
            meant[2] = meant[2].min(5.0 / full_share);
            for k in 0..3 {
                worst[k] = worst[k].max((told[k] - meant[k]).abs());
                // Frames count micrometres and millinewtons.
                assert!((told[k] - meant[k]).abs() <= unit[k] + 1e-3, "{name}: {told:?} {meant:?}");
            }
        }
        println!(
            "{}: {} contacts, off by {worst:.4?} mm, mm, N",
            hand.device.name,
            told.iter().flatten().count()
        );
        desktop.seen.clear();
        hand_is_heard(&mut hand, &mut desktop, name, "once the bridge is gone", true);
    }
}

/// Whether the desktop hears a stroke.
fn hand_is_heard(hand: &mut Hand, desktop: &mut Reader, name: &str, when: &str, is_heard: bool) {
    desktop.seen.clear();
    let _ = strokes(hand, 1.0);
    pause(20);
    desktop.read_available();
    assert_eq!(!desktop.seen.is_empty(), is_heard, "{name} {when}: {:?}", desktop.seen);
    // A tablet that does not tell that the pen has left is believed after a second.
    pause(1_200);
}

/// What tells no pressure is not offered, nor the touch and button nodes of tablets.
pub(crate) fn others_are_not_offered() {
    for name in OTHERS {
        let hand = Hand::plug_in(device(name));
        let listed = devices();
        assert!(!listed.contains("\"source\""), "{}: {listed}", hand.device.name);
    }
}

/// The desktop has each pad before and after, and while it is paused, whichever way it was paused.
pub(crate) fn grabbed_and_given_back() {
    for (name, source, _) in PADS {
        let mut hand = Hand::plug_in(device(name));
        let mut desktop = Reader::open(&hand.node);
        hand_is_heard(&mut hand, &mut desktop, name, "before", true);
        let (program, mut gamepad) = start(source, &[]);
        pause(1_200);
        hand_is_heard(&mut hand, &mut desktop, name, "while it plays", false);
        ask("pause");
        pause(100);
        hand_is_heard(&mut hand, &mut desktop, name, "while it is paused", true);
        ask("resume");
        pause(1_200);
        hand_is_heard(&mut hand, &mut desktop, name, "when it goes on", false);
        gamepad.read_available();
        gamepad.seen.clear();
        gesture(&mut hand, true);
        pause(200);
        // The first finger plays until the fourth is there.
        gamepad.read_available();
        let mut last = std::collections::BTreeMap::new();
        last.extend(gamepad.edges());
        assert!(last.values().all(|value| *value == 0), "{name}: the gesture holds {last:?}");
        gamepad.seen.clear();
        pause(1_200);
        assert!(status().contains("playing"), "{name}: too early");
        pause(200);
        assert!(status().contains("paused"), "{name}: {}", status());
        gesture(&mut hand, false);
        gamepad.read_available();
        assert_eq!(gamepad.edges(), [], "{name}: the gesture is no press");
        pause(100);
        hand_is_heard(&mut hand, &mut desktop, name, "after the gesture", true);
        let said = program.complaints();
        assert!(said.contains("paused by the gesture") && said.contains("1.5 s"), "{name}: {said}");
        ask("resume");
        pause(1_200);
        hand_is_heard(&mut hand, &mut desktop, name, "when it goes on again", false);
        drop(program);
        comes_true("the gamepad goes", || find(KeyCode::BTN_SOUTH).is_none());
        hand_is_heard(&mut hand, &mut desktop, name, "after the end", true);
    }
}

/// The gesture that gives the pad back begins, or ends.
fn gesture(hand: &mut Hand, begins: bool) {
    if !hand.is_pen() {
        hand.four(begins);
        return;
    }
    let corner = Pose { x: 0.05, y: 0.95, pressure: 0.0, distance: 0.5 };
    if begins {
        hand.come(&corner);
        hand.hover(&corner, 1);
    } else {
        hand.hover(&Pose { x: 0.06, ..corner }, 0);
        hand.leave();
    }
}

/// The other nodes of a tablet do nothing, and of two devices with one name the one plays that was named.
pub(crate) fn nodes_are_told_apart() {
    let mut pen = Hand::plug_in(device("wacom-intuos5-pen"));
    let mut finger = Hand::plug_in(device("wacom-intuos5-finger"));
    let _buttons = Hand::plug_in(device("wacom-intuos5-pad"));
    let (program, mut gamepad) = start("tablet", &[]);
    let right = Pose { x: 0.95, y: 0.5, pressure: 0.15, distance: 0.0 };
    finger.touch(&right, true);
    pause(150);
    finger.lift(&right);
    press(&mut pen, &right);
    gamepad.read_available();
    assert_eq!(gamepad.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)], "{}", program.complaints());
    drop(program);
    comes_true("the gamepad goes", || find(KeyCode::BTN_SOUTH).is_none());
    drop((pen, finger));
    // Both call themselves "SynPS/2 Synaptics TouchPad".
    let mut other = Hand::plug_in(device("synaptics-x220"));
    let mut played = Hand::plug_in(device("synaptics-t440"));
    assert_eq!(other.device.name, played.device.name);
    let both =
        std::process::Command::new(TACTPAD).args(["run", "--pad", "touchpad", "--output", "none"]).output();
    let said = String::from_utf8(both.expect("run").stderr).expect("text");
    assert!(said.contains("several devices fit, choose one with --pad"), "{said}");
    let (mut program, mut gamepad) = start(&format!("touchpad:{}", played.node.display()), &[]);
    let left = Pose { x: 0.05, ..right };
    press(&mut other, &left);
    press(&mut played, &right);
    gamepad.read_available();
    assert_eq!(gamepad.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)], "{}", program.complaints());
    assert!(!program.has_ended());
}

fn press(hand: &mut Hand, pose: &Pose) {
    if hand.is_pen() {
        hand.come(&Pose { pressure: 0.0, distance: 0.5, ..*pose });
    }
    hand.touch(pose, true);
    pause(150);
    hand.lift(pose);
    if hand.is_pen() {
        hand.leave();
    }
    pause(150);
}
