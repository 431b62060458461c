//! Boots a Linux kernel as an ordinary process (User-Mode Linux) and runs this same test executable inside it.
//!
//! The guest has uinput and evdev whatever the host has, and runs as root there without being root here. Its root is
//! the host's, read-only under a throw-away layer.
//!
//! Its time is virtual: work takes none, and where nobody has work it jumps to the next deadline. So nothing inside is ever
//! late, whatever else the host does, and bounds on times hold exactly. What only real time can tell, how much work
//! something is, has a guest in real time. A guest is pinned to one processor: its processes take turns anyway.

#![allow(
    clippy::expect_used,
    clippy::print_stdout,
    dead_code,
    reason = "a test may stop at what it did not expect, and shows what it saw; each program uses a part"
)]

use std::env;
use std::fs::{self, File};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;

use rustix::fs::{StatVfsMountFlags, statvfs};

use crate::clock::{MS, monotonic_ns, wait_until};
use crate::support::{leave_out, require};

/// Said by the guest after the body, so that a guest that ran no test cannot pass.
const BODY_DONE: &str = "guest: body done";

/// A whole guest run that takes longer is killed: it hangs.
const TIME_LIMIT_S: &str = "1200";

/// Memory of the guest. What it does not use costs the host nothing.
const MEMORY_MIB: u64 = 768;

/// Directories of the guest's first root: mount points of `init.sh`.
const MOUNT_POINTS: [&str; 6] = ["proc", "sys", "dev", "lower", "upper", "root"];

/// How time passes in a guest.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Time {
    /// Only where nobody has work.
    Virtual,
    /// As on the host.
    Real,
}

impl Time {
    const fn name(self) -> &'static str {
        match self {
            Self::Virtual => "virtual",
            Self::Real => "real",
        }
    }
}

/// Runs `body` inside a guest kernel, in virtual time. `name` is the name of the calling test, by which the guest finds it
/// again.
///
/// On the host: boots the guest, shows what it printed, and panics unless the body ran to its end there.
pub(crate) fn in_guest(name: &str, body: impl FnOnce()) {
    run(Time::Virtual, name, body);
}

/// The same in real time. What the guest printed, on the host and if this machine has a kernel.
pub(crate) fn in_guest_in_real_time(name: &str, body: impl FnOnce()) -> Option<String> {
    run(Time::Real, name, body)
}

fn run(time: Time, name: &str, body: impl FnOnce()) -> Option<String> {
    if inside() {
        let _watch = StallWatch::start();
        body();
        println!("{BODY_DONE}");
        return None;
    }
    let kernel = usable_kernel()?;
    let processor = next_processor();
    let lock = File::create(scratch().join(format!("guest-{processor}.lock"))).expect("a lock file");
    lock.lock().expect("the guest's turn");
    let repeats_max = if time == Time::Real { REPEATS_MAX } else { 1 };
    for again in (0..repeats_max).rev() {
        let root = first_root(name, time);
        let output = boot(&kernel, root.path(), time, processor);
        let said = String::from_utf8_lossy(&output.stdout).replace('\r', "");
        println!("{}", said.trim_end().trim_end_matches("reboot: Power down"));
        let exit_code = fs::read_to_string(root.path().join("exit-code")).unwrap_or_default();
        if exit_code.trim() == "0" && said.contains(BODY_DONE) {
            return Some(said);
        }
        // A machine that stood still looks to the bridge like a pad that fell silent: that run says nothing.
        if again > 0 && longest_stall_ms(&said) >= STALL_MS {
            println!("{name}: the machine stood still for {} ms, once more", longest_stall_ms(&said));
            continue;
        }
        panic!(
            "{name} failed in the guest: exit code {:?}, kernel process {}\n{}",
            exit_code.trim(),
            output.status,
            String::from_utf8_lossy(&output.stderr)
        );
    }
    None
}

/// The kernel, if this machine has all that a guest needs.
fn usable_kernel() -> Option<PathBuf> {
    let kernel = kernel();
    let is_there = require(&kernel.to_string_lossy(), BUILD)
        && require("busybox", "apt-get install busybox-static")
        && require("taskset", "apt-get install util-linux");
    if !is_there {
        return None;
    }
    if !has_all_settings(&kernel) {
        leave_out(&format!("a setting of tests/kernel/uml.config in {}", kernel.display()), BUILD);
        return None;
    }
    Some(kernel)
}

/// What makes the kernel, and knows where it lies.
const BUILD: &str = "tests/kernel/build-kernel.sh";

fn build_script() -> Command {
    Command::new(Path::new(env!("CARGO_MANIFEST_DIR")).join(BUILD))
}

/// Whether the kernel was built as the tests need it; one that `TACTPAD_UML` names may be older.
fn has_all_settings(kernel: &Path) -> bool {
    static ANSWER: OnceLock<bool> = OnceLock::new();
    *ANSWER.get_or_init(|| {
        build_script().arg("--fits").arg(kernel).status().expect("the kernel's script").success()
    })
}

/// A run in real time is made anew at most this often, and only if the machine stood still meanwhile.
const REPEATS_MAX: u32 = 4;

/// Standing still for this long may look like silence to the bridge: half of what it waits.
const STALL_MS: u64 = 40;

/// How often the watch looks at the clock.
const WATCH_MS: u64 = 10;

/// Said by the guest at its end: for how long the whole machine stood still, at most.
const STALL_SAID: &str = "guest: longest stall in ms: ";

fn longest_stall_ms(said: &str) -> u64 {
    let number = said.lines().find_map(|line| line.split_once(STALL_SAID)).map(|(_, number)| number.trim());
    number.and_then(|number| number.parse().ok()).unwrap_or(0)
}

/// For how long this guest stood still so far, at most.
static STOOD_STILL_MS: AtomicU64 = AtomicU64::new(0);

/// By how much anything in the guest may have been late so far: in virtual time not at all, in real time the longest stall
/// in full. The watch sees only what of it lies past its own deadline, to the millisecond; up to a whole wait may lie before.
pub(crate) fn lateness_ms() -> u64 {
    if env::var("TACTPAD_IN_GUEST").as_deref() == Ok(Time::Virtual.name()) {
        return 0;
    }
    STOOD_STILL_MS.load(Ordering::Relaxed) + WATCH_MS + 1
}

/// Looks at the clock all the time, and tells at the end how long it was kept from that.
struct StallWatch;

impl StallWatch {
    fn start() -> Self {
        // It ends with the process.
        thread::spawn(|| {
            loop {
                let deadline_ns = monotonic_ns() + WATCH_MS * MS;
                wait_until(deadline_ns);
                STOOD_STILL_MS.fetch_max((monotonic_ns() - deadline_ns) / MS, Ordering::Relaxed);
            }
        });
        Self
    }
}

impl Drop for StallWatch {
    fn drop(&mut self) {
        println!("{STALL_SAID}{}", STOOD_STILL_MS.load(Ordering::Relaxed));
    }
}

/// Whether this process already runs in the guest.
pub(crate) fn inside() -> bool {
    env::var_os("TACTPAD_IN_GUEST").is_some()
}

/// A directory that host and guest see under the same path; the guest's writes to it stay in the guest.
pub(crate) fn scratch() -> &'static Path {
    Path::new(env!("CARGO_TARGET_TMPDIR"))
}

/// Where the host has what the scripts beside this file fetch.
pub(crate) fn cache() -> Option<PathBuf> {
    let home = PathBuf::from(env::var_os("HOME")?);
    let cache = env::var_os("XDG_CACHE_HOME").map_or_else(|| home.join(".cache"), PathBuf::from);
    Some(cache.join("tactpad"))
}

/// The folder that `find` finds on the host. The guest has another home, so the host leaves word where it is, by `name`.
pub(crate) fn host_folder(name: &str, find: impl FnOnce() -> Option<PathBuf>) -> Option<PathBuf> {
    let word = scratch().join(name);
    if inside() {
        return fs::read_to_string(word).ok().map(PathBuf::from);
    }
    let folder = find()?;
    // Two tests may leave it at the same time.
    let unfinished = scratch().join(format!("{name}.{:?}", thread::current().id()));
    fs::write(&unfinished, folder.to_str()?).expect("a word");
    fs::rename(unfinished, word).expect("a word in its place");
    Some(folder)
}

fn kernel() -> PathBuf {
    env::var_os("TACTPAD_UML").map_or_else(
        || {
            let told = build_script().arg("--path").output().expect("the kernel's script");
            PathBuf::from(String::from_utf8_lossy(&told.stdout).trim())
        },
        PathBuf::from,
    )
}

/// The guest's first root: its first process, a shell to run that, and the command.
fn first_root(name: &str, time: Time) -> tempfile::TempDir {
    let root = tempfile::Builder::new().prefix("guest-").tempdir_in(scratch()).expect("a scratch directory");
    for folder in MOUNT_POINTS {
        fs::create_dir(root.path().join(folder)).expect("a mount point");
    }
    let shell = env::split_paths(&env::var_os("PATH").unwrap_or_default())
        .map(|folder| folder.join("busybox"))
        .find(|path| path.is_file())
        .expect("busybox was there a moment ago");
    fs::copy(shell, root.path().join("busybox")).expect("a copy of busybox");
    write_script(&root.path().join("init"), include_str!("init.sh"));
    let command = format!(
        "#!/bin/sh\ncd {} && {} TACTPAD_IN_GUEST={} exec {} --include-ignored --exact {name} --nocapture\n",
        quoted(&env::current_dir().expect("a working directory").to_string_lossy()),
        settings(),
        time.name(),
        quoted(&env::current_exe().expect("this executable's path").to_string_lossy())
    );
    write_script(&root.path().join("command"), &command);
    root
}

/// The settings of this run (`TACTPAD_*`), as a shell sets them for one command.
fn settings() -> String {
    let ours = env::vars().filter(|(name, _)| name.starts_with("TACTPAD_"));
    ours.map(|(name, value)| format!("{name}={} ", quoted(&value))).collect()
}

/// `word` as a shell takes it literally.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

fn write_script(path: &Path, text: &str) {
    fs::write(path, text).expect("a script");
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("an executable script");
}

fn boot(kernel: &Path, root: &Path, time: Time, processor: usize) -> Output {
    let mut command = Command::new("timeout");
    command
        .args(["-k", "2", TIME_LIMIT_S, "taskset", "-c", &processor.to_string()])
        .arg(kernel)
        .arg(format!("mem={MEMORY_MIB}M"))
        .args(["rootfstype=hostfs", "rw", "init=/init", "con=null", "con0=null,fd:1", "quiet", "loglevel=1"])
        .arg(format!("rootflags={}", root.display()))
        .arg(format!("uml_dir={}", root.display()));
    if time == Time::Virtual {
        command.arg("time-travel=inf-cpu");
    }
    command
        .env("TMPDIR", memory_folder())
        .stdin(std::process::Stdio::null())
        .output()
        .expect("coreutils' timeout")
}

/// Where the guest's memory lies as a file that it maps executable: in the host's memory if that is large enough.
fn memory_folder() -> PathBuf {
    let shared = Path::new("/dev/shm");
    let fits = statvfs(shared).is_ok_and(|fs| {
        fs.f_bavail * fs.f_frsize >= MEMORY_MIB << 20 && !fs.f_flag.contains(StatVfsMountFlags::NOEXEC)
    });
    if fits { shared.to_path_buf() } else { env::temp_dir() }
}

/// A processor that this process may use: one after the other, so that as many guests run as there are.
fn next_processor() -> usize {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    let processors = processors();
    processors[NEXT.fetch_add(1, Ordering::Relaxed) % processors.len()]
}

/// The processors that this process may use.
fn processors() -> Vec<usize> {
    let status = fs::read_to_string("/proc/self/status").expect("/proc");
    let list =
        status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:")).expect("a processor list");
    let number = |text: &str| text.trim().parse::<usize>().expect("a processor's number");
    let range = |range: &str| {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        number(first)..=number(last)
    };
    list.split(',').flat_map(range).collect()
}
