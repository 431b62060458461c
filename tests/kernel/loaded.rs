//! A thumb that lies on the pad when the bridge takes its zero: at the start, and when the pad comes back.

use std::process::Command;
use std::thread;

use evdev::KeyCode;
use serde_json::Value;

use crate::bridge::{Bridge, TACTPAD};
use crate::clock::{MS, monotonic_ns, wait_until};
use crate::pad::{NONE, PRESS, Pad};

/// The thumb lies still for this long before it first lifts: the bridge takes that for the zero.
const THUMB_MS: u64 = 500;

/// A lift that is too short to take a zero in.
const SHORT_LIFT_MS: u64 = 100;

const LIFT_MS: u64 = 500;
const PRESS_MS: u64 = 300;
const PRESSES: usize = 15;

/// The bridge's own answer may take so long.
const STATUS_LIMIT_MS: u64 = 10_000;

/// Presses are not lost, and the state says why the first ones would be.
pub(crate) fn thumb_at_the_start() {
    let mut bridge = Bridge::start_under(PRESS, "contra", KeyCode::BTN_SOUTH);
    check_it_is_told_and_mended(&mut bridge);
    let Bridge { pad, program, reader } = bridge;
    let path = pad.path().to_owned();
    pad.unplug();
    // Its number is free when the bridge has let it go.
    let limit_ns = monotonic_ns() + STATUS_LIMIT_MS * MS;
    while status()["state"] != "waiting" {
        assert!(monotonic_ns() < limit_ns, "the bridge does not see that the pad is gone");
        wait_until(monotonic_ns() + MS);
    }
    let pad = Pad::plug_in();
    assert_eq!(pad.path(), path, "the kernel gives the lowest free number");
    let mut bridge = Bridge { pad, program, reader };
    bridge.pad.hold_until("the bridge hears the pad", PRESS, STATUS_LIMIT_MS, {
        let mut said = None;
        move || said.get_or_insert_with(|| thread::spawn(status)).is_finished()
    });
    bridge.pad.hold(PRESS, THUMB_MS);
    check_it_is_told_and_mended(&mut bridge);
}

fn check_it_is_told_and_mended(bridge: &mut Bridge) {
    bridge.reader.read_available();
    bridge.reader.seen.clear();
    bridge.pad.hold(NONE, SHORT_LIFT_MS);
    // The thumb is back before there was a zero.
    assert_eq!(state_under_the_thumb(bridge), "loaded");
    let told = bridge.program.complaints();
    assert!(told.contains("lift the finger"), "{told}");
    for _ in 0..PRESSES {
        bridge.pad.hold(NONE, LIFT_MS);
        bridge.pad.hold(PRESS, PRESS_MS);
    }
    bridge.pad.hold(NONE, LIFT_MS);
    bridge.reader.read_available();
    let edges = bridge.reader.edges();
    let jumps = [("BTN_SOUTH", 1), ("BTN_SOUTH", 0)].repeat(PRESSES);
    assert_eq!(edges, jumps);
}

/// What `ctl status` says while the thumb lies on the pad.
fn state_under_the_thumb(bridge: &mut Bridge) -> Value {
    thread::scope(|scope| {
        let asking = scope.spawn(status);
        bridge.pad.hold_until("an answer", PRESS, STATUS_LIMIT_MS, || asking.is_finished());
        asking.join().expect("an answer")["state"].clone()
    })
}

fn status() -> Value {
    let output = Command::new(TACTPAD).args(["ctl", "status", "--json"]).output().expect("the program");
    serde_json::from_slice(&output.stdout).expect("one document")
}
