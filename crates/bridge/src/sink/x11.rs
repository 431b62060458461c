//! Key presses and the pointer through the X server, for machines where no virtual device may be made.
//!
//! They reach X11 programs only. Dropping the sink releases them. The server does not when the program is killed, so what is held stands in
//! a record, by which a process that outlives this one (`x11/guardian.rs`), or else the next start, lifts it (`x11/left_down.rs`). A thread of its own writes to the server: one that stands still keeps nobody waiting. Keys go out by number, not by symbol: the X server numbers a key 8 higher than the kernel, so a
//! profile means the same key here as with the virtual keyboard.
//!
//! The pointer goes through enigo. Keys do not: for each, enigo asks the server for all its devices before it
//! sends the key, which takes more than twice as long; and a symbol that the layout has only with Shift it
//! moves to a spare key, after which each press comes 12 ms late (enigo-rs/enigo#489).

mod guardian;
mod held_record;
mod left_down;
mod writer;

use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use std::process::Command;

use enigo::{Button, Direction, Enigo, NewConError, Settings};
use x11rb::connection::Connection;
use x11rb::errors::{ConnectError, ReplyError};
use x11rb::protocol::xproto::ConnectionExt as _;
use x11rb::protocol::{xinput, xtest};

pub use self::guardian::guard;
use self::held_record::HeldRecord;
pub use self::left_down::{LeftDown, Treatment, left_down};
use self::writer::{X11Action, X11Writer};
use super::queued::QueuedGroups;
use super::{Sink, SinkError};
use crate::queue::{OnWritten, WriteQueue};
use tactpad_core::pipeline::control::names::POINTER_WHEEL;
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

/// Where it stands what a sink holds, and who lifts that if the sink's process is killed.
#[derive(Debug)]
pub struct HeldRecords<'p> {
    /// The folder of the records.
    pub folder: &'p Path,
    /// A program that calls [`guard`] with its last argument, which this adds; without one the next start lifts.
    pub guardian: Option<Command>,
}

/// The keys of an X display.
struct KeyboardLayout {
    display: String,
    /// Whether the layout gives the key of this number a symbol.
    has_symbol: Vec<bool>,
}

impl X11Sink {
    /// Connects to `display`, for example `:0`, or to the one of the environment. In `records`, if there are any, stands what is held as
    /// long as it plays.
    ///
    /// # Errors
    /// No X server answers, or it takes no key presses from programs, or it numbers its keys in another way; or the folder takes no
    /// file; or the guardian does not start.
    pub fn open(display: Option<&str>, records: Option<HeldRecords<'_>>) -> Result<Self, SinkError> {
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
        let record = records.map(|records| records.begun(&place)).transpose()?;
        let mut writer = X11Writer::new(connection, enigo, place.clone(), record);
        let queue = WriteQueue::start("x11", QUEUE_ACTIONS_MAX, move |actions| writer.write(actions))
            .map_err(|error| failed(&error))?;
        let keyboard = KeyboardLayout { display: place, has_symbol };
        Ok(Self { groups: QueuedGroups::new(queue), pointer_error, keyboard })
    }
}

impl HeldRecords<'_> {
    /// A record on this display, and its guardian.
    fn begun(self, display: &str) -> Result<HeldRecord, SinkError> {
        let record =
            HeldRecord::create(self.folder, display).map_err(|error| no_record(self.folder, &error))?;
        if let Some(program) = self.guardian {
            guardian::start(program, record.path()).map_err(|error| no_guardian(&error))?;
        }
        Ok(record)
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

/// For each key number of the server, whether it has a symbol; checks on the way that key presses can be
/// sent.
fn read_layout(connection: &impl Connection, place: &str) -> Result<Vec<bool>, SinkError> {
    let failed = |error: ReplyError| no_answer(place, &error);
    // The connection keeps what it learns, so that the first key asks for nothing.
    let present = |name| {
        let found = connection.extension_information(name).map_err(|error| failed(error.into()))?;
        Ok(found.is_some())
    };
    if !present(xtest::X11_EXTENSION_NAME)? || !present(xinput::X11_EXTENSION_NAME)? {
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
        let _ = self.write(&self.groups.releases());
        let _ = self.groups.push(vec![X11Action::End]).and_then(|()| self.groups.settle());
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

fn no_record(folder: &Path, error: &io::Error) -> SinkError {
    let message = format!(
        "{} takes no file that says which keys are held ({error}), by which they come up after a crash: make room there or use \
         `--output uinput`",
        folder.display()
    );
    SinkError { message }
}

fn no_guardian(error: &io::Error) -> SinkError {
    let message = format!(
        "the process does not start that lets go of keys if this one is killed ({error}): use `--output uinput`"
    );
    SinkError { message }
}

fn other_numbers(place: &str) -> SinkError {
    let message = format!(
        "X display {place} does not number its keys as Linux does, so wrong ones would be pressed: use \
         `--output uinput`"
    );
    SinkError { message }
}

/// The error of the thread that writes, which says it all.
fn failed(error: &io::Error) -> SinkError {
    SinkError { message: error.to_string() }
}
