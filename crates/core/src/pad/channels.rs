//! The law of the channels, of any number of them: from strains to readings.
//!
//! ```text
//! vₖ = Σₗ (1 + M)ₖₗ eₗ                                          what modules take of each other
//! sₖ = lₖ (1 + αₖ ΔT) gₖ mₖ,    qₖ = sₖ + pₖ sₖ²/Sₖ            the channel
//! yₖ = Σₗ (1 + X)ₖₗ qₗ + zₖ + (βₖ + β₂ₖ ΔT) ΔT + δₖ t           what is read
//! ```
//!
//! e are the strains, m is v with what the channel remembers of it ([`tactpad_numeric::memory`]), M and X are what modules and
//! channels take of each other, g gains, l what ageing has left, α, β and β₂ temperature coefficients, p the second order at full
//! scale S, z zeros, δ drift. This is the only place that has it: the twin, the diagnosis and the calibration read by it, and what
//! the live core takes off is its inverse ([`crate::pipeline::compensation`]).

use super::device::Device;
use super::device::behaviour::{Behaviour, ModuleCrosstalk};
use crate::quantity::CHANNELS;

/// Into a channel, from a channel: a share of the other's value.
pub type Share = (usize, usize, f64);

/// Circumstances of a reading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChannelConditions {
    /// ΔT: how much warmer the sensor is than where gains and zeros are nominal, °C.
    pub above_c: f64,
    /// t: hours since the measurement began.
    pub hours: f64,
    /// The part of the loss by ageing that has come.
    pub aged: f64,
}

/// The numbers of the law, channel by channel; strains and readings are in µV, or whatever the sensor's unit is.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelChain {
    /// M.
    pub module_shares: Vec<Share>,
    /// g.
    pub gain: Vec<f64>,
    /// α, 1/°C.
    pub gain_per_c: Vec<f64>,
    /// Loss of the strain when all of it has come: l = 1 − loss · aged.
    pub loss: Vec<f64>,
    /// p, as a share of full scale.
    pub second_order: Vec<f64>,
    /// S.
    pub full_scale: Vec<f64>,
    /// X.
    pub shares: Vec<Share>,
    /// z.
    pub offset: Vec<f64>,
    /// β, per °C.
    pub zero_per_c: Vec<f64>,
    /// β₂, per °C².
    pub zero_per_c2: Vec<f64>,
    /// δ, per hour.
    pub drift_per_h: Vec<f64>,
}

impl ChannelChain {
    /// Channels with these full scales that read their strains.
    pub fn nominal(full_scale: Vec<f64>) -> Self {
        let none = || vec![0.0; full_scale.len()];
        Self {
            module_shares: Vec::new(),
            gain: vec![1.0; full_scale.len()],
            gain_per_c: none(),
            loss: none(),
            second_order: none(),
            shares: Vec::new(),
            offset: none(),
            zero_per_c: none(),
            zero_per_c2: none(),
            drift_per_h: none(),
            full_scale,
        }
    }

    /// Those of a device. What its ageing takes comes by the part that its cycles of load have brought.
    pub fn of(device: &Device) -> Self {
        let Behaviour { thermal, crosstalk, module_crosstalk, ageing, noise, .. } = &device.behaviour;
        let axes = |it: &ModuleCrosstalk| {
            let ModuleCrosstalk { module, with, share } = *it;
            (0..3).map(move |axis| (3 * module + axis, 3 * with + axis, share))
        };
        Self {
            module_shares: module_crosstalk.iter().flat_map(axes).collect(),
            gain: device.modules.iter().flat_map(|module| module.gain).collect(),
            gain_per_c: thermal.gain_per_c.to_vec(),
            loss: ageing.share.to_vec(),
            shares: crosstalk.iter().map(|it| (it.channel, it.with, it.share)).collect(),
            offset: device.modules.iter().flat_map(|module| module.offset_uv).collect(),
            zero_per_c: thermal.zero_uv_per_c.to_vec(),
            zero_per_c2: thermal.zero_uv_per_c2.to_vec(),
            drift_per_h: noise.drift_uv_per_h.to_vec(),
            ..Self::nominal(vec![1.0; CHANNELS])
        }
    }

    /// e → v, in place.
    pub fn couple(&self, strains: &mut [f64]) {
        add_shares(strains, &self.module_shares);
    }

    /// m → (1 + X) q, in place: what the channels read beside their zeros.
    pub fn amplify(&self, values: &mut [f64], at: &ChannelConditions) {
        for (channel, value) in values.iter_mut().enumerate() {
            let left = 1.0 - self.loss[channel] * at.aged;
            *value *= left * (1.0 + self.gain_per_c[channel] * at.above_c) * self.gain[channel];
            *value += self.second_order[channel] * *value * *value / self.full_scale[channel];
        }
        add_shares(values, &self.shares);
    }

    /// What a channel reads without load.
    pub fn zero(&self, channel: usize, at: &ChannelConditions) -> f64 {
        let per_c = self.zero_per_c[channel] + self.zero_per_c2[channel] * at.above_c;
        self.offset[channel] + per_c * at.above_c + self.drift_per_h[channel] * at.hours
    }

    /// m → y, in place.
    pub fn read(&self, values: &mut [f64], at: &ChannelConditions) {
        self.amplify(values, at);
        values.iter_mut().enumerate().for_each(|(channel, value)| *value += self.zero(channel, at));
    }
}

/// Adds to values what they take of each other as they were. An index that names no channel is left out.
fn add_shares(values: &mut [f64], shares: &[Share]) {
    if shares.is_empty() {
        return;
    }
    let before = values.to_vec();
    for (into, from, share) in shares {
        if let (Some(value), Some(other)) = (values.get_mut(*into), before.get(*from)) {
            *value += share * other;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_take_of_each_other_as_they_were() {
        let nominal = ChannelChain::nominal(vec![1000.0; 3]);
        let both_ways = vec![(0, 1, 0.1), (1, 0, 0.5), (2, 1, 1.0), (3, 0, 1.0)];
        let read = |chain: &ChannelChain| {
            let mut values = [100.0, 200.0, 0.0];
            chain.couple(&mut values);
            chain.read(&mut values, &ChannelConditions::default());
            values
        };
        assert_eq!(read(&nominal), [100.0, 200.0, 0.0]);
        // 100 + 0.1 · 200, 200 + 0.5 · 100, 0 + 200: none of what the others have taken.
        let expected = [120.0, 250.0, 200.0];
        assert_eq!(read(&ChannelChain { module_shares: both_ways.clone(), ..nominal.clone() }), expected);
        assert_eq!(read(&ChannelChain { shares: both_ways, ..nominal }), expected);
    }

    #[test]
    fn a_reading_is_the_law_term_by_term() {
        let chain = ChannelChain {
            gain: vec![2.0, 1.0],
            gain_per_c: vec![-1e-3, 0.0],
            loss: vec![0.1, 0.0],
            second_order: vec![0.0, 0.05],
            offset: vec![7.0, 0.0],
            zero_per_c: vec![3.0, 0.0],
            zero_per_c2: vec![0.5, 0.0],
            drift_per_h: vec![0.0, -4.0],
            ..ChannelChain::nominal(vec![500.0; 2])
        };
        let mut values = [100.0, 100.0];
        chain.read(&mut values, &ChannelConditions { above_c: 10.0, hours: 2.0, aged: 0.5 });
        // 100 · 0.95 · 0.99 · 2 + 7 + (3 + 5) 10; 100 + 0.05 · 100²/500 − 8.
        assert!((values[0] - 275.1).abs() < 1e-9 && (values[1] - 93.0).abs() < 1e-9, "{values:?}");
    }
}
