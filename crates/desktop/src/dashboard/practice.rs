//! Practice hands for a virtual pad: they do what a guide asks, each in its own way, so that guides can be tried without a pad.

use tactpad_core::quantity::Contact;
use tactpad_core::virtual_pad::freehand::Calibrator;
use tactpad_core::virtual_pad::script::{Keyframe, Script};
use tactpad_numeric::random::SplitMix64;

/// What a guide asks of a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// To leave the pad alone.
    Rest,
    /// To press.
    Press(PressWish),
    /// To press anywhere, again and again.
    Anywhere,
    /// To lay a weight of so many grams on a mark.
    Lay {
        /// Where the mark is.
        mark_mm: [f64; 2],
        /// The weight.
        weight_g: f64,
    },
    /// To take it away again.
    TakeAway,
}

/// What touches the pad from now on.
#[derive(Debug)]
pub enum Movement {
    /// A finger.
    Finger(Script),
    /// A weight: it stays where it is put, as no finger does.
    Weight(Script),
}

/// A press that a guide asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressWish {
    /// Where, on the plate.
    pub at_mm: [f32; 2],
    /// In which direction along the plate it is pushed, if in any: of length 1.
    pub push: [f32; 2],
    /// How hard.
    pub level: Level,
    /// Whether it is held for a second.
    pub is_long: bool,
    /// Whether it is done twice, quickly.
    pub is_double: bool,
}

/// How hard a press is meant to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Enough for a direction.
    Touch,
    /// As lightly as feels sure.
    Light,
    /// As for a button.
    Usual,
    /// As hard as is comfortable.
    Hard,
}

/// A way to press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PracticeHand {
    /// Its presses are light.
    Weak,
    /// It trembles.
    Trembling,
    /// It reaches with one finger, and not far.
    OneFinger,
    /// It has its middle beside that of the plate.
    OffCentre,
    /// It presses whatever it likes, whatever is asked.
    Ignoring,
}

/// The names of hands on the command line.
pub const HANDS: [(&str, PracticeHand); 5] = [
    ("weak", PracticeHand::Weak),
    ("trembling", PracticeHand::Trembling),
    ("one-finger", PracticeHand::OneFinger),
    ("off-centre", PracticeHand::OffCentre),
    ("ignoring", PracticeHand::Ignoring),
];

/// What hands differ in.
struct Manner {
    /// Of a touch, a light, a usual and a hard press.
    forces_n: [f32; 4],
    middle_mm: [f32; 2],
    /// How far from its middle it presses at most.
    reach_mm: f32,
    /// How far a press misses its place, and how far it trembles there: standard deviations.
    miss_mm: f32,
    tremor_mm: f32,
    /// The same of forces, as a share of them.
    tremor_share: f32,
}

impl PracticeHand {
    const fn manner(self) -> Manner {
        let usual = Manner {
            forces_n: [0.9, 0.9, USUAL_N, 4.0],
            middle_mm: [0.0; 2],
            reach_mm: 26.0,
            miss_mm: 1.5,
            tremor_mm: 0.2,
            tremor_share: 0.03,
        };
        match self {
            Self::Weak => Manner { forces_n: [0.35, 0.4, 0.9, 1.2], ..usual },
            Self::Trembling | Self::Ignoring => {
                Manner { forces_n: [0.7, 0.7, 2.2, 3.4], tremor_mm: 2.0, tremor_share: 0.25, ..usual }
            }
            Self::OneFinger => {
                Manner { forces_n: [0.8, 0.7, 1.6, 2.4], reach_mm: 6.5, miss_mm: 1.0, ..usual }
            }
            Self::OffCentre => Manner { middle_mm: [-7.0, 5.0], reach_mm: 12.0, ..usual },
        }
    }
}

impl Manner {
    /// Where it presses that is to press there.
    fn reached(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        let share = (self.reach_mm / libm::hypotf(x, y).max(f32::EPSILON)).min(1.0);
        let [middle_x, middle_y] = self.middle_mm;
        [middle_x + share * x, middle_y + share * y]
    }
}

/// How hard an ordinary hand presses for a button.
const USUAL_N: f32 = 2.6;

/// From being asked to touching the pad.
const REACTION_US: u64 = 600_000;
const RAMP_US: u64 = 80_000;
const SHORT_US: u64 = 160_000;
const LONG_US: u64 = 1_000_000;
/// Between the two presses of a double one.
const BETWEEN_US: u64 = 100_000;
/// A tremor of ten hertz turns so often.
const TREMOR_US: u64 = 50_000;
/// Of a press, what is left into the plate and what goes along it where it is pushed: the finger does not slip yet.
const PUSH_SHARE: f32 = 0.6;

/// A hand that practises.
#[derive(Clone, Debug)]
pub struct Practice {
    hand: PracticeHand,
    random: SplitMix64,
    calibrator: Calibrator,
}

impl Practice {
    /// A hand; what is not meant in its movements depends on the seed.
    pub fn new(hand: PracticeHand, seed: u64) -> Self {
        Self { hand, random: SplitMix64::named(seed, "practice hand"), calibrator: Calibrator::new(seed) }
    }

    /// What it does about a wish, from now on.
    pub fn obey(&mut self, wish: Wish) -> Movement {
        match wish {
            _ if self.hand == PracticeHand::Ignoring => {
                let whim = self.whim();
                Movement::Finger(self.presses(whim))
            }
            Wish::Rest => Movement::Finger(Calibrator::rest()),
            Wish::Press(press) => Movement::Finger(self.presses(press)),
            Wish::Anywhere => {
                let script = self.calibrator.press();
                Movement::Finger(self.in_its_manner(&script))
            }
            Wish::Lay { mark_mm, weight_g } => Movement::Weight(self.calibrator.lay(mark_mm, weight_g)),
            Wish::TakeAway => Movement::Weight(self.calibrator.take_away()),
        }
    }

    /// What an ordinary hand does, done by this one.
    fn in_its_manner(&mut self, script: &Script) -> Script {
        let manner = self.hand.manner();
        let share = manner.forces_n[Level::Usual as usize] / USUAL_N;
        let mut moved = |keyframe: &Keyframe| {
            let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = keyframe.contact;
            let [x_mm, y_mm] = manner.reached([x_mm, y_mm]).map(|mm| mm + self.around(0.0, manner.tremor_mm));
            let share = share * self.around(1.0, manner.tremor_share).max(0.3);
            let [fx_n, fy_n, fz_n] = [fx_n, fy_n, fz_n].map(|force_n| share * force_n);
            Keyframe { contact: Contact { x_mm, y_mm, fx_n, fy_n, fz_n }, ..*keyframe }
        };
        Script::of(script.keyframes().iter().map(&mut moved).collect())
    }

    fn presses(&mut self, press: PressWish) -> Script {
        let mut steps = Vec::new();
        let begin_us = REACTION_US + self.random.next_bits() % REACTION_US;
        let lifted_us = self.press(press, begin_us, &mut steps);
        if press.is_double {
            self.press(press, lifted_us + BETWEEN_US, &mut steps);
        }
        Script::of(steps)
    }

    /// A press of which nobody asked anything.
    fn whim(&mut self) -> PressWish {
        let angle = std::f32::consts::TAU * self.random.fraction();
        let out_mm = if self.random.fraction() < 0.6 { 15.0 } else { 0.0 };
        let level = match self.random.next_bits() % 3 {
            0 => Level::Touch,
            1 => Level::Usual,
            _ => Level::Hard,
        };
        let (sin, cos) = libm::sincosf(angle);
        let at_mm = [out_mm * cos, out_mm * sin];
        PressWish { at_mm, push: [0.0; 2], level, is_long: false, is_double: false }
    }

    /// Adds one press, and says when the finger is lifted.
    fn press(&mut self, press: PressWish, begin_us: u64, steps: &mut Vec<Keyframe>) -> u64 {
        let manner = self.hand.manner();
        let force_n = manner.forces_n[press.level as usize] * self.around(1.0, 0.08);
        let at_mm = manner.reached(press.at_mm).map(|mm| mm + self.around(0.0, manner.miss_mm));
        let at = |hand: &mut Self, strength: f32| {
            let force_n = strength * force_n * hand.around(1.0, manner.tremor_share).max(0.3);
            let [fx_n, fy_n] = press.push.map(|along| PUSH_SHARE * along * force_n);
            let force_n = if press.push == [0.0; 2] { force_n } else { PUSH_SHARE * force_n };
            let [x_mm, y_mm] = at_mm.map(|mm| mm + hand.around(0.0, manner.tremor_mm));
            Contact { x_mm, y_mm, fx_n, fy_n, fz_n: force_n }
        };
        let hold_us = if press.is_long { LONG_US } else { SHORT_US };
        let firm_us = begin_us + RAMP_US;
        steps.push(Keyframe { at_us: begin_us, contact: at(self, 0.0) });
        steps.extend(
            (0..=hold_us / TREMOR_US)
                .map(|step| Keyframe { at_us: firm_us + step * TREMOR_US, contact: at(self, 1.0) }),
        );
        let lifted_us = firm_us + hold_us + RAMP_US;
        steps.push(Keyframe { at_us: lifted_us, contact: at(self, 0.0) });
        lifted_us
    }

    fn around(&mut self, middle: f32, deviation: f32) -> f32 {
        middle + deviation * self.random.normal()
    }
}
