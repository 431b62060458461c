//! The chain of a device: what its file says beside the field.

use crate::diagnosis::model::chain::{Chain, MechanicsChain, Reference};
use crate::diagnosis::model::memory::{ChannelFriction, MemoryChain};
use crate::rig::errors::RigErrors;
use tactpad_core::pad::channels::ChannelChain;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::device::behaviour::{Behaviour, OnChannels};
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::memory::{PlayOperator, Relaxation};

/// What a device's file says of its channels and of the rig that measures it.
pub(crate) fn own_chain(device: &Device, weights: Vec<f64>, reference: &Reference) -> Chain {
    let Behaviour { hysteresis, creep, ageing, sampling, rig, .. } = &device.behaviour;
    let mut channels = ChannelChain::of(device);
    channels.full_scale.clone_from(&reference.full_scale);
    // What is lost by the recording's last cycle.
    channels.loss.iter_mut().for_each(|share| *share *= ageing.part(reference.cycle));
    let nominal = Chain::nominal(channels, weights.len());
    Chain {
        rig: RigErrors::of(rig),
        memory: MemoryChain {
            plays: hysteresis.iter().flat_map(|it| plays(it, reference)).collect(),
            relaxations: creep.iter().flat_map(relaxations).collect(),
        },
        skew_s: sampling.skew_us.map(|us| 1e-6 * us).to_vec(),
        mechanics: MechanicsChain { weights, ..nominal.mechanics },
        ..nominal
    }
}

/// A play operator, channel by channel.
fn plays<'r>(
    it: &'r OnChannels<PlayOperator>,
    reference: &'r Reference,
) -> impl Iterator<Item = ChannelFriction> + 'r {
    let of = |channel: usize| {
        let threshold = it.law.threshold / reference.full_scale[channel];
        ChannelFriction { channel, play: PlayOperator { threshold, ..it.law }, above: 1.0 }
    };
    (0..CHANNELS).filter(|channel| it.channels[*channel]).map(of)
}

/// A term of creep, channel by channel.
fn relaxations(it: &OnChannels<Relaxation>) -> impl Iterator<Item = (usize, Relaxation)> + use<> {
    let OnChannels { channels, law } = *it;
    (0..CHANNELS).filter(move |channel| channels[*channel]).map(move |channel| (channel, law))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_has_lost_its_share_at_its_number_of_cycles() {
        let mut device = Device::nominal();
        device.behaviour.ageing.share[4] = 0.2;
        let reference = |cycle: f64| Reference {
            temp_c: 25.0,
            t_s: 0.0,
            cycle,
            full_scale: vec![1.0; CHANNELS],
            sizes: vec![1.0; CHANNELS],
        };
        let loss = |cycle: f64| own_chain(&device, Vec::new(), &reference(cycle)).channels.loss;
        let whole = device.behaviour.ageing.cycles;
        assert!((loss(whole)[4] - 0.2).abs() < 1e-12 && loss(whole)[3] == 0.0);
        assert!((0.05..0.2).contains(&loss(0.1 * whole)[4]), "{}", loss(0.1 * whole)[4]);
        assert_eq!(loss(0.0)[4], 0.0);
    }
}
