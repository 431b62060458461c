//! Somebody who calibrates a pad at home and does what is asked.

use super::course::WITHIN_MM;
use super::draw::{Draw, at, within};
use super::presses::presses;
use super::weights::{MISS_MAX_MM, MISS_MM, RAMP_US, Weights};
use crate::quantity::Contact;
use crate::virtual_pad::script::{Keyframe, Script};

/// Presses go on for so long, or until something else is asked.
const PRESSES_US: u64 = 600_000_000;
/// From being asked to touching the pad.
const REACTION_US: u64 = 500_000;
/// How far a press misses its place: deviation along each axis, and at most.
const PRESS_MISS_MM: f32 = 2.0;
const PRESS_MISS_MAX_MM: f32 = 4.0;
/// With what force somebody presses who is to press firmly, and how far that is from straight, as a share of it.
const PRESS_N: [f32; 2] = [1.5, 3.5];
const SLANT_SHARE: f32 = 0.08;
const PRESS_RAMP_US: u64 = 200_000;
const PRESS_HOLD_US: u64 = 1_600_000;
const PRESS_EVERY_US: usize = 5_000_000;

/// The hands; each of their scripts begins when it is asked for.
#[derive(Clone, Debug)]
pub struct Calibrator {
    draw: Draw,
    seed: u64,
    /// The weight as it lies.
    laid: Contact,
}

impl Calibrator {
    /// Hands that are as exact as the seed draws.
    pub fn new(seed: u64) -> Self {
        Self { draw: Draw::new(seed, "calibrator"), seed, laid: Contact::default() }
    }

    /// Leaves the pad alone.
    pub const fn rest() -> Script {
        Script::of(Vec::new())
    }

    /// Presses anywhere.
    pub fn press(&mut self) -> Script {
        self.seed = self.seed.wrapping_add(1);
        presses(PRESSES_US, WITHIN_MM, self.seed)
    }

    /// Presses at a place for two seconds, and along the plate by this share of the force; again and again, until something else is asked.
    pub fn press_at(&mut self, place_mm: [f64; 2], shear_share: [f64; 2]) -> Script {
        let mut steps = Vec::new();
        for begin_us in (0..PRESSES_US).step_by(PRESS_EVERY_US) {
            let miss = [self.draw.normal(PRESS_MISS_MM), self.draw.normal(PRESS_MISS_MM)];
            let miss = within(miss, PRESS_MISS_MAX_MM);
            let place = [0, 1].map(|axis: usize| place_mm[axis] as f32 + miss[axis]);
            let force_n = self.draw.between(PRESS_N);
            let along = shear_share.map(|share| force_n * (share as f32 + self.draw.normal(SLANT_SHARE)));
            let (pressed, none) = (at(place, along, force_n), at(place, [0.0; 2], 0.0));
            let touch_us = begin_us + REACTION_US;
            let firm_us = touch_us + PRESS_RAMP_US;
            let lift_us = firm_us + PRESS_HOLD_US;
            let ends =
                [(touch_us, none), (firm_us, pressed), (lift_us, pressed), (lift_us + PRESS_RAMP_US, none)];
            steps.extend(keyframes(ends));
        }
        Script::of(steps)
    }

    /// Lays a weight of so many grams on a mark, and lets it lie.
    pub fn lay(&mut self, mark_mm: [f64; 2], weight_g: f64) -> Script {
        let miss = within([self.draw.normal(MISS_MM), self.draw.normal(MISS_MM)], MISS_MAX_MM);
        let place = [0, 1].map(|axis: usize| mark_mm[axis] as f32 + miss[axis]);
        self.laid = at(place, [0.0; 2], Weights::force_n(weight_g) as f32);
        let none = Contact { fz_n: 0.0, ..self.laid };
        Script::of(keyframes([(REACTION_US, none), (REACTION_US + RAMP_US, self.laid)]))
    }

    /// Takes it away.
    pub fn take_away(&mut self) -> Script {
        let laid = std::mem::take(&mut self.laid);
        let none = Contact { fz_n: 0.0, ..laid };
        Script::of(keyframes([(0, laid), (REACTION_US, laid), (REACTION_US + RAMP_US, none)]))
    }
}

fn keyframes<const N: usize>(steps: [(u64, Contact); N]) -> Vec<Keyframe> {
    steps.map(|(at_us, contact)| Keyframe { at_us, contact }).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weight_lies_until_it_is_taken_away() {
        let mut hands = Calibrator::new(3);
        let laid = hands.lay([15.0, 0.0], 200.0);
        assert_eq!(laid.contact_at(400_000).fz_n, 0.0);
        let there = laid.contact_at(60_000_000);
        assert!((there.fz_n - 1.961_33).abs() < 1e-6 && libm::hypotf(there.x_mm - 15.0, there.y_mm) <= 0.701);
        let away = hands.take_away();
        assert_eq!((away.contact_at(0), away.contact_at(2_000_000).fz_n), (there, 0.0));
        let pressed = hands.press_at([20.0, 0.0], [0.5, 0.0]);
        let held = pressed.contact_at(1_500_000);
        assert!(held.fz_n >= 1.5 && held.fx_n > 0.2 * held.fz_n && (held.x_mm - 20.0).abs() <= 4.0);
        assert_eq!([0, 4_000_000].map(|at_us| pressed.contact_at(at_us).fz_n), [0.0; 2]);
        assert!(pressed.contact_at(6_500_000).fz_n >= 1.5, "and once more");
        assert_ne!(hands.press(), hands.press(), "nobody presses twice the same");
        assert_eq!(Calibrator::rest().contact_at(1_000_000), Contact::default());
    }
}
