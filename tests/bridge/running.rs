//! The running program, watched and signalled from outside.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::time::Duration;

use rustix::event::{PollFd, Timespec, poll};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

use crate::clock::monotonic_ns;

/// Far longer than anything takes that is waited for, on a machine that does other work, too. It only bounds how long a
/// test takes that fails.
const LIMIT: Duration = Duration::from_secs(120);

/// How often is looked at what costs nothing.
const OFTEN_MS: i64 = 10;

/// Lets time pass.
fn pause(ms: i64) {
    let pause = Timespec { tv_sec: 0, tv_nsec: ms * 1_000_000 };
    poll(&mut [] as &mut [PollFd<'_>; 0], Some(&pause)).unwrap();
}

/// Waits until `holds`. Whether it came to hold.
pub(crate) fn comes_true(holds: impl FnMut() -> bool) -> bool {
    // In virtual time pauses cost nothing, and each question its work.
    let is_virtual = std::env::var_os("TACTPAD_IN_GUEST").is_some();
    comes_true_every(if is_virtual { 20 * OFTEN_MS } else { OFTEN_MS }, holds)
}

fn comes_true_every(pause_ms: i64, mut holds: impl FnMut() -> bool) -> bool {
    let begin_ns = monotonic_ns();
    loop {
        if holds() {
            return true;
        }
        if Duration::from_nanos(monotonic_ns() - begin_ns) > LIMIT {
            return false;
        }
        pause(pause_ms);
    }
}

/// A program with a folder of its own, where its socket is and what it told.
pub(crate) struct Running {
    pub(crate) folder: tempfile::TempDir,
    child: Child,
}

impl Running {
    /// The program `name`, in `folder`. No signal is ignored from the start, be this test itself under nohup.
    pub(crate) fn program(name: impl AsRef<OsStr>, folder: &Path) -> Command {
        let mut program = Command::new("env");
        program
            .arg("--default-signal")
            .arg(name)
            .current_dir(folder)
            // This test may itself run in a service.
            .env_remove("INVOCATION_ID")
            .env("XDG_RUNTIME_DIR", folder)
            .env("XDG_CONFIG_HOME", folder)
            .env("XDG_STATE_HOME", folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null());
        program
    }

    /// Starts `command` in `folder`.
    pub(crate) fn start(folder: tempfile::TempDir, command: Command) -> Self {
        let told = fs::File::create(folder.path().join("told")).unwrap();
        Self::start_telling(folder, command, told)
    }

    /// The same; what it tells goes elsewhere.
    pub(crate) fn start_telling(folder: tempfile::TempDir, mut command: Command, stderr: fs::File) -> Self {
        Self { child: command.stderr(stderr).spawn().unwrap(), folder }
    }

    pub(crate) fn told(&self) -> String {
        fs::read_to_string(self.folder.path().join("told")).unwrap_or_default()
    }

    pub(crate) fn ctl(&self, request: &str) -> Output {
        self.ctl_command(request).output().unwrap()
    }

    /// The same for a request whose answer may not come.
    pub(crate) fn ctl_begun(&self, request: &str) -> Child {
        self.ctl_command(request).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    }

    fn ctl_command(&self, request: &str) -> Command {
        let mut ctl = Command::new(env!("CARGO_BIN_EXE_tactpad"));
        ctl.env("XDG_RUNTIME_DIR", self.folder.path()).arg("ctl").args(request.split(' '));
        ctl
    }

    pub(crate) fn status(&self) -> Value {
        serde_json::from_slice(&self.ctl("status --json").stdout).unwrap_or(Value::Null)
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.child), signal).unwrap();
    }

    /// Waits for its end; how it ended.
    pub(crate) fn ends(&mut self) -> Option<ExitStatus> {
        comes_true_every(OFTEN_MS, || self.has_ended());
        self.child.try_wait().unwrap()
    }

    pub(crate) fn has_ended(&mut self) -> bool {
        self.child.try_wait().unwrap().is_some()
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// The kernel's letter for what the process does: `T` is stopped.
    pub(crate) fn state(&self) -> char {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.id())).unwrap();
        stat.rsplit(") ").next().and_then(|rest| rest.chars().next()).unwrap()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        if std::thread::panicking() {
            let _ = std::io::Write::write_all(&mut std::io::stderr(), self.told().as_bytes());
        }
    }
}
