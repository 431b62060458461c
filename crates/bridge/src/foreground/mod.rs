//! Which program is in front: the one whose window has the keyboard, as the desktop tells it.

#[cfg(feature = "dbus")]
mod kwin;
mod program;
mod toplevels;
mod wayland;
mod x11;

use std::env;

#[cfg(feature = "dbus")]
use self::kwin::Kwin;
use self::program::OwnProgram;
use self::toplevels::Toplevels;
use self::x11::XServer;

pub use self::program::Foreground;

/// A desktop that is asked for the program in front. It may wait for the desktop: ask on a thread that nothing waits for.
pub struct WindowSystem(Asked);

enum Asked {
    XServer(Box<XServer>),
    Toplevels(Toplevels),
    #[cfg(feature = "dbus")]
    Kwin(Kwin),
}

/// Why nobody can tell which program is in front, and the way out, in one sentence.
fn unknown(why: &str) -> String {
    format!("which program is in front cannot be known ({why}): choose with `tactpad ctl profile NAME`")
}

impl WindowSystem {
    /// Connects to the desktop of the environment: the X server; on Wayland a compositor that lists its windows, as those of wlroots do,
    /// KWin, or gamescope.
    ///
    /// # Errors
    /// There is none, or it tells nobody which window has the keyboard. The text is for people.
    pub fn open() -> Result<Self, String> {
        let is_set = |name: &str| env::var_os(name).is_some_and(|value| !value.is_empty());
        let asked = if is_set("WAYLAND_DISPLAY") {
            on_wayland(is_set("DISPLAY"))
        } else if is_set("DISPLAY") {
            XServer::open(OwnProgram::here()).map(Box::new).map(Asked::XServer)
        } else {
            Err("DISPLAY is not set".into())
        };
        asked.map(Self).map_err(|why| unknown(&why))
    }

    /// Who has the keyboard now.
    ///
    /// # Errors
    /// The desktop does not answer any more; the text is for people.
    pub fn front(&mut self) -> Result<Foreground, String> {
        let front = match &mut self.0 {
            Asked::XServer(server) => server.front(),
            Asked::Toplevels(toplevels) => toplevels.front(),
            #[cfg(feature = "dbus")]
            Asked::Kwin(kwin) => kwin.front(),
        };
        front.map_err(|why| unknown(&why))
    }
}

/// Who tells it on Wayland, which itself has no word for it.
fn on_wayland(has_x_server: bool) -> Result<Asked, String> {
    let why = match Toplevels::open() {
        Ok(toplevels) => return Ok(Asked::Toplevels(toplevels)),
        Err(why) => why,
    };
    #[cfg(feature = "dbus")]
    if let Ok(kwin) = Kwin::open(OwnProgram::here()) {
        return Ok(Asked::Kwin(kwin));
    }
    // An X server below another compositor knows its own windows alone.
    let server = if has_x_server { XServer::open(OwnProgram::here()).ok() } else { None };
    server.filter(XServer::is_gamescope).map(Box::new).map(Asked::XServer).ok_or(why)
}
