//! Outputs as a profile writes them: `"BTN_SOUTH"`, `"ABS_HAT0X+"`, `"KEY_LEFTCTRL+KEY_C"`, `"BTN_LEFT"`.

use crate::pipeline::control::names::{
    self, GAMEPAD_BUTTONS, HAT_AXES, POINTER_BUTTONS, POINTER_MOTION, POINTER_WHEEL,
};
use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::profile::{Binding, KEYS_MAX, Keys};
use crate::toml_text::diag::{Findings, quoted};
use crate::toml_text::section::{Placed, Section};
use crate::toml_text::spelling;

/// The devices that a profile plays on alternatively, see [`Outputs`].
const PLAYED: [OutputDevice; 2] = [OutputDevice::Gamepad, OutputDevice::Keyboard];

/// The keys of a binding's table.
pub(crate) const DEVICE_KEYS: [&str; 3] =
    [OutputDevice::Gamepad.name(), OutputDevice::Keyboard.name(), OutputDevice::Pointer.name()];

/// Outputs of one control of the profile: on the gamepad or the keyboard, whichever is played, or on the pointer
/// in any case. `None` where there is none or the text is unusable (and reported).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outputs {
    pub(crate) gamepad: Option<Placed<Keys>>,
    pub(crate) keyboard: Option<Placed<Keys>>,
    pub(crate) pointer: Option<Placed<Keys>>,
}

impl Outputs {
    /// Output on `device`.
    pub(crate) const fn on(self, device: OutputDevice) -> Option<Placed<Keys>> {
        match device {
            OutputDevice::Gamepad => self.gamepad,
            OutputDevice::Keyboard => self.keyboard,
            OutputDevice::Pointer | OutputDevice::Tablet => self.pointer,
        }
    }

    /// Output where `output` is played.
    pub(crate) fn settle(self, output: OutputDevice) -> Option<Keys> {
        self.pointer.or(self.on(output)).map(|keys| keys.value)
    }

    /// Reads `{ gamepad = "…", keyboard = "…" }` or `{ pointer = "…" }`, a table with [`DEVICE_KEYS`].
    pub(crate) fn read(table: &Section<'_>, findings: &mut Findings<'_>) -> Self {
        if let Some(at) = table.place_of(OutputDevice::Pointer.name()) {
            if PLAYED.iter().any(|device| table.place_of(device.name()).is_some()) {
                let message = format!("{} names the pointer beside other devices", table.title);
                findings.error(at, message, "name the pointer alone, or both the gamepad and the keyboard");
            }
            let pointer = written(OutputDevice::Pointer, table, OutputDevice::Pointer.name(), findings);
            return Self { gamepad: None, keyboard: None, pointer };
        }
        let help = "every binding names both devices, so that the profile plays on either of them";
        let [gamepad, keyboard] = PLAYED.map(|device| {
            table.require(device.name(), help, findings);
            written(device, table, device.name(), findings)
        });
        Self { gamepad, keyboard, pointer: None }
    }
}

/// [`DEVICE_KEYS`] and these.
pub(crate) fn with_keys(more: &[&'static str]) -> Vec<&'static str> {
    DEVICE_KEYS.iter().chain(more).copied().collect()
}

/// The binding under `key`, or `default` (which must be one, if there is one) where it is not written.
pub(crate) fn written_or(
    device: OutputDevice,
    table: Option<&Section<'_>>,
    key: &str,
    default: Option<Placed<&str>>,
    findings: &mut Findings<'_>,
) -> Option<Placed<Keys>> {
    match table {
        Some(table) if table.place_of(key).is_some() => written(device, table, key, findings),
        _ => default.and_then(|default| {
            Some(Placed { value: parse_all(device, default.value).ok()?, at: default.at })
        }),
    }
}

fn written(
    device: OutputDevice,
    table: &Section<'_>,
    key: &str,
    findings: &mut Findings<'_>,
) -> Option<Placed<Keys>> {
    let Placed { value: text, at } = table.text(key, findings)?;
    match parse_all(device, text) {
        Ok(value) => Some(Placed { value, at }),
        Err(Misfit { message, help }) => {
            findings.error(at, message, help);
            None
        }
    }
}

/// Why a text is no binding for a device, and what to write instead.
#[derive(Debug)]
pub(crate) struct Misfit {
    message: String,
    help: String,
}

fn misfit<T>(message: String, help: impl Into<String>) -> Result<T, Misfit> {
    Err(Misfit { message, help: help.into() })
}

/// Names with + between them. A + or - right after an axis is its direction: `ABS_HAT0X++BTN_SOUTH`.
pub(crate) fn parse_all(device: OutputDevice, text: &str) -> Result<Keys, Misfit> {
    let mut names: Vec<String> = Vec::new();
    for part in text.split('+') {
        match names.last_mut() {
            // What is empty lies between a direction's + and the next name, or at the end.
            Some(before) if part.is_empty() => before.push('+'),
            _ => names.push(part.trim().to_owned()),
        }
    }
    if names.len() > KEYS_MAX {
        return misfit(format!("{} are more than {KEYS_MAX} keys", quoted(text)), "leave some out");
    }
    let mut all: Vec<Binding> = Vec::new();
    for name in &names {
        let binding = parse(device, name)?;
        if all.iter().any(|before| before.code == binding.code) {
            return misfit(format!("{} stands twice in {}", binding.code, quoted(text)), "write it once");
        }
        all.push(binding);
    }
    Ok(Keys::new(all))
}

fn parse(device: OutputDevice, text: &str) -> Result<Binding, Misfit> {
    let (name, sign) = match (text.strip_suffix('+'), text.strip_suffix('-')) {
        (Some(name), _) => (name, Some(1)),
        (_, Some(name)) => (name, Some(-1)),
        _ => (text, None),
    };
    let Some(code) = names::parse(name) else { return misfit(unknown(device, text), near(device, name)) };
    match (code, sign) {
        _ if !fits(device, code) => misfit(wrong_device(device, code), instead(device, name, code)),
        (Code::Axis(_) | Code::Relative(_), Some(value)) => Ok(Binding { device, code, value }),
        (Code::Axis(_) | Code::Relative(_), None) => {
            misfit(format!("{code} needs a direction"), format!("write \"{code}+\" or \"{code}-\""))
        }
        (Code::Key(_), Some(_)) => misfit(format!("{code} has no direction"), format!("write \"{code}\"")),
        (Code::Key(_), None) => Ok(Binding { device, code, value: 1 }),
    }
}

/// Whether a profile can bind `code` on `device`. The pointer's movement is no binding: `[pointer]` steers it.
fn fits(device: OutputDevice, code: Code) -> bool {
    match device {
        OutputDevice::Gamepad => GAMEPAD_BUTTONS.contains(&code) || HAT_AXES.contains(&code),
        OutputDevice::Keyboard => names::is_keyboard_key(code),
        OutputDevice::Pointer | OutputDevice::Tablet => {
            POINTER_BUTTONS.contains(&code) || code == POINTER_WHEEL
        }
    }
}

fn unknown(device: OutputDevice, text: &str) -> String {
    match device {
        OutputDevice::Gamepad => format!("{} is no control of the gamepad", quoted(text)),
        OutputDevice::Keyboard => format!("{} is no key of the keyboard", quoted(text)),
        OutputDevice::Pointer | OutputDevice::Tablet => {
            format!("{} is no button of the pointer", quoted(text))
        }
    }
}

fn wrong_device(device: OutputDevice, code: Code) -> String {
    match device {
        OutputDevice::Gamepad if names::is_keyboard_key(code) => {
            format!("{code} is a key of the keyboard, not of the gamepad")
        }
        OutputDevice::Gamepad if names::is_pointers(code) => {
            format!("{code} belongs to the pointer, not to the gamepad")
        }
        OutputDevice::Gamepad => format!("{code} is not on the Xbox 360 pad"),
        OutputDevice::Pointer if POINTER_MOTION.contains(&code) => {
            format!("{code} is a movement, not a button")
        }
        OutputDevice::Pointer | OutputDevice::Tablet => format!("{code} is not on the pointer"),
        OutputDevice::Keyboard if names::is_pointers(code) => {
            format!("{code} belongs to the pointer, not to the keyboard")
        }
        OutputDevice::Keyboard => format!("{code} belongs to the gamepad, not to the keyboard"),
    }
}

/// The names that `device` takes.
fn candidates(device: OutputDevice) -> impl Iterator<Item = &'static str> {
    names::canonical().filter(move |(_, code)| fits(device, *code)).map(|(name, _)| name)
}

fn near(device: OutputDevice, name: &str) -> String {
    let prefix = if device == OutputDevice::Keyboard { "KEY_" } else { "BTN_" };
    // The prefix alone already resembles the shortest names, so what it is put before must be a word.
    let full = if name.len() > 2 { format!("{prefix}{name}") } else { String::new() };
    let near = [name, &full].into_iter().find_map(|name| spelling::nearest(name, candidates(device)));
    match (near, device) {
        (Some(near), _) => format!("did you mean \"{near}\"?"),
        (None, OutputDevice::Gamepad) => pad_controls(),
        (None, OutputDevice::Keyboard) => {
            "keys have the kernel's names, as KEY_Z, KEY_SPACE, KEY_LEFT".to_owned()
        }
        (None, OutputDevice::Pointer | OutputDevice::Tablet) => POINTER_HELP.to_owned(),
    }
}

fn instead(device: OutputDevice, name: &str, code: Code) -> String {
    match (device, names::parse(&format!("BTN_{name}"))) {
        (OutputDevice::Gamepad | OutputDevice::Pointer, Some(button)) if fits(device, button) => {
            format!("did you mean \"{button}\"?")
        }
        (OutputDevice::Gamepad | OutputDevice::Keyboard, _) if code == POINTER_WHEEL => {
            format!("in a [[button]] it stands alone, as {{ pointer = \"{code}+\" }}")
        }
        (OutputDevice::Gamepad | OutputDevice::Keyboard, _) if POINTER_BUTTONS.contains(&code) => {
            format!("in a [[button]] it stands alone, as {{ pointer = \"{code}\" }}")
        }
        (OutputDevice::Gamepad, _) => pad_controls(),
        (OutputDevice::Pointer, _) if POINTER_MOTION.contains(&code) => {
            "the table [pointer] moves the pointer; a button presses BTN_LEFT, BTN_RIGHT or BTN_MIDDLE"
                .to_owned()
        }
        (OutputDevice::Pointer | OutputDevice::Tablet, _) => POINTER_HELP.to_owned(),
        (OutputDevice::Keyboard, _) => {
            format!("write {code} as the gamepad's binding and a key, as \"KEY_Z\", here")
        }
    }
}

const POINTER_HELP: &str =
    "the pointer has BTN_LEFT, BTN_RIGHT and BTN_MIDDLE, and REL_WHEEL with + (away from you) or -";

fn pad_controls() -> String {
    let buttons: Vec<_> = GAMEPAD_BUTTONS.iter().map(Code::to_string).collect();
    format!("the pad has {}, and ABS_HAT0X and ABS_HAT0Y with + or -", buttons.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn help(device: OutputDevice, text: &str) -> String {
        let Misfit { message, help } = parse(device, text).unwrap_err();
        format!("{message}; {help}")
    }

    #[test]
    fn names_of_the_device_bind() {
        let cases = [
            (OutputDevice::Gamepad, "btn_a", Code::Key(0x130), 1),
            (OutputDevice::Gamepad, "ABS_HAT0X+", Code::Axis(0x10), 1),
            (OutputDevice::Gamepad, "abs_hat0y-", Code::Axis(0x11), -1),
            (OutputDevice::Keyboard, "z", Code::Key(44), 1),
            (OutputDevice::Keyboard, "KEY_MINUS", Code::Key(12), 1),
            (OutputDevice::Pointer, "btn_right", Code::Key(0x111), 1),
            (OutputDevice::Pointer, "rel_wheel+", Code::Relative(8), 1),
            (OutputDevice::Pointer, "REL_WHEEL-", Code::Relative(8), -1),
        ];
        for (device, text, code, value) in cases {
            assert_eq!(parse(device, text).unwrap(), Binding { device, code, value });
        }
    }

    #[test]
    fn several_names_bind_together() {
        let codes = |text: &str| {
            parse_all(OutputDevice::Gamepad, text)
                .unwrap()
                .iter()
                .map(|it| (it.code, it.value))
                .collect::<Vec<_>>()
        };
        let (south, axis) = ((Code::Key(0x130), 1), Code::Axis(0x10));
        assert_eq!(codes("BTN_SOUTH + btn_east"), [south, (Code::Key(0x131), 1)]);
        assert_eq!(codes("ABS_HAT0X++BTN_SOUTH"), [(axis, 1), south]);
        assert_eq!(codes("ABS_HAT0X-+BTN_SOUTH"), [(axis, -1), south]);
        assert_eq!(codes("BTN_SOUTH+ABS_HAT0X+"), [south, (axis, 1)]);
        for (text, expected) in [
            ("KEY_A+KEY_B+KEY_C+KEY_D+KEY_E", "more than 4 keys"),
            ("KEY_A+key_a", "KEY_A stands twice"),
            ("KEY_A+", "KEY_A has no direction"),
            ("KEY_LEFTCTRL+KEY_CC", "\"KEY_CC\" is no key"),
        ] {
            let Misfit { message, .. } = parse_all(OutputDevice::Keyboard, text).unwrap_err();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn controls_that_the_device_lacks_are_refused_with_a_way_out() {
        let cases = [
            (OutputDevice::Gamepad, "KEY_Z", "KEY_Z is a key of the keyboard"),
            (OutputDevice::Gamepad, "A", "did you mean \"BTN_SOUTH\"?"),
            (OutputDevice::Gamepad, "south", "did you mean \"BTN_SOUTH\"?"),
            (OutputDevice::Gamepad, "BTN_TL2", "BTN_TL2 is not on the Xbox 360 pad; the pad has BTN_SOUTH"),
            (OutputDevice::Gamepad, "BTN_C", "not on the Xbox 360 pad"),
            (OutputDevice::Gamepad, "ABS_X+", "ABS_X is not on the Xbox 360 pad"),
            (OutputDevice::Gamepad, "ABS_HAT0X", "write \"ABS_HAT0X+\" or \"ABS_HAT0X-\""),
            (OutputDevice::Gamepad, "BTN_EAST+", "BTN_EAST has no direction"),
            (OutputDevice::Gamepad, "BTN_WSET", "did you mean \"BTN_WEST\"?"),
            (OutputDevice::Keyboard, "BTN_SOUTH", "BTN_SOUTH belongs to the gamepad"),
            (OutputDevice::Keyboard, "ABS_HAT0X+", "ABS_HAT0X belongs to the gamepad"),
            (OutputDevice::Keyboard, "KEY_SPAEC", "did you mean \"KEY_SPACE\"?"),
            (OutputDevice::Keyboard, "spce", "did you mean \"KEY_SPACE\"?"),
            (OutputDevice::Keyboard, "", "is no key of the keyboard; keys have the kernel's names"),
            (OutputDevice::Keyboard, "+", "is no key of the keyboard"),
            (OutputDevice::Keyboard, "BTN_LEFT", "{ pointer = \"BTN_LEFT\" }"),
            (OutputDevice::Gamepad, "BTN_LEFT", "{ pointer = \"BTN_LEFT\" }"),
            (OutputDevice::Pointer, "left", "did you mean \"BTN_LEFT\"?"),
            (OutputDevice::Pointer, "BTN_LEFFT", "did you mean \"BTN_LEFT\"?"),
            (OutputDevice::Pointer, "BTN_SOUTH", "BTN_SOUTH is not on the pointer; the pointer has BTN_LEFT"),
            (OutputDevice::Pointer, "REL_WHEEL", "write \"REL_WHEEL+\" or \"REL_WHEEL-\""),
            (OutputDevice::Keyboard, "REL_WHEEL+", "{ pointer = \"REL_WHEEL+\" }"),
            (OutputDevice::Pointer, "click", "is no button of the pointer; the pointer has BTN_LEFT"),
            (OutputDevice::Pointer, "REL_X", "REL_X is a movement, not a button; the table [pointer] moves"),
        ];
        for (device, text, expected) in cases {
            let shown = help(device, text);
            assert!(shown.contains(expected), "{text}: {shown}");
        }
    }
}
