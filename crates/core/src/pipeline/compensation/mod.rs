//! Compensation of a strain for earlier loads and the temperature.

pub mod creep;
pub mod gain;
pub mod hysteresis;
pub mod memory;
pub mod thermal;
pub mod thermometer;

use crate::pipeline::compensation::hysteresis::{Hysteresis, NO_HYSTERESIS};
use crate::pipeline::compensation::thermal::Thermal;
use crate::quantity::CHANNELS;
use tactpad_numeric::memory::Relaxation;

/// Compensation of a pad's channels for all that is not the contact. Any decoder can have one.
///
/// Channel by channel, a pad at temperature T reads
///
/// ```text
/// r = z + β (T − T₀) + (1 + γ (T − T₀)) s,    s = e + c u + Σⱼ wⱼ (pⱼ − e)
/// ```
///
/// where e is what the contact at hand makes it read, z the zero, β and γ the coefficients of [`Thermal`], c and u the share and
/// the state of [`Relaxation`], wⱼ and pⱼ those of [`Hysteresis`]. A decoder takes e.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation {
    /// z in µV: what the untouched pad reads at the reference temperature, if it was calibrated by a table that never
    /// reads it. In play the zero is measured.
    pub zero_uv: Option<[f64; CHANNELS]>,
    /// How the channels follow the temperature, if it was calibrated at several.
    pub thermal: Option<Thermal>,
    /// How much the channels creep.
    pub creep: Relaxation,
    /// Hysteresis of the channels.
    pub hysteresis: Hysteresis,
}

impl Compensation {
    /// Of a pad of which nothing is known: nothing is taken off.
    pub const NONE: Self =
        Self { zero_uv: None, thermal: None, creep: Relaxation::NONE, hysteresis: NO_HYSTERESIS };
}
