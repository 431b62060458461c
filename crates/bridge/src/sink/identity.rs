//! The identities and controls of the virtual devices.
//!
//! The gamepad is an Xbox 360 pad on a wire, down to the last axis range, because games, browsers and SDL
//! recognise controllers by their numbers and count buttons and axes by the order of the codes. Version
//! 0x0114 matters: SDL's controller database maps the D-pad of version 1 upside down.

use tactpad_core::pipeline::control::names::{
    GAMEPAD_BUTTONS, POINTER_BUTTONS, POINTER_PLACE, POINTER_PLACE_MAX, canonical, is_keyboard_key, name,
};
use tactpad_core::pipeline::control::{Code, OutputDevice};

/// `BUS_USB` of `linux/input.h`.
const BUS_USB: u16 = 0x03;

/// `BUS_VIRTUAL` of `linux/input.h`.
const BUS_VIRTUAL: u16 = 0x06;

/// The numbers and the name by which programs recognise a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceIdentity {
    /// The bus it claims to be on (`BUS_*` of `linux/input.h`).
    pub bus: u16,
    /// The name that people see.
    pub name: &'static str,
    /// USB vendor number.
    pub vendor: u16,
    /// USB product number.
    pub product: u16,
    /// Version of the product.
    pub version: u16,
}

/// The Xbox 360 pad.
pub const GAMEPAD: DeviceIdentity = DeviceIdentity {
    bus: BUS_USB,
    name: "Microsoft X-Box 360 pad",
    vendor: 0x045e,
    product: 0x028e,
    version: 0x0114,
};

/// The keyboard. Nothing looks for its numbers: they are two of those that pid.codes keeps free for tests.
pub const KEYBOARD: DeviceIdentity = DeviceIdentity {
    bus: BUS_VIRTUAL,
    name: "tactpad keyboard",
    vendor: 0x1209,
    product: 0x0002,
    version: 0x0001,
};

/// The pointer, told from other mice by its name alone.
pub const POINTER: DeviceIdentity = DeviceIdentity {
    bus: BUS_VIRTUAL,
    name: "tactpad pointer",
    vendor: 0x1209,
    product: 0x0003,
    version: 0x0001,
};

/// The tablet, told from others by its name alone.
pub const TABLET: DeviceIdentity = DeviceIdentity {
    bus: BUS_VIRTUAL,
    name: "tactpad tablet",
    vendor: 0x1209,
    product: 0x0004,
    version: 0x0001,
};

/// One axis of the pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AbsoluteAxis {
    /// The kernel's number, `ABS_*`.
    pub code: u16,
    /// Smallest position.
    pub min: i32,
    /// Largest position.
    pub max: i32,
    /// The kernel takes smaller changes for noise.
    pub fuzz: i32,
    /// Readers take positions up to this far from 0 for 0.
    pub flat: i32,
}

/// The pad's axes: X, Y, Z, RX, RY, RZ, HAT0X, HAT0Y. All rest at 0.
pub const GAMEPAD_AXES: [AbsoluteAxis; 8] =
    [stick(0x00), stick(0x01), trigger(0x02), stick(0x03), stick(0x04), trigger(0x05), hat(0x10), hat(0x11)];

const fn stick(code: u16) -> AbsoluteAxis {
    AbsoluteAxis { code, min: -32_768, max: 32_767, fuzz: 16, flat: 128 }
}

const fn trigger(code: u16) -> AbsoluteAxis {
    AbsoluteAxis { code, min: 0, max: 255, fuzz: 0, flat: 0 }
}

const fn hat(code: u16) -> AbsoluteAxis {
    AbsoluteAxis { code, min: -1, max: 1, fuzz: 0, flat: 0 }
}

/// The axes of the tablet.
pub const TABLET_AXES: [AbsoluteAxis; 2] = [
    AbsoluteAxis { code: 0x00, min: 1, max: POINTER_PLACE_MAX, fuzz: 0, flat: 0 },
    AbsoluteAxis { code: 0x01, min: 1, max: POINTER_PLACE_MAX, fuzz: 0, flat: 0 },
];

/// The numbers of all keys of `device`.
///
/// The pad has the eleven of the driver xpad and no more: readers count them. The keyboard has every key that
/// a profile can name, so that a profile which passed its check loses nothing here. The pointer has a mouse's
/// three.
pub fn keys(device: OutputDevice) -> impl Iterator<Item = u16> {
    canonical().filter(move |(_, code)| declares(device, *code)).filter_map(|(_, code)| match code {
        Code::Key(number) => Some(number),
        Code::Axis(_) | Code::Relative(_) => None,
    })
}

/// The numbers of the movements that the pointer has: both directions, and the wheel that programs expect of a mouse.
pub fn movements() -> impl Iterator<Item = u16> {
    canonical().filter_map(|(_, code)| match code {
        Code::Relative(number) => Some(number),
        Code::Key(_) | Code::Axis(_) => None,
    })
}

/// Says whether `device` has the control `code`. The kernel drops events of all others without a word.
pub fn declares(device: OutputDevice, code: Code) -> bool {
    match (device, code) {
        (OutputDevice::Gamepad, Code::Key(_)) => GAMEPAD_BUTTONS.contains(&code),
        (OutputDevice::Gamepad, Code::Axis(axis)) => {
            GAMEPAD_AXES.iter().any(|declared| declared.code == axis)
        }
        (OutputDevice::Gamepad, Code::Relative(_)) => false,
        (OutputDevice::Keyboard, _) => is_keyboard_key(code) && name(code).is_some(),
        (OutputDevice::Pointer, Code::Relative(movement)) => movements().any(|declared| declared == movement),
        (OutputDevice::Pointer, _) => POINTER_BUTTONS.contains(&code),
        (OutputDevice::Tablet, _) => POINTER_PLACE.contains(&code),
    }
}

#[cfg(test)]
mod tests {
    use evdev::{AbsoluteAxisCode, KeyCode};

    use super::*;

    #[test]
    fn pad_has_the_controls_of_the_xpad_driver_and_no_others() {
        let expected = [
            KeyCode::BTN_SOUTH,
            KeyCode::BTN_EAST,
            KeyCode::BTN_NORTH,
            KeyCode::BTN_WEST,
            KeyCode::BTN_TL,
            KeyCode::BTN_TR,
            KeyCode::BTN_SELECT,
            KeyCode::BTN_START,
            KeyCode::BTN_MODE,
            KeyCode::BTN_THUMBL,
            KeyCode::BTN_THUMBR,
        ];
        assert!(keys(OutputDevice::Gamepad).eq(expected.map(|key| key.0)));
        for key in [KeyCode::BTN_C, KeyCode::BTN_TL2, KeyCode::BTN_TR2, KeyCode::BTN_DPAD_UP, KeyCode::KEY_A]
        {
            assert!(!declares(OutputDevice::Gamepad, Code::Key(key.0)), "{key:?}");
        }
    }

    #[test]
    fn sticks_triggers_and_hat_have_their_ranges() {
        let of = |code: AbsoluteAxisCode| {
            let axis = GAMEPAD_AXES.iter().find(|axis| axis.code == code.0).unwrap();
            (axis.min, axis.max, axis.fuzz, axis.flat)
        };
        use AbsoluteAxisCode as Abs;
        for code in [Abs::ABS_X, Abs::ABS_Y, Abs::ABS_RX, Abs::ABS_RY] {
            assert_eq!(of(code), (-32_768, 32_767, 16, 128), "{code:?}");
        }
        for code in [Abs::ABS_Z, Abs::ABS_RZ] {
            assert_eq!(of(code), (0, 255, 0, 0), "{code:?}");
        }
        for code in [Abs::ABS_HAT0X, Abs::ABS_HAT0Y] {
            assert_eq!(of(code), (-1, 1, 0, 0), "{code:?}");
        }
    }

    #[test]
    fn pointer_is_a_mouse_and_nothing_else() {
        use evdev::RelativeAxisCode as Rel;
        assert!(movements().eq([Rel::REL_X.0, Rel::REL_Y.0, Rel::REL_WHEEL.0]));
        assert!(keys(OutputDevice::Pointer).eq([
            KeyCode::BTN_LEFT.0,
            KeyCode::BTN_RIGHT.0,
            KeyCode::BTN_MIDDLE.0
        ]));
        for code in [
            Code::Key(KeyCode::BTN_SIDE.0),
            Code::Key(KeyCode::BTN_SOUTH.0),
            Code::Axis(0),
            Code::Relative(2),
        ] {
            assert!(!declares(OutputDevice::Pointer, code), "{code}");
        }
        for device in [OutputDevice::Gamepad, OutputDevice::Keyboard] {
            assert!(
                !declares(device, Code::Relative(0)) && !declares(device, Code::Key(KeyCode::BTN_LEFT.0))
            );
        }
    }

    #[test]
    fn keyboard_has_what_games_ask_for() {
        for name in [
            "KEY_A",
            "KEY_Z",
            "KEY_M",
            "KEY_1",
            "KEY_0",
            "KEY_UP",
            "KEY_DOWN",
            "KEY_LEFT",
            "KEY_RIGHT",
            "KEY_LEFTSHIFT",
            "KEY_RIGHTSHIFT",
            "KEY_LEFTCTRL",
            "KEY_RIGHTCTRL",
            "KEY_LEFTALT",
            "KEY_RIGHTALT",
            "KEY_LEFTMETA",
            "KEY_RIGHTMETA",
            "KEY_SPACE",
            "KEY_ENTER",
            "KEY_ESC",
            "KEY_TAB",
            "KEY_BACKSPACE",
            "KEY_DELETE",
            "KEY_HOME",
            "KEY_PAGEDOWN",
            "KEY_F1",
            "KEY_F10",
            "KEY_F11",
            "KEY_F12",
            "KEY_F24",
            "KEY_KP0",
            "KEY_KPENTER",
            "KEY_102ND",
            "KEY_PAUSE",
            "KEY_COMPOSE",
        ] {
            let key: KeyCode = name.parse().unwrap();
            assert!(declares(OutputDevice::Keyboard, Code::Key(key.0)), "{name}");
        }
    }

    #[test]
    fn keyboard_is_taken_for_a_keyboard_and_for_nothing_else() {
        // udev asks for every key from escape to D; a joystick or mouse button would change the verdict.
        assert!(
            (KeyCode::KEY_ESC.0..=KeyCode::KEY_D.0).all(|key| keys(OutputDevice::Keyboard).any(|k| k == key))
        );
        assert!(keys(OutputDevice::Keyboard).all(|key| key < KeyCode::BTN_0.0));
        for key in [KeyCode::KEY_RESERVED, KeyCode::BTN_SOUTH, KeyCode::BTN_LEFT] {
            assert!(!declares(OutputDevice::Keyboard, Code::Key(key.0)), "{key:?}");
        }
        assert!(!declares(OutputDevice::Keyboard, Code::Axis(AbsoluteAxisCode::ABS_X.0)));
    }
}
