//! Hands that play without knowing the profile's thresholds, unlike the scripted player: they miss, slide, press too lightly and
//! too hard. What comes of it is measured, not known before.
//!
//! How exact they are is no measurement of anybody's hand: the numbers are plausible ones.

mod calibrator;
mod course;
mod draw;
mod play;
mod presses;
mod weights;

pub use self::calibrator::Calibrator;
pub use self::course::{FORCE_MAX_N, LEAST_US, WITHIN_MM};
pub use self::play::play;
pub use self::presses::presses;
pub use self::weights::{Placement, Weights};
