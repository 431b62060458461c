//! From what was written down to what N channels should read: everything in which a pad, or the rig, may differ.
//!
//! ```text
//! place = d + c R(φ) written                    force = R(tilt)⁻¹ (written − zero)/gain           (the rig)
//! eₖ = Σₐ Fₐ (Gₖₐ + ¼ ½ (R² − R₀²) ∇²Gₖₐ + Σⱼ wⱼ Cⱼₖₐ)(place) + h (Fx ∂ₓ + Fy ∂ᵧ) Gₖz(place)      (the mechanics)
//! vₖ = Σₗ (1 + M)ₖₗ eₗ,    mₖ = vₖ + what k remembers of vₖ                                         (the memory)
//! ```
//!
//! and from m to what is read by the law of the channels ([`tactpad_core::pad::channels`]). G is the pad's influence field, C are
//! changes of it. What is written, and what a channel reads, may be late: of a series' rows it is then that of another moment
//! (`memory`). A load patch of radius R averages a field to G + (R²/8) ∇²G. A force at the height h turns about the plate: h Fx is
//! the couple of two opposite pressing forces.

use super::memory::MemoryChain;
use super::setting::Setting;
use crate::ageing::aged;
use crate::rig::errors::RigErrors;
use tactpad_core::pad::channels::{ChannelChain, ChannelConditions};
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
    /// By how much what each channel reads is late.
    pub(crate) skew_s: Vec<f64>,
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
    /// These channels, and a field that may change in so many ways.
    pub(crate) fn nominal(channels: ChannelChain, changes: usize) -> Self {
        Self {
            rig: RigErrors::NONE,
            mechanics: MechanicsChain { height_mm: 0.0, patch_mm2: 0.0, weights: vec![0.0; changes] },
            memory: MemoryChain::default(),
            skew_s: vec![0.0; channels.gain.len()],
            channels,
        }
    }
}

impl Chain {
    /// The rig's errors at a row.
    pub(crate) const fn rig_at(&self, sample: &Sample) -> RigErrors {
        self.rig.of_row(sample.turned_deg, sample.is_weight)
    }
}

impl Reference {
    /// Circumstances of a row.
    pub(crate) fn conditions(&self, sample: &Sample) -> ChannelConditions {
        ChannelConditions {
            above_c: sample.temp_c.map_or(0.0, |temp_c| temp_c - self.temp_c),
            hours: sample.t_s.map_or(0.0, |t_s| (t_s - self.t_s) / 3600.0),
            aged: sample.cycle.map_or(0.0, |cycle| aged(cycle, self.cycle)),
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
