//! Other programs that make one key of another. They are run as programs, if `fetch-peers.sh` has fetched them.

use std::env::temp_dir;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::report::Cause;
use super::way::{Contender, KEYBOARD_ID, Way};
use crate::guest::{cache, host_folder};
use crate::program::Running;
use crate::support::leave_out;

const FETCH: &str = "tests/kernel/fetch-peers.sh";

/// Another program.
struct Peer {
    name: &'static str,
    /// The first of its programs.
    program: &'static str,
    /// The command that starts this program on the device at a node.
    command: fn(&Path, &str) -> Command,
}

const PEERS: [Peer; 4] = [
    Peer { name: "kanata", program: "kanata", command: kanata },
    Peer { name: "xremap", program: "xremap", command: xremap },
    Peer { name: "keyd", program: "keyd", command: keyd },
    Peer { name: "interception-tools", program: "intercept", command: interception },
];

/// Says so where they were not fetched: then only the bridge and the echoes are measured.
pub(crate) fn tell_if_missing() {
    if folder().is_none() {
        leave_out("kanata, xremap and other programs beside which latency is measured", FETCH);
    }
}

fn folder() -> Option<PathBuf> {
    host_folder("peers", || cache().map(|cache| cache.join("peers")).filter(|folder| folder.is_dir()))
}

/// The script's own words on those that it could not have.
pub(super) fn left_out() -> Vec<String> {
    let Some(folder) = folder() else { return vec![format!("all other programs: {FETCH} fetches them")] };
    fs::read_to_string(folder.join("left-out")).unwrap_or_default().lines().map(str::to_owned).collect()
}

/// Those that are there.
pub(super) fn contenders() -> Vec<Contender> {
    let Some(programs) = folder().map(|folder| folder.join("bin")) else { return Vec::new() };
    let contender = |Peer { name, program, command }| {
        let program = Some(programs.join(program)).filter(|program| program.exists())?;
        let start = move || Way::of_keys(|node| Running::start_command(&mut command(&program, node)));
        Some(Contender::new(Cause::Event, name, start))
    };
    PEERS.into_iter().filter_map(contender).collect()
}

/// Writes a configuration, and gives its path.
fn configuration(path: impl AsRef<Path>, text: &str) -> PathBuf {
    let path = temp_dir().join(path);
    fs::create_dir_all(path.parent().expect("a folder")).expect("its folder");
    fs::write(&path, text).expect("a configuration");
    path
}

fn kanata(program: &Path, node: &str) -> Command {
    let text = format!("(defcfg linux-dev {node})\n(defsrc esc)\n(deflayer base caps)\n");
    let mut command = Command::new(program);
    command.args(["--nodelay", "--no-wait", "--cfg"]).arg(configuration("kanata.kbd", &text));
    command
}

fn xremap(program: &Path, node: &str) -> Command {
    let text = "modmap:\n  - remap:\n      KEY_ESC: KEY_CAPSLOCK\n";
    let mut command = Command::new(program);
    command.args(["--device", node]).arg(configuration("xremap.yml", text));
    command
}

/// It takes devices by vendor and product.
fn keyd(program: &Path, _node: &str) -> Command {
    let [vendor, product] = KEYBOARD_ID;
    let text = format!("[ids]\n{vendor:04x}:{product:04x}\n[main]\nesc = capslock\n");
    configuration("/etc/keyd/latency.conf", &text);
    Command::new(program)
}

/// Three programs in a row; the one in the middle, caps2esc, makes Caps Lock of Esc among other things.
fn interception(program: &Path, node: &str) -> Command {
    let folder = program.parent().expect("the folder of programs");
    let script = r#""$0" -g "$2" | "$1/caps2esc" | "$1/uinput" -d "$2""#;
    let mut command = Command::new("sh");
    command.args(["-c", script]).args([program, folder]).arg(node);
    command.env("LD_LIBRARY_PATH", folder.with_file_name("lib"));
    command
}
