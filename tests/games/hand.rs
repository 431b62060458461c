//! A hand on a pad: where it comes down, how hard and how fast, with its errors. Places and forces are those of a profile's plate.

use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::Contact;
use tactpad::virtual_pad::script::{Keyframe, Script};

use crate::segment::{Segment, Touch};

/// How a thumb presses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Style {
    /// Deviation of where a touch lands from where it is meant to, along each axis.
    pub(crate) aim_mm: f64,
    /// Deviation of a force, as a share of it.
    pub(crate) force_share: f64,
}

/// Presses as most people do.
pub(crate) const ORDINARY: Style = Style { aim_mm: 1.5, force_share: 0.1 };

/// Presses the same each time.
pub(crate) const EXACT: Style = Style { aim_mm: 0.0, force_share: 0.0 };

/// With so much force a hand holds a direction,
const STEER_N: f64 = 1.0;
/// and with so much it presses a button.
const PRESS_N: f64 = 3.0;
/// No force is less, however it scatters.
const LEAST_N: f64 = 0.05;

/// What does not change from one touch to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hand {
    /// Where it takes the middle to be.
    pub(crate) middle_mm: [f64; 2],
    /// It reaches so far from there for a direction.
    pub(crate) reach_mm: f64,
    /// Deviation of where a touch lands, along each axis.
    pub(crate) aim_mm: [f64; 2],
    /// Its forces over those that are meant.
    pub(crate) strength: f64,
    /// Deviation of a force, as a share of it.
    pub(crate) force_share: f64,
    /// A force comes within this time, and goes within the other one.
    pub(crate) rise_us: u64,
    pub(crate) fall_us: u64,
}

impl Hand {
    /// A thumb that rests on the middle.
    pub(crate) const fn thumb(Style { aim_mm, force_share }: Style) -> Self {
        Self {
            middle_mm: [0.0; 2],
            reach_mm: 14.0,
            aim_mm: [aim_mm; 2],
            strength: 1.0,
            force_share,
            rise_us: 50_000,
            fall_us: 40_000,
        }
    }

    /// What it does for a segment; its errors are drawn.
    pub(crate) fn script(&self, segment: &Segment, random: SplitMix64) -> Script {
        let mut drawn = Drawn { hand: self, random };
        let mut keyframes = Vec::new();
        segment.0.iter().for_each(|touch| drawn.touch(touch, &mut keyframes));
        Script::of(keyframes)
    }
}

/// Draws how a hand comes down each time.
struct Drawn<'a> {
    hand: &'a Hand,
    random: SplitMix64,
}

impl Drawn<'_> {
    fn place_mm(&mut self, towards: Option<&str>) -> [f64; 2] {
        let reach_mm = self.hand.reach_mm;
        let aim = match towards {
            Some("right") => [reach_mm, 0.0],
            Some("up") => [0.0, reach_mm],
            Some("left") => [-reach_mm, 0.0],
            Some("down") => [0.0, -reach_mm],
            Some(other) => panic!("{other} is no direction"),
            None => [0.0, 0.0],
        };
        std::array::from_fn(|axis| {
            aim[axis] + self.hand.middle_mm[axis] + self.hand.aim_mm[axis] * f64::from(self.random.normal())
        })
    }

    fn force_n(&mut self, meant_n: f64) -> f64 {
        let scattered = 1.0 + self.hand.force_share * f64::from(self.random.normal());
        (meant_n * self.hand.strength * scattered).max(LEAST_N)
    }

    fn touch(&mut self, touch: &Touch, keyframes: &mut Vec<Keyframe>) {
        let Hand { rise_us, fall_us, .. } = *self.hand;
        let [x_mm, y_mm] = self.place_mm(touch.towards).map(|mm| mm as f32);
        let mut frame = |at_us: u64, fz_n: f64| {
            let contact = Contact { x_mm, y_mm, fz_n: fz_n as f32, ..Contact::default() };
            keyframes.push(Keyframe { at_us, contact });
        };
        let steer_n = if touch.towards.is_some() { self.force_n(STEER_N) } else { 0.0 };
        frame(1_000 * touch.begin_ms, 0.0);
        let mut free_us = 1_000 * touch.begin_ms;
        if touch.towards.is_some() {
            free_us += rise_us;
            frame(free_us, steer_n);
        }
        for press in &touch.presses {
            let (begin_us, end_us) = (1_000 * press.begin_ms, 1_000 * press.end_ms);
            let press_n = self.force_n(PRESS_N);
            frame(begin_us.max(free_us), steer_n);
            frame(begin_us.max(free_us) + rise_us, press_n);
            frame(end_us, press_n);
            free_us = end_us + fall_us;
            frame(free_us, steer_n);
        }
        let lift_us = (1_000 * touch.end_ms).max(free_us);
        frame(lift_us, steer_n);
        frame(lift_us + fall_us, 0.0);
    }
}
