//! Nothing stays held: not when the bridge is ended or killed, not when the pad leaves or falls silent.

use std::thread;

use evdev::{AbsoluteAxisCode, KeyCode};
use rustix::process::Signal;

use crate::bridge::Bridge;
use crate::clock::{MS, monotonic_ns, stamp_ns, wait_until};
use crate::pad::{NONE, PRESS_RIGHT, Pad, RIGHT};
use crate::reader::{Change, Reader, find};

/// Everything is neutral at most this long after the last sample.
const NEUTRAL_LIMIT_MS: u64 = 100;

/// A game that shows 100 pictures a second; one that shows 60 leaves a guest under load no time to be late.
const PICTURE_MS: u64 = 10;

/// Pictures until the device must be gone: three seconds.
const PICTURES_MAX: u64 = 300;

/// Ended politely: a reader sees everything released before the device goes.
pub(crate) fn after_sigterm() {
    ended_by(Signal::TERM);
}

/// Ended with Ctrl-\: the same.
pub(crate) fn after_sigquit() {
    ended_by(Signal::QUIT);
}

fn ended_by(signal: Signal) {
    let mut bridge = holding();
    read_to_the_end(&mut bridge, signal);
    let mut released = bridge.reader.edges();
    released.sort_unstable();
    assert_eq!(released, [("ABS_HAT0X", 0), ("BTN_EAST", 0)]);
    assert_eq!(bridge.program.wait(1_000).code(), Some(0));
    assert_eq!(find(KeyCode::BTN_SOUTH), None, "the device is gone");
}

/// Stopped with Ctrl-Z: everything is released first, the device stays, and the pad plays again when the bridge goes on.
pub(crate) fn after_sigtstp() {
    let mut bridge = holding();
    let sent_ns = stamp_ns();
    bridge.program.signal(Signal::TSTP);
    check_neutral_since(sent_ns, &mut bridge.reader);
    bridge.program.signal(Signal::CONT);
    check_plays_again(&mut bridge);
}

/// Killed: the kernel removes the device and with it whatever was held.
pub(crate) fn after_sigkill() {
    let mut bridge = holding();
    read_to_the_end(&mut bridge, Signal::KILL);
    assert!(bridge.reader.device.get_key_state().is_err(), "a device that is gone holds nothing");
    assert!(bridge.reader.seen.iter().all(|change| change.value == 0), "{:?}", bridge.reader.seen);
    assert_eq!(find(KeyCode::BTN_SOUTH), None, "the device is gone");
}

/// Unplugged: everything is released at once, the device stays, and the pad plays again when it is back.
pub(crate) fn after_unplugging() {
    let Bridge { pad, mut program, mut reader } = holding();
    let path = pad.path().to_owned();
    let unplugged_ns = pad.unplug();
    check_neutral_since(unplugged_ns, &mut reader);
    assert!(!program.has_ended(), "the bridge waits for the pad");
    let pad = Pad::plug_in();
    assert_eq!(pad.path(), path, "the kernel gives the lowest free number");
    check_plays_again(&mut Bridge { pad, program, reader });
}

/// Silent: the same, without any word from the kernel.
pub(crate) fn after_silence() {
    let mut bridge = holding();
    check_neutral_since(bridge.pad.last_write_ns(), &mut bridge.reader);
    assert!(!bridge.program.has_ended(), "the bridge waits for the pad");
    check_plays_again(&mut bridge);
}

/// A bridge that holds a direction and a button; what its reader saw so far is forgotten.
fn holding() -> Bridge {
    let mut bridge = Bridge::start("super-mario", KeyCode::BTN_SOUTH);
    bridge.pad.hold(PRESS_RIGHT, 600);
    bridge.reader.read_available();
    assert_eq!(bridge.reader.edges(), [("ABS_HAT0X", 1), ("BTN_EAST", 1)]);
    bridge.reader.seen.clear();
    bridge
}

/// Sends `signal` while the finger stays, and reads until the device is gone.
fn read_to_the_end(bridge: &mut Bridge, signal: Signal) {
    let Bridge { pad, program, reader } = bridge;
    thread::scope(|scope| {
        let reading = scope.spawn(|| read_as_a_game_does(reader));
        let sent_ns = stamp_ns();
        program.signal(signal);
        pad.hold_until("the end of the bridge", PRESS_RIGHT, 2_000, || program.has_ended());
        println!("ended {} us after {signal:?}", (stamp_ns() - sent_ns) / 1_000);
        reading.join().expect("the reader saw the device go");
    });
}

/// Reads once a picture until the device is gone. What it has not read by then went with the device.
fn read_as_a_game_does(reader: &mut Reader) {
    let mut picture_ns = monotonic_ns();
    for _ in 0..PICTURES_MAX {
        picture_ns += PICTURE_MS * MS;
        wait_until(picture_ns);
        reader.read_available();
        if reader.gone {
            return;
        }
    }
    panic!("the device is still there");
}

fn check_neutral_since(since_ns: u64, reader: &mut Reader) {
    let released = |seen: &[Change]| seen.len() >= 2;
    reader.read_until(1_000, released);
    for change in &reader.seen {
        let after_us = change.at_ns.saturating_sub(since_ns) / 1_000;
        println!("{} {} after {after_us} us", change.name, change.value);
        assert_eq!(change.value, 0);
        assert!(after_us <= NEUTRAL_LIMIT_MS * 1_000, "later than {NEUTRAL_LIMIT_MS} ms");
    }
    wait_until(monotonic_ns() + 300 * MS);
    reader.read_available();
    assert!(!reader.gone, "the device stays");
    let keys = reader.device.get_key_state().expect("the device stays");
    assert_eq!(keys.iter().next(), None);
    for (axis, state) in reader.device.get_absinfo().expect("the device stays") {
        let is_hat = [AbsoluteAxisCode::ABS_HAT0X, AbsoluteAxisCode::ABS_HAT0Y].contains(&axis);
        assert!(!is_hat || state.value() == 0, "{axis:?} is {}", state.value());
    }
    assert_eq!(reader.seen.len(), 2, "nothing more happened: {:?}", reader.seen);
    reader.seen.clear();
}

fn check_plays_again(bridge: &mut Bridge) {
    bridge.pad.hold(NONE, 2_000);
    bridge.pad.hold(RIGHT, 200);
    bridge.pad.hold(NONE, 200);
    bridge.reader.read_available();
    assert_eq!(bridge.reader.edges(), [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)]);
}
