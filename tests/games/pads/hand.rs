//! Hands and pens on pads that people own. The people are made up.

use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::Contact;
use tactpad::virtual_pad::script::Script;

use super::{PLATE_MM, between};
use crate::hand::Hand;
use crate::segment::Segment;

/// What people have in common who play on a pad. Lengths are those of the pad.
pub(super) struct Habits {
    /// Deviations of where a hand takes the middle to be, of where each touch lands from there, and of how far it strays.
    middle_mm: f64,
    aim_mm: f64,
    stray_mm: f64,
    /// Deviations of how hard a person presses at all, of each force, and of the force while it is held.
    strength_share: f64,
    force_share: f64,
    unsteady_share: f64,
    /// How much of what muscles differ by shows in how hard somebody presses: who plays learns how hard it must be.
    muscle_share: f64,
    rise_us: u64,
    fall_us: u64,
}

/// On a plate or a board: hands of who sits.
pub(super) const HANDS: Habits = Habits {
    middle_mm: 8.0,
    aim_mm: 6.0,
    stray_mm: 2.0,
    strength_share: 0.08,
    force_share: 0.1,
    unsteady_share: 0.04,
    muscle_share: 0.5,
    rise_us: 70_000,
    fall_us: 60_000,
};

/// A pen in a hand that rests beside it.
pub(super) const PEN: Habits = Habits {
    middle_mm: 5.0,
    aim_mm: 3.0,
    stray_mm: 0.5,
    strength_share: 0.12,
    force_share: 0.12,
    unsteady_share: 0.03,
    muscle_share: 0.0,
    rise_us: 50_000,
    fall_us: 40_000,
};

/// People weigh from this to that, kg.
const MASSES_KG: [f64; 2] = [40.0, 120.0];
/// Muscles are as strong as they are thick: with the mass to this power.
const MUSCLE_POWER: f64 = 2.0 / 3.0;
/// Somebody aims so far towards an edge for a direction.
const REACH_SHARE: f64 = 0.6;
/// A hand strays with this time constant.
const STRAY_S: f64 = 0.3;

impl Habits {
    /// The hand of somebody.
    fn of(&self, half_mm: [f64; 2], seed: u64) -> Hand {
        let mut random = SplitMix64::named(seed, "person");
        let mass_kg = between(&mut random, MASSES_KG);
        let of_mass = (mass_kg * 2.0 / MASSES_KG.iter().sum::<f64>()).powf(MUSCLE_POWER * self.muscle_share);
        let mut normal = || f64::from(random.normal());
        let plate_mm_per_mm = half_mm.map(|half_mm| PLATE_MM / half_mm);
        Hand {
            middle_mm: plate_mm_per_mm.map(|scale| scale * self.middle_mm * normal()),
            reach_mm: REACH_SHARE * PLATE_MM,
            aim_mm: plate_mm_per_mm.map(|scale| scale * self.aim_mm),
            strength: of_mass * (1.0 + self.strength_share * normal()),
            force_share: self.force_share,
            rise_us: self.rise_us,
            fall_us: self.fall_us,
        }
    }
}

/// A hand is never quite still: first-order noise of the place along each axis and of the force, each with deviation 1.
struct Stray {
    random: SplitMix64,
    now: [f64; 3],
    at_us: u64,
}

impl Stray {
    fn at(&mut self, now_us: u64) -> [f64; 3] {
        let keeps = (-1e-6 * (now_us - self.at_us) as f64 / STRAY_S).exp();
        let renews = (1.0 - keeps * keeps).sqrt();
        self.now = self.now.map(|now| keeps * now + renews * f64::from(self.random.normal()));
        self.at_us = now_us;
        self.now
    }
}

/// A hand that plays.
pub(super) struct OnPad {
    habits: &'static Habits,
    half_mm: [f64; 2],
    hand: Hand,
    stray: Stray,
    script: Script,
    seed: u64,
}

impl OnPad {
    pub(super) fn new(habits: &'static Habits, half_mm: [f64; 2], seed: u64) -> Self {
        let stray = Stray { random: SplitMix64::named(seed, "stray"), now: [0.0; 3], at_us: 0 };
        let hand = habits.of(half_mm, seed);
        Self { habits, half_mm, hand, stray, script: Script::of(Vec::new()), seed }
    }

    /// Begins a segment.
    pub(super) fn begin(&mut self, segment: &Segment) {
        self.script = self.hand.script(segment, SplitMix64::named(self.seed, "finger"));
    }

    /// What it does to the pad, as a contact on a profile's plate: `now_us` after the beginning of all, `playing_us` after that of the
    /// segment.
    pub(super) fn contact(&mut self, now_us: u64, playing_us: Option<u64>) -> Contact {
        let [right, up, harder] = self.stray.at(now_us);
        let contact =
            playing_us.map_or_else(Contact::default, |playing_us| self.script.contact_at(playing_us));
        let [x_scale, y_scale] = self.half_mm.map(|half_mm| PLATE_MM / half_mm);
        Contact {
            x_mm: contact.x_mm + (right * self.habits.stray_mm * x_scale) as f32,
            y_mm: contact.y_mm + (up * self.habits.stray_mm * y_scale) as f32,
            fz_n: contact.fz_n * (1.0 + self.habits.unsteady_share * harder) as f32,
            ..contact
        }
    }
}
