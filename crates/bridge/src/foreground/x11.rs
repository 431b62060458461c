//! The program in front, as an X server tells it: its own, XWayland's for what runs on that, or gamescope's.

use std::fs;

use x11rb::connection::Connection;
use x11rb::errors::{ConnectionError, ReplyError};
use x11rb::properties::WmClass;
use x11rb::protocol::xproto::{Atom, AtomEnum, ConnectionExt as _, Window};
use x11rb::rust_connection::RustConnection;

use super::program::{Foreground, OwnProgram};

/// A toolkit may give the keyboard to a window inside the one that says whose it is; that is so many windows above it at most.
const WINDOWS_ABOVE_MAX: usize = 16;

/// So many numbers of a property are read at most.
const NUMBERS_MAX: u32 = 3 * 256;

/// What gamescope, which has no window manager beside it, tells on the root window of its first X server.
struct Gamescope {
    /// The window in front.
    focused: Atom,
    /// Three numbers for each window: it, Steam's number of the game, and its process.
    windows: Atom,
}

/// A window that gamescope has in front.
struct GamescopeWindow {
    window: Window,
    process: Option<u32>,
}

/// A connection to the X server that is asked for the program in front.
pub(super) struct XServer {
    connection: RustConnection,
    root: Window,
    active_window: Atom,
    process: Atom,
    machine: Atom,
    gamescope: Gamescope,
    own: OwnProgram,
}

impl XServer {
    /// Connects to the X server of the environment.
    ///
    /// # Errors
    /// There is none.
    pub(super) fn open(own: OwnProgram) -> Result<Self, String> {
        let (connection, screen) = x11rb::connect(None).map_err(|error| error.to_string())?;
        Self::on(connection, screen, own).map_err(|error| error.to_string())
    }

    fn on(connection: RustConnection, screen: usize, own: OwnProgram) -> Result<Self, ReplyError> {
        let atom =
            |name: &str| connection.intern_atom(false, name.as_bytes())?.reply().map(|reply| reply.atom);
        let active_window = atom("_NET_ACTIVE_WINDOW")?;
        let process = atom("_NET_WM_PID")?;
        let machine = atom("WM_CLIENT_MACHINE")?;
        let gamescope = Gamescope {
            focused: atom("GAMESCOPE_FOCUSED_WINDOW")?,
            windows: atom("GAMESCOPE_FOCUSABLE_WINDOWS")?,
        };
        let root = connection.setup().roots.get(screen).map_or(x11rb::NONE, |screen| screen.root);
        Ok(Self { root, active_window, process, machine, gamescope, own, connection })
    }

    /// Who has the keyboard now.
    ///
    /// # Errors
    /// The X server does not answer any more.
    pub(super) fn front(&self) -> Result<Foreground, String> {
        self.asked().map_err(|error| error.to_string())
    }

    /// Whether gamescope keeps this server's windows.
    pub(super) fn is_gamescope(&self) -> bool {
        passed(self.numbers(self.root, self.gamescope.windows))
            .ok()
            .flatten()
            .is_some_and(|it| !it.is_empty())
    }

    fn asked(&self) -> Result<Foreground, ReplyError> {
        let mut window = match self.chosen_by_gamescope()? {
            Some(GamescopeWindow { process: Some(process), .. }) if process > 0 => {
                return Ok(self.own.or_program(Vec::new(), Some(process)));
            }
            Some(GamescopeWindow { window, .. }) => window,
            None => self.focused()?,
        };
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
        let is_here = id.is_some() && self.is_here(window)?;
        Ok(Some(self.own.or_program(classes, id.filter(|_| is_here))))
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

    /// The window that gamescope has in front, on whichever of its X servers that is.
    fn chosen_by_gamescope(&self) -> Result<Option<GamescopeWindow>, ReplyError> {
        let focused = passed(self.numbers(self.root, self.gamescope.focused))?.unwrap_or_default();
        let Some(window) = focused.first().copied().filter(|window| *window != x11rb::NONE) else {
            return Ok(None);
        };
        let windows = passed(self.numbers(self.root, self.gamescope.windows))?.unwrap_or_default();
        let process = windows.chunks_exact(3).find(|it| it[0] == window).map(|it| it[2]);
        Ok(Some(GamescopeWindow { window, process }))
    }

    fn numbers(&self, window: Window, name: Atom) -> Result<Vec<u32>, ReplyError> {
        let kind = AtomEnum::CARDINAL;
        let property = self.connection.get_property(false, window, name, kind, 0, NUMBERS_MAX)?.reply()?;
        Ok(property.value32().map_or(Vec::new(), Iterator::collect))
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
