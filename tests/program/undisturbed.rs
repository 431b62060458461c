//! Demos on a machine that does other things: a virtual pad plays in real time, and where the machine stood still for so long
//! that the link was lost, the program says so and what it played says nothing.

use std::process::Output;

/// So many demos in a row are not disturbed by chance.
const REPEATS_MAX: usize = 5;

/// Plays until the machine did not stand still.
pub(crate) fn undisturbed(play: impl Fn() -> Output) -> Output {
    let mut played = play();
    for _ in 1..REPEATS_MAX {
        if !stood_still(&String::from_utf8_lossy(&played.stderr)) {
            break;
        }
        played = play();
    }
    played
}

/// Whether the program says that its events differ for this reason.
pub(crate) fn stood_still(said: &str) -> bool {
    said.contains("a machine that stood still")
}
