//! A screen and a keyboard of one game alone: an X server without a window manager, and the picture that it shows.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use tactpad::bridge::sink::Sink;
use tactpad::bridge::sink::x11::X11Sink;
use tactpad::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad::time::StreamInstant;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{AtomEnum, ConfigureWindowAux, ConnectionExt as _, InputFocus, MapState};
use x11rb::rust_connection::RustConnection;

use crate::clock::{MS, monotonic_ns, wait_until};
use crate::framebuffer::Framebuffer;

/// A key is down for so long, and not pressed again for so long.
const KEY_MS: u64 = 60;

/// A process that ends with its test.
pub(crate) struct Process(pub(crate) Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Lets milliseconds pass.
pub(crate) fn pause_ms(ms: u64) {
    wait_until(monotonic_ns() + ms * MS);
}

/// Looks every 10 ms, for `limit_ms` at most, until there is something; then that.
pub(crate) fn await_some<T>(limit_ms: u64, mut look: impl FnMut() -> Option<T>) -> Option<T> {
    let end_ns = monotonic_ns() + limit_ms * MS;
    loop {
        let found = look();
        if found.is_some() || monotonic_ns() >= end_ns {
            return found;
        }
        pause_ms(10);
    }
}

/// An X server with a folder of its own. Fields are dropped in this order.
pub(crate) struct Desk {
    connection: RustConnection,
    _server: Process,
    pub(crate) display: String,
    pub(crate) screen: Framebuffer,
    /// Where programs of this desk have their home.
    pub(crate) home: tempfile::TempDir,
}

impl Desk {
    /// One of this size in pixels.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let home = tempfile::tempdir().unwrap();
        let mut server = Command::new("Xvfb");
        server.args(["-displayfd", "1", "-nolisten", "tcp", "-noreset"]);
        server.args(["-screen", "0", &format!("{width}x{height}x24"), "-fbdir"]).arg(home.path());
        let mut server = Process(server.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap());
        let mut number = String::new();
        // The server names its display once it takes connections.
        BufReader::new(server.0.stdout.as_mut().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "Xvfb did not start");
        let display = format!(":{}", number.trim());
        let connection = x11rb::connect(Some(&display)).unwrap().0;
        let screen = Framebuffer::open(&home.path().join("Xvfb_screen0"));
        Self { connection, _server: server, display, screen, home }
    }

    /// A program of this desk, without sound, that sees nothing of this machine's settings.
    pub(crate) fn command(&self, program: &str) -> Command {
        command(program, &self.display, self.home.path())
    }

    /// Waits for the window of a program, by its class; puts it into the upper left corner and gives it the keyboard, as there is
    /// no window manager that does so.
    pub(crate) fn focus(&self, class: &str) {
        let window = await_some(20_000, || self.window(class)).expect("a window");
        let corner = ConfigureWindowAux::new().x(0).y(0);
        self.connection.configure_window(window, &corner).unwrap();
        self.connection.set_input_focus(InputFocus::POINTER_ROOT, window, x11rb::CURRENT_TIME).unwrap();
        self.connection.flush().unwrap();
    }

    fn window(&self, class: &str) -> Option<u32> {
        let root = self.connection.setup().roots[0].root;
        let windows = self.connection.query_tree(root).unwrap().reply().unwrap().children;
        windows.into_iter().rev().find(|window| self.is_seen(*window) && self.has_class(*window, class))
    }

    /// Presses a key and lets it up again.
    pub(crate) fn press(&self, key: u16) {
        let mut sink = X11Sink::open(Some(&self.display), None).unwrap();
        for value in [1, 0] {
            let (at, device) = (StreamInstant::from_us(0), OutputDevice::Keyboard);
            sink.write(&[OutputEvent { at, device, code: Code::Key(key), value }]).unwrap();
            pause_ms(KEY_MS);
        }
    }

    fn is_seen(&self, window: u32) -> bool {
        let attributes = self.connection.get_window_attributes(window).ok().and_then(|it| it.reply().ok());
        attributes.is_some_and(|it| it.map_state == MapState::VIEWABLE)
    }

    fn has_class(&self, window: u32, class: &str) -> bool {
        let asked = self.connection.get_property(false, window, AtomEnum::WM_CLASS, AtomEnum::STRING, 0, 64);
        let told = asked.ok().and_then(|it| it.reply().ok()).map(|it| it.value).unwrap_or_default();
        told.split(|byte| *byte == 0).any(|word| word.eq_ignore_ascii_case(class.as_bytes()))
    }
}

fn command(program: &str, display: &str, home: &Path) -> Command {
    let mut command = Command::new(program);
    command
        .env("DISPLAY", display)
        .env_remove("WAYLAND_DISPLAY")
        .env("SDL_AUDIODRIVER", "dummy")
        .env("LC_ALL", "C.UTF-8");
    for variable in ["HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_RUNTIME_DIR", "XDG_CACHE_HOME"] {
        command.env(variable, home);
    }
    let games = std::env::var("PATH").unwrap_or_default() + ":/usr/games";
    command
        .env("PATH", games)
        .current_dir(home)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}
