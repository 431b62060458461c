//! The plain word of each control: `A`, `up`, `left Ctrl`, `wheel, away from you`.

use std::borrow::Cow;

use crate::pipeline::control::names::{
    self, GAMEPAD_BUTTONS, HAT_AXES, POINTER_BUTTONS, POINTER_MOTION, POINTER_WHEEL, STICKS, TRIGGERS,
};
use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::profile::{Binding, Keys};

/// Of the gamepad's buttons, by what is printed on an Xbox 360 pad, in the order of [`GAMEPAD_BUTTONS`]. The kernel calls that pad's X
/// `BTN_NORTH` and its Y `BTN_WEST`.
const GAMEPAD_WORDS: [&str; GAMEPAD_BUTTONS.len()] = [
    "A",
    "B",
    "X",
    "Y",
    "left bumper",
    "right bumper",
    "Back",
    "Start",
    "Guide",
    "left stick pressed",
    "right stick pressed",
];

/// Of the hat, in the order of [`HAT_AXES`]: each axis below and above its rest.
const HAT_WORDS: [[&str; 2]; 2] = [["left", "right"], ["up", "down"]];

/// Of the sticks, in the order of [`STICKS`].
const STICK_WORDS: [[&str; 2]; 2] = [
    ["left stick, sideways", "left stick, up and down"],
    ["right stick, sideways", "right stick, up and down"],
];

/// Of the triggers, in the order of [`TRIGGERS`].
const TRIGGER_WORDS: [&str; 2] = ["left trigger", "right trigger"];

/// Of the mouse's buttons, in the order of [`POINTER_BUTTONS`].
const MOUSE_WORDS: [&str; 3] = ["left mouse button", "right mouse button", "middle mouse button"];

/// Of the pointer's movement, in the order of [`POINTER_MOTION`].
const POINTER_WORDS: [&str; 2] = ["pointer, sideways", "pointer, up and down"];

/// Of the wheel: towards the hand, and away from it.
const WHEEL_WORDS: [&str; 2] = ["wheel, towards you", "wheel, away from you"];

/// Keys whose word is not their kernel name with other capitals.
#[rustfmt::skip]
const KEY_WORDS: &[(&str, &str)] = &[
    ("ESC", "Escape"), ("EQUAL", "equals sign"), ("MINUS", "minus"), ("LEFTBRACE", "left bracket"), ("RIGHTBRACE", "right bracket"),
    ("SEMICOLON", "semicolon"), ("APOSTROPHE", "apostrophe"), ("GRAVE", "backquote"), ("BACKSLASH", "backslash"),
    ("COMMA", "comma"), ("DOT", "full stop"), ("SLASH", "slash"), ("102ND", "key beside left Shift"), ("RO", "Ro"),
    ("SPACE", "space"), ("CAPSLOCK", "Caps Lock"), ("NUMLOCK", "Num Lock"), ("SCROLLLOCK", "Scroll Lock"), ("SYSRQ", "Print Screen"),
    ("UP", "up arrow"), ("DOWN", "down arrow"), ("LEFT", "left arrow"), ("RIGHT", "right arrow"),
    ("PAGEUP", "Page Up"), ("PAGEDOWN", "Page Down"), ("COMPOSE", "menu key"), ("MENU", "menu of the computer"),
    ("KPASTERISK", "keypad times"), ("KPMINUS", "keypad minus"), ("KPPLUS", "keypad plus"), ("KPDOT", "keypad point"),
    ("KPSLASH", "keypad divide"), ("KPENTER", "keypad Enter"), ("KPEQUAL", "keypad equals"), ("KPPLUSMINUS", "keypad plus minus"),
    ("KPCOMMA", "keypad comma"), ("KPJPCOMMA", "Japanese keypad comma"), ("KPLEFTPAREN", "keypad left parenthesis"),
    ("KPRIGHTPAREN", "keypad right parenthesis"), ("ZENKAKUHANKAKU", "Zenkaku/Hankaku"), ("KATAKANAHIRAGANA", "Katakana/Hiragana"),
    ("VOLUMEDOWN", "volume down"), ("VOLUMEUP", "volume up"), ("DELETEFILE", "delete file"), ("SENDFILE", "send file"),
    ("PROG1", "program 1"), ("PROG2", "program 2"), ("PROG3", "program 3"), ("PROG4", "program 4"), ("WWW", "web browser"),
    ("COFFEE", "lock screen"), ("CYCLEWINDOWS", "next window"), ("CLOSECD", "close CD"), ("EJECTCD", "eject CD"),
    ("EJECTCLOSECD", "eject or close CD"), ("NEXTSONG", "next song"), ("PREVIOUSSONG", "previous song"), ("PLAYPAUSE", "play or pause"),
    ("STOPCD", "stop CD"), ("PLAYCD", "play CD"), ("PAUSECD", "pause CD"), ("HOMEPAGE", "home page"), ("SCROLLUP", "scroll up"),
    ("SCROLLDOWN", "scroll down"), ("FASTFORWARD", "fast forward"), ("BASSBOOST", "bass boost"), ("HP", "HP key"),
    ("ALTERASE", "Alt erase"), ("BRIGHTNESSDOWN", "brightness down"), ("BRIGHTNESSUP", "brightness up"), ("SWITCHVIDEOMODE", "next display"),
    ("KBDILLUMTOGGLE", "keyboard light on or off"), ("KBDILLUMDOWN", "keyboard light down"), ("KBDILLUMUP", "keyboard light up"),
    ("FORWARDMAIL", "forward mail"), ("BRIGHTNESS_AUTO", "automatic brightness"), ("BRIGHTNESS_CYCLE", "next brightness"),
    ("VIDEO_PREV", "previous video source"), ("VIDEO_NEXT", "next video source"), ("RFKILL", "all radios off"), ("MICMUTE", "microphone mute"),
    ("ISO", "ISO key"), ("XFER", "transfer"), ("MSDOS", "MS-DOS"), ("WLAN", "Wi-Fi"), ("UWB", "ultra-wideband"), ("WWAN", "mobile network"),
];

/// Beginnings of keys' kernel names that stand for a word.
const KEY_BEGINNINGS: [(&str, &str); 3] = [("LEFT", "left "), ("RIGHT", "right "), ("KP", "keypad ")];

/// The plain word of a control where it has this value: the halves of a hat and of a wheel have a word each.
pub fn word(device: OutputDevice, code: Code, value: i32) -> Cow<'static, str> {
    let half = usize::from(value > 0);
    let word = match device {
        OutputDevice::Keyboard => return key_word(code),
        OutputDevice::Gamepad => find(&GAMEPAD_BUTTONS, code, &GAMEPAD_WORDS)
            .or_else(|| find(&HAT_AXES, code, &HAT_WORDS.map(|halves| halves[half])))
            .or_else(|| STICKS.iter().zip(&STICK_WORDS).find_map(|(axes, words)| find(axes, code, words)))
            .or_else(|| find(&TRIGGERS, code, &TRIGGER_WORDS)),
        OutputDevice::Pointer | OutputDevice::Tablet if code == POINTER_WHEEL => Some(WHEEL_WORDS[half]),
        OutputDevice::Pointer => {
            find(&POINTER_BUTTONS, code, &MOUSE_WORDS).or_else(|| find(&POINTER_MOTION, code, &POINTER_WORDS))
        }
        OutputDevice::Tablet => find(&POINTER_BUTTONS, code, &MOUSE_WORDS)
            .or_else(|| find(&names::POINTER_PLACE, code, &POINTER_WORDS)),
    };
    word.map_or_else(|| code.to_string().into(), Cow::Borrowed)
}

fn find(codes: &[Code], code: Code, words: &[&'static str]) -> Option<&'static str> {
    codes.iter().zip(words).find(|(it, _)| **it == code).map(|(_, word)| *word)
}

fn key_word(code: Code) -> Cow<'static, str> {
    let Some(rest) = names::name(code).and_then(|name| name.strip_prefix("KEY_")) else {
        return code.to_string().into();
    };
    if let Some((_, word)) = KEY_WORDS.iter().find(|(key, _)| *key == rest) {
        return Cow::Borrowed(word);
    }
    let beginning = KEY_BEGINNINGS.iter().find_map(|(start, word)| Some((word, rest.strip_prefix(start)?)));
    let (start, end) = beginning.filter(|(_, end)| !end.is_empty()).unwrap_or((&"", rest));
    // Letters, numbers and function keys are written as they are printed.
    let is_printed =
        end.len() <= 2 || end.strip_prefix('F').is_some_and(|number| number.parse::<u8>().is_ok());
    if is_printed && start.is_empty() {
        return Cow::Borrowed(rest);
    }
    let (first, others) = end.split_at(1);
    format!("{start}{first}{}", others.to_lowercase().replace('_', " ")).into()
}

/// The word of a binding.
pub fn of(binding: Binding) -> Cow<'static, str> {
    word(binding.device, binding.code, binding.value)
}

/// The words of controls that go down together: `left Ctrl + C`.
pub fn all_of(keys: &Keys) -> String {
    keys.iter().map(of).collect::<Vec<_>>().join(" + ")
}

/// A control as bindings write it, with its side: `BTN_SOUTH`, `ABS_HAT0X-`.
pub fn written(code: Code, value: i32) -> String {
    match code {
        Code::Key(_) => code.to_string(),
        Code::Axis(_) | Code::Relative(_) => format!("{code}{}", if value < 0 { '-' } else { '+' }),
    }
}

/// The controls of a device that a profile can drive: as bindings write them, and the word of each.
pub fn table(device: OutputDevice) -> Vec<(String, Cow<'static, str>)> {
    let both = |code: Code| [(code, -1), (code, 1)];
    let once = |code: Code| (code, 1);
    let all: Vec<(Code, i32)> = match device {
        OutputDevice::Gamepad => {
            let axes = STICKS.into_iter().flatten().chain(TRIGGERS);
            let hat = HAT_AXES.into_iter().flat_map(both);
            GAMEPAD_BUTTONS.into_iter().map(once).chain(hat).chain(axes.flat_map(both)).collect()
        }
        OutputDevice::Keyboard => {
            let keys = names::canonical().map(|(_, code)| code);
            keys.filter(|code| names::is_keyboard_key(*code)).map(once).collect()
        }
        OutputDevice::Pointer => {
            let moved = POINTER_MOTION.into_iter().chain([POINTER_WHEEL]).flat_map(both);
            POINTER_BUTTONS.into_iter().map(once).chain(moved).collect()
        }
        OutputDevice::Tablet => names::POINTER_PLACE.into_iter().map(once).collect(),
    };
    all.into_iter().map(|(code, value)| (written(code, value), word(device, code, value))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    const DEVICES: [OutputDevice; 4] =
        [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Pointer, OutputDevice::Tablet];

    #[test]
    fn each_control_of_each_device_has_a_word_of_its_own() {
        for device in DEVICES {
            let mut owners: HashMap<String, Code> = HashMap::new();
            for (name, word) in table(device) {
                let code = names::parse(name.trim_end_matches(['-', '+'])).unwrap();
                assert!(!word.contains('_') && !word.is_empty(), "{name}: {word}");
                let longest = word.split(' ').map(str::len).max();
                assert!(longest <= Some(17), "{name} is spelt as the kernel does: {word}");
                let shouts = word.len() > 3 && word.chars().all(|it| it.is_ascii_uppercase());
                assert!(!shouts, "{name} is spelt as the kernel does: {word}");
                assert_eq!(*owners.entry(word.to_lowercase()).or_insert(code), code, "{name}: {word}");
            }
        }
        assert_eq!(table(OutputDevice::Keyboard).len(), 242);
    }

    #[test]
    fn words_are_those_that_are_printed_on_pads_and_keys() {
        for (device, name, value, expected) in [
            (OutputDevice::Gamepad, "BTN_SOUTH", 1, "A"),
            (OutputDevice::Gamepad, "BTN_X", 1, "X"),
            (OutputDevice::Gamepad, "ABS_HAT0Y", -1, "up"),
            (OutputDevice::Gamepad, "ABS_HAT0X", 1, "right"),
            (OutputDevice::Gamepad, "ABS_Z", 200, "left trigger"),
            (OutputDevice::Keyboard, "KEY_Z", 1, "Z"),
            (OutputDevice::Keyboard, "KEY_F11", 1, "F11"),
            (OutputDevice::Keyboard, "KEY_LEFTSHIFT", 1, "left Shift"),
            (OutputDevice::Keyboard, "KEY_KP7", 1, "keypad 7"),
            (OutputDevice::Keyboard, "KEY_DISPLAY_OFF", 1, "Display off"),
            (OutputDevice::Pointer, "REL_WHEEL", -1, "wheel, towards you"),
            (OutputDevice::Tablet, "ABS_X", 900, "pointer, sideways"),
            (OutputDevice::Tablet, "BTN_LEFT", 1, "left mouse button"),
        ] {
            assert_eq!(word(device, names::parse(name).unwrap(), value), expected, "{name}");
        }
    }
}
