//! Profiles that follow the program in front, on real Wayland compositors without a screen, and as gamescope tells it.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{AtomEnum, ConnectionExt as _, PropMode};
use x11rb::wrapper::ConnectionExt as _;

use crate::programs::{await_profile, follow, write_profile};
use crate::running::comes_true;
use crate::support::require;
use crate::x11::Server;

/// Two programs with windows.
const CLICKDOT: &str = "weston-clickdot";
const FLOWER: &str = "weston-flower";

/// A process that ends with its test.
struct Process(Child);

impl Process {
    /// Starts a program that has its socket, and what it says, in this folder.
    fn start(command: &mut Command, folder: &Path) -> Self {
        let said = File::create(folder.join("said")).unwrap();
        let command = command.env("XDG_RUNTIME_DIR", folder).env("HOME", folder).current_dir(folder);
        Self(command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(said).spawn().unwrap())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A compositor without a screen. Fields are dropped in this order.
struct Compositor {
    _process: Process,
    _bus: Option<Process>,
    folder: tempfile::TempDir,
    /// What a program needs to reach it.
    environment: Vec<(&'static str, String)>,
}

impl Compositor {
    fn sway() -> Self {
        let folder = private_folder();
        fs::write(folder.path().join("config"), "xwayland disable\n").unwrap();
        // It refuses to run as root, which whoever runs it here may be.
        let mut sway = Command::new("unshare");
        sway.args([
            "--user",
            "--map-user=1000",
            "--map-group=1000",
            "sway",
            "--unsupported-gpu",
            "-c",
            "config",
        ]);
        sway.env("WLR_BACKENDS", "headless")
            .env("WLR_LIBINPUT_NO_DEVICES", "1")
            .env("WLR_RENDERER", "pixman");
        let process = Process::start(&mut sway, folder.path());
        Self::of(process, None, folder, "wayland-1", Vec::new())
    }

    fn kwin() -> Self {
        let folder = private_folder();
        let mut daemon = Command::new("dbus-daemon");
        daemon
            .args(["--session", "--nofork", "--print-address"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut daemon = daemon.spawn().unwrap();
        let mut address = String::new();
        BufReader::new(daemon.stdout.take().unwrap()).read_line(&mut address).unwrap();
        let bus = vec![("DBUS_SESSION_BUS_ADDRESS", address.trim().to_owned())];
        // The installed file has a capability that a container does not give; a copy has none.
        let program = folder.path().join("kwin_wayland");
        fs::copy("/usr/bin/kwin_wayland", &program).unwrap();
        let mut kwin = Command::new(program);
        kwin.args(["--virtual", "--no-lockscreen", "--no-global-shortcuts", "--socket", "wayland-1"]);
        kwin.env("KWIN_COMPOSE", "Q")
            .env_remove("DISPLAY")
            .env_remove("QT_QPA_PLATFORM")
            .envs(bus.iter().cloned());
        let process = Process::start(&mut kwin, folder.path());
        Self::of(process, Some(Process(daemon)), folder, "wayland-1", bus)
    }

    fn of(
        process: Process,
        bus: Option<Process>,
        folder: tempfile::TempDir,
        socket: &str,
        mut environment: Vec<(&'static str, String)>,
    ) -> Self {
        let socket = folder.path().join(socket);
        let is_there = comes_true(|| socket.exists());
        assert!(is_there, "{}", fs::read_to_string(folder.path().join("said")).unwrap());
        environment.push(("WAYLAND_DISPLAY", socket.to_str().unwrap().to_owned()));
        Self { _process: process, _bus: bus, folder, environment }
    }

    /// Starts a program with a window.
    fn open(&self, program: &str) -> Process {
        let said = self.folder.path().join(program);
        fs::create_dir_all(&said).unwrap();
        Process::start(Command::new(program).envs(self.environment.iter().cloned()), &said)
    }

    /// Has a bridge follow the programs on it.
    fn is_followed(&self) {
        let folder = tempfile::tempdir().unwrap();
        write_profile(
            folder.path(),
            "clickdot.toml",
            "Clickdot",
            "class = \"org.freedesktop.weston.wayland-clickdot\"",
        );
        write_profile(folder.path(), "flower.toml", "Flower", "class = \"org.freedesktop.weston.flower\"");
        let environment: Vec<(&str, &str)> =
            self.environment.iter().map(|(name, value)| (*name, value.as_str())).collect();
        let bridge = follow(folder, &environment);
        await_profile(&bridge, "Tetris", "none is for the program in front");
        let clickdot = self.open(CLICKDOT);
        await_profile(&bridge, "Clickdot", "clickdot");
        let flower = self.open(FLOWER);
        await_profile(&bridge, "Flower", "flower");
        drop(flower);
        await_profile(&bridge, "Clickdot", "clickdot");
        drop(clickdot);
        await_profile(&bridge, "Tetris", "none is for the program in front");
    }
}

/// A folder that nobody else may look into, as compositors ask of their runtime folder.
fn private_folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o700)).unwrap();
    folder
}

#[test]
fn the_profile_follows_the_program_in_front_on_a_compositor_of_wlroots() {
    if require("sway", "apt-get install --no-install-recommends sway")
        && require(CLICKDOT, "apt-get install --no-install-recommends weston")
    {
        Compositor::sway().is_followed();
    }
}

#[test]
fn the_profile_follows_the_program_in_front_on_kwin() {
    if require("kwin_wayland", "apt-get install --no-install-recommends kwin-wayland")
        && require("dbus-daemon", "apt-get install dbus")
        && require(CLICKDOT, "apt-get install --no-install-recommends weston")
    {
        Compositor::kwin().is_followed();
    }
}

#[test]
fn the_profile_follows_the_program_that_gamescope_has_in_front() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let (connection, screen) = x11rb::connect(Some(&server.display)).unwrap();
    let root = connection.setup().roots[screen].root;
    let set = |name: &str, numbers: &[u32]| {
        let name = connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
        connection.change_property32(PropMode::REPLACE, root, name, AtomEnum::CARDINAL, numbers).unwrap();
        connection.sync().unwrap();
    };
    let own = std::env::current_exe().unwrap();
    let own = own.file_name().unwrap().to_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    write_profile(folder.path(), "game.toml", "Game", &format!("executable = {own:?}"));
    // Windows of another X server than this one: gamescope has one for each game.
    set("GAMESCOPE_FOCUSABLE_WINDOWS", &[0x40_0007, 769, 1, 0x40_0009, 1234, std::process::id()]);
    let wayland = folder.path().join("gamescope-0").to_str().unwrap().to_owned();
    let bridge = follow(folder, &[("DISPLAY", &server.display), ("WAYLAND_DISPLAY", &wayland)]);
    await_profile(&bridge, "Tetris", "none is for the program in front");
    set("GAMESCOPE_FOCUSED_WINDOW", &[0x40_0009]);
    await_profile(&bridge, "Game", own);
    set("GAMESCOPE_FOCUSED_WINDOW", &[]);
    await_profile(&bridge, "Tetris", "none is for the program in front");
}
