//! Boots a Linux kernel as an ordinary process (User-Mode Linux) and runs this same test executable inside it.
//!
//! The guest has uinput and evdev whatever the host has, and runs as root there without being root here. Its root is
//! the host's, read-only under a throw-away layer. One guest runs at a time, pinned to one processor, because
//! a kernel that its host moves about or starves tells nothing about time.

use std::env;
use std::fs::{self, File};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use rustix::fs::{StatVfsMountFlags, statvfs};

use crate::clock::{MS, monotonic_ns, wait_until};
use crate::support::require;

/// Said by the guest after the body, so that a guest that ran no test cannot pass.
const BODY_DONE: &str = "guest: body done";

/// A whole guest run that takes longer is killed.
const TIME_LIMIT_S: &str = "300";

/// Memory of the guest.
const MEMORY_MIB: u64 = 384;

/// Directories of the guest's first root: mount points of `init.sh`.
const MOUNT_POINTS: [&str; 6] = ["proc", "sys", "dev", "lower", "upper", "root"];

/// Runs `body` inside a guest kernel. `name` is the name of the calling test, by which the guest finds it again.
///
/// On the host: boots the guest, shows what it printed, and panics unless the body ran to its end there.
pub(crate) fn in_guest(name: &str, body: impl FnOnce()) {
    if inside() {
        let _watch = StallWatch::start();
        body();
        println!("{BODY_DONE}");
        return;
    }
    let kernel = kernel();
    if !require(&kernel.to_string_lossy(), "tests/kernel/build-kernel.sh")
        || !require("busybox", "apt-get install busybox-static")
        || !require("taskset", "apt-get install util-linux")
    {
        return;
    }
    let lock = File::create(scratch().join("guest.lock")).expect("a lock file");
    lock.lock().expect("the guest's turn");
    for again in (0..REPEATS_MAX).rev() {
        let root = first_root(name);
        let output = boot(&kernel, root.path());
        let said = String::from_utf8_lossy(&output.stdout).replace('\r', "");
        println!("{}", said.trim_end().trim_end_matches("reboot: Power down"));
        let exit_code = fs::read_to_string(root.path().join("exit-code")).unwrap_or_default();
        if exit_code.trim() == "0" && said.contains(BODY_DONE) {
            return;
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
}

/// A run is made anew at most this often, and only if the machine stood still meanwhile.
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

/// By how much anything in the guest may have been late so far: the longest stall in full. The watch sees only what of
/// it lies past its own deadline, to the millisecond; up to a whole wait may lie before.
pub(crate) fn lateness_ms() -> u64 {
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

fn kernel() -> PathBuf {
    let named = env::var_os("TACTPAD_UML").map(PathBuf::from);
    let cache = env::var_os("XDG_CACHE_HOME")
        .map_or_else(|| PathBuf::from(env::var_os("HOME").unwrap_or_default()).join(".cache"), PathBuf::from);
    named.unwrap_or_else(|| cache.join("tactpad/linux-uml-6.12"))
}

/// The guest's first root: its first process, a shell to run that, and the command.
fn first_root(name: &str) -> tempfile::TempDir {
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
        "#!/bin/sh\ncd {} && TACTPAD_IN_GUEST=1 {} exec {} --exact {name} --nocapture\n",
        quoted(&env::current_dir().expect("a working directory").to_string_lossy()),
        settings(),
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

fn boot(kernel: &Path, root: &Path) -> Output {
    Command::new("timeout")
        .args(["-k", "2", TIME_LIMIT_S, "taskset", "-c", &last_processor()])
        .arg(kernel)
        .arg(format!("mem={MEMORY_MIB}M"))
        .args(["rootfstype=hostfs", "rw", "init=/init", "con=null", "con0=null,fd:1", "quiet", "loglevel=1"])
        .arg(format!("rootflags={}", root.display()))
        .arg(format!("uml_dir={}", root.display()))
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

/// The highest-numbered processor that this process may use, as `taskset` wants it.
fn last_processor() -> String {
    let status = fs::read_to_string("/proc/self/status").expect("/proc");
    let list =
        status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:")).expect("a processor list");
    list.trim().rsplit([',', '-']).next().expect("rsplit yields at least one part").to_owned()
}
