//! The plain words of a profile's own words: modes, forces, kinds of press, what is asked of tactpad itself.

use super::settings;
use crate::pipeline::mapping::profile::words::{COMMANDS, DPAD_MODES, FORCES, POINTER_MODES, SIDES, SOURCES};

/// A setting that takes one of some words, and the plain word of each.
type Choice = (&'static str, &'static [(&'static str, &'static str)]);

/// The settings that take words.
pub const CHOICES: &[Choice] = &[
    ("output", &[("gamepad", "gamepad"), ("keyboard", "keyboard")]),
    (
        "dpad.mode",
        &[
            (DPAD_MODES[0].0, "four directions"),
            (DPAD_MODES[1].0, "four directions, kept on diagonals"),
            (DPAD_MODES[2].0, "eight directions"),
        ],
    ),
    (
        "pointer.mode",
        &[
            (POINTER_MODES[0].0, "the place is a speed"),
            (POINTER_MODES[1].0, "the place is a place of the screen"),
        ],
    ),
    (
        "button.force",
        &[
            (FORCES[0].0, "press into the plate"),
            (FORCES[1].0, "push up"),
            (FORCES[2].0, "push down"),
            (FORCES[3].0, "push right"),
            (FORCES[4].0, "push left"),
        ],
    ),
    (
        "button.skip",
        &[
            ("no", "light comes first, hard on top"),
            ("may", "a quick hard press is hard alone"),
            ("must", "light or hard, never both"),
        ],
    ),
    ("stick.stick", &[(SIDES[0].0, "left stick"), (SIDES[1].0, "right stick")]),
    ("stick.from", &[(SOURCES[0].0, "where the finger is"), (SOURCES[1].0, "where the finger pushes")]),
    ("trigger.trigger", &[(SIDES[0].0, "left trigger"), (SIDES[1].0, "right trigger")]),
    (
        "button.*.bridge",
        &[
            (COMMANDS[0].0, "next profile"),
            (COMMANDS[1].0, "pause, or go on"),
            (COMMANDS[2].0, "release everything"),
            (COMMANDS[3].0, "measure the zero"),
        ],
    ),
];

/// The plain word of what stands for a setting; the word itself where it has none.
pub fn word<'w>(place: &str, written: &'w str) -> &'w str {
    let choice = CHOICES.iter().find(|(pattern, _)| settings::fits(pattern, place));
    let word = choice.and_then(|(_, words)| words.iter().find(|(it, _)| *it == written));
    word.map_or(written, |(_, word)| *word)
}
