//! `--hand`: a virtual pad that nobody touches but a practice hand, which does what the page's guides ask.

use std::sync::mpsc::Sender;

use super::guided_pad::{self, Touch};
use crate::cli::failure::Failure;
use crate::cli::files::device::PadOptions;
use tactpad::bridge::opening::OpenedPad;
use tactpad::dashboard::practice::{HANDS, Movement, Practice, PracticeHand, Wish};

/// Seed of the hand's movements.
const SEED: u64 = 1;

/// A hand, and the pad that it touches.
pub(super) struct Practising {
    practice: Practice,
    to: Sender<Touch>,
}

/// The virtual pad, which nothing touches yet, and the hand.
pub(super) fn open(pad: &PadOptions, hand: PracticeHand) -> Result<(OpenedPad, Practising), Failure> {
    let (opened, to) = guided_pad::open(pad)?;
    Ok((opened, Practising { practice: Practice::new(hand, SEED), to }))
}

impl Practising {
    /// Does what a guide asks.
    pub(super) fn obey(&mut self, wish: Wish) {
        let touch = match self.practice.obey(wish) {
            Movement::Finger(script) => Touch::Finger(script),
            Movement::Weight(script) => Touch::Weight(script),
        };
        // A pad that is gone feels nothing.
        let _ = self.to.send(touch);
    }
}

/// A hand by its name.
pub(super) fn hand(name: &str) -> Result<PracticeHand, String> {
    let known = HANDS.iter().find(|(known, _)| *known == name).map(|(_, hand)| *hand);
    let names: Vec<_> = HANDS.iter().map(|(name, _)| *name).collect();
    known.ok_or_else(|| format!("take one of {}", names.join(", ")))
}
