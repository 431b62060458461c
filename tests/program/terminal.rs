//! What the program draws on a terminal: a small emulator behind a pseudo-terminal looks at it.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};
use tempfile::TempDir;

use crate::undisturbed::stood_still;

/// A program on a terminal of its own.
struct Terminal {
    child: Child,
    device: File,
    screen: vt100::Parser,
    /// All that was written, for what is gone from the screen.
    written: Vec<u8>,
}

impl Terminal {
    /// Starts the program in `folder` on a terminal of this kind and size.
    fn start(folder: &Path, line: &str, term: &str, [columns, rows]: [u16; 2]) -> Self {
        let device = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&device).unwrap();
        unlockpt(&device).unwrap();
        let path = ptsname(&device, Vec::new()).unwrap().into_string().unwrap();
        let host =
            || Stdio::from(open(Path::new(&path), OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap());
        tcsetwinsize(&device, size(columns, rows)).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
        command.args(line.split(' ')).current_dir(folder).env("TERM", term);
        command.env("XDG_RUNTIME_DIR", folder).env("XDG_CACHE_HOME", folder.join("cache"));
        command.env("XDG_CONFIG_HOME", folder.join("config"));
        let child = command.stdin(Stdio::null()).stdout(host()).stderr(host()).spawn().unwrap();
        let screen = vt100::Parser::new(rows, columns, 10_000);
        Self { child, device: device.into(), screen, written: Vec::new() }
    }

    /// Reads on until the screen shows what is wanted; `false` if the program ends before.
    fn shows(&mut self, wanted: impl Fn(&vt100::Screen) -> bool) -> bool {
        let mut bytes = [0; 4096];
        loop {
            if wanted(self.screen.screen()) {
                return true;
            }
            match self.device.read(&mut bytes) {
                Ok(0) => return false,
                Ok(count) => {
                    self.screen.process(&bytes[..count]);
                    self.written.extend_from_slice(&bytes[..count]);
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                // The other end is closed.
                Err(_) => return false,
            }
        }
    }

    /// Another size, as when a window is pulled.
    fn resize(&mut self, columns: u16, rows: u16) {
        tcsetwinsize(&self.device, size(columns, rows)).unwrap();
        self.screen.screen_mut().set_size(rows, columns);
    }

    /// Lets the program end.
    fn finish(mut self) -> (ExitStatus, String) {
        self.shows(|_| false);
        (self.child.wait().unwrap(), String::from_utf8_lossy(&self.written).into_owned())
    }

    /// Lets a demo end: whether its events are those that the player meant, as far as the machine let it play.
    fn plays_as_meant(self) -> bool {
        let (status, written) = self.finish();
        status.success() || stood_still(&written.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}

fn size(columns: u16, rows: u16) -> Winsize {
    Winsize { ws_row: rows, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 }
}

/// How often a text stands on the screen.
fn count(screen: &vt100::Screen, text: &str) -> usize {
    screen.contents().matches(text).count()
}

/// Whether the seconds on the screen's picture are `from` or more.
fn plays_since(screen: &vt100::Screen, from: f64) -> bool {
    let text = screen.contents();
    let words: Vec<&str> = text.split_whitespace().collect();
    let played = words.windows(3).find(|words| words[0] == "playing" && words[2] == "s");
    played.and_then(|words| words[1].parse().ok()).is_some_and(|seconds: f64| seconds >= from)
}

/// A folder with a profile whose name is longer than a line.
fn with_long_profile() -> (TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let shown =
        Command::new(env!("CARGO_BIN_EXE_tactpad")).args(["profile", "show", "contra"]).output().unwrap();
    let text = String::from_utf8(shown.stdout).unwrap();
    let name = "a very long name of a profile for a small window, beyond it";
    let line = text.lines().find(|line| line.starts_with("name")).unwrap();
    let text = text.replacen(line, &format!("name = \"{name}\""), 1);
    fs::write(folder.path().join("long.toml"), text).unwrap();
    (folder, name.to_owned())
}

#[test]
fn the_live_picture_stays_in_place_in_small_terminals() {
    let (folder, name) = with_long_profile();
    let line = "demo --seconds 4 --output none --profile long.toml";
    for [columns, rows] in [[80, 24], [40, 10], [50, 12]] {
        let mut terminal = Terminal::start(folder.path(), line, "xterm", [columns, rows]);
        // Some twenty pictures later.
        assert!(terminal.shows(|screen| plays_since(screen, 1.5)), "{}", terminal.screen.screen().contents());
        let screen = terminal.screen.screen();
        for text in [&name[..30], "playing", "frames"] {
            assert_eq!(count(screen, text), 1, "{text} at {columns} × {rows}:\n{}", screen.contents());
        }
        assert!(terminal.plays_as_meant());
    }
}

#[test]
fn another_size_leaves_one_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut terminal = Terminal::start(folder.path(), "demo --seconds 6 --output none", "xterm", [100, 30]);
    let mut since = 1.0;
    for [columns, rows] in [[40, 10], [120, 40], [70, 16]] {
        assert!(
            terminal.shows(|screen| plays_since(screen, since)),
            "{}",
            terminal.screen.screen().contents()
        );
        terminal.resize(columns, rows);
        since += 1.0;
        assert!(
            terminal.shows(|screen| plays_since(screen, since)),
            "{}",
            terminal.screen.screen().contents()
        );
        let screen = terminal.screen.screen();
        for text in ["on a virtual pad", "playing", "frames"] {
            assert_eq!(count(screen, text), 1, "{text} at {columns} × {rows}:\n{}", screen.contents());
        }
    }
    assert!(terminal.plays_as_meant());
}

#[test]
fn run_without_virtual_devices_shows_the_events_here() {
    if Path::new("/dev/uinput").exists() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut terminal = Terminal::start(
        folder.path(),
        "run --pad virtual --seconds 3 --profile super-mario",
        "xterm",
        [90, 30],
    );
    let told = |screen: &vt100::Screen| {
        count(screen, "For a virtual gamepad: ") == 1 && count(screen, "event log, here") > 1
    };
    assert!(terminal.shows(|screen| told(screen) && count(screen, "right, pressed") > 0));
    assert!(terminal.finish().0.success());
}

#[test]
fn a_picture_without_a_pad_says_what_it_waits_for() {
    let folder = tempfile::tempdir().unwrap();
    let line = "run --pad serial:/dev/ttyOfMine --wait --output none --seconds 2 --profile contra";
    let mut terminal = Terminal::start(folder.path(), line, "xterm", [80, 24]);
    assert!(terminal.shows(|screen| count(screen, "waiting for the pad: plug it in") == 1));
    assert!(terminal.finish().0.success());
}

#[test]
fn dumb_terminals_get_no_escape_sequences() {
    let folder = tempfile::tempdir().unwrap();
    for line in
        ["demo --seconds 2", "demo --seconds 2 --output none", "profile check nothing", "adapt --help"]
    {
        let (_, written) = Terminal::start(folder.path(), line, "dumb", [80, 24]).finish();
        assert!(!written.contains('\x1b'), "{line}: {written:?}");
    }
    let adapted = adapt(folder.path());
    let (_, written) = Terminal::start(folder.path(), &adapted, "dumb", [80, 24]).finish();
    assert!(!written.contains('\x1b') && written.contains("is written"), "{written:?}");
}

/// Makes a measured table and says how a decoder is fitted to it.
fn adapt(folder: &Path) -> String {
    let mut twin = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    twin.args(["twin", "--plan", "paper", "--imperfections", "none.toml", "--out", "m.csv"]);
    fs::write(folder.join("none.toml"), "").unwrap();
    assert!(twin.current_dir(folder).output().unwrap().status.success());
    "adapt --method inverse --rows 30 --measured m.csv --out mine.decoder".to_owned()
}

#[test]
fn long_work_shows_a_bar_that_moves() {
    let folder = tempfile::tempdir().unwrap();
    let mut terminal = Terminal::start(folder.path(), &adapt(folder.path()), "xterm", [100, 24]);
    let is_under_way = |screen: &vt100::Screen| {
        count(screen, "fitting the pad's field") == 1
            && screen.contents().contains("[#")
            && !screen.contents().contains(" 0 %")
    };
    assert!(terminal.shows(is_under_way), "{}", String::from_utf8_lossy(&terminal.written));
    terminal.shows(|_| false);
    let rest = terminal.screen.screen().contents();
    assert!(!rest.contains("[#"), "the bar is still there: {rest}");
    assert!(terminal.finish().0.success());
}

#[test]
fn pipes_get_no_bar() {
    let folder = tempfile::tempdir().unwrap();
    let line = adapt(folder.path());
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    let output =
        command.args(line.split(' ')).current_dir(folder.path()).env("TERM", "xterm").output().unwrap();
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
