//! Which program is in front: the one whose window has the keyboard, as the X server tells it.

use std::env;
use std::fs;
use std::path::PathBuf;

use x11rb::connection::Connection;
use x11rb::errors::{ConnectionError, ReplyError};
use x11rb::properties::WmClass;
use x11rb::protocol::xproto::{Atom, AtomEnum, ConnectionExt as _, Window};
use x11rb::rust_connection::RustConnection;

/// A toolkit may give the keyboard to a window inside the one that says whose it is; that is so many windows above it at most.
const WINDOWS_ABOVE_MAX: usize = 16;

/// The window that has the keyboard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Foreground {
    /// None has it, or one that says nothing of itself.
    Unknown,
    /// One of this program.
    OwnProgram,
    /// One of another program.
    Program {
        /// The words of its class (`WM_CLASS`).
        classes: Vec<String>,
        /// The path of the executable that its process runs, if that can be known.
        executable: Option<String>,
    },
}

/// A connection to the X server that is asked for the program in front.
pub struct WindowSystem {
    connection: RustConnection,
    root: Window,
    active_window: Atom,
    process: Atom,
    machine: Atom,
    own: Option<PathBuf>,
}

/// Why nobody can tell which program is in front, and the way out, in one sentence.
fn unknown(why: &str) -> String {
    format!("which program is in front cannot be known ({why}): choose with `tactpad ctl profile NAME`")
}

impl WindowSystem {
    /// Connects to the X server of the environment.
    ///
    /// # Errors
    /// There is none, or this is a Wayland session: that tells nobody which window has the keyboard. The text is for people.
    pub fn open() -> Result<Self, String> {
        let is_set = |name: &str| env::var_os(name).is_some_and(|value| !value.is_empty());
        if is_set("WAYLAND_DISPLAY") {
            return Err(unknown("Wayland tells no program"));
        }
        if !is_set("DISPLAY") {
            return Err(unknown("DISPLAY is not set"));
        }
        let (connection, screen) = x11rb::connect(None).map_err(|error| unknown(&error.to_string()))?;
        Self::on(connection, screen).map_err(|error| unknown(&error.to_string()))
    }

    fn on(connection: RustConnection, screen: usize) -> Result<Self, ReplyError> {
        let atom = |name: &[u8]| connection.intern_atom(false, name)?.reply().map(|reply| reply.atom);
        let active_window = atom(b"_NET_ACTIVE_WINDOW")?;
        let process = atom(b"_NET_WM_PID")?;
        let machine = atom(b"WM_CLIENT_MACHINE")?;
        let root = connection.setup().roots.get(screen).map_or(x11rb::NONE, |screen| screen.root);
        Ok(Self { root, active_window, process, machine, own: env::current_exe().ok(), connection })
    }

    /// Who has the keyboard now.
    ///
    /// # Errors
    /// The X server does not answer any more; the text is for people.
    pub fn front(&self) -> Result<Foreground, String> {
        self.asked().map_err(|error| unknown(&error.to_string()))
    }

    fn asked(&self) -> Result<Foreground, ReplyError> {
        let mut window = self.focused()?;
        // Windows come and go while one asks: what is gone says nothing.
        for _ in 0..WINDOWS_ABOVE_MAX {
            if window <= 1 || window == self.root {
                return Ok(Foreground::Unknown);
            }
            if let Some(front) = passed(self.owner(window))?.flatten() {
                return Ok(front);
            }
            let Some(tree) = passed(self.connection.query_tree(window)?.reply())? else { break };
            window = tree.parent;
        }
        Ok(Foreground::Unknown)
    }

    /// The window that the window manager says is active; without one, that which has the keyboard.
    fn focused(&self) -> Result<Window, ReplyError> {
        match passed(self.number(self.root, self.active_window, AtomEnum::WINDOW.into()))?.flatten() {
            Some(window) if window != x11rb::NONE => Ok(window),
            _ => Ok(self.connection.get_input_focus()?.reply()?.focus),
        }
    }

    /// Whose window it is, if it says so.
    fn owner(&self, window: Window) -> Result<Option<Foreground>, ReplyError> {
        let class = WmClass::get(&self.connection, window)?.reply()?;
        let classes = class.map_or(Vec::new(), |class| {
            let words = [class.instance(), class.class()];
            words.iter().map(|word| String::from_utf8_lossy(word).into_owned()).collect()
        });
        let id = self.number(window, self.process, AtomEnum::CARDINAL.into())?;
        if classes.is_empty() && id.is_none() {
            return Ok(None);
        }
        let path = match id {
            Some(id) if self.is_here(window)? => fs::read_link(format!("/proc/{id}/exe")).ok(),
            _ => None,
        };
        if path.is_some() && path == self.own {
            return Ok(Some(Foreground::OwnProgram));
        }
        let executable = path.map(|path| path.to_string_lossy().trim_end_matches(" (deleted)").to_owned());
        Ok(Some(Foreground::Program { classes, executable }))
    }

    /// Whether a window's program runs on this machine: the number of another machine's process means nothing here.
    fn is_here(&self, window: Window) -> Result<bool, ReplyError> {
        let asked = self.connection.get_property(false, window, self.machine, AtomEnum::ANY, 0, 64)?;
        let told = asked.reply()?.value;
        let here = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        let told = String::from_utf8_lossy(&told);
        let told = told.trim_end_matches('\0');
        Ok(told.is_empty() || told == here.trim())
    }

    fn number(&self, window: Window, name: Atom, kind: Atom) -> Result<Option<u32>, ReplyError> {
        let property = self.connection.get_property(false, window, name, kind, 0, 1)?.reply()?;
        Ok(property.value32().and_then(|mut values| values.next()))
    }
}

/// The server's answer; `None` where it could not give one, as for a window that is gone.
fn passed<T>(answer: Result<T, ReplyError>) -> Result<Option<T>, ReplyError> {
    match answer {
        Ok(answer) => Ok(Some(answer)),
        Err(ReplyError::X11Error(_) | ReplyError::ConnectionError(ConnectionError::ParseError(_))) => {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}
