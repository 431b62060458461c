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

#[cfg(test)]
mod tests {
    use super::creep::CreepState;
    use super::hysteresis::History;
    use super::memory::Memory;
    use super::*;
    use crate::pad::channels::{ChannelChain, ChannelConditions};
    use crate::quantity::Strain;
    use crate::time::StreamInstant;
    use tactpad_numeric::memory::PlayOperator;

    #[test]
    fn what_it_takes_off_is_what_the_channels_add() {
        let thermal = Thermal {
            reference_c: 25.0,
            zero_uv_per_c: std::array::from_fn(|k| 10.0 * k as f64 - 30.0),
            gain_per_c: std::array::from_fn(|k| 1e-4 * k as f64 - 5e-4),
        };
        let play = |threshold, share| [PlayOperator { threshold, share }; CHANNELS];
        let (hysteresis, creep) =
            ([play(100.0, 0.05), play(800.0, 0.03)], Relaxation { time_s: 3.0, share: 0.02 });
        let chain = ChannelChain {
            gain_per_c: thermal.gain_per_c.to_vec(),
            offset: vec![700.0; CHANNELS],
            zero_per_c: thermal.zero_uv_per_c.to_vec(),
            ..ChannelChain::nominal(vec![1.0; CHANNELS])
        };
        let mut memory = Memory::of(&Compensation { hysteresis, creep, ..Compensation::NONE });
        let (mut history, mut crept) = (History::default(), CreepState::default());
        for ms in 0..20_000_u32 {
            // Presses that grow, and a pad that warms up.
            let (press, above_c) = (ms / 2_000, f64::from(ms) * 5e-4);
            let load_uv = if ms % 2_000 < 1_000 { 300.0 * f64::from(press + 1) } else { 0.0 };
            let free_uv = [load_uv; CHANNELS];
            history.follow(&hysteresis, &free_uv);
            let (lag_uv, crept_uv) = (history.added_uv(&hysteresis, &free_uv), crept.added_uv(&creep));
            crept.hold(&free_uv, 1e-3, &creep);
            let mut read_uv: [f64; CHANNELS] = std::array::from_fn(|k| free_uv[k] + lag_uv[k] + crept_uv[k]);
            chain.read(&mut read_uv, &ChannelConditions { above_c, ..ChannelConditions::default() });
            let (zero_uv, gain) = (thermal.zero_uv(Some(25.0 + above_c)), thermal.gain(Some(25.0 + above_c)));
            let uv = std::array::from_fn(|k| ((read_uv[k] - 700.0 - zero_uv[k]) / gain[k]) as f32);
            let freed = memory.freed(&Strain { uv });
            let off = freed.uv.iter().map(|uv| (f64::from(*uv) - load_uv).abs()).fold(0.0, f64::max);
            assert!(off < 0.05, "{ms} ms: {off} µV");
            memory.follow(StreamInstant::from_us(1_000 * u64::from(ms)), (load_uv > 0.0).then_some(&freed));
        }
    }
}
