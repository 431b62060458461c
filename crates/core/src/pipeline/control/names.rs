//! The kernel's names of keys, buttons and axes.
//!
//! Source: `linux/input-event-codes.h` of the Linux kernel. The keyboard's keys up to 248, a mouse's three
//! buttons and movements, the gamepad block and the position axes are here; the header's further blocks (media
//! remotes, pens) are nothing a pad should press.

use std::fmt;

use super::Code;

/// The buttons of the virtual Xbox 360 pad, in the kernel's order.
pub const GAMEPAD_BUTTONS: [Code; 11] = [
    Code::Key(0x130),
    Code::Key(0x131),
    Code::Key(0x133),
    Code::Key(0x134),
    Code::Key(0x136),
    Code::Key(0x137),
    Code::Key(0x13a),
    Code::Key(0x13b),
    Code::Key(0x13c),
    Code::Key(0x13d),
    Code::Key(0x13e),
];

/// The hat of a gamepad: left and right, then up and down.
pub const HAT_AXES: [Code; 2] = [Code::Axis(0x10), Code::Axis(0x11)];

/// The sticks of a gamepad, left and right: of each the axis to the right, then down.
pub const STICKS: [[Code; 2]; 2] =
    [[Code::Axis(0x00), Code::Axis(0x01)], [Code::Axis(0x03), Code::Axis(0x04)]];

/// The triggers of a gamepad, left and right.
pub const TRIGGERS: [Code; 2] = [Code::Axis(0x02), Code::Axis(0x05)];

/// Movement of the pointer: to the right, then down.
pub const POINTER_MOTION: [Code; 2] = [Code::Relative(0x00), Code::Relative(0x01)];

/// Places of the pointer on the screen: from the left, then from the top.
pub const POINTER_PLACE: [Code; 2] = [Code::Axis(0x00), Code::Axis(0x01)];

/// The far edge of the screen in [`POINTER_PLACE`]; the near one is 1.
pub const POINTER_PLACE_MAX: i32 = 32_767;

/// The wheel of the virtual mouse: a notch away from the hand is positive.
pub const POINTER_WHEEL: Code = Code::Relative(0x08);

/// The buttons of the virtual mouse: left, right, middle.
pub const POINTER_BUTTONS: [Code; 3] = [Code::Key(0x110), Code::Key(0x111), Code::Key(0x112)];

/// The keys that change what other keys and the mouse's buttons mean while they are down.
const MODIFIER_KEYS: [Code; 8] = [
    Code::Key(29),
    Code::Key(42),
    Code::Key(54),
    Code::Key(56),
    Code::Key(97),
    Code::Key(100),
    Code::Key(125),
    Code::Key(126),
];

/// The first number that belongs to a button of a mouse, joystick or gamepad; below it are the keyboard's
/// keys.
const FIRST_BUTTON: u16 = 0x100;

/// Names of consecutive numbers, from a first number on.
type NameRange = (u16, &'static [&'static str]);

macro_rules! runs {
    ($($first:literal: $($name:ident)+;)+) => { &[$(($first, &[$(stringify!($name)),+])),+] };
}

const KEYS: &[NameRange] = runs! {
    1: KEY_ESC KEY_1 KEY_2 KEY_3 KEY_4 KEY_5 KEY_6 KEY_7 KEY_8 KEY_9 KEY_0 KEY_MINUS KEY_EQUAL KEY_BACKSPACE;
    15: KEY_TAB KEY_Q KEY_W KEY_E KEY_R KEY_T KEY_Y KEY_U KEY_I KEY_O KEY_P KEY_LEFTBRACE KEY_RIGHTBRACE;
    28: KEY_ENTER KEY_LEFTCTRL KEY_A KEY_S KEY_D KEY_F KEY_G KEY_H KEY_J KEY_K KEY_L KEY_SEMICOLON;
    40: KEY_APOSTROPHE KEY_GRAVE KEY_LEFTSHIFT KEY_BACKSLASH KEY_Z KEY_X KEY_C KEY_V KEY_B KEY_N KEY_M;
    51: KEY_COMMA KEY_DOT KEY_SLASH KEY_RIGHTSHIFT KEY_KPASTERISK KEY_LEFTALT KEY_SPACE KEY_CAPSLOCK KEY_F1;
    60: KEY_F2 KEY_F3 KEY_F4 KEY_F5 KEY_F6 KEY_F7 KEY_F8 KEY_F9 KEY_F10 KEY_NUMLOCK KEY_SCROLLLOCK KEY_KP7;
    72: KEY_KP8 KEY_KP9 KEY_KPMINUS KEY_KP4 KEY_KP5 KEY_KP6 KEY_KPPLUS KEY_KP1 KEY_KP2 KEY_KP3 KEY_KP0;
    83: KEY_KPDOT;
    85: KEY_ZENKAKUHANKAKU KEY_102ND KEY_F11 KEY_F12 KEY_RO KEY_KATAKANA KEY_HIRAGANA KEY_HENKAN;
    93: KEY_KATAKANAHIRAGANA KEY_MUHENKAN KEY_KPJPCOMMA KEY_KPENTER KEY_RIGHTCTRL KEY_KPSLASH KEY_SYSRQ;
    100: KEY_RIGHTALT KEY_LINEFEED KEY_HOME KEY_UP KEY_PAGEUP KEY_LEFT KEY_RIGHT KEY_END KEY_DOWN;
    109: KEY_PAGEDOWN;
    110: KEY_INSERT KEY_DELETE KEY_MACRO KEY_MUTE KEY_VOLUMEDOWN KEY_VOLUMEUP KEY_POWER KEY_KPEQUAL;
    118: KEY_KPPLUSMINUS KEY_PAUSE KEY_SCALE KEY_KPCOMMA KEY_HANGEUL KEY_HANJA KEY_YEN KEY_LEFTMETA;
    126: KEY_RIGHTMETA KEY_COMPOSE KEY_STOP KEY_AGAIN KEY_PROPS KEY_UNDO KEY_FRONT KEY_COPY KEY_OPEN;
    135: KEY_PASTE;
    136: KEY_FIND KEY_CUT KEY_HELP KEY_MENU KEY_CALC KEY_SETUP KEY_SLEEP KEY_WAKEUP KEY_FILE KEY_SENDFILE;
    146: KEY_DELETEFILE KEY_XFER KEY_PROG1 KEY_PROG2 KEY_WWW KEY_MSDOS KEY_COFFEE KEY_ROTATE_DISPLAY;
    154: KEY_CYCLEWINDOWS KEY_MAIL KEY_BOOKMARKS KEY_COMPUTER KEY_BACK KEY_FORWARD KEY_CLOSECD KEY_EJECTCD;
    162: KEY_EJECTCLOSECD KEY_NEXTSONG KEY_PLAYPAUSE KEY_PREVIOUSSONG KEY_STOPCD KEY_RECORD KEY_REWIND;
    169: KEY_PHONE KEY_ISO KEY_CONFIG KEY_HOMEPAGE KEY_REFRESH KEY_EXIT KEY_MOVE KEY_EDIT KEY_SCROLLUP;
    178: KEY_SCROLLDOWN KEY_KPLEFTPAREN KEY_KPRIGHTPAREN KEY_NEW KEY_REDO KEY_F13 KEY_F14 KEY_F15 KEY_F16;
    187: KEY_F17 KEY_F18 KEY_F19 KEY_F20 KEY_F21 KEY_F22 KEY_F23 KEY_F24;
    200: KEY_PLAYCD KEY_PAUSECD KEY_PROG3 KEY_PROG4 KEY_ALL_APPLICATIONS KEY_SUSPEND KEY_CLOSE KEY_PLAY;
    208: KEY_FASTFORWARD KEY_BASSBOOST KEY_PRINT KEY_HP KEY_CAMERA KEY_SOUND KEY_QUESTION KEY_EMAIL KEY_CHAT;
    217: KEY_SEARCH KEY_CONNECT KEY_FINANCE KEY_SPORT KEY_SHOP KEY_ALTERASE KEY_CANCEL KEY_BRIGHTNESSDOWN;
    225: KEY_BRIGHTNESSUP KEY_MEDIA KEY_SWITCHVIDEOMODE KEY_KBDILLUMTOGGLE KEY_KBDILLUMDOWN KEY_KBDILLUMUP;
    231: KEY_SEND KEY_REPLY KEY_FORWARDMAIL KEY_SAVE KEY_DOCUMENTS KEY_BATTERY KEY_BLUETOOTH KEY_WLAN KEY_UWB;
    240: KEY_UNKNOWN KEY_VIDEO_NEXT KEY_VIDEO_PREV KEY_BRIGHTNESS_CYCLE KEY_BRIGHTNESS_AUTO KEY_DISPLAY_OFF;
    246: KEY_WWAN KEY_RFKILL KEY_MICMUTE;
    0x110: BTN_LEFT BTN_RIGHT BTN_MIDDLE;
    0x130: BTN_SOUTH BTN_EAST BTN_C BTN_NORTH BTN_WEST BTN_Z BTN_TL BTN_TR BTN_TL2 BTN_TR2 BTN_SELECT;
    0x13b: BTN_START BTN_MODE BTN_THUMBL BTN_THUMBR;
    0x220: BTN_DPAD_UP BTN_DPAD_DOWN BTN_DPAD_LEFT BTN_DPAD_RIGHT;
};

const AXES: &[NameRange] = runs! {
    0x00: ABS_X ABS_Y ABS_Z ABS_RX ABS_RY ABS_RZ;
    0x10: ABS_HAT0X ABS_HAT0Y;
};

const MOVEMENTS: &[NameRange] = runs! {
    0x00: REL_X REL_Y;
    0x08: REL_WHEEL;
};

/// Second names that the header defines, each with the name that is printed for it.
const ALIASES: &[(&str, &str)] = &[
    ("BTN_GAMEPAD", "BTN_SOUTH"),
    ("BTN_A", "BTN_SOUTH"),
    ("BTN_B", "BTN_EAST"),
    ("BTN_X", "BTN_NORTH"),
    ("BTN_Y", "BTN_WEST"),
    ("KEY_HANGUEL", "KEY_HANGEUL"),
    ("KEY_SCREENLOCK", "KEY_COFFEE"),
    ("KEY_DIRECTION", "KEY_ROTATE_DISPLAY"),
    ("KEY_DASHBOARD", "KEY_ALL_APPLICATIONS"),
    ("KEY_BRIGHTNESS_ZERO", "KEY_BRIGHTNESS_AUTO"),
    ("KEY_WIMAX", "KEY_WWAN"),
];

impl Code {
    /// Whether it is Shift, Ctrl, Alt or Meta, left or right.
    pub fn is_modifier(self) -> bool {
        MODIFIER_KEYS.contains(&self)
    }

    /// Whether a modifier changes what it means: any other key, a button of the mouse, or its wheel.
    pub fn takes_modifiers(self) -> bool {
        let is_key = matches!(self, Self::Key(number) if number < FIRST_BUTTON) && !self.is_modifier();
        is_key || POINTER_BUTTONS.contains(&self) || self == POINTER_WHEEL
    }
}

/// The kernel's name of `code`, or `None` for a number outside the table.
pub fn name(code: Code) -> Option<&'static str> {
    let (runs, number) = match code {
        Code::Key(number) => (KEYS, number),
        Code::Axis(number) => (AXES, number),
        Code::Relative(number) => (MOVEMENTS, number),
    };
    runs.iter().find_map(|(first, names)| names.get(usize::from(number.checked_sub(*first)?)).copied())
}

/// The kernel's name, as `BTN_SOUTH`; for a number without a name, as `KEY_0x2bf`, `ABS_0x28`
/// or `REL_0xf`.
impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (name(*self), *self) {
            (Some(name), _) => f.write_str(name),
            (None, Self::Key(number)) => write!(f, "KEY_{number:#x}"),
            (None, Self::Axis(number)) => write!(f, "ABS_{number:#x}"),
            (None, Self::Relative(number)) => write!(f, "REL_{number:#x}"),
        }
    }
}

/// The control that `text` names: a kernel name or an alias in any case; `KEY_` may be left out (`"space"`).
pub fn parse(text: &str) -> Option<Code> {
    let full = |name: &str| canonical().chain(aliases()).find(|(n, _)| n.eq_ignore_ascii_case(name));
    let short = |(name, _): &(&str, Code)| {
        name.strip_prefix("KEY_").is_some_and(|rest| rest.eq_ignore_ascii_case(text))
    };
    full(text).or_else(|| canonical().chain(aliases()).find(short)).map(|(_, code)| code)
}

/// Whether `code` is a key of a keyboard.
pub const fn is_keyboard_key(code: Code) -> bool {
    matches!(code, Code::Key(number) if number < FIRST_BUTTON)
}

/// Whether `code` is on the virtual mouse.
pub fn is_pointers(code: Code) -> bool {
    matches!(code, Code::Relative(_)) || POINTER_BUTTONS.contains(&code)
}

/// Every control of the table with its kernel name: keys, axes, movements.
pub fn canonical() -> impl Iterator<Item = (&'static str, Code)> {
    let keys = numbered(KEYS).map(|(name, number)| (name, Code::Key(number)));
    let axes = numbered(AXES).map(|(name, number)| (name, Code::Axis(number)));
    keys.chain(axes).chain(numbered(MOVEMENTS).map(|(name, number)| (name, Code::Relative(number))))
}

fn aliases() -> impl Iterator<Item = (&'static str, Code)> {
    let target = |wanted: &str| canonical().find(|(name, _)| *name == wanted);
    ALIASES.iter().filter_map(move |(alias, wanted)| Some((*alias, target(wanted)?.1)))
}

fn numbered(runs: &'static [NameRange]) -> impl Iterator<Item = (&'static str, u16)> {
    runs.iter().flat_map(|(first, names)| names.iter().copied().zip(*first..))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_and_its_number_find_each_other() {
        for (text, code) in canonical() {
            assert_eq!(parse(text), Some(code), "{text}");
            assert_eq!(name(code), Some(text));
        }
        assert_eq!(
            canonical().count(),
            242 + 3 + 15 + 4 + 8 + 3,
            "all keys of the header from 1 to 248, buttons, axes, movements"
        );
    }

    #[test]
    fn numbers_are_those_of_the_header() {
        let header = [
            ("KEY_ESC", Code::Key(1)),
            ("KEY_Z", Code::Key(44)),
            ("KEY_X", Code::Key(45)),
            ("KEY_ZENKAKUHANKAKU", Code::Key(85)),
            ("KEY_UP", Code::Key(103)),
            ("KEY_DOWN", Code::Key(108)),
            ("KEY_F24", Code::Key(194)),
            ("KEY_PLAYCD", Code::Key(200)),
            ("KEY_MICMUTE", Code::Key(248)),
            ("BTN_LEFT", Code::Key(0x110)),
            ("BTN_SOUTH", Code::Key(0x130)),
            ("BTN_THUMBR", Code::Key(0x13e)),
            ("BTN_DPAD_RIGHT", Code::Key(0x223)),
            ("ABS_RZ", Code::Axis(5)),
            ("ABS_HAT0Y", Code::Axis(0x11)),
            ("REL_WHEEL", Code::Relative(8)),
        ];
        for (text, code) in header {
            assert_eq!(parse(text), Some(code), "{text}");
        }
        for gap in [0, 84, 195, 199, 249, 0x12f, 0x13f] {
            assert_eq!(name(Code::Key(gap)), None, "{gap:#x}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_evdev_crate_has_the_same_numbers() {
        for (text, code) in canonical() {
            let theirs = match code {
                Code::Key(number) => format!("{:?}", evdev::KeyCode(number)),
                Code::Axis(number) => format!("{:?}", evdev::AbsoluteAxisCode(number)),
                Code::Relative(number) => format!("{:?}", evdev::RelativeAxisCode(number)),
            };
            assert_eq!(parse(&theirs), Some(code), "{theirs} is {text}");
        }
    }

    #[test]
    fn case_and_the_key_prefix_do_not_matter() {
        assert_eq!(parse("space"), Some(Code::Key(57)));
        assert_eq!(parse("Key_Space"), Some(Code::Key(57)));
        assert_eq!(parse("1"), Some(Code::Key(2)));
        assert_eq!(parse("screenlock"), Some(Code::Key(152)));
        assert_eq!(parse("btn_start"), Some(Code::Key(0x13b)));
        for text in ["", "KEY_", "SOUTH", "BTN_", "HAT0X", "KEY_KEY_A", " KEY_A"] {
            assert_eq!(parse(text), None, "{text:?}");
        }
    }

    #[test]
    fn aliases_print_the_canonical_name() {
        for (alias, wanted) in ALIASES {
            assert_eq!(parse(alias).and_then(name), Some(*wanted));
        }
        assert_eq!(aliases().count(), ALIASES.len());
    }

    #[test]
    fn the_pad_has_exactly_the_buttons_of_its_kind() {
        let names: Vec<_> = GAMEPAD_BUTTONS.iter().filter_map(|code| name(*code)).collect();
        let wanted = "BTN_SOUTH BTN_EAST BTN_NORTH BTN_WEST BTN_TL BTN_TR BTN_SELECT BTN_START BTN_MODE \
                      BTN_THUMBL BTN_THUMBR";
        assert_eq!(names.join(" "), wanted);
        assert_eq!(HAT_AXES.map(name), [Some("ABS_HAT0X"), Some("ABS_HAT0Y")]);
    }

    #[test]
    fn codes_print_the_kernel_name_or_the_number() {
        assert_eq!(Code::Key(0x130).to_string(), "BTN_SOUTH");
        assert_eq!(Code::Axis(0x11).to_string(), "ABS_HAT0Y");
        assert_eq!(Code::Key(0x2bf).to_string(), "KEY_0x2bf");
        assert_eq!(Code::Axis(0x28).to_string(), "ABS_0x28");
        assert_eq!(Code::Relative(1).to_string(), "REL_Y");
        assert_eq!(Code::Relative(15).to_string(), "REL_0xf");
    }
}
