//! The words that stand in a profile's text for its values.

use super::{Command, DpadMode, Force, PointerMode, Side, Source};

/// The word of a value.
pub(crate) fn word<T: PartialEq>(words: &[(&'static str, T)], of: &T) -> &'static str {
    words.iter().find(|(_, value)| value == of).map_or("", |(word, _)| word)
}

/// How the directions divide the plate.
pub(crate) const DPAD_MODES: [(&str, DpadMode); 3] =
    [("4way", DpadMode::FourWay), ("4way-sticky", DpadMode::FourWaySticky), ("8way", DpadMode::EightWay)];
/// How the pointer is moved.
pub(crate) const POINTER_MODES: [(&str, PointerMode); 2] =
    [("relative", PointerMode::Relative), ("absolute", PointerMode::Absolute)];
/// Which force presses a button.
pub(crate) const FORCES: [(&str, Force); 5] = [
    ("fz", Force::Fz),
    ("fy", Force::FyPositive),
    ("-fy", Force::FyNegative),
    ("fx", Force::FxPositive),
    ("-fx", Force::FxNegative),
];
/// Which stick, or which trigger.
pub(crate) const SIDES: [(&str, Side); 2] = [("left", Side::Left), ("right", Side::Right)];
/// The quantity that moves a stick.
pub(crate) const SOURCES: [(&str, Source); 2] = [("place", Source::Place), ("shear", Source::Shear)];
/// Commands to the bridge, but for going over to a profile of a name.
pub(crate) const COMMANDS: [(&str, Command); 4] = [
    ("next-profile", Command::NextProfile),
    ("pause", Command::TogglePause),
    ("panic", Command::Panic),
    ("tare", Command::Tare),
];
