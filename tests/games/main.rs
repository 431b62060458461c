//! Real games, played by a finger of software on the twin of the paper's pad, through the bridge and an X server's keys, and
//! judged by their own screens.
//!
//! The tests play in a guest kernel, in virtual time: no game loses a frame there, whatever else the machine does. Studies are
//! in real time.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on has failed")]
#![allow(clippy::print_stdout, reason = "the figures are what one looks for in a long test")]

mod block;
#[path = "../support/clock.rs"]
mod clock;
mod desk;
mod digits;
#[path = "../support/framebuffer.rs"]
mod framebuffer;
#[path = "../kernel/guest.rs"]
mod guest;
mod hand;
mod heard;
mod owned;
mod pads;
mod pictures;
mod player;
#[path = "../support/pseudo_terminal.rs"]
mod pseudo_terminal;
mod reaction;
mod scroll;
mod segment;
mod supertux;
#[path = "../support/mod.rs"]
mod support;
mod tanks;
mod trial;
mod vitetris;

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use block::Played;
use guest::in_guest;
use hand::{ORDINARY, Style};
use reaction::Times;
use segment::Segment;
use supertux::SuperTux;
use support::require;
use tanks::Tanks;
use trial::{Game, Way, play};
use vitetris::Vitetris;

/// Whether the machine has what every game here needs.
fn has_desk() -> bool {
    require("Xvfb", "apt-get install xvfb")
}

/// One game at a time: two would take each other's time.
static TURN: Mutex<()> = Mutex::new(());

/// Whether the game's screen shows all that the segment asks for.
fn reaches<G: Game>(start: impl Fn() -> G, who: &str, segment: &Segment, profile: &str) -> bool {
    let outcome = play(&mut start(), segment, Way::Pad { style: ORDINARY, seed: SEED, profile });
    println!("{profile}, {who}: {outcome}");
    outcome.reached_s.is_ok()
}

/// Plays a segment by the pad.
fn is_played<G: Game>(start: impl Fn() -> G, segment: &Segment, profile: &str) {
    assert!(reaches(start, "by the finger", segment, profile), "{profile} by the finger");
}

/// Plays a segment with nobody at the pad, and with left and right exchanged: both must fail.
fn takes_a_player<G: Game>(start: impl Fn() -> G, segment: &Segment, profile: &str) {
    for (who, other) in
        [("with nobody at the pad", segment.muted()), ("with left and right exchanged", segment.mirrored())]
    {
        assert!(!reaches(&start, who, &other, profile), "{profile} {who}");
    }
}

/// Pad and finger of single trials.
const SEED: u64 = 1;

#[test]
#[ignore = "proof: 15 s: the whole desk; btanks and vitetris stay tests, and so does SuperTux in the guest's kernel"]
fn supertux_is_played() {
    if has_desk() && supertux::is_there() {
        in_guest("supertux_is_played", || {
            is_played(SuperTux::start, &supertux::segment(), supertux::PROFILE);
        });
    }
}

#[test]
fn vitetris_is_played() {
    if has_desk() && vitetris::is_there() {
        in_guest("vitetris_is_played", || {
            is_played(Vitetris::start, &vitetris::segment(), vitetris::PROFILE);
        });
    }
}

#[test]
#[ignore = "proof: 15 s: a third game, whose screen costs most; the other two stay tests"]
fn btanks_is_played() {
    if has_desk() && tanks::is_there() {
        in_guest("btanks_is_played", || is_played(Tanks::start, &tanks::segment(), tanks::PROFILE));
    }
}

#[test]
#[ignore = "proof: 15 s: without its player the game is not won, so that playing it proves something"]
fn supertux_takes_a_player() {
    in_guest("supertux_takes_a_player", || {
        takes_a_player(SuperTux::start, &supertux::segment(), supertux::PROFILE);
    });
}

#[test]
#[ignore = "proof: 25 s: without its player the game is not won, so that playing it proves something"]
fn vitetris_takes_a_player() {
    in_guest("vitetris_takes_a_player", || {
        takes_a_player(Vitetris::start, &vitetris::segment(), vitetris::PROFILE);
    });
}

#[test]
#[ignore = "proof: 35 s: without its player the game is not won, so that playing it proves something"]
fn btanks_takes_a_player() {
    in_guest("btanks_takes_a_player", || takes_a_player(Tanks::start, &tanks::segment(), tanks::PROFILE));
}

/// How often a long study plays a segment: `TACTPAD_GAMES` of its name, as `block=20`.
fn trials(study: &str) -> Option<u64> {
    let asked = std::env::var("TACTPAD_GAMES").ok()?;
    asked.split(' ').find_map(|word| word.strip_prefix(study)?.strip_prefix('=')?.parse().ok())
}

/// Plays a segment `count` times by the pad and by commands; then with nobody at it, and with left and right exchanged.
fn is_played_again(start: &dyn Fn() -> Box<dyn Game>, segment: &Segment, profile: &str, count: u64) {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let [pad, plain] = Played { start, segment, profile }.side_by_side(count);
    assert!(pad.reached() as u64 >= count - count / 10, "{} of {count} by the pad", pad.reached());
    assert!(plain.reached() as u64 >= count - count / 10, "{} of {count} by commands", plain.reached());
    for (what, other) in [("muted", segment.muted()), ("mirrored", segment.mirrored())] {
        println!("{what}:");
        let reached =
            Played { start, segment: &other, profile }.side_by_side(count).map(|them| them.reached());
        assert_eq!(reached, [0, 0], "{what}");
    }
}

#[test]
fn vitetris_is_played_again() {
    let Some(count) = trials("vitetris") else { return };
    is_played_again(&|| Box::new(Vitetris::start()), &vitetris::segment(), vitetris::PROFILE, count);
}

#[test]
fn btanks_is_played_again() {
    let Some(count) = trials("btanks") else { return };
    is_played_again(&|| Box::new(Tanks::start()), &tanks::segment(), tanks::PROFILE, count);
}

const SUPERTUX: fn() -> Box<dyn Game> = || Box::new(SuperTux::start());

#[test]
fn supertux_is_played_as_well_by_the_pad_as_by_commands() {
    let Some(count) = trials("block") else { return };
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let segment = &supertux::segment();
    let [pad, plain] = Played { start: &SUPERTUX, segment, profile: supertux::PROFILE }.side_by_side(count);
    let least = count - count.div_ceil(20);
    assert!(pad.reached() as u64 >= least, "{} of {count}", pad.reached());
    assert!(pad.reached() + 1 >= plain.reached(), "{} and {}", pad.reached(), plain.reached());
    let ratio = pad.time_s()[0] / plain.time_s()[0];
    assert!(ratio <= 1.05, "{ratio} times the time");
}

#[test]
fn supertux_shows_a_press_in_time() {
    let Some(count) = trials("latency") else { return };
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let game = SuperTux::start();
    let Times { events_ms, presses_ms } = reaction::times(&game, supertux::PROFILE, count as usize);
    println!(
        "| from | presses | mean ± deviation, ms | median, ms | 95th percentile, ms |\n|---|---|---|---|---|"
    );
    println!("{}", reaction::row("event", &events_ms));
    println!("{}", reaction::row("force at the threshold", &presses_ms));
}

/// Deviation of aim and force of the players who scatter.
const SCATTERED: [Style; 3] =
    [ORDINARY, Style { aim_mm: 3.0, force_share: 0.2 }, Style { aim_mm: 5.0, force_share: 0.3 }];

#[test]
fn supertux_is_played_by_players_who_scatter() {
    let Some(count) = trials("scatter") else { return };
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let segment = &supertux::segment();
    Played { start: &SUPERTUX, segment, profile: supertux::PROFILE }.scattered(&SCATTERED, count);
}

#[test]
fn vitetris_is_played_by_players_who_scatter() {
    let Some(count) = trials("scatter") else { return };
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let segment = &vitetris::segment();
    let start: &dyn Fn() -> Box<dyn Game> = &|| Box::new(Vitetris::start());
    Played { start, segment, profile: vitetris::PROFILE }.scattered(&SCATTERED, count);
}

/// Where recordings of games go, if they are asked for.
fn pictures() -> Option<PathBuf> {
    std::env::var_os("TACTPAD_PICTURES").map(PathBuf::from)
}

#[test]
fn supertux_is_recorded() {
    let Some(folder) = pictures() else { return };
    let desk = pictures::desk(supertux::WIDTH_PX, supertux::HEIGHT_PX);
    pictures::record(desk, SuperTux::start_on, &supertux::segment(), supertux::PROFILE, &folder);
}

#[test]
fn vitetris_is_recorded() {
    let Some(folder) = pictures() else { return };
    let desk = pictures::desk(vitetris::WIDTH_PX, vitetris::HEIGHT_PX);
    pictures::record(desk, Vitetris::start_on, &vitetris::segment(), vitetris::PROFILE, &folder);
}

#[test]
fn btanks_is_recorded() {
    let Some(folder) = pictures() else { return };
    let desk = pictures::desk(tanks::WIDTH_PX, tanks::HEIGHT_PX);
    pictures::record(desk, Tanks::start_on, &tanks::segment(), tanks::PROFILE, &folder);
}
