//! The icon on a real panel, read and clicked over the session's bus as a panel does it.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::collections::HashMap;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use serde_json::Value as Json;
use zbus::blocking::Connection;
use zbus::blocking::connection::Builder;
use zbus::zvariant::{OwnedValue, Structure, Value};

use crate::control::await_status;
use crate::presses;
use crate::running::{Running, comes_true};
use crate::support::require;
use crate::x11::Server;

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");

const WATCHER: (&str, &str) = ("org.kde.StatusNotifierWatcher", "/StatusNotifierWatcher");
const ITEM: &str = "org.kde.StatusNotifierItem";
const MENU: &str = "com.canonical.dbusmenu";

/// A panel with nothing but the place for icons.
const PANEL: &str = include_str!("tray/xfce4-panel.xml");

/// Whether this machine has what a desktop needs.
fn has_desktop() -> bool {
    let needed = [
        ("Xvfb", "apt-get install xvfb"),
        ("dbus-daemon", "apt-get install dbus"),
        ("xfce4-panel", "apt-get install --no-install-recommends xfce4-panel xfconf adwaita-icon-theme"),
    ];
    needed.iter().all(|(program, install)| require(program, install))
}

/// A process that ends with its test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A session of this test alone: an X server, a bus, and a panel if one was started. Fields are dropped in this order.
struct Desktop {
    panel: Option<Process>,
    bus: Connection,
    _daemon: Process,
    server: Server,
    folder: tempfile::TempDir,
    address: String,
}

impl Desktop {
    /// One without a panel.
    fn bare() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let server = Server::start();
        let mut daemon = Self::command("dbus-daemon", folder.path(), &server.display);
        daemon.args(["--session", "--nofork", "--print-address"]).stdout(Stdio::piped());
        let mut daemon = Process(daemon.spawn().unwrap());
        let mut address = String::new();
        BufReader::new(daemon.0.stdout.as_mut().unwrap()).read_line(&mut address).unwrap();
        let address = address.trim().to_owned();
        let bus = Builder::address(address.as_str()).unwrap().build().unwrap();
        Self { panel: None, bus, _daemon: daemon, server, folder, address }
    }

    fn with_panel() -> Self {
        let mut desktop = Self::bare();
        let settings = desktop.folder.path().join("xfce4/xfconf/xfce-perchannel-xml");
        fs::create_dir_all(&settings).unwrap();
        fs::write(settings.join("xfce4-panel.xml"), PANEL).unwrap();
        desktop.start_panel();
        desktop
    }

    /// A program of this session, with its files in `folder`.
    fn command(program: &str, folder: &Path, display: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", display).env_remove("WAYLAND_DISPLAY").env("NO_AT_BRIDGE", "1");
        for variable in ["HOME", "XDG_CONFIG_HOME", "XDG_RUNTIME_DIR", "XDG_CACHE_HOME"] {
            command.env(variable, folder);
        }
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command
    }

    fn start_panel(&mut self) {
        let mut panel = Self::command("xfce4-panel", self.folder.path(), &self.server.display);
        panel.arg("--disable-wm-check").env("DBUS_SESSION_BUS_ADDRESS", &self.address);
        self.panel = Some(Process(panel.spawn().unwrap()));
        assert!(comes_true(|| self.takes_icons()), "the panel does not start");
    }

    fn end_panel(&mut self) {
        self.panel = None;
        assert!(comes_true(|| !self.takes_icons()), "the panel does not end");
    }

    fn takes_icons(&self) -> bool {
        let daemon = "org.freedesktop.DBus";
        let answer = self.bus.call_method(
            Some(daemon),
            "/org/freedesktop/DBus",
            Some(daemon),
            "NameHasOwner",
            &WATCHER.0,
        );
        answer.unwrap().body().deserialize().unwrap()
    }

    /// `tactpad` with these arguments, in `folder`.
    fn program(&self, folder: &Path, arguments: &[&str]) -> Command {
        let mut program = Running::program(TACTPAD, folder);
        program
            .args(arguments)
            .env("DBUS_SESSION_BUS_ADDRESS", &self.address)
            .env("DISPLAY", &self.server.display);
        program.env_remove("WAYLAND_DISPLAY").env("XDG_STATE_HOME", folder).env("HOME", folder);
        program
    }

    /// A bridge with an icon.
    fn play(&self, pad: &str) -> Running {
        let folder = tempfile::tempdir().unwrap();
        let program = self.program(folder.path(), &["run", "--tray", "--output", "none", "--pad", pad]);
        Running::start(folder, program)
    }

    fn property(&self, at: (&str, &str), interface: &str, name: &str) -> Option<OwnedValue> {
        let properties = "org.freedesktop.DBus.Properties";
        let answer =
            self.bus.call_method(Some(at.0), at.1, Some(properties), "Get", &(interface, name)).ok()?;
        answer.body().deserialize().ok()
    }

    /// The icon, once the panel knows it.
    fn icon(&self) -> Icon<'_> {
        let mut names: Vec<String> = Vec::new();
        let is_there = comes_true(|| {
            let items = self.property(WATCHER, WATCHER.0, "RegisteredStatusNotifierItems");
            names = items.and_then(|items| Vec::try_from(items).ok()).unwrap_or_default();
            !names.is_empty()
        });
        assert!(is_there, "no icon comes");
        assert_eq!(names.len(), 1, "{names:?}");
        // The panel writes the path behind the name.
        let name = names[0].split('/').next().unwrap().to_owned();
        Icon { desktop: self, name }
    }
}

/// An icon as its panel sees it.
struct Icon<'d> {
    desktop: &'d Desktop,
    name: String,
}

/// An entry's number, its properties, and those below it.
type Told = (i32, HashMap<String, OwnedValue>, Vec<OwnedValue>);

/// An entry of a menu.
#[derive(Clone, Debug, Default)]
struct Entry {
    number: i32,
    label: String,
    is_enabled: bool,
    is_checked: bool,
    below: Vec<Self>,
}

impl Entry {
    fn of((number, properties, below): Told) -> Self {
        let text = |name: &str| properties.get(name).and_then(|it| it.downcast_ref::<String>().ok());
        Self {
            number,
            label: text("label").unwrap_or_default(),
            is_enabled: properties.get("enabled").is_none_or(|it| it.downcast_ref().unwrap()),
            is_checked: properties
                .get("toggle-state")
                .is_some_and(|it| it.downcast_ref::<i32>().unwrap() == 1),
            below: below.iter().map(Self::child).collect(),
        }
    }

    fn child(value: &OwnedValue) -> Self {
        let parts: Structure<'static> = value.try_clone().unwrap().try_into().unwrap();
        Self::of(parts.try_into().unwrap())
    }

    /// The entry with this label, at any depth.
    fn find(&self, label: &str) -> Option<&Self> {
        if self.label == label {
            return Some(self);
        }
        self.below.iter().find_map(|entry| entry.find(label))
    }
}

impl Icon<'_> {
    /// The menu, once its entries have their names: at the very first they are told without.
    fn menu(&self) -> Entry {
        let mut menu = self.told();
        let is_named = |menu: &Entry| menu.below.iter().any(|entry| !entry.label.is_empty());
        assert!(comes_true(|| {
            menu = self.told();
            is_named(&menu)
        }));
        menu
    }

    fn told(&self) -> Entry {
        let asked = (0, -1, Vec::<String>::new());
        let answer = self.call(MENU, "GetLayout", &asked).unwrap();
        let (_, told): (u32, Told) = answer.body().deserialize().unwrap();
        Entry::of(told)
    }

    fn call<B>(&self, interface: &str, method: &str, body: &B) -> zbus::Result<zbus::Message>
    where
        B: serde::Serialize + zbus::zvariant::DynamicType,
    {
        self.desktop.bus.call_method(Some(self.name.as_str()), "/MenuBar", Some(interface), method, body)
    }

    fn click(&self, label: &str) {
        let menu = self.menu();
        let number = menu.find(label).unwrap_or_else(|| panic!("no {label:?} in {menu:#?}")).number;
        // Who is told to end may have no time to answer. That a click did nothing is seen by what comes of it.
        let _ = self.call(MENU, "Event", &(number, "clicked", Value::from(0), 0_u32));
    }

    /// The one profile with a mark.
    fn marked(&self) -> Vec<String> {
        let menu = self.menu();
        let profiles = &menu.find("Profile").unwrap().below;
        profiles.iter().filter(|it| it.is_checked).map(|it| it.label.clone()).collect()
    }

    fn property(&self, name: &str) -> OwnedValue {
        self.desktop.property((&self.name, "/StatusNotifierItem"), ITEM, name).unwrap()
    }

    /// What it says, and its picture.
    fn looks(&self) -> (String, Vec<u8>) {
        type Pictures = Vec<(i32, i32, Vec<u8>)>;
        let (_, _, _, words): (String, Pictures, String, String) =
            self.property("ToolTip").try_into().unwrap();
        let pictures: Pictures = self.property("IconPixmap").try_into().unwrap();
        (words, pictures.into_iter().next().unwrap().2)
    }

    /// Its picture once it says something that begins like this.
    fn picture(&self, words: &str) -> Vec<u8> {
        let mut looks = (String::new(), Vec::new());
        let found = comes_true(|| {
            looks = self.looks();
            looks.0.starts_with(words)
        });
        assert!(found, "it never says {words:?} but {:?}", looks.0);
        looks.1
    }
}

/// A place for programs that stand before the system's, with one that notes what it is to open.
fn opener(folder: &Path, note: &Path) -> String {
    let program = folder.join("xdg-open");
    fs::write(&program, format!("#!/bin/sh\nprintf %s \"$1\" > '{}'\n", note.display())).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    format!("{}:{}", folder.display(), std::env::var("PATH").unwrap())
}

fn presses_in(desktop: &Desktop) -> String {
    let capture: PathBuf = presses::write_capture(desktop.folder.path());
    format!("capture:{}", capture.display())
}

#[test]
fn the_menu_changes_the_profile_pauses_and_ends_the_bridge() {
    if !has_desktop() {
        return;
    }
    let desktop = Desktop::with_panel();
    let mut bridge = desktop.play("virtual");
    let icon = desktop.icon();
    // The icon is there before the bridge has anything to say.
    let says = || icon.menu().below[0].label.starts_with("Super Mario: ");
    assert!(comes_true(says), "{:#?}", icon.menu());
    assert!(!icon.menu().below[0].is_enabled);
    assert!(comes_true(|| icon.marked() == ["super-mario"]), "{:?}", icon.marked());

    icon.click("contra");
    await_status(&bridge, "plays what was chosen", |status| status["profile"] == "Contra");
    assert!(comes_true(|| icon.marked() == ["contra"]), "{:?}", icon.marked());
    // By other means.
    assert!(bridge.ctl("profile tetris").status.success());
    assert!(comes_true(|| icon.marked() == ["tetris"]), "{:?}", icon.marked());
    let kept = bridge.folder.path().join("tactpad/last-profile");
    let is_kept = comes_true(|| fs::read_to_string(&kept).is_ok_and(|it| it == "tetris\n"));
    assert!(is_kept, "{:?}", fs::read_to_string(&kept));

    icon.click("Pause");
    await_status(&bridge, "pauses", |status| status["state"] == "paused");
    assert!(comes_true(|| icon.menu().find("Go on").is_some()));
    assert!(icon.menu().below[0].label.ends_with(": paused"));
    icon.click("Go on");
    await_status(&bridge, "goes on", |status| status["state"] == "playing");
    icon.click("Measure the zero");
    await_status(&bridge, "measures the zero", |status| {
        status["state"] == "taring" || status["state"] == "loaded"
    });
    icon.click("Quit");
    assert!(bridge.ends().is_some_and(|status| status.success()));
}

#[test]
fn profiles_that_come_and_cannot_be_used_are_seen_in_the_menu() {
    if !has_desktop() {
        return;
    }
    let desktop = Desktop::with_panel();
    let bridge = desktop.play("virtual");
    let icon = desktop.icon();
    let own = bridge.folder.path().join("tactpad/profiles");
    fs::create_dir_all(&own).unwrap();
    fs::write(own.join("mine.toml"), "schema = 1\nname = \"My & own\"\noutput = \"gamepad\"\n[dpad]\n")
        .unwrap();
    fs::write(own.join("broken.toml"), "schema = 1\nname = 5\n").unwrap();
    assert!(comes_true(|| icon.menu().find("mine").is_some() && icon.menu().find("broken").is_some()));
    icon.click("broken");
    assert!(comes_true(|| icon.menu().below[0].label.contains("broken.toml cannot be used")));
    assert_eq!(
        (icon.marked(), &bridge.status()["profile"]),
        (vec!["super-mario".into()], &"Super Mario".into())
    );
    icon.click("mine");
    assert!(comes_true(|| icon.marked() == ["mine"]), "{:?}", icon.marked());
    assert!(comes_true(|| icon.menu().below[0].label.starts_with("My & own: ")), "{:#?}", icon.menu());
}

#[test]
fn the_icon_shows_what_the_pad_does_and_outlives_its_panel() {
    if !has_desktop() {
        return;
    }
    let mut desktop = Desktop::with_panel();
    let bridge = desktop.play(&presses_in(&desktop));
    let icon = desktop.icon();
    let pressed = icon.picture("pressed, profile Super Mario");
    let ready = icon.picture("ready, ");
    assert!(bridge.ctl("pause").status.success());
    let paused = icon.picture("paused, ");
    assert!(pressed != ready && ready != paused && paused != pressed);
    drop(icon);
    desktop.end_panel();
    assert_eq!(bridge.status()["state"], "paused", "the bridge plays on");
    desktop.start_panel();
    let icon = desktop.icon();
    assert_eq!(icon.picture("paused, "), paused);
    icon.click("Go on");
    await_status(&bridge, "goes on", |status| status["state"] == "playing");
}

#[test]
fn without_a_panel_the_bridge_says_so_and_the_icon_comes_with_one() {
    if !has_desktop() {
        return;
    }
    let mut desktop = Desktop::bare();
    let bridge = desktop.play("virtual");
    await_status(&bridge, "plays", |status| status["state"] == "playing");
    let told = bridge.told();
    assert_eq!(told.matches("there is no tray here (no panel takes icons yet)").count(), 1, "{told}");
    desktop.start_panel();
    desktop.icon().picture("ready, ");

    let folder = tempfile::tempdir().unwrap();
    let mut program =
        desktop.program(folder.path(), &["run", "--tray", "--output", "none", "--pad", "virtual"]);
    program.env("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nowhere");
    let bridge = Running::start(folder, program);
    await_status(&bridge, "plays", |status| status["state"] == "playing");
    let told = bridge.told();
    assert_eq!(told.matches("there is no tray here (there is no session bus)").count(), 1, "{told}");
}

#[test]
fn without_a_verb_it_plays_with_the_profile_played_last() {
    if !has_desktop() {
        return;
    }
    let desktop = Desktop::with_panel();
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("tactpad")).unwrap();
    fs::write(folder.path().join("tactpad/last-profile"), "contra\n").unwrap();
    let program = desktop.program(folder.path(), &[]);
    let mut bridge = Running::start(folder, program);
    let icon = desktop.icon();
    icon.picture("waiting for the pad");
    assert_eq!(icon.marked(), ["contra"]);
    assert_eq!(bridge.status()["profile"], "Contra");
    icon.click("Quit");
    assert!(bridge.ends().is_some_and(|status| status.success()));
}

#[test]
fn without_a_verb_and_a_desktop_it_prints_its_help() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = Running::program(TACTPAD, folder.path());
    program.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").stderr(Stdio::piped());
    let printed = program.output().unwrap();
    assert_eq!(printed.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&printed.stderr).contains("Usage: tactpad"));
}

#[test]
fn a_second_start_opens_the_page_of_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let note = folder.path().join("opened");
    let listener = UnixListener::bind(folder.path().join("tactpad.sock")).unwrap();
    let url = "http://127.0.0.1:4711/?token=a&b";
    let answers =
        [Json::from_iter([("ok", Json::from(true)), ("url", url.into())]), Json::from_iter([("ok", false)])];
    let bridge = std::thread::spawn(move || {
        for answer in answers {
            let (client, _) = listener.accept().unwrap();
            let mut asked = String::new();
            BufReader::new(&client).read_line(&mut asked).unwrap();
            assert_eq!(asked, "dashboard\n");
            writeln!(&client, "{answer}").unwrap();
        }
    });
    let start = || {
        let mut program = Running::program(TACTPAD, folder.path());
        program.env("DISPLAY", ":nowhere").env("PATH", opener(folder.path(), &note)).stderr(Stdio::piped());
        program.output().unwrap()
    };
    let opened = start();
    assert!(opened.status.success(), "{opened:?}");
    let opened = fs::read_to_string(&note).unwrap();
    assert_eq!(opened, "http://127.0.0.1:4711/open", "no token is in what every user can read");
    let refused = start();
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("it has no page"), "{refused:?}");
    bridge.join().unwrap();
}

#[test]
fn the_desktop_entries_are_sound() {
    if !require("desktop-file-validate", "apt-get install desktop-file-utils") {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/linux");
    for entry in ["tactpad.desktop", "tactpad-autostart.desktop"] {
        let judged = Command::new("desktop-file-validate").arg(folder.join(entry)).output().unwrap();
        assert!(judged.status.success(), "{judged:?}");
    }
}
