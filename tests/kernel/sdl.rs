//! SDL, which most games use, knows the virtual gamepad without being told anything.

use std::io::{BufRead, BufReader};
use std::process::Command;

use evdev::KeyCode;

use crate::bridge::Bridge;
use crate::pad::{NONE, PRESS, RIGHT, Touch};
use crate::program::{Running, compiled, path};
use crate::support::require;

/// Whether the probe is there to run; on the host, compiles it.
pub(crate) fn probe_is_there() -> bool {
    if !require("sdl2-config", "apt-get install libsdl2-dev") {
        return false;
    }
    let flags = Command::new("sdl2-config").args(["--cflags", "--libs"]).output().expect("sdl2-config");
    let flags = String::from_utf8(flags.stdout).expect("flags in ASCII");
    compiled("sdl_probe", &flags.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
}

/// SDL lists the pad as a game controller with a mapping, and its D-pad and A button arrive.
pub(crate) fn game_controller() {
    let mut bridge = Bridge::start("super-mario", KeyCode::BTN_SOUTH);
    check(|touch, for_ms| bridge.pad.hold(touch, for_ms));
}

/// What SDL sees of the gamepad that a running bridge made, while `hold` plays on the pad before it.
pub(crate) fn check(mut hold: impl FnMut(Touch, u64)) {
    let mut probe = Running::start(path("sdl_probe"), &["4", "10000"]);
    let mut lines = BufReader::new(probe.take_output()).lines().map(|line| line.expect("a line"));
    let listed: Vec<_> = lines.by_ref().take_while(|line| line != "ready").collect();
    println!("{}", listed.join("\n"));
    assert_eq!(listed.len(), 2, "one joystick and its mapping");
    // USB, 045e:028e, version 0114, the last one being what tells a wired pad from those with another D-pad.
    assert!(
        listed[0].starts_with("joystick 0300") && listed[0].contains("5e0400008e02000014010000"),
        "{}",
        listed[0]
    );
    assert!(listed[0].ends_with("controller 1"), "{}", listed[0]);
    assert!(listed[1].contains("dpright:h0.2") && listed[1].contains("a:b0"), "{}", listed[1]);
    hold(NONE, 500);
    hold(RIGHT, 100);
    hold(NONE, 100);
    hold(PRESS, 100);
    hold(NONE, 100);
    let events: Vec<_> = lines.collect();
    assert_eq!(events, ["button dpright 1", "button dpright 0", "button a 1", "button a 0"]);
    assert!(probe.wait(1_000).success());
}
