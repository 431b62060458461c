//! From what was written down to what N channels should read: everything in which a pad, or the rig, may differ.
//!
//! ```text
//! place = d + c R(φ) written                    force = R(tilt)⁻¹ (written − zero)/gain           (the rig)
//! eₖ = Σₐ Fₐ (Gₖₐ + ¼ ½ (R² − R₀²) ∇²Gₖₐ + Σⱼ wⱼ Cⱼₖₐ)(place) + h (Fx ∂ₓ + Fy ∂ᵧ) Gₖz(place)      (the mechanics)
//! mₖ = eₖ + what k remembers of eₖ                                                                  (the memory)
//! sₖ = lₖ (1 + αₖ ΔT) gₖ Σₘ (1 + M)ₖₘ mₘ,    qₖ = sₖ + pₖ sₖ²/Sₖ                                   (the channel)
//! yₖ = Σₗ (1 + X)ₖₗ qₗ + zₖ + βₖ ΔT + δₖ t                                                          (what is read)
//! ```
//!
//! G is the pad's influence field, C are changes of it, M and X what modules and channels take of each other, g gains, l what
//! ageing has left, α and β temperature coefficients, p the second order at full scale S, z zeros, δ drift. What is written, and what a
//! channel reads, may be late: of a series' rows it is then that of another moment (`memory`). A load patch of
//! radius R averages a field to G + (R²/8) ∇²G. A force at the height h turns about the plate: h Fx is the couple of two
//! opposite pressing forces.

use super::memory::MemoryChain;
use super::setting::Setting;
use crate::ageing::aged;
use crate::rig::errors::RigErrors;
use tactpad_core::pad::device::Side;
use tactpad_inference::observations::Sample;

/// Parameters of the chain in the contact and the mechanics.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MechanicsChain {
    /// h: how far above the plate's surface forces act.
    pub(crate) height_mm: f64,
    /// R² − R₀² of the load patch.
    pub(crate) patch_mm2: f64,
    /// w: weights of the field's changes.
    pub(crate) weights: Vec<f64>,
}

/// Parameters of the chain in the channels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChannelChain {
    /// M, as (into, from, share).
    pub(crate) module_shares: Vec<(usize, usize, f64)>,
    /// g.
    pub(crate) gain: Vec<f64>,
    /// α, 1/°C.
    pub(crate) gain_per_c: Vec<f64>,
    /// Loss of the strain at the largest cycle of the measurement.
    pub(crate) loss: Vec<f64>,
    /// p, as a share of full scale.
    pub(crate) second_order: Vec<f64>,
    /// X, as (into, from, share).
    pub(crate) shares: Vec<(usize, usize, f64)>,
    /// z.
    pub(crate) offset: Vec<f64>,
    /// β, per °C.
    pub(crate) zero_per_c: Vec<f64>,
    /// δ, per hour.
    pub(crate) drift_per_h: Vec<f64>,
    /// By how much what is read is late.
    pub(crate) skew_s: Vec<f64>,
}

/// Everything that may differ. [`Chain::nominal`] differs in nothing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chain {
    /// The rig.
    pub(crate) rig: RigErrors,
    /// Contact and plate.
    pub(crate) mechanics: MechanicsChain,
    /// Memory of the channels.
    pub(crate) memory: MemoryChain,
    /// The channels.
    pub(crate) channels: ChannelChain,
}

/// What the channels' equations need to know of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reference {
    /// Temperature at which gains and zeros are nominal.
    pub(crate) temp_c: f64,
    /// First time of the measurement.
    pub(crate) t_s: f64,
    /// Its largest cycle.
    pub(crate) cycle: f64,
    /// S: each channel's full scale.
    pub(crate) full_scale: Vec<f64>,
    /// Each channel's root mean square.
    pub(crate) sizes: Vec<f64>,
}

impl Chain {
    /// N channels, and a field that may change in so many ways.
    pub(crate) fn nominal(channels: usize, changes: usize) -> Self {
        Self {
            rig: RigErrors::NONE,
            mechanics: MechanicsChain { height_mm: 0.0, patch_mm2: 0.0, weights: vec![0.0; changes] },
            memory: MemoryChain::default(),
            channels: ChannelChain {
                module_shares: Vec::new(),
                gain: vec![1.0; channels],
                gain_per_c: vec![0.0; channels],
                loss: vec![0.0; channels],
                second_order: vec![0.0; channels],
                shares: Vec::new(),
                offset: vec![0.0; channels],
                zero_per_c: vec![0.0; channels],
                drift_per_h: vec![0.0; channels],
                skew_s: vec![0.0; channels],
            },
        }
    }
}

impl MechanicsChain {
    /// Adds to a number of the device, to first order about the field's own pad. A pad whose field does not know the number
    /// stays.
    pub(crate) fn add(&mut self, setting: &Setting, number: &str, value: f64) {
        if let Some((at, _)) = setting.number(number) {
            self.weights[at] += value;
        }
    }

    /// Multiplies a modulus or stiffness by a factor.
    pub(crate) fn stiffen(&mut self, setting: &Setting, number: &str, factor: f64) {
        if let Some((at, change)) = setting.number(number) {
            self.weights[at] += change.weight(factor) - change.weight(1.0);
        }
    }

    /// Takes away a share of a frame's area on a side: of the change of a pad that has nothing left there, in proportion.
    pub(crate) fn open(&mut self, setting: &Setting, module: usize, side: Side, share: f64) {
        if let Some((at, whole)) = setting.frame_open(module, side) {
            self.weights[at] += share / whole;
        }
    }

    /// Takes away a share of a bond's area from a side inwards: between the changes of pads that have lost known shares.
    pub(crate) fn debond(&mut self, setting: &Setting, module: usize, side: Side, share: f64) {
        for (at, weight) in setting.debonded(module, side, share) {
            self.weights[at] += weight;
        }
    }
}

impl ChannelChain {
    /// Turns the strains of all channels into what they read, in these circumstances.
    pub(crate) fn read(&self, values: &mut [f64], sample: &Sample, reference: &Reference) {
        let above_c = sample.temp_c.map_or(0.0, |temp_c| temp_c - reference.temp_c);
        let hours = sample.t_s.map_or(0.0, |t_s| (t_s - reference.t_s) / 3600.0);
        let aged = sample.cycle.map_or(0.0, |cycle| aged(cycle, reference.cycle));
        add_shares(values, &self.module_shares);
        for (channel, value) in values.iter_mut().enumerate() {
            let left = 1.0 - self.loss[channel] * aged;
            *value *= left * (1.0 + self.gain_per_c[channel] * above_c) * self.gain[channel];
            *value += self.second_order[channel] * *value * *value / reference.full_scale[channel];
        }
        add_shares(values, &self.shares);
        for (channel, value) in values.iter_mut().enumerate() {
            *value +=
                self.offset[channel] + self.zero_per_c[channel] * above_c + self.drift_per_h[channel] * hours;
        }
    }
}

/// Adds to values what they take of each other as they were: (1 + M) v, with M as (into, from, share).
fn add_shares(values: &mut [f64], shares: &[(usize, usize, f64)]) {
    if shares.is_empty() {
        return;
    }
    let before = values.to_vec();
    for (into, from, share) in shares {
        values[*into] += share * before[*from];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_take_of_each_other_as_they_were() {
        let reference = Reference {
            temp_c: 25.0,
            t_s: 0.0,
            cycle: 0.0,
            full_scale: vec![1000.0; 3],
            sizes: vec![1000.0; 3],
        };
        let both_ways = vec![(0, 1, 0.1), (1, 0, 0.5), (2, 1, 1.0)];
        let read = |channels: &ChannelChain| {
            let mut values = [100.0, 200.0, 0.0];
            channels.read(&mut values, &Sample::default(), &reference);
            values
        };
        let nominal = Chain::nominal(3, 0).channels;
        assert_eq!(read(&nominal), [100.0, 200.0, 0.0]);
        // 100 + 0.1 · 200, 200 + 0.5 · 100, 0 + 200: none of what the others have taken.
        let expected = [120.0, 250.0, 200.0];
        assert_eq!(read(&ChannelChain { module_shares: both_ways.clone(), ..nominal.clone() }), expected);
        assert_eq!(read(&ChannelChain { shares: both_ways, ..nominal }), expected);
    }
}
