//! Real games, played by a finger of software on the twin of the paper's pad, through the bridge and an X server's keys, and
//! judged by their own screens.
#![cfg(all(feature = "live", feature = "lab", target_os = "linux"))]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on has failed")]
#![allow(clippy::print_stdout, reason = "the figures are what one looks for in a long test")]

#[path = "../kernel/clock.rs"]
mod clock;
mod desk;
mod digits;
#[path = "../support/framebuffer.rs"]
mod framebuffer;
mod player;
mod segment;
mod supertux;
#[path = "../support/mod.rs"]
mod support;
mod trial;

use player::ORDINARY;
use supertux::SuperTux;
use support::require;
use trial::{Way, play};

#[test]
fn supertux_is_played() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let profile = "supertux";
    for way in [Way::Plain { profile }, Way::Pad { style: ORDINARY, seed: 101, profile }] {
        let outcome = play(&mut SuperTux::start(), &supertux::segment(), way);
        println!("{way:?}: {outcome:?}");
    }
}
