//! The program in front, by a compositor that lists its windows for panels (`wlr-foreign-toplevel-management`): sway, labwc, Hyprland and
//! others.

use std::collections::BTreeMap;
use std::io;

use super::program::Foreground;
use super::wayland::{Connection, DISPLAY, Message, number, text};

/// The list of windows, by its name in the compositor's registry.
const MANAGER: &str = "zwlr_foreign_toplevel_manager_v1";

/// Our names for objects, in the order in which they are made.
const REGISTRY: u32 = 2;
const GLOBALS_TOLD: u32 = 3;
const LIST: u32 = 4;
const WINDOWS_TOLD: u32 = 5;

/// Requests.
const SYNC: u16 = 0;
const GET_REGISTRY: u16 = 1;
const BIND: u16 = 0;
const DESTROY: u16 = 7;

/// Events, each of the object that it stands behind.
const ERROR: u16 = 0;
const GLOBAL: u16 = 0;
const TOPLEVEL: u16 = 0;
const FINISHED: u16 = 1;
const APP_ID: u16 = 1;
const STATE: u16 = 4;
const CLOSED: u16 = 6;

/// The state of a window that has the keyboard.
const ACTIVATED: u32 = 2;

/// More messages before the answer are no answer.
const RECEIVES_MAX: usize = 64;

/// What is told of a window.
#[derive(Debug, Default, PartialEq, Eq)]
struct Toplevel {
    app_id: String,
    is_activated: bool,
}

/// The windows of a compositor.
pub(super) struct Toplevels {
    connection: Connection,
    windows: Windows,
}

impl Toplevels {
    /// Connects to the compositor of the environment.
    ///
    /// # Errors
    /// There is none, or it lists no windows.
    pub(super) fn open() -> Result<Self, String> {
        let mut toplevels = Self {
            connection: Connection::open().map_err(|why| no_compositor(&why))?,
            windows: Windows::default(),
        };
        toplevels.bind().map_err(|why| no_compositor(&why))?;
        if toplevels.windows.manager.is_none() {
            return Err("this Wayland compositor tells no program".into());
        }
        Ok(toplevels)
    }

    /// Asks for the list, if there is one, and waits until all windows were told.
    fn bind(&mut self) -> io::Result<()> {
        self.connection.send(DISPLAY, GET_REGISTRY, &number(REGISTRY))?;
        self.await_answer(GLOBALS_TOLD)?;
        if let Some(manager) = self.windows.manager {
            let version = number(1);
            let arguments = [number(manager), text(MANAGER), version, number(LIST)].concat();
            self.connection.send(REGISTRY, BIND, &arguments)?;
            self.await_answer(WINDOWS_TOLD)?;
        }
        self.connection.wait_no_more()
    }

    /// Waits until all that was asked before is answered.
    fn await_answer(&mut self, callback: u32) -> io::Result<()> {
        self.connection.send(DISPLAY, SYNC, &number(callback))?;
        for _ in 0..RECEIVES_MAX {
            let messages = self.connection.receive()?;
            if messages.is_empty() {
                return Err(io::ErrorKind::TimedOut.into());
            }
            let is_answered = messages.iter().any(|message| message.object == callback);
            self.take(&messages)?;
            if is_answered {
                return Ok(());
            }
        }
        Err(io::ErrorKind::InvalidData.into())
    }

    fn take(&mut self, messages: &[Message]) -> io::Result<()> {
        for message in messages {
            if let Some(closed) = self.windows.take(message)? {
                self.connection.send(closed, DESTROY, &[])?;
            }
        }
        Ok(())
    }

    /// Who has the keyboard now.
    ///
    /// # Errors
    /// The compositor is gone.
    pub(super) fn front(&mut self) -> Result<Foreground, String> {
        loop {
            let messages = self.connection.receive().map_err(|why| no_compositor(&why))?;
            if messages.is_empty() {
                return Ok(self.windows.front());
            }
            self.take(&messages).map_err(|why| no_compositor(&why))?;
        }
    }
}

fn no_compositor(why: &io::Error) -> String {
    let why = why.to_string();
    let why = why.split(" (os error").next().unwrap_or_default();
    format!("the Wayland compositor does not answer: {why}")
}

/// What was told so far.
#[derive(Debug, Default)]
struct Windows {
    /// The registry's number of the list.
    manager: Option<u32>,
    open: BTreeMap<u32, Toplevel>,
}

impl Windows {
    /// Takes what a message tells; the window that it closes, if it does.
    fn take(&mut self, message: &Message) -> io::Result<Option<u32>> {
        let mut words = message.words();
        match (message.object, message.event) {
            (DISPLAY, ERROR) | (LIST, FINISHED) => return Err(io::ErrorKind::ConnectionAborted.into()),
            (REGISTRY, GLOBAL) => {
                let named = words.number().zip(words.text());
                self.manager =
                    named.filter(|(_, name)| name == MANAGER).map(|(global, _)| global).or(self.manager);
            }
            (LIST, TOPLEVEL) => {
                self.open.extend(words.number().map(|window| (window, Toplevel::default())));
            }
            (window, CLOSED) if self.open.remove(&window).is_some() => return Ok(Some(window)),
            (window, event) => {
                let Some(window) = self.open.get_mut(&window) else { return Ok(None) };
                match event {
                    APP_ID => window.app_id = words.text().unwrap_or_default(),
                    STATE => {
                        let states = words.array().unwrap_or_default();
                        window.is_activated =
                            states.chunks_exact(4).any(|state| state == ACTIVATED.to_ne_bytes());
                    }
                    _ => {}
                }
            }
        }
        Ok(None)
    }

    fn front(&self) -> Foreground {
        match self.open.values().find(|window| window.is_activated) {
            Some(window) if !window.app_id.is_empty() => {
                Foreground::Program { classes: vec![window.app_id.clone()], executable: None }
            }
            _ => Foreground::Unknown,
        }
    }
}
