//! Ranges and defaults of a profile's numbers; `mappings/README.md` says them to people.

use crate::pipeline::mapping::profile::POINTER_SPEED_MAX;
use crate::toml_text::section::Bounds;

pub(crate) const FILTER_SAMPLES: Bounds<u32> = Bounds { low: 1, high: 64, default: 6 };
pub(crate) const MIN_PRESS_MS: Bounds<u32> = Bounds { low: 0, high: 1_000, default: 40 };
pub(crate) const LONG_PRESS_MS: Bounds<u32> = Bounds { low: 1, high: 10_000, default: 400 };
pub(crate) const DOUBLE_PRESS_MS: Bounds<u32> = Bounds { low: 50, high: 2_000, default: 250 };
pub(crate) const TURBO_MS: Bounds<u32> = Bounds { low: 2, high: 10_000, default: 100 };
/// Two frames of a game, and some.
pub(crate) const STEP_MS: Bounds<u32> = Bounds { low: 1, high: 10_000, default: 50 };
pub(crate) const WAIT_MS: Bounds<u32> = Bounds { low: 1, high: 10_000, default: 50 };
/// The plate's radius is 30 mm; on its rim there is nothing left to steer with.
pub(crate) const CENTRE_RADIUS_MM: Bounds<f32> = Bounds { low: 2.0, high: 29.0, default: 8.0 };
pub(crate) const RADIUS_HYSTERESIS_MM: Bounds<f32> = Bounds { low: 0.0, high: 29.0, default: 1.5 };
/// A hand that rests farther from the middle leaves no room on its side.
pub(crate) const CENTRE_MM: Bounds<f32> = Bounds { low: -15.0, high: 15.0, default: 0.0 };
pub(crate) const ROTATION_DEG: Bounds<f32> = Bounds { low: -180.0, high: 180.0, default: 0.0 };
pub(crate) const HYSTERESIS_DEG: Bounds<f32> = Bounds { low: 0.0, high: 45.0, default: 8.0 };
pub(crate) const HYSTERESIS_MM: Bounds<f32> = Bounds { low: 0.0, high: 10.0, default: 0.0 };
/// Zones are new with this key, so that theirs need not be as before.
pub(crate) const ZONE_HYSTERESIS_MM: Bounds<f32> = Bounds { default: 2.5, ..HYSTERESIS_MM };
pub(crate) const ANGLE_DEG: Bounds<f32> = Bounds { low: -360.0, high: 360.0, default: 0.0 };
pub(crate) const INNER_RADIUS_MM: Bounds<f32> = Bounds { low: 0.0, high: 29.0, default: 0.0 };
/// The plate's rim, and a finger that lies over it.
pub(crate) const OUTER_RADIUS_MM: Bounds<f32> = Bounds { low: 1.0, high: 40.0, default: 40.0 };
pub(crate) const ZONE_DEG_MIN: f32 = 10.0;
pub(crate) const ZONE_MM_MIN: f32 = 3.0;
pub(crate) const GAIN: Bounds<f32> = Bounds { low: 0.25, high: 4.0, default: 1.0 };
pub(crate) const DIAGONAL_DEG: Bounds<f32> = Bounds { low: 5.0, high: 85.0, default: 45.0 };
pub(crate) const STICKY_DIAGONAL_DEG: f32 = 30.0;
pub(crate) const FORCE_N: Bounds<f32> = Bounds { low: 0.05, high: 50.0, default: 0.3 };
pub(crate) const HARD_N: Bounds<f32> = Bounds { default: 3.0, ..FORCE_N };
pub(crate) const HAIR_N: Bounds<f32> = Bounds { low: 0.05, high: 10.0, default: 0.2 };
pub(crate) const SKIP_MS: Bounds<u32> = Bounds { low: 10, high: 2_000, default: 150 };
pub(crate) const SLOW_MS: Bounds<u32> = Bounds { low: 0, high: 5_000, default: 0 };
pub(crate) const BOUNCE_MS: Bounds<u32> = Bounds { low: 0, high: 5_000, default: 0 };
pub(crate) const DWELL_MS: Bounds<u32> = Bounds { low: 50, high: 10_000, default: 800 };
pub(crate) const DWELL_MM: Bounds<f32> = Bounds { low: 0.5, high: 15.0, default: 3.0 };
pub(crate) const TREMOR_HZ: Bounds<f32> = Bounds { low: 0.3, high: 10.0, default: 1.0 };
pub(crate) const TREMOR_PER_MM: Bounds<f32> = Bounds { low: 0.0, high: 1.0, default: 0.05 };
pub(crate) const REST_N: Bounds<f32> = Bounds { low: 0.05, high: 10.0, default: 0.5 };
pub(crate) const REST_MS: Bounds<u32> = Bounds { low: 50, high: 5_000, default: 500 };
/// Default of a button's release force over its press force.
pub(crate) const RELEASE_SHARE: f32 = 0.7;
/// Force that starts a direction, or the pointer, over the default of the force that ends it.
pub(crate) const RELEASE_RATIO: f32 = 1.5;
pub(crate) const POINTER_CENTRE_MM: Bounds<f32> = Bounds { default: 5.0, ..CENTRE_RADIUS_MM };
pub(crate) const STICK_CENTRE_MM: Bounds<f32> = Bounds { low: 0.0, high: 29.0, default: 3.0 };
pub(crate) const SHEAR_REST_N: Bounds<f32> = Bounds { low: 0.0, high: 10.0, default: 0.2 };
pub(crate) const SHEAR_FULL_N: Bounds<f32> = Bounds { low: 0.1, high: 20.0, default: 2.0 };
pub(crate) const TRIGGER_FROM_N: Bounds<f32> = Bounds { low: 0.05, high: 20.0, default: 0.5 };
pub(crate) const TRIGGER_FULL_N: Bounds<f32> = Bounds { low: 0.1, high: 50.0, default: 4.0 };
pub(crate) const STICK_CURVE: Bounds<f32> = Bounds { low: 1.0, high: 3.0, default: 1.0 };
pub(crate) const FULL_RADIUS_MM: Bounds<f32> = Bounds { low: 3.0, high: 30.0, default: 24.0 };
pub(crate) const SPEED_COUNTS_PER_S: Bounds<f32> =
    Bounds { low: 10.0, high: POINTER_SPEED_MAX as f32, default: 800.0 };
pub(crate) const CURVE: Bounds<f32> = Bounds { low: 1.0, high: 3.0, default: 2.0 };
