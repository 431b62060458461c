//! The chain of a device: what its file says beside the field.

use super::chain::{Chain, ChannelChain, MechanicsChain, Reference, RigChain};
use super::memory::{MemoryChain, Play, Prony};
use crate::pad::device::Device;
use crate::pad::device::behaviour::{self, Behaviour, ModuleCrosstalk};
use crate::quantity::CHANNELS;

/// What a device's file says of its channels and of the rig that measures it.
pub(super) fn own_chain(device: &Device, weights: Vec<f64>, reference: &Reference) -> Chain {
    let Behaviour { thermal, crosstalk, module_crosstalk, hysteresis, creep, noise, sampling, rig, .. } =
        &device.behaviour;
    let modules = || device.modules.iter();
    let nominal = Chain::nominal(CHANNELS, weights.len());
    Chain {
        rig: RigChain {
            offset_mm: [rig.stage_x_mm, rig.stage_y_mm],
            rotation_deg: rig.stage_rotation_deg,
            scale: rig.stage_scale,
            tilt_deg: [rig.reference_tilt_x_deg, rig.reference_tilt_y_deg],
            gain: rig.reference_gain,
            zero_n: rig.reference_zero_n,
            lag_s: 1e-3 * rig.label_lag_ms,
        },
        memory: MemoryChain {
            plays: hysteresis.iter().flat_map(|it| plays(it, reference)).collect(),
            prony: creep.iter().flat_map(prony).collect(),
        },
        channels: ChannelChain {
            module_shares: module_crosstalk.iter().flat_map(by_axis).collect(),
            gain: modules().flat_map(|module| module.gain).collect(),
            gain_per_c: thermal.gain_per_c.to_vec(),
            shares: crosstalk.iter().map(|it| (it.channel, it.with, it.share)).collect(),
            offset: modules().flat_map(|module| module.offset_uv).collect(),
            zero_per_c: thermal.zero_uv_per_c.to_vec(),
            drift_per_h: noise.drift_uv_per_h.to_vec(),
            skew_s: sampling.skew_us.map(|us| 1e-6 * us).to_vec(),
            ..nominal.channels
        },
        mechanics: MechanicsChain { weights, ..nominal.mechanics },
    }
}

/// A play operator, channel by channel.
fn plays<'r>(it: &'r behaviour::Play, reference: &'r Reference) -> impl Iterator<Item = Play> + 'r {
    let of = |channel: usize| {
        let threshold = it.threshold_uv / reference.full_scale[channel];
        Play { channel, threshold, share: it.share, above: 1.0 }
    };
    (0..CHANNELS).filter(|channel| it.channels[*channel]).map(of)
}

/// A term of creep, channel by channel.
fn prony(it: &behaviour::Prony) -> impl Iterator<Item = Prony> + use<'_> {
    let of = |channel: usize| Prony { channel, time_s: it.time_s, share: it.share };
    (0..CHANNELS).filter(|channel| it.channels[*channel]).map(of)
}

/// A module's share, channel by channel.
fn by_axis(it: &ModuleCrosstalk) -> impl Iterator<Item = (usize, usize, f64)> + use<> {
    let ModuleCrosstalk { module, with, share } = *it;
    (0..3).map(move |axis| (3 * module + axis, 3 * with + axis, share))
}
