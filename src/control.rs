//! What a game can see: devices, their keys and axes, and one change of one of them.

use crate::time::StreamInstant;

/// A virtual device. Keys and gamepad controls never share one: input stacks would misclassify it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Device {
    /// The virtual Xbox 360 pad.
    Gamepad,
    /// The virtual keyboard.
    Keyboard,
}

/// A control of a device, by the kernel's number (`linux/input-event-codes.h`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Code {
    /// `KEY_*` or `BTN_*`: 1 while held, 0 otherwise.
    Key(u16),
    /// `ABS_*`: a position; 0 is neutral.
    Axis(u16),
}

/// One edge: at `at`, `code` of `device` took the value `value`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputEvent {
    /// Stream time of the decision.
    pub at: StreamInstant,
    /// The device it happens on.
    pub device: Device,
    /// The key or axis.
    pub code: Code,
    /// Its new value: 1 or 0 for keys, the position for axes.
    pub value: i32,
}
