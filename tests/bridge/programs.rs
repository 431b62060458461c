//! Profiles that follow the program in front, on a real X server.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;

use x11rb::COPY_DEPTH_FROM_PARENT;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    AtomEnum, ConnectionExt as _, CreateWindowAux, EventMask, InputFocus, PropMode, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use crate::control::await_status;
use crate::running::Running;
use crate::support::require;
use crate::x11::Server;

/// Programs with windows.
struct Programs {
    connection: RustConnection,
    root: Window,
}

impl Programs {
    fn on(display: &str) -> Self {
        let (connection, screen) = x11rb::connect(Some(display)).unwrap();
        let root = connection.setup().roots[screen].root;
        Self { connection, root }
    }

    /// A window that says whose it is, as far as that is given, and has the keyboard.
    fn open(&self, class: Option<&str>, process: Option<u32>) -> Window {
        let window = self.window(self.root);
        if let Some(class) = class {
            let words = format!("{}\0{class}\0", class.to_lowercase());
            let (name, kind) = (AtomEnum::WM_CLASS, AtomEnum::STRING);
            self.connection
                .change_property8(PropMode::REPLACE, window, name, kind, words.as_bytes())
                .unwrap();
        }
        if let Some(process) = process {
            let name = self.connection.intern_atom(false, b"_NET_WM_PID").unwrap().reply().unwrap().atom;
            let kind = AtomEnum::CARDINAL;
            self.connection.change_property32(PropMode::REPLACE, window, name, kind, &[process]).unwrap();
        }
        self.focus(window);
        window
    }

    fn window(&self, parent: Window) -> Window {
        let window = self.connection.generate_id().unwrap();
        let shown = CreateWindowAux::new().event_mask(EventMask::EXPOSURE);
        let (depth, class) = (COPY_DEPTH_FROM_PARENT, WindowClass::INPUT_OUTPUT);
        self.connection.create_window(depth, window, parent, 0, 0, 50, 50, 0, class, 0, &shown).unwrap();
        self.connection.map_window(window).unwrap();
        self.connection.flush().unwrap();
        while !matches!(self.connection.wait_for_event().unwrap(), Event::Expose(_)) {}
        window
    }

    fn focus(&self, window: Window) {
        self.connection.set_input_focus(InputFocus::POINTER_ROOT, window, x11rb::CURRENT_TIME).unwrap();
        self.connection.sync().unwrap();
    }

    fn close(&self, window: Window) {
        self.connection.destroy_window(window).unwrap();
        self.connection.sync().unwrap();
    }
}

/// A profile of one's own that is for a program.
pub(crate) fn write_profile(folder: &Path, file: &str, name: &str, program: &str) {
    let own = folder.join("tactpad/profiles");
    fs::create_dir_all(&own).unwrap();
    let text =
        format!("schema = 1\nname = \"{name}\"\noutput = \"gamepad\"\n[dpad]\n[[program]]\n{program}\n");
    fs::write(own.join(file), text).unwrap();
}

/// A bridge that follows the program in front, in an environment with these variables.
pub(crate) fn follow(folder: tempfile::TempDir, environment: &[(&str, &str)]) -> Running {
    let mut program = Running::program(env!("CARGO_BIN_EXE_tactpad"), folder.path());
    program.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").envs(environment.iter().copied());
    program.args(["run", "--pad", "virtual", "--profile", "auto:tetris", "--output", "none"]);
    Running::start(folder, program)
}

pub(crate) fn await_profile(bridge: &Running, name: &str, why: &str) {
    await_status(bridge, &format!("{name}: {why}"), |status| {
        let reason = status["profile_reason"].as_str();
        status["profile"] == name && reason.is_some_and(|reason| reason.contains(why))
    });
}

#[test]
fn the_profile_follows_the_program_in_front() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let programs = Programs::on(&server.display);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_owned();
    write_profile(&path, "game.toml", "Game", "class = \"kart\"");
    let own = std::env::current_exe().unwrap();
    let own = own.file_name().unwrap().to_str().unwrap();
    write_profile(&path, "process.toml", "Process", &format!("executable = {own:?}"));
    let bridge = follow(folder, &[("DISPLAY", &server.display)]);
    await_profile(&bridge, "Tetris", "none is for the program in front");

    let kart = programs.open(Some("Kart"), None);
    await_profile(&bridge, "Game", "for the program in front, Kart");
    programs.focus(programs.window(kart));
    let ours = programs.open(None, Some(bridge.id()));
    // Had it gone back to Tetris, this change would not be seen.
    write_profile(&path, "game.toml", "Game 2", "class = \"kart\"");
    await_profile(&bridge, "Game 2", "Kart");
    let process = programs.open(None, Some(std::process::id()));
    await_profile(&bridge, "Process", own);
    programs.close(process);
    await_profile(&bridge, "Tetris", "none is for the program in front");

    programs.focus(kart);
    await_profile(&bridge, "Game 2", "Kart");
    assert!(bridge.ctl("profile contra").status.success());
    await_profile(&bridge, "Contra", "asked for");
    programs.close(ours);
    programs.close(kart);
    assert!(bridge.ctl("profile auto:super-mario").status.success());
    await_profile(&bridge, "Super Mario", "none is for the program in front");
}

#[test]
fn where_the_program_in_front_cannot_be_known_it_is_said_with_the_way_out() {
    for (environment, why) in [
        (&[][..], "DISPLAY is not set"),
        (&[("DISPLAY", ":65000")][..], "cannot be known"),
        (
            &[("DISPLAY", ":65000"), ("WAYLAND_DISPLAY", "wayland-0")][..],
            "the Wayland compositor does not answer",
        ),
    ] {
        let bridge = follow(tempfile::tempdir().unwrap(), environment);
        await_profile(&bridge, "Tetris", why);
        await_profile(&bridge, "Tetris", "choose with `tactpad ctl profile NAME`");
        assert_eq!(bridge.told().matches(why).count(), 1, "{}", bridge.told());
    }
}
