//! A mass on a spring with a damper: the simplest thing that rings.

use std::f64::consts::{PI, TAU};

/// ẍ + 2ζω ẋ + ω² x = ω² u, with ω = 2πf; at rest x = u. Source: L. Rayleigh, The Theory of Sound (1877), chapter 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator {
    /// f, of the undamped motion; positive.
    pub frequency_hz: f64,
    /// ζ, from 0 up to, but not including, 1.
    pub damping_ratio: f64,
}

impl Oscillator {
    /// |x/u| of a sine: 1/√((1−r²)² + (2ζr)²), r its frequency over f.
    pub fn gain(self, hz: f64) -> f64 {
        let r = hz / self.frequency_hz;
        1.0 / (1.0 - r * r).hypot(2.0 * self.damping_ratio * r)
    }

    /// x so long after u has stepped from 0 to 1; 0 before that.
    ///
    /// 1 − exp(−ζωt) (cos ω_d t + ζ/√(1−ζ²) sin ω_d t), ω_d = ω√(1−ζ²).
    pub fn step(self, t_s: f64) -> f64 {
        if t_s < 0.0 {
            return 0.0;
        }
        let (angular, ratio) = (TAU * self.frequency_hz, self.damping_ratio);
        let root = (1.0 - ratio * ratio).sqrt();
        let (sin, cos) = (angular * root * t_s).sin_cos();
        1.0 - (-ratio * angular * t_s).exp() * (cos + ratio / root * sin)
    }

    /// Up to which frequency it follows within ±3 dB: where the gain first reaches √2 on its way to the resonance, or 1/√2 where
    /// damping keeps it below √2.
    ///
    /// With s = r², (1−s)² + 4ζ²s is ½ at the rise (if it falls so low) and 2 at the fall.
    pub fn bandwidth_hz(self) -> f64 {
        let half = 1.0 - 2.0 * self.damping_ratio * self.damping_ratio;
        // s² − 2 half s + 1 − level = 0.
        let under = half * half - 0.5;
        let rises = half > 0.0 && under >= 0.0;
        let square = if rises { half - under.sqrt() } else { half + (half * half + 1.0).sqrt() };
        self.frequency_hz * square.sqrt()
    }

    /// After a step, when the ringing stays within 2 %: ln 50/(ζω).
    pub fn settling_s(self) -> f64 {
        50.0_f64.ln() / (self.damping_ratio * TAU * self.frequency_hz)
    }

    /// By how much a step overshoots: exp(−πζ/√(1−ζ²)).
    pub fn overshoot(self) -> f64 {
        let ratio = self.damping_ratio;
        (-PI * ratio / (1.0 - ratio * ratio).sqrt()).exp()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::SQRT_2;

    use super::*;

    const RINGS: Oscillator = Oscillator { frequency_hz: 700.0, damping_ratio: 0.02 };

    #[test]
    fn at_the_end_of_the_bandwidth_the_gain_is_three_decibels_off() {
        assert!((RINGS.gain(RINGS.bandwidth_hz()) / SQRT_2 - 1.0).abs() < 1e-12);
        assert!((RINGS.bandwidth_hz() / 700.0 - 0.5412).abs() < 1e-3);
        let calm = Oscillator { damping_ratio: 0.7, ..RINGS };
        assert!((calm.gain(calm.bandwidth_hz()) * SQRT_2 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_step_overshoots_after_half_a_turn_and_settles() {
        let root = (1.0_f64 - 0.02 * 0.02).sqrt();
        let top_s = 0.5 / (700.0 * root);
        assert!((RINGS.step(top_s) - 1.0 - RINGS.overshoot()).abs() < 1e-12);
        assert!(RINGS.step(top_s) > RINGS.step(0.99 * top_s) && RINGS.step(top_s) > RINGS.step(1.01 * top_s));
        assert_eq!((RINGS.step(-1e-9), RINGS.step(0.0)), (0.0, 0.0));
        let end_s = RINGS.settling_s();
        assert!((0..200).all(|k| (RINGS.step(end_s + 1e-5 * f64::from(k)) - 1.0).abs() < 0.0201));
    }

    #[test]
    fn it_obeys_its_equation() {
        let (h, t_s, angular) = (1e-6, 3.3e-4, TAU * 700.0);
        let at = |k: f64| RINGS.step(t_s + k * h);
        let (speed, force) =
            ((at(1.0) - at(-1.0)) / (2.0 * h), (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / (h * h));
        let sum = force + 2.0 * 0.02 * angular * speed + angular * angular * at(0.0);
        assert!((sum / (angular * angular) - 1.0).abs() < 1e-4, "{sum}");
    }
}
