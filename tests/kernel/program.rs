//! Programs: those written in C for these tests, and processes that end with the test.

use std::fs::{self, File};
use std::os::fd::AsFd;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::Mutex;

use rustix::process::{Pid, PidfdFlags, Signal, kill_process, pidfd_open};

use crate::clock::{MS, monotonic_ns, readable_before};
use crate::guest::{inside, scratch};
use crate::support::require;

/// Whether the C program `name` beside this file is there to run; on the host, compiles it.
pub(crate) fn compiled(name: &str, libraries: &[String]) -> bool {
    if inside() {
        return true;
    }
    if !require("gcc", "apt-get install gcc libc6-dev") {
        return false;
    }
    // Two tests may want the same program at the same time.
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _turn = ONE_AT_A_TIME.lock();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/kernel").join(name).with_extension("c");
    let unfinished = scratch().join(format!("{name}.{}", std::process::id()));
    let status = Command::new("gcc")
        .args(["-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&unfinished)
        .arg(&source)
        .args(libraries)
        .status();
    assert!(status.expect("gcc").success(), "{} does not compile", source.display());
    fs::rename(unfinished, path(name)).expect("the compiled program in its place");
    true
}

/// Where the C program `name` lies once compiled.
pub(crate) fn path(name: &str) -> PathBuf {
    scratch().join(name)
}

/// A running program. It is killed when this value goes, and what it said is shown if the test failed.
pub(crate) struct Running {
    child: Child,
    complaints: PathBuf,
}

impl Running {
    /// Starts `program`; its standard output is for [`Running::take_output`].
    pub(crate) fn start(program: impl AsRef<Path>, arguments: &[&str]) -> Self {
        Self::start_command(Command::new(program.as_ref()).args(arguments))
    }

    /// The same with more than arguments.
    pub(crate) fn start_command(command: &mut Command) -> Self {
        let program = Path::new(command.get_program());
        let name = program.file_name().expect("a program's name").to_string_lossy().into_owned();
        let complaints = std::env::temp_dir().join(format!("{name}.stderr"));
        let child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(File::create(&complaints).expect("a file for complaints"))
            .spawn()
            .expect("a program that starts");
        Self { child, complaints }
    }

    /// The program's standard output, once.
    pub(crate) fn take_output(&mut self) -> ChildStdout {
        self.child.stdout.take().expect("taken once")
    }

    /// What it said on standard error so far.
    pub(crate) fn complaints(&self) -> String {
        fs::read_to_string(&self.complaints).expect("its file")
    }

    pub(crate) fn has_ended(&mut self) -> bool {
        self.child.try_wait().expect("a child").is_some()
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill_process(self.pid(), signal).expect("a signal to a child");
    }

    /// Waits for the program's end.
    pub(crate) fn wait(&mut self, limit_ms: u64) -> ExitStatus {
        if let Some(status) = self.child.try_wait().expect("a child") {
            return status;
        }
        let end = pidfd_open(self.pid(), PidfdFlags::empty()).expect("a descriptor of a child");
        let ended = readable_before(monotonic_ns() + limit_ms * MS, end.as_fd());
        assert!(ended, "the program still runs after {limit_ms} ms");
        self.child.wait().expect("a child")
    }

    fn pid(&self) -> Pid {
        Pid::from_child(&self.child)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended already; either way it is gone afterwards.
        drop(self.child.kill());
        drop(self.child.wait());
        if std::thread::panicking() {
            let said = fs::read_to_string(&self.complaints).unwrap_or_default();
            println!("{} said:\n{said}", self.complaints.display());
        }
    }
}
