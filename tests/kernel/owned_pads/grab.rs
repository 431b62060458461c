//! Who has the device: the bridge, the desktop, another program, or nobody who reads.

use evdev::raw_stream::RawDevice;
use evdev::{EventType, KeyCode};
use rustix::process::Signal;

use super::device::{Device, MT, PEN, SHAPES};
use super::{ask, comes_true, pause, start, status};
use crate::reader::{Reader, find};

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
