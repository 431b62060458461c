//! Strokes and what comes of them, also after the device was away, and of a recording.

use evdev::KeyCode;

use super::device::{Device, SHAPES};
use super::{LIMIT_MS, comes_true, devices, pause, start};
use crate::bridge::TACTPAD;
use crate::clock::MS;
use crate::program::Running;
use crate::reader::find;

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
