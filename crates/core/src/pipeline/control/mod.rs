//! Outputs that a game can see: devices, their keys and axes, and one change of one of them.

use crate::time::StreamInstant;

pub mod names;

/// A virtual device. Keys, gamepad controls and the pointer never share one: input stacks would misclassify it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum OutputDevice {
    /// The virtual Xbox 360 pad.
    Gamepad,
    /// The virtual keyboard.
    Keyboard,
    /// The virtual mouse.
    Pointer,
    /// Tablet, which puts the pointer to a place of the screen, as a tablet does. Its buttons are the mouse's.
    Tablet,
}

impl OutputDevice {
    /// The word that files and the event log use: `gamepad`, `keyboard` or, for mouse and tablet, `pointer`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gamepad => "gamepad",
            Self::Keyboard => "keyboard",
            Self::Pointer | Self::Tablet => "pointer",
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

/// One edge: at `at`, `code` of `device` took the value `value`, or moved by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputEvent {
    /// Stream time of the decision.
    pub at: StreamInstant,
    /// The device it happens on.
    pub device: OutputDevice,
    /// The key or axis.
    pub code: Code,
    /// Its new value: 1 or 0 for keys, the position for axes; for relative axes the counts moved, never 0.
    pub value: i32,
}
