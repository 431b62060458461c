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
    let mut demo = Running::start(TACTPAD, &["demo", "--seconds", "5", "--output", "uinput", "--json"]);
    let limit_ns = monotonic_ns() + 5_000 * MS;
    while find(KeyCode::BTN_SOUTH).is_none() {
        assert!(monotonic_ns() < limit_ns && !demo.has_ended(), "the demo makes a gamepad");
        wait_until(monotonic_ns() + MS);
    }
    let mut reader = Reader::open(&find(KeyCode::BTN_SOUTH).expect("it was there a moment ago"));
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
    let downs = reader.seen.iter().filter(|change| change.value != 0).count();
    assert_eq!(number("downs"), downs as u64, "the reader saw {:?}", reader.edges());
}
