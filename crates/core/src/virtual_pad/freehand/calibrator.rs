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
        assert_ne!(hands.press(), hands.press(), "nobody presses twice the same");
        assert_eq!(Calibrator::rest().contact_at(1_000_000), Contact::default());
    }
}
