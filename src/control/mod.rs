//! What a game can see: devices, their keys and axes, and one change of one of them.

use std::fmt;

use crate::time::StreamInstant;

pub mod names;

/// A virtual device. Keys, gamepad controls and the pointer never share one: input stacks would misclassify it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Device {
    /// The virtual Xbox 360 pad.
    Gamepad,
    /// The virtual keyboard.
    Keyboard,
    /// The virtual mouse.
    Pointer,
}

impl Device {
    /// The word that files and the event log use: `gamepad`, `keyboard` or `pointer`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gamepad => "gamepad",
            Self::Keyboard => "keyboard",
            Self::Pointer => "pointer",
        }
    }
}

/// A control of a device, by the kernel's number (`linux/input-event-codes.h`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Code {
    /// `KEY_*` or `BTN_*`: 1 while held, 0 otherwise.
    Key(u16),
    /// `ABS_*`: a position; 0 is neutral.
    Axis(u16),
    /// `REL_*`: a movement by so many counts. As an event it is done once it is told; nothing stays held.
    Relative(u16),
}

/// The kernel's name, as `BTN_SOUTH`; for a number without a name in [`names`], as `KEY_0x2bf`, `ABS_0x28`
/// or `REL_0xf`.
impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (names::name(*self), *self) {
            (Some(name), _) => f.write_str(name),
            (None, Self::Key(number)) => write!(f, "KEY_{number:#x}"),
            (None, Self::Axis(number)) => write!(f, "ABS_{number:#x}"),
            (None, Self::Relative(number)) => write!(f, "REL_{number:#x}"),
        }
    }
}

/// One edge: at `at`, `code` of `device` took the value `value`, or moved by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputEvent {
    /// Stream time of the decision.
    pub at: StreamInstant,
    /// The device it happens on.
    pub device: Device,
    /// The key or axis.
    pub code: Code,
    /// Its new value: 1 or 0 for keys, the position for axes; for relative axes the counts moved, never 0.
    pub value: i32,
}

#[cfg(test)]
mod tests {
    use super::*;

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
