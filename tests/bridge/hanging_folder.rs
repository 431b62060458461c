//! Profiles on a file system that hangs, as a network's does when its server is gone: nobody but the reader of profiles waits.
//!
//! The file system is the test's own, through `/dev/fuse`, in a mount namespace of its own, so it takes no rights.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::AsRawFd;
use std::os::unix::fs::symlink;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, Thread};

use rustix::event::{PollFd, PollFlags, poll};
use rustix::io::{FdFlags, fcntl_setfd};
use rustix::process::Signal;
use tempfile::TempDir;

use crate::running::{Running, comes_true};
use crate::support::leave_out;
use tactpad::pipeline::mapping::read::shipped;

/// Set where the test runs in its namespace.
const INSIDE: &str = "TACTPAD_IN_NAMESPACE";
const DEVICE: &str = "/dev/fuse";

/// The one file, and the numbers of the folder and of it.
const NAME: &str = "mine.toml";
const FOLDER: u64 = 1;
const FILE: u64 = 2;

const REQUEST_HEAD_BYTES: usize = 40;
const NO_SUCH_FILE: i32 = -2;
const UNKNOWN_REQUEST: i32 = -38;

/// A folder with one profile that answers until it is told to hang.
struct HangingFolder {
    place: TempDir,
    state: Arc<State>,
    server: Thread,
}

#[derive(Default)]
struct State {
    hangs: AtomicBool,
    /// Somebody asked while it hung.
    is_asked: AtomicBool,
}

impl HangingFolder {
    fn mount(profile: &'static str) -> Self {
        let place = tempfile::tempdir().unwrap();
        let device = File::options().read(true).write(true).open(DEVICE).unwrap();
        fcntl_setfd(&device, FdFlags::empty()).unwrap();
        let options = format!("fd={},rootmode=40000,user_id=0,group_id=0", device.as_raw_fd());
        let mut mount = Command::new("mount");
        mount.args(["-i", "-t", "fuse", "-o", &options, "none"]).arg(place.path());
        assert!(mount.status().unwrap().success());
        fcntl_setfd(&device, FdFlags::CLOEXEC).unwrap();
        let state = Arc::new(State::default());
        let of_server = Arc::clone(&state);
        let server = thread::spawn(move || serve(&device, profile.as_bytes(), &of_server));
        Self { place, state, server: server.thread().clone() }
    }

    fn hang(&self) {
        self.state.hangs.store(true, Ordering::SeqCst);
    }

    fn is_asked(&self) -> bool {
        self.state.is_asked.load(Ordering::SeqCst)
    }
}

impl Drop for HangingFolder {
    /// Whoever looks into the folder to remove it gets an answer.
    fn drop(&mut self) {
        self.state.hangs.store(false, Ordering::SeqCst);
        self.server.unpark();
        let _ = Command::new("umount").args(["-l", "-i"]).arg(self.place.path()).status();
    }
}

/// Answers what the kernel asks. While it hangs it takes no request: whoever waits for one that was taken cannot even be killed.
fn serve(mut device: &File, profile: &[u8], state: &State) {
    let mut request = vec![0; 1 << 16];
    loop {
        poll(&mut [PollFd::new(device, PollFlags::IN)], None).unwrap();
        while state.hangs.load(Ordering::SeqCst) {
            state.is_asked.store(true, Ordering::SeqCst);
            thread::park();
        }
        let read = match device.read(&mut request) {
            Ok(read) => read,
            // Whoever asked is gone.
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
            // It is not mounted any more.
            Err(_) => return,
        };
        let number = |at: usize| u64::from_ne_bytes(request[at..at + 8].try_into().unwrap());
        let opcode = number(0) >> 32;
        let Some(answer) = answer(opcode, number(16), &request[REQUEST_HEAD_BYTES..read], profile) else {
            continue;
        };
        let (error, body) = answer.map_or_else(|error| (error, Vec::new()), |body| (0, body));
        let mut bytes = joined(&[], &[16 + body.len() as u32, error.cast_unsigned()]);
        bytes.extend(joined(&[number(8)], &[]));
        bytes.extend(body);
        // It may have been interrupted meanwhile.
        let _ = device.write(&bytes);
    }
}

/// What to answer, or an error's number; none for what is only told.
fn answer(opcode: u64, node: u64, body: &[u8], profile: &[u8]) -> Option<Result<Vec<u8>, i32>> {
    let attributes = |node: u64| {
        let (mode, bytes) = if node == FOLDER { (0o040_755, 0) } else { (0o100_644, profile.len() as u64) };
        joined(&[node, bytes, 0, 0, 0, 0], &[0, 0, 0, mode, 1, 0, 0, 0, 4_096, 0])
    };
    Some(match opcode {
        // FORGET, INTERRUPT, BATCH_FORGET.
        2 | 36 | 42 => return None,
        // LOOKUP. Nothing is remembered.
        1 if body.strip_suffix(b"\0") == Some(NAME.as_bytes()) => {
            Ok([joined(&[FILE, 0, 0, 0], &[0, 0]), attributes(FILE)].concat())
        }
        1 => Err(NO_SUCH_FILE),
        // GETATTR.
        3 => Ok([joined(&[0], &[0, 0]), attributes(node)].concat()),
        // OPEN and OPENDIR, past the kernel's cache.
        14 | 27 => Ok(joined(&[0], &[1, 0])),
        // READ: handle, offset, bytes.
        15 => {
            let offset = u64::from_ne_bytes(body[8..16].try_into().unwrap()) as usize;
            let bytes = u32::from_ne_bytes(body[16..20].try_into().unwrap()) as usize;
            let rest = profile.get(offset..).unwrap_or_default();
            Ok(rest[..bytes.min(rest.len())].to_vec())
        }
        // RELEASE, FLUSH, READDIR, RELEASEDIR.
        18 | 25 | 28 | 29 => Ok(Vec::new()),
        // INIT: version 7.31, 4 kB a write, nothing else.
        26 => Ok(joined(&[], &[7, 31, 0, 0, 0, 4_096, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0])),
        _ => Err(UNKNOWN_REQUEST),
    })
}

fn joined(long: &[u64], short: &[u32]) -> Vec<u8> {
    let long = long.iter().flat_map(|number| number.to_ne_bytes());
    long.chain(short.iter().flat_map(|number| number.to_ne_bytes())).collect()
}

fn unshared() -> Command {
    let mut command = Command::new("unshare");
    command.args(["--map-root-user", "--mount"]);
    command
}

#[test]
fn a_profile_folder_that_hangs_holds_nothing_up() {
    if std::env::var_os(INSIDE).is_some() {
        folder_hangs();
        return;
    }
    let mut tried = unshared();
    tried.args(["sh", "-c", &format!("exec 3<>{DEVICE}")]).stderr(Stdio::null());
    if !tried.status().is_ok_and(|status| status.success()) {
        leave_out(
            "/dev/fuse for every user",
            "modprobe fuse; chmod 666 /dev/fuse; apt-get install util-linux",
        );
        return;
    }
    let mut inside = unshared();
    inside.arg(std::env::current_exe().unwrap()).env(INSIDE, "1");
    inside.args(["--exact", "hanging_folder::a_profile_folder_that_hangs_holds_nothing_up", "--nocapture"]);
    let output = inside.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}

fn folder_hangs() {
    let profiles = HangingFolder::mount(shipped::text("contra").unwrap());
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("tactpad")).unwrap();
    symlink(profiles.place.path(), folder.path().join("tactpad/profiles")).unwrap();
    let log = folder.path().join("log");
    let mut program = Running::program(env!("CARGO_BIN_EXE_tactpad"), folder.path());
    program.args(["run", "--pad", "virtual", "--profile", "mine", "--output"]);
    program.arg(format!("log:{}", log.display()));
    let mut bridge = Running::start(folder, program);
    let held = || if log.exists() { crate::stalled::held(&log) } else { Vec::new() };
    assert!(comes_true(|| !held().is_empty()), "{}", bridge.told());

    profiles.hang();
    let mut reload = bridge.ctl_begun("reload");
    assert!(comes_true(|| profiles.is_asked()), "nobody reads the profile");
    // Who holds is let go of as the finger lifts, and what is pressed anew comes down.
    assert!(comes_true(|| held().is_empty()), "{:?}", held());
    assert!(comes_true(|| !held().is_empty()), "{}", bridge.status());
    assert!(bridge.ctl("pause").status.success());
    assert!(comes_true(|| held().is_empty()), "{:?}", held());
    assert!(bridge.ctl("panic").status.success() && bridge.ctl("resume").status.success());
    assert!(comes_true(|| !held().is_empty()), "{}", bridge.status());
    bridge.signal(Signal::TERM);
    assert_eq!(bridge.ends().and_then(|status| status.code()), Some(0), "{}", bridge.told());
    assert!(held().is_empty(), "{:?}", held());
    // It was answered, or its bridge has ended.
    reload.wait().unwrap();
}
