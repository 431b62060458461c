//! What signals and a closed terminal do to a bridge that holds keys.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

use rustix::fs::{Mode, OFlags, open};
use rustix::process::Signal;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use x11rb::protocol::xproto::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

use crate::presses::write_capture;
use crate::running::{Running, comes_true};
use crate::support::require;
use crate::x11::Server;

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");

/// An X server and what it takes for held.
struct Keys {
    server: Server,
    connection: RustConnection,
}

impl Keys {
    fn start() -> Self {
        let server = Server::start();
        let (connection, _) = x11rb::connect(Some(&server.display)).unwrap();
        Self { server, connection }
    }

    fn are_held(&self) -> bool {
        let map = self.connection.query_keymap().unwrap().reply().unwrap();
        map.keys.iter().any(|byte| *byte != 0)
    }

    /// Waits for the next press, of which there are 2 seconds left then.
    fn await_press(&self) {
        assert!(comes_true(|| !self.are_held()), "held for too long");
        assert!(comes_true(|| self.are_held()), "nothing is pressed");
    }

    /// The program plays long presses on the X server.
    fn play(&self) -> Running {
        let folder = tempfile::tempdir().unwrap();
        let pad = format!("capture:{}", write_capture(folder.path()).display());
        let mut program = Running::program(TACTPAD, folder.path());
        program.args(["run", "--pad", &pad, "--output", "x11"]).env("DISPLAY", &self.server.display);
        Running::start(folder, program)
    }
}

#[test]
fn ctrl_z_releases_then_stops_and_the_shell_brings_it_back() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let keys = Keys::start();
    let mut bridge = keys.play();
    for _ in 0..2 {
        keys.await_press();
        bridge.signal(Signal::TSTP);
        assert!(comes_true(|| bridge.state() == 'T'), "it is not stopped");
        assert!(!keys.are_held(), "keys stay down while it is stopped");
        bridge.signal(Signal::CONT);
        assert!(comes_true(|| bridge.status()["state"] == "playing"), "{}", bridge.status());
        keys.await_press();
    }
    bridge.signal(Signal::TERM);
    assert_eq!(bridge.ends().and_then(|status| status.code()), Some(0));
}

#[test]
fn ctrl_backslash_releases_and_ends() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let keys = Keys::start();
    let mut bridge = keys.play();
    keys.await_press();
    bridge.signal(Signal::QUIT);
    assert_eq!(bridge.ends().and_then(|status| status.code()), Some(0));
    assert!(!keys.are_held(), "keys stay down");
}

/// The master of a new pseudo-terminal, and the program on it as a shell would start it.
fn on_a_terminal(folder: &Path, arguments: &[&str]) -> (File, Command) {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let path = ptsname(&master, Vec::new()).unwrap();
    let slave =
        open(path.as_c_str(), OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty()).unwrap();
    // A session of its own, whose controlling terminal is its standard input.
    let mut program = Running::program("setsid", folder);
    program.arg("--ctty").args(arguments).stdin(Stdio::from(slave));
    (master.into(), program)
}

#[test]
fn a_closed_terminal_releases_and_ends_whatever_plays() {
    if !require("Xvfb", "apt-get install xvfb") || !require("setsid", "apt-get install util-linux") {
        return;
    }
    let keys = Keys::start();
    for verb in ["run", "record game.cap", "latency --seconds 60", "demo --seconds 60"] {
        let folder = tempfile::tempdir().unwrap();
        let pad = format!("capture:{}", write_capture(folder.path()).display());
        let mut arguments: Vec<_> = [TACTPAD].into_iter().chain(verb.split(' ')).collect();
        arguments.extend(["--output", "x11"]);
        if !verb.starts_with("demo") {
            arguments.extend(["--pad", &pad]);
        }
        let (terminal, mut program) = on_a_terminal(folder.path(), &arguments);
        program.env("DISPLAY", &keys.server.display);
        let mut bridge = Running::start(folder, program);
        keys.await_press();
        assert!(!bridge.has_ended(), "{verb}: {}", bridge.told());
        drop(terminal);
        assert!(bridge.ends().is_some(), "{verb} plays on");
        assert!(!keys.are_held(), "{verb}: keys stay down");
    }
}

#[test]
fn a_bridge_in_the_background_ends_with_its_terminal_too() {
    if !require("setsid", "apt-get install util-linux") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let line = format!("set -m; {TACTPAD} run --pad virtual --output log:events & wait");
    let (terminal, program) = on_a_terminal(folder.path(), &["sh", "-c", &line]);
    let bridge = Running::start(folder, program);
    assert!(comes_true(|| bridge.status()["state"] == "playing"), "{}", bridge.told());
    // The shell dies of it, and passes nothing on to a process group in the background.
    drop(terminal);
    let has_ended = comes_true(|| bridge.ctl("status").status.code() == Some(1));
    bridge.ctl("quit");
    assert!(has_ended, "it plays on");
}

#[test]
fn a_bridge_under_nohup_outlives_its_terminal() {
    if !require("setsid", "apt-get install util-linux") || !require("nohup", "apt-get install coreutils") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let pad = format!("capture:{}", write_capture(folder.path()).display());
    let arguments = ["nohup", TACTPAD, "run", "--pad", &pad, "--output", "log:events"];
    let (terminal, program) = on_a_terminal(folder.path(), &arguments);
    let mut bridge = Running::start(folder, program);
    let log = bridge.folder.path().join("events");
    let length = || fs::metadata(&log).map_or(0, |log| log.len());
    assert!(comes_true(|| length() > 0), "it does not play");
    drop(terminal);
    bridge.signal(Signal::HUP);
    let before = length();
    assert!(comes_true(|| length() > before), "it plays no more");
    assert!(
        !bridge.told().contains("profile "),
        "it was not asked to read its profile again: {}",
        bridge.told()
    );
    bridge.signal(Signal::TERM);
    assert_eq!(bridge.ends().and_then(|status| status.code()), Some(0));
}

#[test]
fn without_a_terminal_a_hang_up_reloads_and_so_does_ctl() {
    if !require("setsid", "apt-get install util-linux") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let shown = Running::program(TACTPAD, folder.path())
        .args(["profile", "show", "contra"])
        .stdout(Stdio::piped())
        .output();
    let shown = String::from_utf8(shown.unwrap().stdout).unwrap();
    let mine = folder.path().join("mine.toml");
    let name = |name: &str| {
        fs::write(&mine, shown.replace(r#"name = "Contra""#, &format!("name = \"{name}\""))).unwrap();
    };
    name("First");
    let mut program = Running::program("setsid", folder.path());
    program.args([TACTPAD, "run", "--pad", "virtual", "--output", "none", "--profile", "mine.toml"]);
    let bridge = Running::start(folder, program);
    let plays = |name: &str| comes_true(|| bridge.status()["profile"] == name);
    assert!(plays("First"), "{}", bridge.status());
    name("Second");
    bridge.signal(Signal::HUP);
    assert!(plays("Second"), "{}", bridge.status());
    name("Third");
    assert!(bridge.ctl("reload").status.success());
    assert!(plays("Third"), "{}", bridge.status());
    fs::write(&mine, "schema = 1\n").unwrap();
    let refused = bridge.ctl("reload");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("mine.toml"));
    assert!(plays("Third"), "a profile that cannot be used changes nothing");
}
