//! `tactpad ctl` and a bridge that plays on a virtual pad.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use rustix::event::{PollFd, Timespec, poll};
use serde_json::Value;

struct Running {
    folder: tempfile::TempDir,
    child: Child,
}

impl Running {
    fn start(arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let child = Self::program(folder.path())
            .arg("run")
            .args(arguments)
            .args(["--output", "log:events"])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(fs::File::create(folder.path().join("told")).unwrap())
            .spawn()
            .unwrap();
        Self { folder, child }
    }

    fn program(folder: &Path) -> Command {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tactpad"));
        program.current_dir(folder).env("XDG_RUNTIME_DIR", folder);
        program
    }

    fn ctl(&self, request: &str) -> Output {
        let words = request.split(' ');
        Self::program(self.folder.path()).arg("ctl").args(words).output().unwrap()
    }

    fn status(&self) -> Value {
        let output = self.ctl("status --json");
        serde_json::from_slice(&output.stdout).unwrap_or(Value::Null)
    }

    /// Waits until the status satisfies `holds`; panics after ten seconds.
    fn await_status(&self, what: &str, holds: impl Fn(&Value) -> bool) -> Value {
        for _ in 0..500 {
            let status = self.status();
            if holds(&status) {
                return status;
            }
            let pause = Timespec { tv_sec: 0, tv_nsec: 20_000_000 };
            poll(&mut [] as &mut [PollFd<'_>; 0], Some(&pause)).unwrap();
        }
        panic!("{what}: {}", self.status());
    }

    fn told(&self) -> String {
        fs::read_to_string(self.folder.path().join("told")).unwrap()
    }

    fn events(&self) -> usize {
        fs::read_to_string(self.folder.path().join("events")).unwrap_or_default().lines().count()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_bridge_is_asked_paused_changed_and_ended() {
    let mut bridge = Running::start(&["--pad", "virtual"]);
    let status = bridge.await_status("plays", |status| {
        status["state"] == "playing" && status["held"] != Value::Array(vec![])
    });
    assert_eq!((&status["pad"], &status["profile"]), (&"VIRTUAL-0001".into(), &"Super Mario".into()));
    assert_eq!(status["decoder"], "inverse");
    assert_eq!(status["health"]["frames_lost"], 0);

    assert!(bridge.ctl("pause").status.success());
    let status = bridge.await_status("pauses", |status| status["state"] == "paused");
    assert_eq!(status["held"], Value::Array(vec![]));
    let events = bridge.events();
    bridge.await_status("goes on hearing", |status| status["health"]["samples"].as_u64() > Some(3_000));
    assert_eq!(bridge.events(), events, "a paused bridge emits nothing");
    assert!(bridge.ctl("resume").status.success());
    bridge.await_status("plays again", |status| status["state"] == "playing" && bridge.events() > events);

    assert!(bridge.ctl("profile contra").status.success());
    assert_eq!(bridge.status()["profile"], "Contra");
    let refused = bridge.ctl("profile no-such-game");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("no-such-game"));
    assert_eq!(bridge.status()["profile"], "Contra");

    assert!(bridge.ctl("panic").status.success());
    assert!(bridge.ctl("tare").status.success());
    assert!(bridge.ctl("quit").status.success());
    assert!(bridge.child.wait().unwrap().success());
    let gone = bridge.ctl("status");
    assert_eq!(gone.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&gone.stderr).contains("tactpad run"));
}

#[test]
fn a_bridge_without_a_pad_waits_and_says_so() {
    let bridge = Running::start(&["--pad", "serial:pad", "--wait", "--decoder", "scdf"]);
    let status = bridge.await_status("waits", |status| status["state"] == "waiting");
    bridge.await_status("says so", |_| bridge.told().contains("waiting for the pad"));
    assert_eq!(status["decoder"], "network (scdf)");
    let listed = bridge.ctl("status").stdout;
    assert!(String::from_utf8_lossy(&listed).contains("decoder  network (scdf)"));
    let found = Running::program(bridge.folder.path()).arg("doctor").output().unwrap().stdout;
    assert!(String::from_utf8_lossy(&found).contains("decoder network (scdf)"));
}

#[test]
fn only_one_bridge_has_the_socket_and_a_dead_ones_is_taken_over() {
    let first = Running::start(&["--pad", "serial:pad", "--wait"]);
    first.await_status("waits", |status| status["state"] == "waiting");
    let second = Running::program(first.folder.path())
        .args(["run", "--pad", "virtual", "--output", "none", "--seconds", "1"])
        .output()
        .unwrap();
    assert!(second.status.success());
    assert!(String::from_utf8_lossy(&second.stderr).contains("does not reach this bridge"));
    assert_eq!(first.status()["state"], "waiting");

    let socket = first.folder.path().join("tactpad.sock");
    fs::remove_file(&socket).unwrap();
    drop(std::os::unix::net::UnixListener::bind(&socket).unwrap());
    let third = Running::program(first.folder.path())
        .args(["run", "--pad", "virtual", "--output", "none", "--seconds", "1"])
        .output()
        .unwrap();
    assert!(third.status.success() && !String::from_utf8_lossy(&third.stderr).contains("does not reach"));
}
