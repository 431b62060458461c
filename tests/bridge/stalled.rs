//! Readers that stall: a log or a capture that nobody takes must not keep the bridge from playing and from ending.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::time::Duration;

use rustix::fs::{CWD, FileType, Mode, OFlags, mknodat};
use rustix::pipe::fcntl_setpipe_size;
use rustix::process::Signal;
use serde_json::Value;

use crate::clock::monotonic_ns;
use crate::guest::in_guest;
use crate::running::{Running, comes_true};
use crate::support::require;
use crate::x11::Server;
use tactpad::pipeline::mapping::read::shipped;

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");

/// It is to end within this time.
const END_LIMIT: Duration = Duration::from_secs(1);

fn make_pipe(folder: &Path) -> PathBuf {
    let path = folder.join("pipe");
    mknodat(CWD, &path, FileType::Fifo, Mode::RWXU, 0).unwrap();
    path
}

/// A pipe holds little where nobody is to read it, and seconds where somebody does, who may be kept from it.
const SMALL_BYTES: usize = 4_096;
const LARGE_BYTES: usize = 1 << 20;

/// A reader that takes nothing until it is told to, on a pipe that holds little.
fn open_reader(path: &Path) -> File {
    let flags = OFlags::NONBLOCK.bits().cast_signed();
    let reader = OpenOptions::new().read(true).custom_flags(flags).open(path).unwrap();
    fcntl_setpipe_size(&reader, SMALL_BYTES).unwrap();
    reader
}

fn start(folder: tempfile::TempDir, line: &str) -> Running {
    let mut program = Running::program(TACTPAD, folder.path());
    program.args(line.split(' '));
    Running::start(folder, program)
}

/// Asks the bridge to end, and sees that it does so in time; how it ended.
fn ended(bridge: &mut Running) -> ExitStatus {
    let asked_ns = monotonic_ns();
    bridge.signal(Signal::TERM);
    let status = bridge.ends().unwrap();
    let took = Duration::from_nanos(monotonic_ns() - asked_ns);
    assert!(took <= END_LIMIT, "it ended after {took:?}: {}", bridge.told());
    status
}

/// What a reader of the log has read so far, and takes for held.
#[derive(Default)]
struct Log {
    unfinished: Vec<u8>,
    lines: usize,
    held: BTreeMap<String, i64>,
}

impl Log {
    /// Takes what is there. A control that is said to be what it already was is a surprise.
    fn read(&mut self, reader: &mut File) {
        let mut bytes = [0; 4_096];
        while let Ok(read @ 1..) = reader.read(&mut bytes) {
            self.unfinished.extend_from_slice(&bytes[..read]);
            while let Some(end) = self.unfinished.iter().position(|byte| *byte == b'\n') {
                let line: Vec<u8> = self.unfinished.drain(..=end).collect();
                self.take(&serde_json::from_slice(&line).unwrap());
            }
        }
    }

    fn take(&mut self, line: &Value) {
        let (code, value) = (line["code"].to_string(), line["value"].as_i64().unwrap());
        self.lines += 1;
        if !code.contains("REL_") {
            assert_ne!(self.held.insert(code, value).unwrap_or(0), value, "{line} says what was said before");
        }
    }
}

#[test]
fn a_log_that_is_not_read_loses_whole_groups_and_nothing_else() {
    in_guest("stalled::a_log_that_is_not_read_loses_whole_groups_and_nothing_else", log_not_read);
}

fn log_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = make_pipe(folder.path());
    let mut reader = open_reader(&path);
    let line = format!("run --pad virtual --profile pointer --output log:{}", path.display());
    let mut bridge = start(folder, &line);
    let dropped = |bridge: &Running| bridge.status()["health"]["groups_dropped"].as_u64();
    assert!(comes_true(|| dropped(&bridge) > Some(0)), "{}", bridge.status());
    assert_eq!(bridge.status()["state"], "playing");
    let told = |bridge: &Running| bridge.told().matches("events are not taken in time").count();
    assert!(comes_true(|| told(&bridge) == 1), "{}", bridge.told());

    let mut log = Log::default();
    fcntl_setpipe_size(&reader, LARGE_BYTES).unwrap();
    assert!(comes_true(|| {
        log.read(&mut reader);
        log.lines > 1_000
    }));
    log.read(&mut reader);
    let (counted, lines) = (dropped(&bridge), log.lines);
    assert!(comes_true(|| {
        log.read(&mut reader);
        log.lines > lines + 100
    }));
    assert_eq!(dropped(&bridge), counted, "who reads again loses nothing");

    // In a second the pipe is full again. It cannot be made to hold less than is in it.
    assert!(comes_true(|| {
        log.read(&mut reader);
        fcntl_setpipe_size(&reader, SMALL_BYTES).is_ok()
    }));
    let samples = |bridge: &Running| bridge.status()["health"]["samples"].as_u64().unwrap();
    let later = samples(&bridge) + 1_000;
    assert!(comes_true(|| samples(&bridge) > later));
    assert_eq!(told(&bridge), 1);
    assert_eq!(ended(&mut bridge).code(), Some(0), "{}", bridge.told());
    log.read(&mut reader);
    assert_eq!(log.unfinished, b"", "a line in part");
}

#[test]
fn a_capture_that_is_not_read_does_not_hold_up_the_end_and_is_told() {
    in_guest("stalled::a_capture_that_is_not_read_does_not_hold_up_the_end_and_is_told", capture_not_read);
}

fn capture_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = make_pipe(folder.path());
    let _reader = open_reader(&path);
    let mut bridge = start(folder, &format!("record {}", path.display()));
    assert!(comes_true(|| bridge.status()["health"]["samples"].as_u64() > Some(1_000)));
    assert_eq!(ended(&mut bridge).code(), Some(1), "{}", bridge.told());
    assert!(bridge.told().contains("calls missing at its end"), "{}", bridge.told());
}

#[test]
fn a_pipe_that_nobody_reads_is_not_waited_for() {
    in_guest("stalled::a_pipe_that_nobody_reads_is_not_waited_for", pipe_without_reader);
}

fn pipe_without_reader() {
    for verb in ["run --pad virtual --output log:", "record "] {
        let folder = tempfile::tempdir().unwrap();
        let path = make_pipe(folder.path());
        let mut bridge = start(folder, &format!("{verb}{}", path.display()));
        assert!(comes_true(|| bridge.status()["state"] == "playing"), "{verb}: {}", bridge.told());
        assert!(bridge.told().contains("nobody reads the pipe"), "{verb}: {}", bridge.told());
        ended(&mut bridge);
    }
}

/// Contra with a line that is doubted whenever it is read: two buttons on one force.
fn doubtful_profile(folder: &Path) -> PathBuf {
    let path = folder.join("doubtful.toml");
    let button = "[[button]]\nforce = \"fz\"\npress_n = 4.0\nrelease_n = 3.0\nout = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\" }\n";
    std::fs::write(&path, format!("{}\n{button}", shipped::text("contra").unwrap())).unwrap();
    path
}

/// What is held at the end of an event log.
pub(crate) fn held(log: &Path) -> Vec<String> {
    let mut read = Log::default();
    read.read(&mut File::open(log).unwrap());
    read.held.into_iter().filter(|(_, value)| *value != 0).map(|(code, _)| code).collect()
}

/// Fills a pipe to the brim.
fn fill(pipe: &mut File) {
    while pipe.write(&[b'x'; 4_096]).is_ok() || pipe.write(b"x").is_ok() {}
}

#[test]
fn standard_error_that_nobody_reads_holds_nothing_up() {
    in_guest("stalled::standard_error_that_nobody_reads_holds_nothing_up", standard_error_not_read);
}

fn standard_error_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let (profile, pipe, log) =
        (doubtful_profile(folder.path()), make_pipe(folder.path()), folder.path().join("log"));
    let _reader = open_reader(&pipe);
    let mut program = Running::program(TACTPAD, folder.path());
    program.args(["run", "--pad", "virtual", "--profile"]).arg(&profile);
    program.arg("--output").arg(format!("log:{}", log.display()));
    let stderr = OpenOptions::new().write(true).open(&pipe).unwrap();
    let mut bridge = Running::start_telling(folder, program, stderr);
    assert!(comes_true(|| held(&log) != Vec::<String>::new()));
    let nonblocking = OFlags::NONBLOCK.bits().cast_signed();
    fill(&mut OpenOptions::new().write(true).custom_flags(nonblocking).open(&pipe).unwrap());
    assert!(bridge.ctl("reload").status.success());
    assert!(bridge.ctl("next-profile").status.success() || bridge.status()["state"] == "playing");
    assert!(comes_true(|| held(&log) != Vec::<String>::new()), "it plays on");
    assert!(bridge.ctl("pause").status.success());
    assert!(comes_true(|| held(&log).is_empty()), "{:?}", held(&log));
    assert!(bridge.ctl("panic").status.success());
    assert_eq!(ended(&mut bridge).code(), Some(0));
}

#[test]
fn the_first_and_the_last_word_of_a_run_wait_for_no_reader() {
    for (verb, code) in
        [("run --pad virtual --output none", 0), ("record game.cap", 0), ("run --pad serial:nowhere", 2)]
    {
        let folder = tempfile::tempdir().unwrap();
        let pipe = make_pipe(folder.path());
        let _reader = open_reader(&pipe);
        let nonblocking = OFlags::NONBLOCK.bits().cast_signed();
        fill(&mut OpenOptions::new().write(true).custom_flags(nonblocking).open(&pipe).unwrap());
        let mut program = Running::program(TACTPAD, folder.path());
        program.args(verb.split(' '));
        let stderr = OpenOptions::new().write(true).open(&pipe).unwrap();
        let mut bridge = Running::start_telling(folder, program, stderr);
        if code == 0 {
            assert!(comes_true(|| bridge.status()["state"] == "playing"), "{verb}");
            bridge.signal(Signal::TERM);
        }
        assert_eq!(bridge.ends().and_then(|status| status.code()), Some(code), "{verb}");
    }
}

#[test]
fn an_x_server_that_stands_still_is_not_waited_for_and_has_no_key_down_when_it_goes_on() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let folder = tempfile::tempdir().unwrap();
    let mut program = Running::program(TACTPAD, folder.path());
    program.args(["run", "--pad", "virtual", "--profile", "contra", "--output", "x11"]);
    program.env("DISPLAY", &server.display);
    let mut bridge = Running::start(folder, program);
    assert!(comes_true(|| bridge.status()["held"].as_array().is_some_and(|held| !held.is_empty())));
    server.stop();
    let presses = bridge.status()["health"]["contacts"].as_u64();
    assert!(comes_true(|| bridge.status()["health"]["contacts"].as_u64() > presses), "it plays on");
    assert!(comes_true(|| bridge.status()["held"].as_array().is_some_and(|held| !held.is_empty())));
    assert!(bridge.ctl("pause").status.success() && bridge.ctl("panic").status.success());
    server.go_on();
    assert!(comes_true(|| server.keys_down() == 0), "{} keys are down", server.keys_down());
    server.stop();
    bridge.signal(Signal::TERM);
    assert!(bridge.ends().is_some(), "{}", bridge.told());
    server.go_on();
}
