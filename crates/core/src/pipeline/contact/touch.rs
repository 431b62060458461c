//! Whether a finger is on the pad: force thresholds with hysteresis, and a guard against drift posing as a finger.

use crate::pipeline::interruption::Effect;
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// A touch begins at this normal force. Five times the published noise of Fz after the filter.
pub const ON_N: f32 = 0.15;

/// A touch ends below this normal force.
const OFF_N: f32 = 0.10;

/// Largest residue of a lifted pad, as a share of the hardest press of the touch: the published hysteresis, 3.1 %.
const RESIDUE_SHARE: f32 = 0.031;

/// The residue never raises the thresholds by more; so they stay below those of the shipped profiles.
const RESIDUE_MAX_N: f32 = 0.09;

/// The residue fades with this time constant after the lift.
const RESIDUE_FADE_S: f32 = 3.0;

/// A touch that stays below this force …
const GUARD_N: f32 = 0.30;

/// … for this long is drift, not a finger.
const GUARD_US: u64 = 10_000_000;

/// State of the touch detector at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchState {
    /// Nothing touches the pad.
    Idle,
    /// A finger is on the pad.
    Touched,
    /// The zero is wrong: what looks like a touch is drift. Nothing touches the pad.
    Drifted,
}

/// The touch detector.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    touched: bool,
    peak_n: f32,
    residue_n: f32,
    last: StreamInstant,
    sound_at: StreamInstant,
}

impl Default for Touch {
    fn default() -> Self {
        Self::new()
    }
}

impl Touch {
    /// A detector for an untouched pad.
    pub const fn new() -> Self {
        let start = StreamInstant::from_us(0);
        Self { touched: false, peak_n: 0.0, residue_n: 0.0, last: start, sound_at: start }
    }

    /// Whether the last sample was a touch.
    pub const fn is_touched(&self) -> bool {
        self.touched
    }

    /// Takes the contact of the sample at `at`. A normal force that is not a number is no touch.
    pub fn update(&mut self, at: StreamInstant, contact: &Contact) -> TouchState {
        let fz_n = if contact.fz_n.is_finite() { contact.fz_n } else { 0.0 };
        self.fade(at);
        let threshold_n = if self.touched { OFF_N } else { ON_N };
        let was_touched = self.touched;
        self.touched = fz_n >= threshold_n + self.residue_n;
        if self.touched != was_touched {
            self.peak_n = 0.0;
            self.sound_at = at;
        }
        if self.touched {
            self.peak_n = self.peak_n.max(fz_n);
            self.residue_n = self.residue_n.max((RESIDUE_SHARE * self.peak_n).min(RESIDUE_MAX_N));
        }
        self.judge(at, fz_n)
    }

    /// In doubt, the touch ends whatever the force is.
    pub fn interrupt(&mut self, effect: Effect) {
        match effect {
            Effect::Keep => {}
            Effect::Doubt => (self.touched, self.peak_n) = (false, 0.0),
            Effect::Forget => *self = Self::new(),
        }
    }

    fn fade(&mut self, at: StreamInstant) {
        let elapsed_s = at.us_since(self.last) as f32 * 1e-6;
        self.last = at;
        if !self.touched {
            self.residue_n *= (1.0 - elapsed_s / RESIDUE_FADE_S).max(0.0);
        }
    }

    fn judge(&mut self, at: StreamInstant, fz_n: f32) -> TouchState {
        if !self.touched || fz_n >= GUARD_N {
            self.sound_at = at;
        } else if at.us_since(self.sound_at) >= GUARD_US {
            *self = Self { last: at, sound_at: at, ..Self::new() };
            return TouchState::Drifted;
        }
        if self.touched { TouchState::Touched } else { TouchState::Idle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs a force profile sampled every 10 ms from 1 s on.
    fn states(forces_n: &[f32]) -> Vec<TouchState> {
        let mut touch = Touch::new();
        let mut at = StreamInstant::from_us(1_000_000);
        touch.update(at, &Contact::default());
        forces_n
            .iter()
            .map(|&fz_n| {
                at = at.plus_us(10_000);
                touch.update(at, &Contact { fz_n, ..Contact::default() })
            })
            .collect()
    }

    #[test]
    fn a_touch_begins_at_the_upper_threshold_and_ends_below_the_lower() {
        use TouchState::{Idle, Touched};
        assert_eq!(
            states(&[0.149, 0.151, 0.12, 0.149, 0.09, 0.12]),
            [Idle, Touched, Touched, Touched, Idle, Idle]
        );
    }

    #[test]
    fn what_a_hard_press_leaves_behind_is_no_touch() {
        let after = states(&[5.0, 0.18, 0.18, 0.155, 0.15]);
        assert_eq!(after[1..], [TouchState::Idle; 4]);
    }

    #[test]
    fn the_allowance_for_residue_fades() {
        let mut forces_n = vec![5.0];
        forces_n.extend([0.0; 300]);
        forces_n.push(0.20);
        assert_eq!(states(&forces_n).last(), Some(&TouchState::Touched));
    }

    #[test]
    fn a_faint_touch_that_never_ends_is_drift() {
        let states = states(&[0.25; 1_002]);
        assert_eq!(states[1_000], TouchState::Drifted);
        assert!(states[..1_000].iter().all(|&state| state == TouchState::Touched));
    }

    #[test]
    fn a_firm_press_may_last_for_ever() {
        assert!(states(&[0.31; 6_000]).iter().all(|&state| state == TouchState::Touched));
    }

    #[test]
    fn a_force_that_is_no_number_ends_the_touch() {
        assert_eq!(states(&[1.0, f32::NAN]), [TouchState::Touched, TouchState::Idle]);
    }
}
