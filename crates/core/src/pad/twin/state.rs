//! State of a pad that goes on in time, apart from its constants.

use super::delay::Delay;
use super::memory::Memory;
use super::noise::{Lasting, Walk};
use crate::bytes::{Reader, push_doubles};
use crate::pad::device::Device;
use crate::quantity::CHANNELS;
use tactpad_numeric::random::SplitMix64;

/// Strain that is remembered, signals on their way, noise, and how old the pad is.
#[derive(Clone, Debug)]
pub struct PadState {
    /// What the pad was drawn from.
    pub(super) seed: u64,
    pub(super) memory: Memory,
    pub(super) delay: Delay,
    pub(super) relative: [Lasting; CHANNELS],
    pub(super) walks: [Walk; CHANNELS],
    pub(super) white: SplitMix64,
    /// Where the mains began, in turns.
    pub(super) mains_phase: f64,
    pub(super) at_s: f64,
}

impl PadState {
    /// A new pad of this device, drawn from the seed.
    pub fn new(device: &Device, seed: u64) -> Self {
        let behaviour = &device.behaviour;
        let mut starts = SplitMix64::named(seed, "channels");
        let mut stream = || SplitMix64::new(starts.next_bits());
        Self {
            seed,
            memory: Memory::new(behaviour),
            delay: Delay::new(behaviour.sampling.skew_us),
            relative: std::array::from_fn(|_| Lasting::new(stream(), behaviour.noise.share_time_s)),
            walks: std::array::from_fn(|_| Walk::new(stream())),
            white: SplitMix64::named(seed, "white"),
            mains_phase: f64::from(SplitMix64::named(seed, "mains").fraction()),
            at_s: 0.0,
        }
    }

    /// The seed that drew the pad.
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// How long the pad has lived, in seconds.
    pub const fn age_s(&self) -> f64 {
        self.at_s
    }

    /// Seed, age and white noise; relative noise and walks by channel; what the strains left; signals on their way.
    pub(super) fn write(&self, to: &mut Vec<u8>) {
        to.extend(self.seed.to_le_bytes());
        push_doubles(to, &[self.at_s, self.mains_phase]);
        to.extend(self.white.state().to_le_bytes());
        self.relative.iter().for_each(|relative| relative.write(to));
        self.walks.iter().for_each(|walk| walk.write(to));
        self.memory.write(to);
        self.delay.write(to);
    }

    /// Reads what [`Self::write`] wrote of a pad of this device.
    pub(super) fn read(from: &mut Reader<'_>, device: &Device) -> Option<Self> {
        let mut state = Self::new(device, from.bits()?);
        (state.at_s, state.mains_phase) = (from.finite()?, from.finite()?);
        state.white = SplitMix64::new(from.bits()?);
        state.relative.iter_mut().try_for_each(|relative| relative.take_up(from))?;
        state.walks.iter_mut().try_for_each(|walk| walk.take_up(from))?;
        state.memory.take_up(from)?;
        state.delay.take_up(from)?;
        Some(state)
    }
}
