//! Key presses through the X server, for machines where no virtual device may be made.
//!
//! They reach X11 programs only, and nothing releases them when the program is killed; dropping the sink
//! does. Keys go out by number, not by symbol: the X server numbers a key 8 higher than the kernel, so a
//! profile means the same key here as with the virtual keyboard. A symbol that the layout has only with Shift
//! would be moved to a spare key, and each later press would then come 12 ms late (enigo-rs/enigo#489).

use enigo::{Direction, Enigo, InputError, Keyboard, NewConError, Settings};
use x11rb::connection::Connection;
use x11rb::errors::{ConnectError, ReplyError};
use x11rb::protocol::xproto::ConnectionExt;

use super::{Sink, SinkError};
use crate::control::{Code, Device, OutputEvent};

/// What the X server adds to the kernel's number of a key.
const OFFSET: u16 = 8;

/// A key that every layout has in the same place: up, with its symbol `XK_Up`.
const UP: (u8, u32) = (111, 0xff52);

/// Key presses on one X display. Dropping it releases what it holds.
pub struct X11Sink {
    enigo: Enigo,
    display: String,
    /// Whether the layout gives the key of this number a symbol.
    has_symbol: Vec<bool>,
}

impl X11Sink {
    /// Connects to `display`, for example `:0`, or to the one of the environment.
    ///
    /// # Errors
    /// No X server answers, or it takes no key presses from programs, or it numbers its keys in another way.
    pub fn open(display: Option<&str>) -> Result<Self, SinkError> {
        let environment = || std::env::var("DISPLAY").unwrap_or_default();
        let place = display.map_or_else(environment, str::to_owned);
        let (connection, _) = x11rb::connect(display).map_err(|error| no_server(&place, &error))?;
        let has_symbol = read_layout(&connection, &place)?;
        let settings = Settings { x11_display: display.map(str::to_owned), ..Settings::default() };
        let enigo = Enigo::new(&settings).map_err(|error| no_injection(&place, &error))?;
        Ok(Self { enigo, display: place, has_symbol })
    }

    fn key(&self, event: &OutputEvent) -> Result<u16, SinkError> {
        let Code::Key(number) = event.code else {
            return Err(no_gamepad());
        };
        let key = number.saturating_add(OFFSET);
        match self.has_symbol.get(usize::from(key)) {
            Some(true) => Ok(key),
            _ => Err(self.no_key(event.code)),
        }
    }

    fn no_key(&self, code: Code) -> SinkError {
        let message = format!(
            "the keyboard layout of X display {} has no {code}: bind another key or use `--output uinput`",
            self.display
        );
        SinkError { message }
    }
}

/// For each key number of the server, whether it has a symbol; checks on the way that key presses can be
/// sent.
fn read_layout(connection: &impl Connection, place: &str) -> Result<Vec<bool>, SinkError> {
    let failed = |error: ReplyError| no_answer(place, &error);
    let present = |name: &[u8]| connection.query_extension(name)?.reply().map(|reply| reply.present);
    if !present(b"XTEST").map_err(failed)? || !present(b"XInputExtension").map_err(failed)? {
        return Err(no_extension(place));
    }
    let (first, last) = (connection.setup().min_keycode, connection.setup().max_keycode);
    let count = last.saturating_sub(first).saturating_add(1);
    let mapping = connection.get_keyboard_mapping(first, count).map_err(ReplyError::from);
    let mapping = mapping.and_then(|cookie| cookie.reply()).map_err(failed)?;
    let width = usize::from(mapping.keysyms_per_keycode).max(1);
    let symbols = |key: u8| mapping.keysyms.chunks(width).nth(usize::from(key.checked_sub(first)?));
    if !symbols(UP.0).is_some_and(|of_key| of_key.contains(&UP.1)) {
        return Err(other_numbers(place));
    }
    let has_symbol = |key| symbols(key).is_some_and(|of_key| of_key.iter().any(|symbol| *symbol != 0));
    Ok((0..=u8::MAX).map(has_symbol).collect())
}

impl Sink for X11Sink {
    fn prepare(&mut self, device: Device) -> Result<(), SinkError> {
        match device {
            Device::Keyboard => Ok(()),
            Device::Gamepad => Err(no_gamepad()),
        }
    }

    /// Sends one key after the other: the X server knows no groups.
    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        for event in group {
            self.prepare(event.device)?;
            self.key(event)?;
        }
        for event in group {
            let direction = if event.value == 0 { Direction::Release } else { Direction::Press };
            let key = self.key(event)?;
            self.enigo.raw(key, direction).map_err(|error| lost(&self.display, &error))?;
        }
        Ok(())
    }

    fn describe(&self) -> String {
        format!("keys on X display {} (X11 programs only)", self.display)
    }
}

fn no_gamepad() -> SinkError {
    let message =
        "the X server has no gamepads: set `output = \"keyboard\"` in the profile or use `--output uinput`";
    SinkError { message: message.into() }
}

fn no_server(place: &str, error: &ConnectError) -> SinkError {
    let message = if place.is_empty() {
        "no X server: DISPLAY is not set, so run this in a desktop session or use `--output uinput`".into()
    } else {
        format!("no X server answers on display `{place}` ({error}): set DISPLAY or use `--output uinput`")
    };
    SinkError { message }
}

fn no_answer(place: &str, error: &ReplyError) -> SinkError {
    SinkError {
        message: format!("X display {place} does not say which keys it has ({error}): use `--output uinput`"),
    }
}

fn no_extension(place: &str) -> SinkError {
    let message = format!(
        "X display {place} takes no key presses from programs: start its server with the extension XTEST or \
         use `--output uinput`"
    );
    SinkError { message }
}

fn no_injection(place: &str, error: &NewConError) -> SinkError {
    SinkError {
        message: format!("no key presses can be sent to X display {place} ({error}): use `--output uinput`"),
    }
}

fn other_numbers(place: &str) -> SinkError {
    let message = format!(
        "X display {place} does not number its keys as Linux does, so wrong ones would be pressed: use \
         `--output uinput`"
    );
    SinkError { message }
}

fn lost(place: &str, error: &InputError) -> SinkError {
    SinkError { message: format!("X display {place} takes no keys any more ({error}): start again") }
}
