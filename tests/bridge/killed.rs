//! Keys that a killed bridge leaves down on an X server: its guardian lifts them, and where that is killed, too, the next bridge.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::thread;
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use tactpad::bridge::sink::Sink;
use tactpad::bridge::sink::x11::{HeldRecords, LeftDown, Treatment, X11Sink, left_down};
use tactpad::numeric::random::SplitMix64;
use tactpad::pipeline::control::Code;
use x11rb::protocol::xproto::{BUTTON_PRESS_EVENT, KEY_PRESS_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::wrapper::ConnectionExt as _;

use crate::presses::write_capture;
use crate::running::{Running, comes_true};
use crate::support::require;
use crate::x11::{Server, X, Z, event, put};

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");

/// A key of other programs.
const Q: u16 = 16;

fn records(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.filter(|path| path.to_str().unwrap().contains("tactpad-x11-")).collect()
}

/// Presses keys and buttons, by the server's numbers, as a program that has nothing to do with a pad.
fn press(server: &Server, presses: &[(u8, u8)]) {
    let (connection, _) = x11rb::connect(Some(&server.display)).unwrap();
    for (kind, number) in presses {
        connection.xtest_fake_input(*kind, *number, x11rb::CURRENT_TIME, x11rb::NONE, 0, 0, 0).unwrap();
    }
    connection.sync().unwrap();
}

/// A record of a bridge that died on this display, with these numbers of the server.
fn dead_record(folder: &Path, display: &str, down: &[u8]) -> PathBuf {
    let marks: String = (0..=u8::MAX).map(|number| if down.contains(&number) { '1' } else { '0' }).collect();
    let path = folder.join(format!("tactpad-x11-{}", 40 + records(folder).len()));
    fs::write(&path, format!("tactpad x11 1\n{display}\n{marks}\n")).unwrap();
    path
}

/// A bridge that plays a capture on the server, and holds a key.
fn pressing(server: &Server) -> Running {
    let folder = tempfile::tempdir().unwrap();
    let pad = format!("capture:{}", write_capture(folder.path()).display());
    let mut program = Running::program(TACTPAD, folder.path());
    program.args(["run", "--pad", &pad, "--output", "x11"]).env("DISPLAY", &server.display);
    let bridge = Running::start(folder, program);
    assert!(comes_true(|| server.keys_down() > 0), "nothing is pressed: {}", bridge.told());
    bridge
}

/// The guardians of bridges that have their records in this folder.
fn guardians(folder: &Path) -> Vec<Pid> {
    let is_guardian = |path: &Path| {
        let line = fs::read(path.join("cmdline")).unwrap_or_default();
        let words: Vec<&[u8]> = line.split(|byte| *byte == 0).collect();
        words.get(1) == Some(&b"guard-keys".as_slice())
            && words.get(2).is_some_and(|record| record.starts_with(folder.as_os_str().as_bytes()))
    };
    let processes = fs::read_dir("/proc").unwrap().flatten().map(|entry| entry.path());
    let found = processes.filter(|path| is_guardian(path));
    found.filter_map(|path| Pid::from_raw(path.file_name()?.to_str()?.parse().ok()?)).collect()
}

/// A program that was killed with its guardian while it held a key on the server.
fn killed(server: &Server) -> Running {
    let mut bridge = pressing(server);
    let guardians = guardians(bridge.folder.path());
    assert_eq!(guardians.len(), 1);
    guardians.iter().for_each(|guardian| kill_process(*guardian, Signal::KILL).unwrap());
    bridge.signal(Signal::KILL);
    assert!(bridge.ends().is_some());
    assert!(server.keys_down() > 0, "an X server releases nothing");
    bridge
}

fn asked(bridge: &Running, server: &Server, line: &str) -> Output {
    let mut program = Running::program(TACTPAD, bridge.folder.path());
    program.args(line.split(' ')).env("DISPLAY", &server.display);
    program.stdout(std::process::Stdio::piped()).output().unwrap()
}

/// So many servers at once, each with a bridge.
const SERVERS: u64 = 5;

/// How often a bridge is killed, and by what draws: `TACTPAD_KILLS`.
fn kills() -> u64 {
    std::env::var("TACTPAD_KILLS").map_or(50, |kills| kills.parse().unwrap())
}

#[test]
fn a_bridge_that_is_killed_at_any_moment_leaves_nothing_down() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    thread::scope(|scope| {
        for first in 0..SERVERS {
            scope.spawn(move || {
                let server = Server::start();
                (first..kills())
                    .step_by(SERVERS as usize)
                    .for_each(|seed| leaves_nothing_down(&server, seed));
            });
        }
    });
}

/// Kills a bridge at a moment and in a way that are drawn.
#[expect(clippy::disallowed_methods, reason = "the moment is drawn: nothing is waited for")]
fn leaves_nothing_down(server: &Server, seed: u64) {
    let mut random = SplitMix64::new(seed);
    let mut bridge = pressing(server);
    thread::sleep(Duration::from_millis(random.next_bits() % 300));
    // Of SEGV and BUS Rust takes the first, to look whether a stack is full.
    let signals = [Signal::KILL, Signal::ILL, Signal::TRAP, Signal::SYS];
    let signal = signals[random.next_bits() as usize % signals.len()];
    bridge.signal(signal);
    assert!(bridge.ends().is_some());
    assert!(comes_true(|| server.keys_down() == 0), "kill {seed} by {signal:?}: {} down", server.keys_down());
    assert!(comes_true(|| guardians(bridge.folder.path()).is_empty()), "kill {seed}: its guardian goes on");
    assert_eq!(records(bridge.folder.path()).len(), 0, "kill {seed}");
}

#[test]
fn a_bridge_that_ends_takes_its_guardian_with_it() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let mut bridge = pressing(&server);
    let folder = bridge.folder.path().to_owned();
    // As a service's end asks all of its processes.
    guardians(&folder).iter().for_each(|guardian| kill_process(*guardian, Signal::TERM).unwrap());
    bridge.signal(Signal::TERM);
    assert!(bridge.ends().is_some());
    assert_eq!(server.keys_down(), 0);
    assert!(comes_true(|| guardians(&folder).is_empty()));
}

#[test]
fn the_next_start_lifts_what_a_killed_bridge_held_and_doctor_tells_it_before() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let bridge = killed(&server);
    press(&server, &[(KEY_PRESS_EVENT, Q as u8 + 8)]);
    let found = || -> Option<Value> {
        let report: Value = serde_json::from_slice(&asked(&bridge, &server, "doctor --json").stdout).unwrap();
        report["checks"].as_array().unwrap().iter().find(|check| check["name"] == "X11 keys").cloned()
    };
    let check = found().unwrap();
    assert_eq!((&check["finding"], &check["mend"]), (&"bad".into(), &"tactpad ctl panic".into()));
    assert!(check["message"].as_str().unwrap().contains("KEY_"), "{check}");
    // Wherever events go now.
    let next = asked(&bridge, &server, "run --pad virtual --output none --seconds 0.1");
    let told = String::from_utf8_lossy(&next.stderr);
    assert!(told.contains("a bridge that was killed left KEY_") && told.contains(": released"), "{told}");
    assert_eq!((server.keys_down(), server.is_down(Q)), (1, true), "another program's key stays");
    assert_eq!((found(), records(bridge.folder.path()).len()), (None, 0));
}

#[test]
fn panic_lifts_what_a_killed_bridge_held() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let bridge = killed(&server);
    let answer = asked(&bridge, &server, "ctl panic");
    assert_eq!(answer.status.code(), Some(0), "{}", String::from_utf8_lossy(&answer.stderr));
    assert_eq!((server.keys_down(), records(bridge.folder.path()).len()), (0, 0));
    assert_eq!(asked(&bridge, &server, "ctl panic").status.code(), Some(1), "nobody is left to ask");
}

#[test]
fn what_the_living_and_other_programs_hold_stays_down() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let folder = tempfile::tempdir().unwrap();
    let [z, x, q] = [Z, X, Q].map(|key| key as u8 + 8);
    dead_record(folder.path(), &server.display, &[3, z, x]);
    press(&server, &[(BUTTON_PRESS_EVENT, 3), (KEY_PRESS_EVENT, z), (KEY_PRESS_EVENT, q)]);
    // The same screen by another name.
    let display = format!("{}.0", server.display);
    let mut living =
        X11Sink::open(Some(&display), Some(HeldRecords { folder: folder.path(), guardian: None })).unwrap();
    put(&mut living, &[event(X, 1)]);
    let codes = vec![Code::Key(0x111), Code::Key(Z)];
    let expected = [LeftDown::Held { display: server.display.clone(), codes }];
    assert_eq!(left_down(folder.path(), Treatment::Look), expected);
    assert!(server.is_down(Z), "who looks changes nothing");
    assert_eq!(left_down(folder.path(), Treatment::Lift), expected);
    assert_eq!([Z, X, Q].map(|key| server.is_down(key)), [false, true, true]);
    assert_eq!(left_down(folder.path(), Treatment::Lift), []);
    drop(living);
    assert_eq!((server.is_down(X), records(folder.path()).len()), (false, 0), "a clean end leaves no record");
}

#[test]
fn what_is_recorded_and_not_down_is_not_told() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let folder = tempfile::tempdir().unwrap();
    dead_record(folder.path(), &server.display, &[Z as u8 + 8]);
    assert_eq!(left_down(folder.path(), Treatment::Look), []);
    assert_eq!(records(folder.path()).len(), 1, "who looks removes nothing");
    assert_eq!(left_down(folder.path(), Treatment::Lift), []);
    // With a server that is gone nothing is down either.
    dead_record(folder.path(), ":65000", &[Z as u8 + 8]);
    assert_eq!(left_down(folder.path(), Treatment::Lift), []);
    assert_eq!(records(folder.path()).len(), 0);
}

#[test]
fn a_damaged_record_is_told_once_and_lifts_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = dead_record(folder.path(), ":0\n:1", &[Z as u8 + 8]);
    let told = [LeftDown::Damaged { path }];
    assert_eq!(left_down(folder.path(), Treatment::Look), told);
    assert_eq!(left_down(folder.path(), Treatment::Lift), told);
    assert_eq!(left_down(folder.path(), Treatment::Lift), []);
}

#[test]
fn a_key_is_recorded_before_it_goes_down_and_until_its_release_is_done() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let folder = tempfile::tempdir().unwrap();
    let mut sink =
        X11Sink::open(Some(&server.display), Some(HeldRecords { folder: folder.path(), guardian: None }))
            .unwrap();
    let is_recorded = |key: u16| {
        let text = fs::read_to_string(&records(folder.path())[0]).unwrap();
        text.lines().nth(2).unwrap().as_bytes()[usize::from(key) + 8] == b'1'
    };
    assert!(!is_recorded(Z));
    server.stop();
    sink.write(&[event(Z, 1)]).unwrap();
    assert!(comes_true(|| is_recorded(Z)), "it is not down yet: the server stands still");
    sink.write(&[event(Z, 0)]).unwrap();
    assert!(comes_true(|| sink.waiting() == 0));
    assert!(is_recorded(Z), "the server has not read of the release");
    server.go_on();
    put(&mut sink, &[event(X, 1)]);
    assert_eq!([Z, X].map(is_recorded), [false, true]);
    put(&mut sink, &[event(X, 0)]);
    assert!(!is_recorded(X));
}

#[test]
fn a_server_that_stands_still_keeps_no_start_waiting_and_is_lifted_when_it_goes_on() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let folder = tempfile::tempdir().unwrap();
    dead_record(folder.path(), &server.display, &[Z as u8 + 8]);
    press(&server, &[(KEY_PRESS_EVENT, Z as u8 + 8)]);
    server.stop();
    let expected = [LeftDown::Unanswered { display: server.display.clone(), codes: vec![Code::Key(Z)] }];
    assert_eq!(left_down(folder.path(), Treatment::Lift), expected);
    server.go_on();
    assert!(comes_true(|| !server.is_down(Z) && records(folder.path()).is_empty()));
}
