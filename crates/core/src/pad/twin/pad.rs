//! The pad in time: contact → nine channels, raw.

use std::f64::consts::TAU;

use super::bridges_of;
use super::state::PadState;
use crate::pad::channels::ChannelConditions;
use crate::pad::device::Device;
use crate::pad::device::behaviour::{Ageing, Behaviour, Mains, Noise, Sampling};
use crate::pad::field::PadField;
use crate::pad::readout::Readout;
use crate::quantity::{CHANNELS, Contact};

/// Circumstances of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circumstances {
    /// Temperature of the pad.
    pub temperature_c: f64,
    /// Cycles of load that it has behind it.
    pub cycles: f64,
}

/// A pad whose state goes on in time.
#[derive(Clone, Debug)]
pub struct TwinPad {
    field: PadField,
    readout: Readout,
    ageing: Ageing,
    noise: Noise,
    mains: Mains,
    sampling: Sampling,
    state: PadState,
}

impl TwinPad {
    /// A pad at rest. `field` is that of `device`, whose scatter is drawn from the seed.
    pub fn new(device: &Device, field: &PadField, seed: u64) -> Self {
        Self::going_on(device, field, PadState::new(device, seed))
    }

    /// The pad whose state this is. `device` is the one that the state was made with, and `field` is its field.
    pub fn going_on(device: &Device, field: &PadField, state: PadState) -> Self {
        let device = super::drawn(device, state.seed);
        let Behaviour { ageing, noise, mains, sampling, .. } = device.behaviour;
        Self {
            field: PadField {
                signals: field.signals.clone(),
                sums: field.sums.clone(),
                sensitivities: Vec::new(),
            },
            readout: Readout::of(&device),
            ageing,
            noise,
            mains,
            sampling,
            state,
        }
    }

    /// What of it goes on in time.
    pub fn into_state(self) -> PadState {
        self.state
    }

    /// Channels `after_s` after the last reading, µV: raw, not tared.
    ///
    /// Between the two the strains went evenly. A contact beyond the field's radius, or one that is not finite, reads as
    /// [`InfluenceField::strain_uv`](crate::pad::influence::InfluenceField::strain_uv) says.
    pub fn read(&mut self, after_s: f64, contact: &Contact, around: &Circumstances) -> [f64; CHANNELS] {
        self.read_all(after_s, std::slice::from_ref(contact), around)
    }

    /// The same of several fingers.
    pub fn read_all(
        &mut self,
        after_s: f64,
        contacts: &[Contact],
        around: &Circumstances,
    ) -> [f64; CHANNELS] {
        self.state.at_s += after_s;
        let strain_uv = self.readout.strain_uv(&bridges_of(&self.field, contacts));
        let remembered_uv = self.state.memory.follow(after_s, &strain_uv);
        let conditions = ChannelConditions {
            hours: self.state.at_s / 3600.0,
            aged: self.ageing.part(around.cycles),
            ..self.readout.conditions(around.temperature_c)
        };
        let mut signal_uv = self.readout.signal_uv(&remembered_uv, &conditions);
        for ((uv, relative), share) in
            signal_uv.iter_mut().zip(&mut self.state.relative).zip(self.noise.share)
        {
            *uv *= 1.0 + share * relative.next(after_s);
        }
        let shown_uv = self.state.delay.show(self.state.at_s, signal_uv);
        let zero_uv = self.readout.zero_uv(&conditions);
        std::array::from_fn(|channel| {
            let added_uv = self.added_uv(channel, after_s);
            self.converted(shown_uv[channel] + zero_uv[channel] + added_uv)
        })
    }

    /// Noise and pickup.
    fn added_uv(&mut self, channel: usize, after_s: f64) -> f64 {
        let Noise { additive_uv, walk_uv, .. } = &self.noise;
        let white_uv = additive_uv[channel] * f64::from(self.state.white.normal());
        let walk_uv = walk_uv[channel] * self.state.walks[channel].next(after_s);
        let sampled_s = self.state.at_s - self.sampling.skew_us[channel] * 1e-6;
        let turns = self.state.mains_phase + self.mains.frequency_hz * sampled_s;
        let mains_uv = self.mains.amplitude_uv[channel] * libm::sin(TAU * (turns - libm::floor(turns)));
        white_uv + walk_uv + mains_uv
    }

    fn converted(&self, uv: f64) -> f64 {
        let Sampling { range_uv, step_uv, .. } = self.sampling;
        let kept_uv = uv.clamp(-range_uv, range_uv);
        if step_uv > 0.0 { libm::round(kept_uv / step_uv) * step_uv } else { kept_uv }
    }
}
