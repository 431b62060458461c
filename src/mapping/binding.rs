//! Outputs as a profile writes them: `"BTN_SOUTH"`, `"ABS_HAT0X+"`, `"KEY_Z"`.

use super::diag::{Report, quoted};
use super::profile::Binding;
use super::syntax::{Placed, Section};
use crate::control::names::{self, GAMEPAD_BUTTONS, HAT_AXES};
use crate::control::{Code, Device};
use crate::spelling;

/// Both devices, in the order of [`Outputs::on`].
pub(super) const DEVICES: [Device; 2] = [Device::Gamepad, Device::Keyboard];

/// The keys of [`DEVICES`] in a profile.
pub(super) const DEVICE_KEYS: [&str; 2] = [Device::Gamepad.name(), Device::Keyboard.name()];

/// What one control of the profile does on either device; `None` where the text is unusable (and reported).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outputs {
    pub(super) gamepad: Option<Placed<Binding>>,
    pub(super) keyboard: Option<Placed<Binding>>,
}

impl Outputs {
    /// What it does on `device`.
    pub(super) const fn on(self, device: Device) -> Option<Placed<Binding>> {
        match device {
            Device::Gamepad => self.gamepad,
            Device::Keyboard => self.keyboard,
        }
    }

    /// Reads `{ gamepad = "…", keyboard = "…" }`, a table with [`DEVICE_KEYS`]; both must be there.
    pub(super) fn read(table: &Section<'_>, report: &mut Report<'_>) -> Self {
        let help = "every binding names both devices, so that the profile plays on either of them";
        let [gamepad, keyboard] = DEVICES.map(|device| {
            table.require(device.name(), help, report);
            written(device, table, device.name(), report)
        });
        Self { gamepad, keyboard }
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
    let fits = match device {
        Device::Gamepad => GAMEPAD_BUTTONS.contains(&code) || HAT_AXES.contains(&code),
        Device::Keyboard => names::is_keyboard_key(code),
    };
    match (code, sign) {
        _ if !fits => misfit(wrong_device(device, code), instead(device, name, code)),
        (Code::Axis(_), Some(value)) => Ok(Binding { code, value }),
        (Code::Axis(_), None) => {
            misfit(format!("{code} needs a direction"), format!("write \"{code}+\" or \"{code}-\""))
        }
        (Code::Key(_), Some(_)) => misfit(format!("{code} has no direction"), format!("write \"{code}\"")),
        (Code::Key(_), None) => Ok(Binding { code, value: 1 }),
    }
}

fn unknown(device: Device, text: &str) -> String {
    match device {
        Device::Gamepad => format!("{} is no control of the gamepad", quoted(text)),
        Device::Keyboard => format!("{} is no key of the keyboard", quoted(text)),
    }
}

fn wrong_device(device: Device, code: Code) -> String {
    match device {
        Device::Gamepad if names::is_keyboard_key(code) => {
            format!("{code} is a key of the keyboard, not of the gamepad")
        }
        Device::Gamepad => format!("{code} is not on the Xbox 360 pad"),
        Device::Keyboard => format!("{code} belongs to the gamepad, not to the keyboard"),
    }
}

/// The names that `device` takes.
fn candidates(device: Device) -> impl Iterator<Item = &'static str> {
    let fits = move |code: &Code| match device {
        Device::Gamepad => GAMEPAD_BUTTONS.contains(code) || HAT_AXES.contains(code),
        Device::Keyboard => names::is_keyboard_key(*code),
    };
    names::canonical().filter(move |(_, code)| fits(code)).map(|(name, _)| name)
}

fn near(device: Device, name: &str) -> String {
    let prefix = if device == Device::Gamepad { "BTN_" } else { "KEY_" };
    // The prefix alone already resembles the shortest names, so what it is put before must be a word.
    let full = if name.len() > 2 { format!("{prefix}{name}") } else { String::new() };
    let near = [name, &full].into_iter().find_map(|name| spelling::nearest(name, candidates(device)));
    match (near, device) {
        (Some(near), _) => format!("did you mean \"{near}\"?"),
        (None, Device::Gamepad) => pad_controls(),
        (None, Device::Keyboard) => "keys have the kernel's names, as KEY_Z, KEY_SPACE, KEY_LEFT".to_owned(),
    }
}

fn instead(device: Device, name: &str, code: Code) -> String {
    match (device, names::parse(&format!("BTN_{name}"))) {
        (Device::Gamepad, Some(button)) if GAMEPAD_BUTTONS.contains(&button) => {
            format!("did you mean \"{button}\"?")
        }
        (Device::Gamepad, _) => pad_controls(),
        (Device::Keyboard, _) => {
            format!("write {code} as the gamepad's binding and a key, as \"KEY_Z\", here")
        }
    }
}

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
        let key = |code, value| Binding { code, value };
        assert_eq!(parse(Device::Gamepad, "btn_a").unwrap(), key(Code::Key(0x130), 1));
        assert_eq!(parse(Device::Gamepad, "ABS_HAT0X+").unwrap(), key(Code::Axis(0x10), 1));
        assert_eq!(parse(Device::Gamepad, "abs_hat0y-").unwrap(), key(Code::Axis(0x11), -1));
        assert_eq!(parse(Device::Keyboard, "z").unwrap(), key(Code::Key(44), 1));
        assert_eq!(parse(Device::Keyboard, "KEY_MINUS").unwrap(), key(Code::Key(12), 1));
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
        ];
        for (device, text, expected) in cases {
            let shown = help(device, text);
            assert!(shown.contains(expected), "{text}: {shown}");
        }
    }
}
