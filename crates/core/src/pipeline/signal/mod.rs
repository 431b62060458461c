//! From raw counts to strain: scale, channel faults, mean filter, tare.
//!
//! Raw counts carry the bridges' offsets, their drift and the sensor's faults. What leaves here is zero for an
//! untouched pad, or nothing at all while the zero is not known or a channel cannot be trusted.

pub mod fault;
pub mod filter;
pub mod lone;
pub mod stillness;
pub mod tare;

use firmware_proto::identity::Identity;
use firmware_proto::sample::Sample;
use firmware_proto::{DEFAULT_COUNT_BITS, DEFAULT_PICOVOLTS_PER_COUNT};

use crate::pipeline::health::Health;
use crate::pipeline::interruption::{Effect, Effects};
use crate::quantity::{CHANNELS, Strain};
use crate::time::StreamInstant;
use fault::ChannelFaults;
use filter::MeanFilter;
pub use tare::{Loads, PadState};
use tare::{Tare, UntouchedOffset};

/// Scale of a count, µV: told by the pad's identity, or the protocol's default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Microvolts at the bridge per count.
    pub uv_per_count: f64,
    /// Bits of a count; its range is ±2^(bits − 1).
    pub count_bits: u8,
}

impl Scale {
    /// The scale of a pad that does not tell one.
    pub fn unidentified() -> Self {
        Self::new(DEFAULT_PICOVOLTS_PER_COUNT, DEFAULT_COUNT_BITS)
    }

    /// The scale that a pad's identity states; `None` for one that the wire's specification does not allow.
    pub fn of(identity: &Identity) -> Option<Self> {
        let allowed = usize::from(identity.channels) == CHANNELS
            && (DEFAULT_COUNT_BITS..=32).contains(&identity.count_bits)
            && identity.picovolts_per_count > 0;
        allowed.then(|| Self::new(identity.picovolts_per_count, identity.count_bits))
    }

    fn new(picovolts_per_count: u32, count_bits: u8) -> Self {
        Self { uv_per_count: f64::from(picovolts_per_count) * 1e-6, count_bits }
    }
}

/// Result of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Conditioned {
    /// Strain relative to the untouched pad.
    Strain(Strain),
    /// The zero is being measured: the pad must lie untouched for a moment.
    Taring,
    /// The zero cannot be measured, as something lies on the pad.
    Loaded,
    /// The zero turned out to be a load, or was measured while something pulled: it is to be measured anew.
    Pulled,
    /// A channel reads a load of which the others know nothing: it is none, and was taken for the channel's zero.
    Stray {
        /// Its index.
        channel: usize,
    },
    /// A channel is at its limit, stuck, or without supply; nothing can be said about the contact.
    Faulty,
}

/// The conditioning stage.
#[derive(Clone, Debug)]
pub struct Signal {
    scale: Scale,
    /// Where the pad does not tell it.
    untold_scale: Scale,
    /// Those that the pad has; the others are zero.
    channels: usize,
    /// Whether 0 is the least that they tell, whatever they would read below.
    is_clamped: bool,
    faults: ChannelFaults,
    filter: MeanFilter,
    tare: Tare,
    /// Samples since the zero was measured.
    zero_age: u32,
    /// A channel did not answer while it was. Once it does, its zero is not known, nor whether the others' was a load.
    is_zero_partial: bool,
}

impl Signal {
    /// A stage that has seen nothing of a pad with so many channels, of which 0 may be the least that they tell: it measures its zero first.
    /// `untold_scale` holds unless the pad tells another, and the mean filter has seen nothing either.
    pub fn new(channels: usize, is_clamped: bool, untold_scale: Scale, filter: MeanFilter) -> Self {
        Self {
            scale: untold_scale,
            untold_scale,
            channels,
            is_clamped,
            faults: ChannelFaults::new(channels, is_clamped),
            filter,
            tare: Tare::new(channels < CHANNELS),
            zero_age: 0,
            is_zero_partial: false,
        }
    }

    /// The scale in use.
    pub const fn scale(&self) -> Scale {
        self.scale
    }

    /// Changes the filter; its window grows anew from one sample.
    pub fn set_filter(&mut self, filter: MeanFilter) {
        self.filter = filter;
    }

    /// Takes the scale of a pad that identified itself; false if it was that anyway. A different scale means a different zero,
    /// so everything else is to be forgotten.
    pub fn set_scale(&mut self, scale: Scale) -> bool {
        std::mem::replace(&mut self.scale, scale) != scale
    }

    /// Without a filter's past nothing from before a fault mixes with what comes after; without a zero it is measured again.
    pub fn interrupt(&mut self, effects: &Effects) {
        let Effects { scale, channels, filter, zero, .. } = *effects;
        if scale == Effect::Forget {
            self.scale = self.untold_scale;
        }
        match channels {
            Effect::Keep => {}
            Effect::Doubt => self.faults.forget_rest(),
            Effect::Forget => self.faults = ChannelFaults::new(self.channels, self.is_clamped),
        }
        if filter == Effect::Forget {
            self.filter.clear();
        }
        match zero {
            Effect::Keep => {}
            Effect::Doubt => self.tare.doubt(),
            Effect::Forget => self.tare = Tare::new(self.channels < CHANNELS),
        }
    }

    /// Raw channels of a sample, µV.
    pub fn raw_uv(&self, sample: &Sample) -> [f64; CHANNELS] {
        sample.counts.map(|count| f64::from(count) * self.scale.uv_per_count)
    }

    /// Conditions one sample. Where it gives no strain, the caller tells the interruption.
    pub fn condition(
        &mut self,
        at: StreamInstant,
        sample: &Sample,
        pad: &PadState,
        loads: &Loads<impl Fn(&Strain) -> f32, impl Fn(&Strain) -> f32>,
        health: &mut Health,
    ) -> Conditioned {
        let is_faulty = self.faults.check(sample, self.scale.count_bits, health);
        self.zero_age = self.zero_age.saturating_add(1);
        if is_faulty {
            self.is_zero_partial |= self.faults.is_stuck_for_more_than(self.zero_age);
            return Conditioned::Faulty;
        }
        if std::mem::take(&mut self.is_zero_partial) {
            self.tare = Tare::new(self.channels < CHANNELS);
            self.faults.forget_rest();
        }
        let uv_per_count = self.scale.uv_per_count;
        let raw_uv =
            |counts: [f64; CHANNELS]| std::array::from_fn(|k| counts[k] * uv_per_count - pad.added_uv[k]);
        let mean = self.filter.push(&sample.counts);
        let block_uv = self.tare.watch(at, &raw_uv(sample.counts.map(f64::from)));
        if self.tare.is_known() {
            if let Some(channel) =
                block_uv.filter(|_| self.channels == CHANNELS).and_then(|uv| self.tare.lone(&uv, &pad.rest))
            {
                return Conditioned::Stray { channel };
            }
            if block_uv
                .is_some_and(|uv| self.tare.is_pulled(&uv, pad, loads) || self.tare.stands(at, pad.touched))
            {
                return Conditioned::Pulled;
            }
            return Conditioned::Strain(self.tare.apply(at, &raw_uv(mean), pad.touched, &pad.rest));
        }
        if let Some(block_uv) = block_uv {
            self.measure(at, &block_uv, &pad.rest, &loads.without_stray_n);
        }
        if self.tare.is_loaded() { Conditioned::Loaded } else { Conditioned::Taring }
    }

    fn measure(
        &mut self,
        at: StreamInstant,
        block_uv: &[f64; CHANNELS],
        rest: &UntouchedOffset,
        load_n: impl Fn(&Strain) -> f32,
    ) {
        if self.tare.measure(at, block_uv, rest, load_n) {
            self.faults.forget_rest();
        }
        if self.tare.is_known() {
            self.faults.learn();
            self.zero_age = 0;
        }
    }
}
