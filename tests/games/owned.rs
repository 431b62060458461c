//! Games played on pads that people own, each by somebody of software: an input device in the guest's kernel, or lines on a
//! pseudo-terminal there.

use crate::block::{HEAD, Played, Trials};
use crate::pads::Kind;
use crate::segment::Segment;
use crate::supertux::{self, SuperTux};
use crate::trial::{Game, Way, play};
use crate::trials;
use crate::vitetris::{self, Vitetris};

/// First seed of the figures of docs/games.md. Nothing was chosen by what these did.
const SEED: u64 = 2_001;

/// In vitetris, which waits, a hand or a pen takes so many times as long as a thumb that rests on its pad.
const PACE: f64 = 1.5;

/// A game with what is played of it.
struct Part {
    start: &'static dyn Fn() -> Box<dyn Game>,
    segment: Segment,
    profile: &'static str,
}

fn of_supertux() -> Part {
    let start = &|| -> Box<dyn Game> { Box::new(SuperTux::start()) };
    Part { start, segment: supertux::segment(), profile: supertux::PROFILE }
}

fn of_vitetris() -> Part {
    let start = &|| -> Box<dyn Game> { Box::new(Vitetris::start()) };
    Part { start, segment: vitetris::segment().slower(PACE), profile: "vitetris-board" }
}

/// How often a study plays, once without one, and the first seed.
fn asked() -> (u64, u64) {
    (trials("pads").unwrap_or(1), trials("from").unwrap_or(SEED))
}

impl Part {
    /// Plays it as often as is asked for; nine of ten must reach the landmark.
    fn is_played_on(&self, kind: Kind) {
        let Self { start, segment, profile } = self;
        let (count, first) = asked();
        let mut all = Trials::default();
        for seed in first..first + count {
            Played { start, segment, profile }.trial(&mut all, Way::Owned { kind, seed, profile });
        }
        println!("{HEAD}\n{}", all.row(&format!("{profile}, {kind}"), segment));
        assert!(all.reached() as u64 >= count - count / 10, "{} of {count}", all.reached());
    }

    /// With nobody at the pad, and with left and right exchanged, the landmark is not reached.
    fn takes_a_player_on(&self, kind: Kind) {
        let Self { start, segment, profile } = self;
        let (count, first) = asked();
        for seed in first..first + count.div_ceil(5) {
            for (what, other) in [("muted", segment.muted()), ("mirrored", segment.mirrored())] {
                let way = Way::Owned { kind, seed, profile };
                let outcome = play(start().as_mut(), &other, way);
                println!("{way}, {what}: {outcome}");
                assert!(outcome.reached_s.is_err(), "{way}, {what}");
            }
        }
    }
}

/// The tests of one kind of pad.
macro_rules! on_a_pad {
    ($name:ident, $kind:expr) => {
        mod $name {
            use crate::guest::in_guest;
            use crate::pads::Kind;
            use crate::{has_desk, supertux, vitetris};

            const KIND: Kind = $kind;

            fn name(test: &str) -> String {
                format!("owned::{}::{test}", stringify!($name))
            }

            #[test]
            fn supertux_is_played() {
                if has_desk() && supertux::is_there() {
                    in_guest(&name("supertux_is_played"), || super::of_supertux().is_played_on(KIND));
                }
            }

            #[test]
            #[ignore = "proof: 20 s: the second game; SuperTux stays a test"]
            fn vitetris_is_played() {
                if has_desk() && vitetris::is_there() {
                    in_guest(&name("vitetris_is_played"), || super::of_vitetris().is_played_on(KIND));
                }
            }

            #[test]
            #[ignore = "proof: 50 s: without its player the game is not won, so that playing it proves something"]
            fn each_takes_a_player() {
                in_guest(&name("each_takes_a_player"), || {
                    super::of_supertux().takes_a_player_on(KIND);
                    super::of_vitetris().takes_a_player_on(KIND);
                });
            }
        }
    };
}

on_a_pad!(balance_board, Kind::Board);
on_a_pad!(tablet, Kind::Tablet);
on_a_pad!(load_cells, Kind::Cells { lines_per_s: 80 });
