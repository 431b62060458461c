//! A pad that knows nothing but the wire specification, played through `tactpad run`.
//!
//! `stranger/pad.py` builds its frames from `firmware-proto/README.md` alone. What the event log must hold is worked
//! out by hand here, from the numbers in `mappings/*.toml`. All four shipped profiles take `filter_samples = 6` and `filter_adapts`: when
//! a force steps from 0 to F, the first sample of the step counts as F / 6 and the second as F, and falls the same way.

#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Read, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::{fs, thread};

use rustix::process::{Pid, Signal, kill_process};

use crate::guest::in_guest;
use crate::support::require;

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");
/// Rest that the pad sends first, and between two contacts.
const FIRST_REST_MS: u64 = 1000;
const REST_MS: u64 = 200;

const X: &str = "ABS_HAT0X";
const Y: &str = "ABS_HAT0Y";
const SOUTH: &str = "BTN_SOUTH";
const EAST: &str = "BTN_EAST";

/// Milliseconds after the contact's first sample, code, value.
type Expected = (u64, &'static str, i32);

/// One contact, and the events that it must come to.
struct Step {
    at_mm: (f32, f32),
    force_n: (f32, f32, f32),
    hold_ms: u64,
    rest_ms: u64,
    expected: &'static [Expected],
}

/// A press straight into the pad at a point, with rest after it.
const fn press(at_mm: (f32, f32), fz_n: f32, hold_ms: u64, expected: &'static [Expected]) -> Step {
    push(at_mm, (0.0, 0.0, fz_n), hold_ms, expected)
}

/// A push of three forces at a point, with rest after it.
const fn push(
    at_mm: (f32, f32),
    force_n: (f32, f32, f32),
    hold_ms: u64,
    expected: &'static [Expected],
) -> Step {
    Step { at_mm, force_n, hold_ms, rest_ms: REST_MS, expected }
}

/// A part of a roll: 100 ms of 1 N at a point, and on without letting go.
const fn roll(at_mm: (f32, f32), expected: &'static [Expected]) -> Step {
    Step { rest_ms: 0, ..press(at_mm, 1.0, 100, expected) }
}

const CENTRE: (f32, f32) = (0.0, 0.0);
const RIGHT: (f32, f32) = (15.0, 0.0);
const UP: (f32, f32) = (0.0, 15.0);
const LEFT: (f32, f32) = (-15.0, 0.0);
const DOWN: (f32, f32) = (0.0, -15.0);
/// Points 15 mm from the centre, named by their angle; all are points of the influence table.
const AT_15_DEG: (f32, f32) = (14.4889, 3.8823);
const AT_25_DEG: (f32, f32) = (13.5946, 6.3393);
const AT_35_DEG: (f32, f32) = (12.2873, 8.6036);
const AT_40_DEG: (f32, f32) = (11.4907, 9.6418);
const AT_45_DEG: (f32, f32) = (10.6066, 10.6066);
const AT_50_DEG: (f32, f32) = (9.6418, 11.4907);
const AT_55_DEG: (f32, f32) = (8.6036, 12.2873);
const AT_65_DEG: (f32, f32) = (6.3393, 13.5946);
const AT_70_DEG: (f32, f32) = (5.1303, 14.0954);
const AT_75_DEG: (f32, f32) = (3.8823, 14.4889);
const AT_85_DEG: (f32, f32) = (1.3073, 14.9429);

/// Four sectors of 90° that reach 8° further while they hold; the press is 2 N, the direction 0.3 N.
const SUPER_MARIO: &[Step] = &[
    press(RIGHT, 1.0, 300, &[(1, X, 1), (301, X, 0)]),
    press(UP, 0.29, 200, &[]),
    press(DOWN, 0.31, 200, &[(1, Y, 1), (201, Y, 0)]),
    // Seven millimetres are inside the centre, where no direction counts; ten are not.
    press((7.0, 0.0), 1.0, 100, &[]),
    press((10.0, 0.0), 1.0, 100, &[(1, X, 1), (101, X, 0)]),
    // Just too light to press, and just enough. The tap comes when it is over, and lasts 40 ms.
    press(LEFT, 1.9, 200, &[(0, X, -1), (201, X, 0)]),
    press(CENTRE, 1.95, 100, &[]),
    press(CENTRE, 2.05, 100, &[(101, SOUTH, 1), (141, SOUTH, 0)]),
    press(UP, 3.2, 200, &[(0, Y, -1), (201, Y, 0), (201, SOUTH, 1), (241, SOUTH, 0)]),
    // Pressed for a little less than 400 ms, a little more, and much more.
    press(RIGHT, 3.2, 395, &[(0, X, 1), (396, X, 0), (396, SOUTH, 1), (436, SOUTH, 0)]),
    press(RIGHT, 3.2, 405, &[(0, X, 1), (401, EAST, 1), (406, X, 0), (441, EAST, 0)]),
    press(DOWN, 3.2, 600, &[(0, Y, 1), (401, EAST, 1), (601, Y, 0), (601, EAST, 0)]),
    // The border at 45° is 53° on the way up and 37° on the way back.
    roll(RIGHT, &[(1, X, 1)]),
    roll(AT_50_DEG, &[]),
    roll(AT_65_DEG, &[(1, X, 0), (1, Y, -1)]),
    roll(AT_40_DEG, &[]),
    press(AT_25_DEG, 1.0, 100, &[(1, Y, 0), (1, X, 1), (101, X, 0)]),
];

/// Four sectors of 60° with zones of 30° between them, where the last direction stays.
const TETRIS: &[Step] = &[
    press(LEFT, 1.0, 100, &[(1, X, -1), (101, X, 0)]),
    press(RIGHT, 1.0, 100, &[(1, X, 1), (101, X, 0)]),
    press(DOWN, 1.0, 300, &[(1, Y, 1), (301, Y, 0)]),
    press(UP, 0.29, 100, &[]),
    press(UP, 0.31, 100, &[(1, Y, -1), (101, Y, 0)]),
    press(CENTRE, 1.95, 100, &[]),
    press(CENTRE, 2.05, 100, &[(101, SOUTH, 1), (141, SOUTH, 0)]),
    press(CENTRE, 3.2, 500, &[(401, EAST, 1), (501, EAST, 0)]),
    // A short stab at a side: the direction, too, is held for 40 ms.
    press(LEFT, 1.0, 20, &[(1, X, -1), (41, X, 0)]),
    roll(RIGHT, &[(1, X, 1)]),
    roll(AT_55_DEG, &[]),
    roll(AT_75_DEG, &[(1, X, 0), (1, Y, -1)]),
    roll(AT_35_DEG, &[]),
    press(AT_15_DEG, 1.0, 100, &[(1, Y, 0), (1, X, 1), (101, X, 0)]),
];

/// As Tetris; at the end the line breaks while the thumb still steers and presses.
const TANK_BATTLE: &[Step] = &[
    press(UP, 1.0, 100, &[(1, Y, -1), (101, Y, 0)]),
    press(LEFT, 1.95, 100, &[(0, X, -1), (101, X, 0)]),
    press(LEFT, 2.05, 100, &[(0, X, -1), (101, X, 0), (101, SOUTH, 1), (141, SOUTH, 0)]),
    press(DOWN, 3.2, 395, &[(0, Y, 1), (396, Y, 0), (396, SOUTH, 1), (436, SOUTH, 0)]),
    press(DOWN, 3.2, 450, &[(0, Y, 1), (401, EAST, 1), (451, Y, 0), (451, EAST, 0)]),
    roll(UP, &[(1, Y, -1)]),
    roll(AT_35_DEG, &[]),
    roll(AT_15_DEG, &[(1, Y, 0), (1, X, 1)]),
    roll(AT_55_DEG, &[]),
    press(AT_75_DEG, 1.0, 100, &[(1, X, 0), (1, Y, -1), (101, Y, 0)]),
    Step { rest_ms: 0, ..press(RIGHT, 3.2, 600, &[(0, X, 1), (401, EAST, 1)]) },
];

/// Eight sectors of 45° that reach 8° further while they hold; a press jumps at once, a push forward fires.
const CONTRA: &[Step] = &[
    press(RIGHT, 3.2, 100, &[(0, X, 1), (1, SOUTH, 1), (101, X, 0), (101, SOUTH, 0)]),
    press(AT_45_DEG, 1.0, 100, &[(1, X, 1), (1, Y, -1), (101, X, 0), (101, Y, 0)]),
    press(LEFT, 1.95, 100, &[(0, X, -1), (101, X, 0)]),
    press(CENTRE, 2.05, 100, &[(1, SOUTH, 1), (101, SOUTH, 0)]),
    // Fire: 1.2 N along +y, in no other direction.
    push(CENTRE, (0.0, 1.9, 1.0), 100, &[(1, EAST, 1), (101, EAST, 0)]),
    push(CENTRE, (0.0, 1.17, 1.0), 100, &[]),
    push(CENTRE, (0.0, 1.23, 1.0), 100, &[(1, EAST, 1), (101, EAST, 0)]),
    push(CENTRE, (0.0, -1.9, 1.0), 100, &[]),
    push(CENTRE, (1.9, 0.0, 1.0), 100, &[]),
    // Run, jump and fire at once; then a stab of 10 ms, after which everything is held for 40 ms.
    push(
        LEFT,
        (0.0, 1.9, 3.2),
        300,
        &[(0, X, -1), (1, SOUTH, 1), (1, EAST, 1), (301, X, 0), (301, SOUTH, 0), (301, EAST, 0)],
    ),
    push(
        DOWN,
        (0.0, 1.9, 3.2),
        10,
        &[(0, Y, 1), (1, SOUTH, 1), (1, EAST, 1), (40, Y, 0), (41, SOUTH, 0), (41, EAST, 0)],
    ),
    // Right, right and up, up: the borders at 22.5° and 67.5° are 30.5° and 75.5° on the way.
    roll(RIGHT, &[(1, X, 1)]),
    roll(AT_25_DEG, &[]),
    roll(AT_40_DEG, &[(1, Y, -1)]),
    roll(AT_70_DEG, &[]),
    press(AT_85_DEG, 1.0, 100, &[(1, X, 0), (101, Y, 0)]),
];

/// Contra on a keyboard: the same, with arrow keys.
const CONTRA_KEYS: &[Step] = &[
    press(RIGHT, 3.2, 100, &[(0, "KEY_RIGHT", 1), (1, "KEY_Z", 1), (101, "KEY_RIGHT", 0), (101, "KEY_Z", 0)]),
    press(LEFT, 1.0, 100, &[(1, "KEY_LEFT", 1), (101, "KEY_LEFT", 0)]),
    press(UP, 1.0, 100, &[(1, "KEY_UP", 1), (101, "KEY_UP", 0)]),
    press(DOWN, 1.0, 100, &[(1, "KEY_DOWN", 1), (101, "KEY_DOWN", 0)]),
    push(CENTRE, (0.0, 1.9, 1.0), 100, &[(1, "KEY_X", 1), (101, "KEY_X", 0)]),
];

/// The event log that the steps must come to, line for line.
fn expected_log(device: &str, steps: &[Step]) -> Vec<String> {
    let mut lines = Vec::new();
    let mut start_ms = FIRST_REST_MS;
    for step in steps {
        lines.extend(step.expected.iter().map(|(after_ms, code, value)| {
            let t_us = (start_ms + after_ms) * 1000;
            format!(r#"{{"t_us":{t_us},"device":"{device}","code":"{code}","value":{value}}}"#)
        }));
        start_ms += step.hold_ms + step.rest_ms;
    }
    lines
}

/// The steps as the pad takes them.
fn contacts_json(steps: &[Step]) -> String {
    let mut json = String::new();
    for Step { at_mm: (x, y), force_n: (fx, fy, fz), hold_ms, rest_ms, .. } in steps {
        let comma = if json.is_empty() { "[" } else { "," };
        let force = format!(r#""fx_n":{fx},"fy_n":{fy},"fz_n":{fz}"#);
        write!(json, r#"{comma}{{"x_mm":{x},"y_mm":{y},{force},"ms":{hold_ms},"rest_ms":{rest_ms}}}"#)
            .unwrap();
    }
    json + "]"
}

/// Starts the pad; returns it with the path of its terminal.
fn start_pad(contacts: &str) -> (Child, String) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bridge/stranger/pad.py");
    let mut pad = Command::new("python3")
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    pad.stdin.take().unwrap().write_all(contacts.as_bytes()).unwrap();
    let mut path = String::new();
    BufReader::new(pad.stdout.take().unwrap()).read_line(&mut path).unwrap();
    (pad, path.trim().to_owned())
}

/// Plays the steps on a pad and returns the lines of the event log.
fn play(profile: &str, steps: &[Step]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("events");
    let (pad, port) = start_pad(&contacts_json(steps));
    let mut run = Command::new(TACTPAD)
        .args(["run", "--pad", &format!("serial:{port}"), "--profile", profile])
        .args(["--output", &format!("log:{}", log.display())])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let pad = pad.wait_with_output().unwrap();
    // The run may have ended by itself, which the status below tells.
    let _ = kill_process(Pid::from_child(&run), Signal::TERM);
    let status = run.wait().unwrap();
    let mut said = String::new();
    run.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert!(pad.status.success(), "{profile}: {}{said}", String::from_utf8_lossy(&pad.stderr));
    assert_eq!(status.code(), Some(0), "{profile}: {said}");
    fs::read_to_string(log).unwrap().lines().map(str::to_owned).collect()
}

/// Contra's own text, with the other output chosen.
fn write_contra_for_keyboard(path: &Path) {
    let shown = Command::new(TACTPAD).args(["profile", "show", "contra"]).output().unwrap();
    let text = String::from_utf8(shown.stdout).unwrap();
    fs::write(path, text.replace(r#"output = "gamepad""#, r#"output = "keyboard""#)).unwrap();
}

/// Leaves out when: the line breaks at a moment that only the machine knows.
fn without_time(line: &str) -> &str {
    line.split_once(',').unwrap().1
}

#[test]
fn a_pad_made_from_the_specification_plays_every_profile() {
    if require("python3", "apt install python3") {
        in_guest("stranger::a_pad_made_from_the_specification_plays_every_profile", every_profile_is_played);
    }
}

fn every_profile_is_played() {
    let folder = tempfile::tempdir().unwrap();
    let keys = folder.path().join("keys.toml");
    write_contra_for_keyboard(&keys);
    thread::scope(|scope| {
        for (profile, device, steps) in [
            ("super-mario", "gamepad", SUPER_MARIO),
            ("tetris", "gamepad", TETRIS),
            ("contra", "gamepad", CONTRA),
            (keys.to_str().unwrap(), "keyboard", CONTRA_KEYS),
        ] {
            scope.spawn(move || assert_eq!(play(profile, steps), expected_log(device, steps), "{profile}"));
        }
        scope.spawn(|| {
            let mut log = play("tank-battle", TANK_BATTLE);
            let released = log.split_off(log.len().saturating_sub(2));
            assert_eq!(log, expected_log("gamepad", TANK_BATTLE));
            let mut released: Vec<_> = released.iter().map(|line| without_time(line)).collect();
            released.sort_unstable();
            assert_eq!(
                released,
                [
                    r#""device":"gamepad","code":"ABS_HAT0X","value":0}"#,
                    r#""device":"gamepad","code":"BTN_EAST","value":0}"#,
                ],
                "the line broke: both are let go"
            );
        });
    });
}
