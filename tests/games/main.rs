//! Real games, played by a finger of software on the twin of the paper's pad, through the bridge and an X server's keys, and
//! judged by their own screens.
#![cfg(all(feature = "live", feature = "lab", target_os = "linux"))]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on has failed")]
#![allow(clippy::print_stdout, reason = "the figures are what one looks for in a long test")]

mod block;
#[path = "../support/clock.rs"]
mod clock;
mod desk;
mod digits;
#[path = "../support/framebuffer.rs"]
mod framebuffer;
mod heard;
mod pictures;
mod player;
mod reaction;
mod segment;
mod supertux;
#[path = "../support/mod.rs"]
mod support;
mod trial;

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use block::Played;
use player::{ORDINARY, Style};
use reaction::Times;
use segment::Segment;
use supertux::SuperTux;
use support::require;
use trial::{Game, Way, play};

/// Whether the machine has what every game here needs.
fn has_desk() -> bool {
    require("Xvfb", "apt-get install xvfb")
}

/// One game at a time: two would take each other's time.
static TURN: Mutex<()> = Mutex::new(());

/// Plays a segment by the pad; then with nobody at it, and with left and right exchanged, which must both fail.
fn is_played<G: Game>(start: impl Fn() -> G, segment: &Segment, profile: &str) {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let way = Way::Pad { style: ORDINARY, seed: SEED, profile };
    for (who, segment, reaches) in [
        ("by the finger", segment.clone(), true),
        ("with nobody at the pad", segment.muted(), false),
        ("with left and right exchanged", segment.mirrored(), false),
    ] {
        let outcome = play(&mut start(), &segment, way);
        println!("{profile}, {who}: {outcome}");
        assert_eq!(outcome.reached_s.is_ok(), reaches, "{profile}, {who}: {outcome}");
    }
}

/// The pad and the finger of a single trial.
const SEED: u64 = 1;

#[test]
fn supertux_is_played() {
    if has_desk() && supertux::is_there() {
        is_played(SuperTux::start, &supertux::segment(), supertux::PROFILE);
    }
}

/// How often a long study plays a segment: `TACTPAD_GAMES` of its name, as `block=20`.
fn trials(study: &str) -> Option<u64> {
    let asked = std::env::var("TACTPAD_GAMES").ok()?;
    asked.split(' ').find_map(|word| word.strip_prefix(study)?.strip_prefix('=')?.parse().ok())
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
fn supertux_is_recorded() {
    let Some(folder) = std::env::var_os("TACTPAD_PICTURES") else { return };
    let mut game = SuperTux::start_on(pictures::desk());
    pictures::record(&mut game, &supertux::segment(), supertux::PROFILE, "game-supertux", Path::new(&folder));
}
