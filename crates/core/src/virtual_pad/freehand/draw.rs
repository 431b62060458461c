//! Random numbers as a hand needs them.

use crate::quantity::Contact;
use tactpad_numeric::random::SplitMix64;

/// Draws.
#[derive(Clone, Debug)]
pub(super) struct Draw {
    random: SplitMix64,
}

impl Draw {
    /// Those of this seed for this purpose.
    pub(super) fn new(seed: u64, purpose: &str) -> Self {
        Self { random: SplitMix64::named(seed, purpose) }
    }

    /// Evenly between two numbers.
    pub(super) fn between(&mut self, [low, high]: [f32; 2]) -> f32 {
        low + (high - low) * self.random.fraction()
    }

    /// Between two numbers above zero, evenly in their logarithm.
    pub(super) fn log_between(&mut self, [low, high]: [f32; 2]) -> f32 {
        libm::expf(self.between([libm::logf(low), libm::logf(high)]))
    }

    /// Normally around zero.
    pub(super) fn normal(&mut self, deviation: f32) -> f32 {
        deviation * self.random.normal()
    }

    /// Around a number above zero; its logarithm is normal.
    pub(super) fn log_normal(&mut self, median: f32, deviation: f32) -> f32 {
        median * libm::expf(self.normal(deviation))
    }

    /// Whether something comes that comes in this share of cases.
    pub(super) fn chance(&mut self, share: f32) -> bool {
        self.random.fraction() < share
    }

    /// One of so many, which are at least one.
    pub(super) fn index(&mut self, count: usize) -> usize {
        ((self.random.fraction() * count as f32) as usize).min(count.saturating_sub(1))
    }

    /// Evenly between two times in milliseconds, in microseconds.
    pub(super) fn us(&mut self, ms: [f32; 2]) -> u64 {
        microseconds(self.between(ms))
    }

    /// Evenly over a disc.
    pub(super) fn in_disc(&mut self, radius_mm: f32) -> [f32; 2] {
        // The area within r grows with r².
        let r_mm = radius_mm * libm::sqrtf(self.random.fraction());
        let [cos, sin] = towards(self.between([0.0, 360.0]));
        [r_mm * cos, r_mm * sin]
    }
}

/// The unit vector in a direction, counter-clockwise from right.
pub(super) fn towards(angle_deg: f32) -> [f32; 2] {
    let (sin, cos) = libm::sincosf(angle_deg.to_radians());
    [cos, sin]
}

/// Milliseconds in whole microseconds.
pub(super) fn microseconds(ms: f32) -> u64 {
    (1e3 * ms) as u64
}

/// The place, moved towards the centre where it lies farther out than `radius_mm`.
pub(super) fn within([x_mm, y_mm]: [f32; 2], radius_mm: f32) -> [f32; 2] {
    let beyond = (libm::hypotf(x_mm, y_mm) / radius_mm).max(1.0);
    [x_mm / beyond, y_mm / beyond]
}

/// A contact at a place.
pub(super) const fn at([x_mm, y_mm]: [f32; 2], [fx_n, fy_n]: [f32; 2], fz_n: f32) -> Contact {
    Contact { x_mm, y_mm, fx_n, fy_n, fz_n }
}
