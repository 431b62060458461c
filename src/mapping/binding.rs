//! Outputs as a profile writes them: `"BTN_SOUTH"`, `"ABS_HAT0X+"`, `"KEY_Z"`, `"BTN_LEFT"`.

use super::profile::Binding;
use crate::control::names::{self, GAMEPAD_BUTTONS, HAT_AXES, POINTER_BUTTONS, POINTER_MOTION};
use crate::control::{Code, Device};
use crate::spelling;
use crate::toml_text::diag::{Report, quoted};
use crate::toml_text::section::{Placed, Section};

/// The devices that a profile plays on alternatively, see [`Outputs`].
const PLAYED: [Device; 2] = [Device::Gamepad, Device::Keyboard];

/// The keys of a binding's table.
pub(super) const DEVICE_KEYS: [&str; 3] =
    [Device::Gamepad.name(), Device::Keyboard.name(), Device::Pointer.name()];

/// What one control of the profile does: on the gamepad or the keyboard, whichever is played, or on the pointer
/// in any case. `None` where there is none or the text is unusable (and reported).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outputs {
    pub(super) gamepad: Option<Placed<Binding>>,
    pub(super) keyboard: Option<Placed<Binding>>,
    pub(super) pointer: Option<Placed<Binding>>,
}

impl Outputs {
    /// What it does on `device`.
    pub(super) const fn on(self, device: Device) -> Option<Placed<Binding>> {
        match device {
            Device::Gamepad => self.gamepad,
            Device::Keyboard => self.keyboard,
            Device::Pointer => self.pointer,
        }
    }

    /// What it does where `output` is played.
    pub(super) fn settle(self, output: Device) -> Option<Binding> {
        self.pointer.or(self.on(output)).map(|binding| binding.value)
    }

    /// Reads `{ gamepad = "…", keyboard = "…" }` or `{ pointer = "…" }`, a table with [`DEVICE_KEYS`].
    pub(super) fn read(table: &Section<'_>, report: &mut Report<'_>) -> Self {
        if let Some(at) = table.place_of(Device::Pointer.name()) {
            if PLAYED.iter().any(|device| table.place_of(device.name()).is_some()) {
                let message = format!("{} names the pointer beside other devices", table.title);
                report.error(at, message, "name the pointer alone, or both the gamepad and the keyboard");
            }
            let pointer = written(Device::Pointer, table, Device::Pointer.name(), report);
            return Self { gamepad: None, keyboard: None, pointer };
        }
        let help = "every binding names both devices, so that the profile plays on either of them";
        let [gamepad, keyboard] = PLAYED.map(|device| {
            table.require(device.name(), help, report);
            written(device, table, device.name(), report)
        });
        Self { gamepad, keyboard, pointer: None }
    }
}

/// The binding under `key`, or `default` (which must be one) where there is none.
pub(super) fn written_or(
    device: Device,
    table: Option<&Section<'_>>,
    key: &str,
    default: Placed<&str>,
    report: &mut Report<'_>,
) -> Option<Placed<Binding>> {
    match table {
        Some(table) if table.place_of(key).is_some() => written(device, table, key, report),
        _ => parse(device, default.value).ok().map(|value| Placed { value, at: default.at }),
    }
}

fn written(
    device: Device,
    table: &Section<'_>,
    key: &str,
    report: &mut Report<'_>,
) -> Option<Placed<Binding>> {
    let Placed { value: text, at } = table.text(key, report)?;
    match parse(device, text) {
        Ok(value) => Some(Placed { value, at }),
        Err(Misfit { message, help }) => {
            report.error(at, message, help);
            None
        }
    }
}

/// Why a text is no binding for a device, and what to write instead.
#[derive(Debug)]
struct Misfit {
    message: String,
    help: String,
}

fn misfit<T>(message: String, help: impl Into<String>) -> Result<T, Misfit> {
    Err(Misfit { message, help: help.into() })
}

fn parse(device: Device, text: &str) -> Result<Binding, Misfit> {
    let (name, sign) = match (text.strip_suffix('+'), text.strip_suffix('-')) {
        (Some(name), _) => (name, Some(1)),
        (_, Some(name)) => (name, Some(-1)),
        _ => (text, None),
    };
    let Some(code) = names::parse(name) else { return misfit(unknown(device, text), near(device, name)) };
    match (code, sign) {
        _ if !fits(device, code) => misfit(wrong_device(device, code), instead(device, name, code)),
        (Code::Axis(_), Some(value)) => Ok(Binding { device, code, value }),
        (Code::Axis(_), None) => {
            misfit(format!("{code} needs a direction"), format!("write \"{code}+\" or \"{code}-\""))
        }
        (_, Some(_)) => misfit(format!("{code} has no direction"), format!("write \"{code}\"")),
        (_, None) => Ok(Binding { device, code, value: 1 }),
    }
}

/// Whether a profile can bind `code` on `device`. The pointer's movement is no binding: `[pointer]` steers it.
fn fits(device: Device, code: Code) -> bool {
    match device {
        Device::Gamepad => GAMEPAD_BUTTONS.contains(&code) || HAT_AXES.contains(&code),
        Device::Keyboard => names::is_keyboard_key(code),
        Device::Pointer => POINTER_BUTTONS.contains(&code),
    }
}

fn unknown(device: Device, text: &str) -> String {
    match device {
        Device::Gamepad => format!("{} is no control of the gamepad", quoted(text)),
        Device::Keyboard => format!("{} is no key of the keyboard", quoted(text)),
        Device::Pointer => format!("{} is no button of the pointer", quoted(text)),
    }
}

fn wrong_device(device: Device, code: Code) -> String {
    match device {
        Device::Gamepad if names::is_keyboard_key(code) => {
            format!("{code} is a key of the keyboard, not of the gamepad")
        }
        Device::Gamepad if POINTER_BUTTONS.contains(&code) => {
            format!("{code} is a button of the pointer, not of the gamepad")
        }
        Device::Gamepad => format!("{code} is not on the Xbox 360 pad"),
        Device::Pointer if POINTER_MOTION.contains(&code) => format!("{code} is a movement, not a button"),
        Device::Pointer => format!("{code} is not on the pointer"),
        Device::Keyboard if POINTER_BUTTONS.contains(&code) => {
            format!("{code} is a button of the pointer, not of the keyboard")
        }
        Device::Keyboard => format!("{code} belongs to the gamepad, not to the keyboard"),
    }
}

/// The names that `device` takes.
fn candidates(device: Device) -> impl Iterator<Item = &'static str> {
    names::canonical().filter(move |(_, code)| fits(device, *code)).map(|(name, _)| name)
}

fn near(device: Device, name: &str) -> String {
    let prefix = if device == Device::Keyboard { "KEY_" } else { "BTN_" };
    // The prefix alone already resembles the shortest names, so what it is put before must be a word.
    let full = if name.len() > 2 { format!("{prefix}{name}") } else { String::new() };
    let near = [name, &full].into_iter().find_map(|name| spelling::nearest(name, candidates(device)));
    match (near, device) {
        (Some(near), _) => format!("did you mean \"{near}\"?"),
        (None, Device::Gamepad) => pad_controls(),
        (None, Device::Keyboard) => "keys have the kernel's names, as KEY_Z, KEY_SPACE, KEY_LEFT".to_owned(),
        (None, Device::Pointer) => POINTER_HELP.to_owned(),
    }
}

fn instead(device: Device, name: &str, code: Code) -> String {
    match (device, names::parse(&format!("BTN_{name}"))) {
        (Device::Gamepad | Device::Pointer, Some(button)) if fits(device, button) => {
            format!("did you mean \"{button}\"?")
        }
        (Device::Gamepad | Device::Keyboard, _) if POINTER_BUTTONS.contains(&code) => {
            format!("in a [[button]] it stands alone, as {{ pointer = \"{code}\" }}")
        }
        (Device::Gamepad, _) => pad_controls(),
        (Device::Pointer, _) if POINTER_MOTION.contains(&code) => {
            "the table [pointer] moves the pointer; a button presses BTN_LEFT, BTN_RIGHT or BTN_MIDDLE"
                .to_owned()
        }
        (Device::Pointer, _) => POINTER_HELP.to_owned(),
        (Device::Keyboard, _) => {
            format!("write {code} as the gamepad's binding and a key, as \"KEY_Z\", here")
        }
    }
}

const POINTER_HELP: &str = "the pointer has BTN_LEFT, BTN_RIGHT and BTN_MIDDLE";

fn pad_controls() -> String {
    let buttons: Vec<_> = GAMEPAD_BUTTONS.iter().map(Code::to_string).collect();
    format!("the pad has {}, and ABS_HAT0X and ABS_HAT0Y with + or -", buttons.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn help(device: Device, text: &str) -> String {
        let Misfit { message, help } = parse(device, text).unwrap_err();
        format!("{message}; {help}")
    }

    #[test]
    fn names_of_the_device_bind() {
        let cases = [
            (Device::Gamepad, "btn_a", Code::Key(0x130), 1),
            (Device::Gamepad, "ABS_HAT0X+", Code::Axis(0x10), 1),
            (Device::Gamepad, "abs_hat0y-", Code::Axis(0x11), -1),
            (Device::Keyboard, "z", Code::Key(44), 1),
            (Device::Keyboard, "KEY_MINUS", Code::Key(12), 1),
            (Device::Pointer, "btn_right", Code::Key(0x111), 1),
        ];
        for (device, text, code, value) in cases {
            assert_eq!(parse(device, text).unwrap(), Binding { device, code, value });
        }
    }

    #[test]
    fn controls_that_the_device_lacks_are_refused_with_a_way_out() {
        let cases = [
            (Device::Gamepad, "KEY_Z", "KEY_Z is a key of the keyboard"),
            (Device::Gamepad, "A", "did you mean \"BTN_SOUTH\"?"),
            (Device::Gamepad, "south", "did you mean \"BTN_SOUTH\"?"),
            (Device::Gamepad, "BTN_TL2", "BTN_TL2 is not on the Xbox 360 pad; the pad has BTN_SOUTH"),
            (Device::Gamepad, "BTN_C", "not on the Xbox 360 pad"),
            (Device::Gamepad, "ABS_X+", "ABS_X is not on the Xbox 360 pad"),
            (Device::Gamepad, "ABS_HAT0X", "write \"ABS_HAT0X+\" or \"ABS_HAT0X-\""),
            (Device::Gamepad, "BTN_EAST+", "BTN_EAST has no direction"),
            (Device::Gamepad, "BTN_WSET", "did you mean \"BTN_WEST\"?"),
            (Device::Keyboard, "BTN_SOUTH", "BTN_SOUTH belongs to the gamepad"),
            (Device::Keyboard, "ABS_HAT0X+", "ABS_HAT0X belongs to the gamepad"),
            (Device::Keyboard, "KEY_SPAEC", "did you mean \"KEY_SPACE\"?"),
            (Device::Keyboard, "spce", "did you mean \"KEY_SPACE\"?"),
            (Device::Keyboard, "", "is no key of the keyboard; keys have the kernel's names"),
            (Device::Keyboard, "+", "is no key of the keyboard"),
            (Device::Keyboard, "BTN_LEFT", "{ pointer = \"BTN_LEFT\" }"),
            (Device::Gamepad, "BTN_LEFT", "{ pointer = \"BTN_LEFT\" }"),
            (Device::Pointer, "left", "did you mean \"BTN_LEFT\"?"),
            (Device::Pointer, "BTN_LEFFT", "did you mean \"BTN_LEFT\"?"),
            (Device::Pointer, "BTN_SOUTH", "BTN_SOUTH is not on the pointer; the pointer has BTN_LEFT"),
            (Device::Pointer, "click", "is no button of the pointer; the pointer has BTN_LEFT"),
            (Device::Pointer, "REL_X", "REL_X is a movement, not a button; the table [pointer] moves"),
        ];
        for (device, text, expected) in cases {
            let shown = help(device, text);
            assert!(shown.contains(expected), "{text}: {shown}");
        }
    }
}
