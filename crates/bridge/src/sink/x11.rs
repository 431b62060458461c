//! Key presses and the pointer through the X server, for machines where no virtual device may be made.
//!
//! They reach X11 programs only, and nothing releases them when the program is killed; dropping the sink
//! does. A thread of its own writes to the server: one that stands still keeps nobody waiting. Keys go out by number, not by symbol: the X server numbers a key 8 higher than the kernel, so a
//! profile means the same key here as with the virtual keyboard.
//!
//! The pointer goes through enigo. Keys do not: for each, enigo asks the server for all its devices before it
//! sends the key, which takes more than twice as long; and a symbol that the layout has only with Shift it
//! moves to a spare key, after which each press comes 12 ms late (enigo-rs/enigo#489).

use std::collections::BTreeSet;
use std::fmt;
use std::io;

use enigo::{Axis, Button, Coordinate, Direction, Enigo, InputResult, Mouse, NewConError, Settings};
use x11rb::connection::Connection;
use x11rb::errors::{ConnectError, ReplyError};
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{ConnectionExt as _, KEY_PRESS_EVENT, KEY_RELEASE_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use super::queued::QueuedGroups;
use super::{Sink, SinkError};
use crate::queue::{OnWritten, WriteQueue};
use tactpad_core::pipeline::control::names::{POINTER_PLACE_MAX, POINTER_WHEEL};
use tactpad_core::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad_core::pipeline::mapping::profile::Binding;

/// The offset of the X server's key codes from the kernel's.
const OFFSET: u16 = 8;

/// A key that every layout has in the same place: up, with its symbol `XK_Up`.
const UP: (u8, u32) = (111, 0xff52);

/// So many actions may wait for a server that stands still.
const QUEUE_ACTIONS_MAX: usize = 2_048;

/// Key presses and the pointer on one X display. Dropping it releases what it holds.
pub struct X11Sink {
    groups: QueuedGroups<X11Action>,
    /// Why the pointer cannot be moved, if so.
    pointer_error: Option<String>,
    keyboard: KeyboardLayout,
}

/// The keys of an X display.
struct KeyboardLayout {
    display: String,
    /// Whether the layout gives the key of this number a symbol.
    has_symbol: Vec<bool>,
}

/// The thread that writes to the server.
struct X11Writer {
    connection: RustConnection,
    /// Moves the pointer.
    enigo: Option<Enigo>,
    display: String,
}

/// One thing for the X server to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum X11Action {
    /// The key of this number, on its way down or up.
    Key(u8, Direction),
    /// A button of the pointer, on its way down or up.
    Button(Button, Direction),
    /// The pointer by so many counts to the right and down.
    Move(i32, i32),
    /// The pointer to this share of the screen's width.
    Across(i32),
    /// The pointer to this share of the screen's height.
    Down(i32),
    /// The wheel by so many notches towards the hand.
    Scroll(i32),
    /// Nothing, once all before it is done: a server forgets what it has not read of a client that is gone.
    Sync,
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
        // Its delay is for buttons: each would come that much later.
        let x11_display = Some(place.clone()).filter(|place| !place.is_empty());
        let settings = Settings { linux_delay: 0, x11_display, ..Settings::default() };
        let (enigo, pointer_error) = match Enigo::new(&settings) {
            Ok(enigo) => (Some(enigo), None),
            Err(error) => (None, Some(no_injection(&place, &error).message)),
        };
        let mut writer = X11Writer { connection, enigo, display: place.clone() };
        let queue = WriteQueue::start("x11", QUEUE_ACTIONS_MAX, move |actions| writer.write(actions))
            .map_err(|error| failed(&error))?;
        let keyboard = KeyboardLayout { display: place, has_symbol };
        Ok(Self { groups: QueuedGroups::new(queue), pointer_error, keyboard })
    }
}

impl KeyboardLayout {
    /// The server's actions for these events.
    fn actions(&self, events: &[OutputEvent]) -> Result<Vec<X11Action>, SinkError> {
        events.iter().map(|event| self.act(event)).collect()
    }

    fn act(&self, event: &OutputEvent) -> Result<X11Action, SinkError> {
        let direction = if event.value == 0 { Direction::Release } else { Direction::Press };
        match (event.device, event.code) {
            (OutputDevice::Gamepad, _) => Err(no_gamepad()),
            (OutputDevice::Keyboard, code) => self.key(code).map(|key| X11Action::Key(key, direction)),
            (OutputDevice::Pointer, Code::Relative(0x00)) => Ok(X11Action::Move(event.value, 0)),
            (OutputDevice::Pointer, Code::Relative(0x01)) => Ok(X11Action::Move(0, event.value)),
            (OutputDevice::Pointer, POINTER_WHEEL) => Ok(X11Action::Scroll(-event.value)),
            (OutputDevice::Pointer, Code::Key(0x110)) => Ok(X11Action::Button(Button::Left, direction)),
            (OutputDevice::Pointer, Code::Key(0x111)) => Ok(X11Action::Button(Button::Right, direction)),
            (OutputDevice::Pointer, Code::Key(0x112)) => Ok(X11Action::Button(Button::Middle, direction)),
            (OutputDevice::Tablet, Code::Axis(0x00)) => Ok(X11Action::Across(event.value)),
            (OutputDevice::Tablet, Code::Axis(0x01)) => Ok(X11Action::Down(event.value)),
            (OutputDevice::Pointer | OutputDevice::Tablet, code) => Err(no_such_movement(code)),
        }
    }

    fn key(&self, code: Code) -> Result<u8, SinkError> {
        let number = if let Code::Key(number) = code { number.saturating_add(OFFSET) } else { 0 };
        let key = u8::try_from(number).ok();
        let has_symbol = |key: &u8| self.has_symbol.get(usize::from(*key)) == Some(&true);
        key.filter(has_symbol).ok_or_else(|| self.no_key(code))
    }

    fn no_key(&self, code: Code) -> SinkError {
        self.no_keys(&code.to_string())
    }

    fn no_keys(&self, names: &str) -> SinkError {
        let message = format!(
            "the keyboard layout of X display {} has no {names}: bind other keys or use `--output uinput`",
            self.display
        );
        SinkError { message }
    }
}

impl X11Writer {
    /// Writes one action after the other: the X server knows no groups. Keys are out when they are on their way: a server that is
    /// busy takes them in their order.
    fn write(&mut self, actions: &[X11Action]) -> io::Result<()> {
        actions.iter().try_for_each(|action| self.perform(*action))?;
        self.connection.flush().map_err(|error| lost(&self.display, &error))?;
        while let Some(event) =
            self.connection.poll_for_event().map_err(|error| lost(&self.display, &error))?
        {
            if let Event::Error(error) = event {
                return Err(lost(&self.display, &ReplyError::X11Error(error)));
            }
        }
        Ok(())
    }

    fn perform(&mut self, action: X11Action) -> io::Result<()> {
        if let X11Action::Key(key, direction) = action {
            let kind = if direction == Direction::Press { KEY_PRESS_EVENT } else { KEY_RELEASE_EVENT };
            // Its errors come as events.
            return match self.connection.xtest_fake_input(
                kind,
                key,
                x11rb::CURRENT_TIME,
                x11rb::NONE,
                0,
                0,
                0,
            ) {
                Ok(_) => Ok(()),
                Err(error) => Err(lost(&self.display, &error)),
            };
        }
        if action == X11Action::Sync {
            return self.connection.sync().map_err(|error| lost(&self.display, &error));
        }
        // Who has no pointer was refused before.
        let Some(enigo) = &mut self.enigo else { return Ok(()) };
        let done = match action {
            X11Action::Button(button, direction) => enigo.button(button, direction),
            X11Action::Across(share) => go_to(enigo, share, true),
            X11Action::Down(share) => go_to(enigo, share, false),
            X11Action::Move(right, down) => enigo.move_mouse(right, down, Coordinate::Rel),
            X11Action::Scroll(notches) => enigo.scroll(notches, Axis::Vertical),
            X11Action::Key(..) | X11Action::Sync => Ok(()),
        };
        done.map_err(|error| lost(&self.display, &error))
    }
}

/// Puts the pointer to a share of the screen, across it or down; along the other side it stays where it is.
fn go_to(enigo: &mut Enigo, share: i32, is_across: bool) -> InputResult<()> {
    let ((width, height), (x, y)) = (enigo.main_display()?, enigo.location()?);
    // Share 1 is the first pixel, the last share is the last one.
    let pixel = |size: i32| {
        let way = i64::from(share - 1) * i64::from(size - 1) / i64::from(POINTER_PLACE_MAX - 1);
        i32::try_from(way).unwrap_or(0)
    };
    let (x, y) = if is_across { (pixel(width), y) } else { (x, pixel(height)) };
    enigo.move_mouse(x, y, Coordinate::Abs)
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
    fn prepare(&mut self, device: OutputDevice) -> Result<(), SinkError> {
        match device {
            OutputDevice::Keyboard => Ok(()),
            OutputDevice::Gamepad => Err(no_gamepad()),
            OutputDevice::Pointer | OutputDevice::Tablet => match &self.pointer_error {
                Some(error) => Err(SinkError { message: error.clone() }),
                None => Ok(()),
            },
        }
    }

    fn accepts(&self, bindings: &[Binding]) -> Result<(), SinkError> {
        let keys = bindings.iter().filter(|binding| binding.device == OutputDevice::Keyboard);
        let lacking: BTreeSet<Code> =
            keys.map(|binding| binding.code).filter(|code| self.keyboard.key(*code).is_err()).collect();
        let lacking: Vec<String> = lacking.iter().map(Code::to_string).collect();
        if lacking.is_empty() { Ok(()) } else { Err(self.keyboard.no_keys(&lacking.join(", "))) }
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        self.write_then(group, Box::new(|| ()))
    }

    fn write_then(&mut self, group: &[OutputEvent], written: OnWritten) -> Result<(), SinkError> {
        let actions = |events: &[OutputEvent]| self.keyboard.actions(events).map_err(io::Error::other);
        self.groups.write(group, written, actions).map_err(|error| failed(&error))
    }

    fn settle(&mut self) -> Result<(), SinkError> {
        self.groups
            .push(vec![X11Action::Sync])
            .and_then(|()| self.groups.settle())
            .map_err(|error| failed(&error))
    }

    fn dropped(&self) -> u64 {
        self.groups.dropped()
    }

    fn waiting(&self) -> u64 {
        self.groups.waiting()
    }

    fn describe(&self) -> String {
        format!("keys and pointer of X display {} (X11 programs only)", self.keyboard.display)
    }
}

impl Drop for X11Sink {
    fn drop(&mut self) {
        // Where this fails the server is gone, and with it what it held. The queue waits a little for it.
        let _ = self.write(&self.groups.releases()).and_then(|()| self.settle());
    }
}

fn no_gamepad() -> SinkError {
    let message =
        "the X server has no gamepads: set `output = \"keyboard\"` in the profile or use `--output uinput`";
    SinkError { message: message.into() }
}

fn no_such_movement(code: Code) -> SinkError {
    SinkError { message: format!("the pointer of the X server has no {code}: use `--output uinput`") }
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
        message: format!("the pointer of X display {place} cannot be moved ({error}): use `--output uinput`"),
    }
}

fn other_numbers(place: &str) -> SinkError {
    let message = format!(
        "X display {place} does not number its keys as Linux does, so wrong ones would be pressed: use \
         `--output uinput`"
    );
    SinkError { message }
}

fn lost(place: &str, error: &impl fmt::Display) -> io::Error {
    io::Error::other(format!("X display {place} takes no events any more ({error}): start again"))
}

/// The error of the thread that writes, which says it all.
fn failed(error: &io::Error) -> SinkError {
    SinkError { message: error.to_string() }
}
