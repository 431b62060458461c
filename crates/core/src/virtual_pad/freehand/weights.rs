//! A weight that is laid on marks of the plate, one after the other: a force that is known without any reference.

use super::draw::{Draw, at, within};
use crate::pad::marks::MARKS_MM;
use crate::pad::weight::weight_n;
use crate::quantity::Contact;
use crate::virtual_pad::script::{Keyframe, Script};

/// How far from its mark it comes to rest: deviation along each axis, and at most.
pub(super) const MISS_MM: f32 = 0.35;
pub(super) const MISS_MAX_MM: f32 = 0.7;
/// It is set down, and taken up, in this time,
pub(super) const RAMP_US: u64 = 200_000;
/// rests,
const REST_US: u64 = 2_000_000;
/// and nothing touches the pad before the next one and after the last.
const PAUSE_US: u64 = 1_000_000;

/// A weight at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The middle of its rest, since the script's begin.
    pub at_us: u64,
    /// The mark that it was meant for.
    pub mark_mm: [f32; 2],
}

/// Placements of one weight.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    /// What the pad feels.
    pub script: Script,
    /// One for each mark.
    pub placements: Vec<Placement>,
    /// With the pauses.
    pub duration_us: u64,
}

impl Weights {
    /// A weight of so many grams on each mark, straight down; the seed draws how far it misses them.
    pub fn new(weight_g: f64, seed: u64) -> Self {
        let mut draw = Draw::new(seed, "weights");
        let force_n = Self::force_n(weight_g) as f32;
        let (mut keyframes, mut placements, mut now_us) = (Vec::new(), Vec::new(), 0);
        for mark_mm in MARKS_MM.map(|mark_mm| mark_mm.map(|mm| mm as f32)) {
            let miss = within([draw.normal(MISS_MM), draw.normal(MISS_MM)], MISS_MAX_MM);
            let laid = at([mark_mm[0] + miss[0], mark_mm[1] + miss[1]], [0.0; 2], force_n);
            let none = Contact { fz_n: 0.0, ..laid };
            placements.push(Placement { at_us: now_us + PAUSE_US + RAMP_US + REST_US / 2, mark_mm });
            for (after_us, contact) in [(PAUSE_US, none), (RAMP_US, laid), (REST_US, laid), (RAMP_US, none)] {
                now_us += after_us;
                keyframes.push(Keyframe { at_us: now_us, contact });
            }
        }
        Self { script: Script::of(keyframes), placements, duration_us: now_us + PAUSE_US }
    }

    /// Force of a mass in grams, N: m g.
    pub fn force_n(weight_g: f64) -> f64 {
        weight_n(weight_g)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_placement_rests_near_its_mark_with_its_weight() {
        for seed in 0..50 {
            let weights = Weights::new(200.0, seed);
            assert_eq!(weights.placements.len(), 5);
            for Placement { at_us, mark_mm: [x_mm, y_mm] } in &weights.placements {
                for within_rest_us in [at_us - 999_000, *at_us, at_us + 999_000] {
                    let it = weights.script.contact_at(within_rest_us);
                    assert!(libm::hypotf(it.x_mm - x_mm, it.y_mm - y_mm) <= 0.701, "{it:?}");
                    assert!((it.fz_n - 1.961_33).abs() < 1e-6 && it.fx_n == 0.0 && it.fy_n == 0.0);
                }
                for beside_us in [at_us - 1_300_000, at_us + 1_300_000] {
                    assert_eq!(weights.script.contact_at(beside_us).fz_n, 0.0);
                }
            }
            assert_eq!(weights.script.contact_at(weights.duration_us).fz_n, 0.0);
        }
    }
}
