//! The gesture that gives a pad back to the desktop without a keyboard. Told the time; it reads no clock.
//!
//! It must be possible on every such pad, and no play may make it by accident:
//!
//! - Four fingers on a touchpad, down within half a second and then still. Every touchpad with pressure tells four fingers, but many know
//!   the places of two only. One finger plays, so four that come together are no play once the fourth is there; fingers that rest there while one plays came
//!   before, or after.
//! - A pen with its side button held in the air above a corner. An eraser or a second button is on few pens. A button alone is held by
//!   many a grip, and whoever plays is not in the air, or not in a corner, for so long.

use tactpad_core::source::Touching;
use tactpad_core::source::codes::MT_FIRST;

/// What is said once it was made.
pub(crate) const PAUSED: &str = "paused by the gesture, the pad is the desktop's again: `tactpad ctl resume`, the page or the tray goes on";

/// What is said of it at the start, of a device with these axes.
pub const fn how(touching: &Touching) -> &'static str {
    if touching.place[0] >= MT_FIRST {
        "the pad is taken from the desktop while it plays: four fingers put down together, and held still for 1.5 s, pause it"
    } else {
        "the pen is taken from the desktop while it plays: its side button, held in the air above a corner for 1.5 s, pauses it"
    }
}

/// So long it is held, µs.
const HOLD_US: u64 = 1_500_000;

/// Fingers that come within so long come together, µs.
const TOGETHER_US: u64 = 500_000;

/// A place that stays within this share of the pad's width and height is still.
const STILL_SHARE: f64 = 0.05;

/// A corner is this share of the width and of the height.
const CORNER_SHARE: f64 = 0.15;

/// Fingers of the gesture.
pub(super) const FINGERS: usize = 4;

/// What is on the pad, as far as the gesture is concerned: what is held, each with its place in shares of the width and height.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Hold {
    /// So many fingers, of which these places are known, by slot.
    Fingers(usize, Vec<(usize, [f64; 2])>),
    /// A side button, in the air.
    SideButton([f64; 2]),
}

/// Watches for the gesture.
#[derive(Clone, Debug, Default)]
pub(super) struct Leave {
    /// When the first finger came to an untouched pad, µs.
    touched_us: Option<u64>,
    /// Since when what is held has been still, µs, and where it was then.
    held: Option<(u64, Hold)>,
    is_done: bool,
}

impl Leave {
    /// Takes what is on the pad at `now_us`, nothing if the gesture cannot be there. True once for each gesture.
    pub(super) fn see(&mut self, now_us: u64, hold: Option<Hold>) -> bool {
        self.touched_us = hold.as_ref().map(|_| self.touched_us.unwrap_or(now_us));
        let Some(hold) = hold.filter(Hold::is_gesture) else {
            (self.held, self.is_done) = (None, false);
            return false;
        };
        let begun = self.held.take().filter(|(_, before)| before.is_still(&hold));
        let is_together = |touched_us: u64| now_us.saturating_sub(touched_us) <= TOGETHER_US;
        // Who moves begins anew: with the fingers up.
        self.held = begun.or_else(|| self.touched_us.is_some_and(is_together).then_some((now_us, hold)));
        let is_due =
            self.held.as_ref().is_some_and(|(since_us, _)| now_us.saturating_sub(*since_us) >= HOLD_US);
        is_due && !std::mem::replace(&mut self.is_done, true)
    }

    /// Whether it may be under way: then nothing is pressed.
    pub(super) const fn is_begun(&self) -> bool {
        self.held.is_some()
    }
}

impl Hold {
    fn is_gesture(&self) -> bool {
        match self {
            Self::Fingers(count, _) => *count >= FINGERS,
            Self::SideButton(place) => place.iter().all(|share| share.min(1.0 - share) <= CORNER_SHARE),
        }
    }

    /// Whether all that was held still is, where it was.
    fn is_still(&self, now: &Self) -> bool {
        let is_near = |before: &[f64; 2], now: &[f64; 2]| {
            before.iter().zip(now).all(|(before, now)| (before - now).abs() <= STILL_SHARE)
        };
        match (self, now) {
            (Self::Fingers(_, before), Self::Fingers(_, now)) => before.iter().all(|(slot, place)| {
                now.iter().any(|(now_slot, now)| slot == now_slot && is_near(place, now))
            }),
            (Self::SideButton(before), Self::SideButton(now)) => is_near(before, now),
            _ => false,
        }
    }
}
