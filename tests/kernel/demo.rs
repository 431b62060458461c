//! The demo on a real input stack.

use std::io::Read;

use evdev::KeyCode;
use serde_json::Value;

use crate::bridge::TACTPAD;
use crate::clock::{MS, monotonic_ns, wait_until};
use crate::program::Running;
use crate::reader::{Reader, find};

/// The demo plays on a virtual gamepad; its account agrees with what a reader of the device saw.
pub(crate) fn plays_on_uinput() {
    let reader = play("super-mario", KeyCode::BTN_SOUTH);
    assert!(reader.seen.iter().all(|change| !change.name.starts_with("REL")));
}

/// The demo of the mouse moves a virtual one, in all directions.
pub(crate) fn moves_the_pointer() {
    let reader = play("pointer", KeyCode::BTN_LEFT);
    for (axis, sign) in [("REL_X", 1), ("REL_X", -1), ("REL_Y", 1), ("REL_Y", -1)] {
        let moved = reader.seen.iter().any(|change| change.name == axis && change.value.signum() == sign);
        assert!(moved, "{axis} {sign}");
    }
}

/// Plays the demo with `profile` and checks its account against the device that has `key`.
fn play(profile: &str, key: KeyCode) -> Reader {
    let arguments = ["demo", "--seconds", "5", "--output", "uinput", "--json", "--profile", profile];
    let mut demo = Running::start(TACTPAD, &arguments);
    let limit_ns = monotonic_ns() + 5_000 * MS;
    while find(key).is_none() {
        assert!(monotonic_ns() < limit_ns && !demo.has_ended(), "the demo makes a device");
        wait_until(monotonic_ns() + MS);
    }
    let mut reader = Reader::open(&find(key).expect("it was there a moment ago"));
    reader.read_until(15_000, |_| false);
    let mut said = String::new();
    demo.take_output().read_to_string(&mut said).expect("text");
    println!("{said}");
    assert!(demo.wait(1_000).success());
    let account: Value = serde_json::from_str(&said).expect("exactly one JSON document");
    let number = |name: &str| account[name].as_u64().unwrap_or_else(|| panic!("no number {name} in {said}"));
    assert!(number("frames") > 0 && number("contacts") > 0 && number("downs") > 0, "it played: {said}");
    assert_eq!((number("frames_lost"), number("held_at_end")), (0, 0));
    assert_eq!(number("downs"), number("ups"));
    let p50_us = account["latency_us"]["p50"].as_f64().expect("a median latency");
    assert!(p50_us > 0.0, "{said}");
    let (moves, edges): (Vec<_>, Vec<_>) =
        reader.seen.iter().partition(|change| change.name.starts_with("REL"));
    let downs = edges.iter().filter(|change| change.value != 0).count();
    assert_eq!(number("downs"), downs as u64, "the reader saw {:?}", reader.edges());
    assert_eq!(number("pointer_moves"), moves.len() as u64);
    reader
}
