//! Behaviour of a pad beyond its mechanics, and errors of the rig that measures it: temperature, couplings, memory, noise,
//! sampling, the finger, the labels.
//!
//! `docs/twin.md` has the equations, in the order in which a contact passes them.

use crate::quantity::CHANNELS;
use tactpad_numeric::memory::{PlayOperator, Relaxation};

/// All of it. What a device file does not write is ideal: [`Behaviour::IDEAL`].
#[derive(Clone, Debug, PartialEq)]
pub struct Behaviour {
    /// How zero and gain follow the temperature.
    pub thermal: Thermal,
    /// Signals that leak into other channels, electrically: after the gains.
    pub crosstalk: Vec<Crosstalk>,
    /// Modules that strain others, mechanically: before everything else.
    pub module_crosstalk: Vec<ModuleCrosstalk>,
    /// Hysteresis: the sum of play operators.
    pub hysteresis: Vec<OnChannels<PlayOperator>>,
    /// Slow strain: the sum of relaxations.
    pub creep: Vec<OnChannels<Relaxation>>,
    /// Loss of strain with the cycles of load.
    pub ageing: Ageing,
    /// Random noise and drift.
    pub noise: Noise,
    /// Pickup from the mains.
    pub mains: Mains,
    /// Range, step and instants of the conversion.
    pub sampling: Sampling,
    /// How still a finger, or an indenter, stays.
    pub finger: Finger,
    /// Errors of the measuring rig.
    pub rig: Rig,
}

/// Zero and gain by temperature, for each channel:
/// zero = (`zero_uv_per_c` + `zero_uv_per_c2` ΔT) ΔT and gain = 1 + `gain_per_c` ΔT with ΔT = T − `reference_c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermal {
    /// Where zero and gain are those of the modules' tables.
    pub reference_c: f64,
    /// Slope of the zero at the reference.
    pub zero_uv_per_c: [f64; CHANNELS],
    /// Curvature of the zero, µV/K².
    pub zero_uv_per_c2: [f64; CHANNELS],
    /// Relative change of gain.
    pub gain_per_c: [f64; CHANNELS],
    /// Standard deviation over the channels of `zero_uv_per_c` from pad to pad.
    pub zero_scatter_uv_per_c: f64,
    /// Standard deviation over the channels of `gain_per_c` from pad to pad.
    pub gain_scatter_per_c: f64,
}

/// A share of one channel's signal that appears in another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crosstalk {
    /// Index of the receiving channel.
    pub channel: usize,
    /// Index of the source.
    pub with: usize,
    /// Of the source's microvolts.
    pub share: f64,
}

/// A share of one module's three strains that appears in another one's, axis by axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModuleCrosstalk {
    /// Index of the receiving module.
    pub module: usize,
    /// Index of the source.
    pub with: usize,
    /// Of the source's microvolts.
    pub share: f64,
}

/// A law of the strain that some channels have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnChannels<T> {
    /// Which channels have it.
    pub channels: [bool; CHANNELS],
    /// In microvolts where it has a unit of strain.
    pub law: T,
}

impl<T> OnChannels<T> {
    /// Of all channels.
    pub const fn all(law: T) -> Self {
        Self { channels: [true; CHANNELS], law }
    }
}

/// The strain's loss after n cycles: share · ln(1 + n/`onset_cycles`) / ln(1 + `cycles`/`onset_cycles`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ageing {
    /// Of the strain, lost after `cycles`.
    pub share: [f64; CHANNELS],
    /// Where the loss is `share`.
    pub cycles: f64,
    /// Where the loss begins to slow down.
    pub onset_cycles: f64,
}

impl Ageing {
    /// The part of `share` that is lost after n cycles: ln(1 + n/n₀)/ln(1 + N/n₀).
    pub fn part(&self, cycles: f64) -> f64 {
        libm::log1p(cycles / self.onset_cycles) / libm::log1p(self.cycles / self.onset_cycles)
    }
}

/// Random parts of each channel, and drift of its zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation of each sample's own error.
    pub additive_uv: [f64; CHANNELS],
    /// Standard deviation of the signal's relative error, which lasts some `share_time_s`.
    pub share: [f64; CHANNELS],
    /// Correlation time of the relative error; zero: each sample has its own.
    pub share_time_s: f64,
    /// Even drift of the zero.
    pub drift_uv_per_h: [f64; CHANNELS],
    /// Random walk of the zero: standard deviation after an hour.
    pub walk_uv: [f64; CHANNELS],
}

/// A sine of the mains, in phase in all channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mains {
    /// Its amplitude in each channel; negative turns the phase.
    pub amplitude_uv: [f64; CHANNELS],
    /// Its frequency.
    pub frequency_hz: f64,
}

/// Conversion of the signals to numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Largest magnitude that is converted; larger ones stop there.
    pub range_uv: f64,
    /// One count. Zero: no steps.
    pub step_uv: f64,
    /// How late each channel is sampled, as a delay of its signal.
    pub skew_us: [f64; CHANNELS],
}

/// Finger that holds the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finger {
    /// Standard deviation of the place along x and along y while it is held.
    pub wander_mm: f64,
    /// Correlation time of the place.
    pub wander_time_s: f64,
    /// Standard deviation of the force's relative error while it is held.
    pub tremor_share: f64,
    /// Correlation time of the force.
    pub tremor_time_s: f64,
}

/// The measuring rig: what it writes down beside what is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// Turn of the reference sensor about x, right-handed: it turns the true force into the written one.
    pub reference_tilt_x_deg: f64,
    /// Turn of the reference sensor about y.
    pub reference_tilt_y_deg: f64,
    /// Written force over true force.
    pub reference_gain: f64,
    /// Written minus true force: fx, fy, fz.
    pub reference_zero_n: [f64; 3],
    /// Standard deviation of each written force.
    pub reference_noise_n: f64,
    /// True minus written place along x.
    pub stage_x_mm: f64,
    /// True minus written place along y.
    pub stage_y_mm: f64,
    /// Turn of the stage about the pad's axis, counter-clockwise: from the written to the true place.
    pub stage_rotation_deg: f64,
    /// True over written distance from the axis.
    pub stage_scale: f64,
    /// Standard deviation of the true place along x and along y, anew for each approach.
    pub stage_scatter_mm: f64,
    /// Standard deviation of the true force's relative error, anew for each approach.
    pub force_scatter_share: f64,
    /// How late the labels are.
    pub label_lag_ms: f64,
}

impl Behaviour {
    /// A pad and a rig without faults, at 25 °C.
    pub const IDEAL: Self = Self {
        thermal: Thermal {
            reference_c: 25.0,
            zero_uv_per_c: [0.0; CHANNELS],
            zero_uv_per_c2: [0.0; CHANNELS],
            gain_per_c: [0.0; CHANNELS],
            zero_scatter_uv_per_c: 0.0,
            gain_scatter_per_c: 0.0,
        },
        crosstalk: Vec::new(),
        module_crosstalk: Vec::new(),
        hysteresis: Vec::new(),
        creep: Vec::new(),
        ageing: Ageing { share: [0.0; CHANNELS], cycles: 50_000.0, onset_cycles: 500.0 },
        noise: Noise {
            additive_uv: [0.0; CHANNELS],
            share: [0.0; CHANNELS],
            share_time_s: 0.0,
            drift_uv_per_h: [0.0; CHANNELS],
            walk_uv: [0.0; CHANNELS],
        },
        mains: Mains { amplitude_uv: [0.0; CHANNELS], frequency_hz: 50.0 },
        sampling: Sampling { range_uv: 1e6, step_uv: 0.0, skew_us: [0.0; CHANNELS] },
        finger: Finger { wander_mm: 0.0, wander_time_s: 1.0, tremor_share: 0.0, tremor_time_s: 1.0 },
        rig: Rig {
            reference_tilt_x_deg: 0.0,
            reference_tilt_y_deg: 0.0,
            reference_gain: 1.0,
            reference_zero_n: [0.0; 3],
            reference_noise_n: 0.0,
            stage_x_mm: 0.0,
            stage_y_mm: 0.0,
            stage_rotation_deg: 0.0,
            stage_scale: 1.0,
            stage_scatter_mm: 0.0,
            force_scatter_share: 0.0,
            label_lag_ms: 0.0,
        },
    };
}
