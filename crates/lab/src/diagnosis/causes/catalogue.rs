//! The table of causes. To add one, add its row.

use super::cause::{Cause, ChainStage, Need, Places};
use super::memory::{THRESHOLDS, TIMES_S, plays, terms};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::memory::ChannelFriction;
use crate::diagnosis::model::setting::Setting;
use crate::effect::Effect;
use tactpad_inference::hypothesis::{Coordinate, Parameter, with_shapes};
use tactpad_numeric::memory::{PlayOperator, Relaxation};

/// Height of the loop of a full stroke, as a share of full scale, and its course. What a height is a share of is the model's full
/// scale, which is no better known than to 0.8 %. Nobody writes from how far above a static load came, so that is fitted, too.
const HYSTERESIS: [Parameter; 3 + THRESHOLDS.len()] = with_shapes(
    Parameter::additive("share_of_full_scale", [0.0, 0.5], 1e-3),
    [
        ("part_0", 1.0),
        ("part_1", 1.0),
        ("part_2", 1.0),
        ("part_3", 1.0),
        ("part_4", 1.0),
        ("above", 1.0),
        ("full_scale", 0.008),
    ],
);

/// Creep after 20 s, as a share of the load, and its course.
const CREEP: [Parameter; 1 + TIMES_S.len()] = with_shapes(
    Parameter::additive("share_at_20s", [-0.5, 0.5], 1e-3),
    [("part_0", 1.0), ("part_1", 1.0), ("part_2", 1.0), ("part_3", 1.0), ("part_4", 1.0)],
);

/// Deviation of creep after 20 s in any pad, whether a plan tells it or not: adhesive and polyimide.
const CREEP_OF_ANY_PAD: f64 = 0.01;

/// Larger patches would reach over the modules.
const RADIUS_MAX_MM: f64 = 15.0;

/// All causes, in the order of reports.
pub(crate) static CATALOGUE: [Cause; 29] = [
    // A channel's sensitivity differs: gauge factor, glue, amplifier. Measured over modelled signal.
    Cause::new(
        Effect::ChannelGain,
        ChainStage::Channels,
        Places::Channels,
        |_| vec![Parameter::factor("gain", [0.05, 20.0])],
        |target, values, _, chain| {
            if let Target::Channel(channel) = *target {
                chain.channels.gain[channel] *= values[0];
            }
        },
    )
    .individual(),
    // A channel's zero is not zero: the bridge is out of balance.
    Cause::new(
        Effect::ChannelOffset,
        ChainStage::Channels,
        Places::Channels,
        |_| vec![Parameter::additive("offset_uv", [-1e6, 1e6], 1.0)],
        |target, values, _, chain| each_channel(target, &mut chain.channels.offset, values[0]),
    ),
    // A part of one channel's signal, after its gain, appears in another: wires, multiplexer.
    Cause::new(
        Effect::ChannelCrosstalk,
        ChainStage::Channels,
        Places::ChannelPairs,
        |_| vec![Parameter::additive("share", [-0.9, 0.9], 1e-3)],
        |target, values, _, chain| {
            if let Target::Channels { into, from } = *target {
                chain.channels.shares.push((into, from, values[0]));
            }
        },
    ),
    // A channel bends: at full scale, its largest modelled reading, it deviates by this share from what its slope at rest promises.
    Cause::new(
        Effect::GaugeNonlinearity,
        ChainStage::Channels,
        Places::Channels,
        |_| vec![Parameter::additive("second_order_percent_fs", [-50.0, 50.0], 0.1)],
        |target, values, _, chain| each_channel(target, &mut chain.channels.second_order, 0.01 * values[0]),
    ),
    // A channel is converted later than the others, or earlier.
    Cause::new(
        Effect::ChannelSkew,
        ChainStage::Channels,
        Places::Channels,
        |_| vec![Parameter::additive("skew_us", [-1e6, 1e6], 500.0)],
        |target, values, _, chain| each_channel(target, &mut chain.skew_s, 1e-6 * values[0]),
    )
    .with(Need::Series),
    // A module stands elsewhere under the plate.
    Cause::new(
        Effect::ModuleDisplaced,
        ChainStage::Mechanics,
        Places::Modules,
        |_| {
            let axis = |name| Parameter::additive(name, [-5.0, 5.0], 1e-2);
            vec![axis("radial_mm"), axis("tangential_mm")]
        },
        |target, values, setting, chain| {
            add_to_module(target, &["radial_mm", "tangential_mm"], values, setting, chain);
        },
    ),
    // A module is turned about its own axis, counter-clockwise seen from above.
    Cause::new(
        Effect::ModuleRotated,
        ChainStage::Mechanics,
        Places::Modules,
        |_| vec![Parameter::additive("deg", [-30.0, 30.0], 1e-2)],
        |target, values, setting, chain| {
            add_to_module(target, &["rotation_deg"], values, setting, chain);
        },
    ),
    // A module stands askew under the plate: turns about its tangential and its radial axis, right-handed.
    Cause::new(
        Effect::ModuleTilted,
        ChainStage::Mechanics,
        Places::Modules,
        |_| {
            let axis = |name| Parameter::additive(name, [-10.0, 10.0], 1e-2);
            vec![axis("tangential_deg"), axis("radial_deg")]
        },
        |target, values, setting, chain| {
            add_to_module(target, &["tilt_tangential_deg", "tilt_radial_deg"], values, setting, chain);
        },
    ),
    // A module gives way more, or less: the modulus of its frame differs.
    Cause::new(
        Effect::ModuleStiffness,
        ChainStage::Mechanics,
        Places::Modules,
        |_| vec![Parameter::factor("factor", [0.02, 10.0])],
        |target, values, setting, chain| {
            if let Target::Module(module) = *target {
                chain.mechanics.stiffen(setting, &format!("module.{module}.frame_e_factor"), values[0]);
            }
        },
    ),
    // The bond between a module's post and the plate has come off, from one side inwards, over a part of its area.
    Cause::new(
        Effect::ModuleDebonded,
        ChainStage::Mechanics,
        Places::ModuleSides,
        |_| vec![Parameter::additive("area_share", [0.0, 0.8], 1e-3)],
        |target, values, setting, chain| {
            if let Target::ModuleSide(module, side) = *target {
                chain.mechanics.debond(setting, module, side, values[0]);
            }
        },
    ),
    // The frame of a module is missing on one side, over a part of its area.
    Cause::new(
        Effect::ModuleFrameOpen,
        ChainStage::Mechanics,
        Places::ModuleSides,
        |_| vec![Parameter::additive("area_share", [0.0, 0.5], 1e-3)],
        |target, values, setting, chain| {
            if let Target::ModuleSide(module, side) = *target {
                chain.mechanics.open(setting, module, side, values[0]);
            }
        },
    ),
    // A module strains another one, axis by axis, by a share of its three strains: through the base, before the channels.
    Cause::new(
        Effect::ModuleCrosstalk,
        ChainStage::Coupling,
        Places::ModulePairs,
        |_| vec![Parameter::additive("share", [-0.9, 0.9], 1e-3)],
        |target, values, _, chain| {
            if let Target::Modules { into, from } = *target {
                let axes = (0..3).map(|axis| (3 * into + axis, 3 * from + axis, values[0]));
                chain.channels.module_shares.extend(axes);
            }
        },
    ),
    // The plate bends less, or more: another thickness, another modulus. Factor of its bending stiffness.
    Cause::new(
        Effect::PlateStiffness,
        ChainStage::Mechanics,
        Places::PadWithField,
        |_| vec![Parameter::factor("factor", [0.05, 20.0])],
        |_, values, setting, chain| chain.mechanics.stiffen(setting, "material.plate.e_mpa", values[0]),
    ),
    // All channels have one gain: the excitation, or the converter's reference, differs.
    Cause::new(
        Effect::ExcitationGain,
        ChainStage::Channels,
        Places::Pad,
        |_| vec![Parameter::factor("gain", [0.05, 20.0])],
        |_, values, _, chain| chain.channels.gain.iter_mut().for_each(|gain| *gain *= values[0]),
    ),
    // Zeros follow the temperature, of one channel or of all alike.
    Cause::new(
        Effect::ThermalZero,
        ChainStage::Channels,
        Places::PadAndChannels,
        |_| vec![Parameter::additive("uv_per_c", [-2e3, 2e3], 0.1)],
        |target, values, _, chain| each_channel(target, &mut chain.channels.zero_per_c, values[0]),
    )
    .with(Need::Temperatures)
    .individual(),
    // Gains follow the temperature: moduli of polymers, gauge factor.
    Cause::new(
        Effect::ThermalGain,
        ChainStage::Channels,
        Places::PadAndChannels,
        |_| vec![Parameter::additive("per_c", [-0.05, 0.05], 1e-4)],
        |target, values, _, chain| each_channel(target, &mut chain.channels.gain_per_c, values[0]),
    )
    .with(Need::Temperatures)
    .individual(),
    // Zeros drift evenly in time.
    Cause::new(
        Effect::ZeroDrift,
        ChainStage::Channels,
        Places::PadAndChannels,
        |_| vec![Parameter::additive("uv_per_h", [-1e5, 1e5], 1.0)],
        |target, values, _, chain| each_channel(target, &mut chain.channels.drift_per_h, values[0]),
    )
    .with(Need::Time)
    .individual(),
    // Friction between the pad's parts: on the way down a channel reads more than on the way up.
    Cause::new(
        Effect::Hysteresis,
        ChainStage::Mechanics,
        Places::PadAndChannelsBothWays,
        |_| HYSTERESIS.to_vec(),
        |target, values, setting, chain| {
            let above = values[1 + THRESHOLDS.len()];
            for channel in channels_of(target, setting) {
                let play = |[threshold, share]: [f64; 2]| ChannelFriction {
                    channel,
                    play: PlayOperator { threshold, share },
                    above,
                };
                chain.memory.plays.extend(plays(values).map(play));
            }
        },
    )
    .individual(),
    // Glue and film give way slowly: a load that is held reads more and more, or less and less.
    Cause::new(
        Effect::Creep,
        ChainStage::Mechanics,
        Places::PadAndChannelsHeld,
        |_| CREEP.to_vec(),
        |target, values, setting, chain| {
            for channel in channels_of(target, setting) {
                let term = |[time_s, share]: [f64; 2]| (channel, Relaxation { time_s, share });
                chain.memory.relaxations.extend(terms(values).map(term));
            }
        },
    )
    .with(Need::Dwells)
    .individual()
    .prior_deviation(CREEP_OF_ANY_PAD),
    // Strains become smaller with the cycles of load: glue and film tire. Loss at the end of the measurement.
    Cause::new(
        Effect::Ageing,
        ChainStage::Channels,
        Places::PadAndChannels,
        |_| vec![Parameter::additive("share_at_end", [-0.9, 0.9], 1e-3)],
        |target, values, _, chain| each_channel(target, &mut chain.channels.loss, values[0]),
    )
    .with(Need::Cycles)
    .individual(),
    // The force sensor of the rig stands askew: turns about x and y, right-handed, from true to written force.
    Cause::new(
        Effect::ReferenceTilt,
        ChainStage::Contact,
        Places::Rig,
        |_| ["x_deg", "y_deg"].map(|name| Parameter::additive(name, [-45.0, 45.0], 0.01)).to_vec(),
        |_, values, _, chain| add(&mut chain.rig.tilt_deg, values),
    ),
    // The force sensor of the rig has a wrong gain. Written over true force.
    Cause::new(
        Effect::ReferenceGain,
        ChainStage::Contact,
        Places::Rig,
        |_| vec![Parameter::factor("gain", [0.1, 10.0])],
        |_, values, _, chain| chain.rig.gain *= values[0],
    ),
    // The force sensor of the rig has a zero of its own. Written minus true force.
    Cause::new(
        Effect::ReferenceZero,
        ChainStage::Contact,
        Places::Rig,
        |_| ["fx_n", "fy_n", "fz_n"].map(|name| Parameter::additive(name, [-20.0, 20.0], 1e-3)).to_vec(),
        |_, values, _, chain| add(&mut chain.rig.zero_n, values),
    ),
    // The stage does not stand where it says: its zero is not the middle of the pad. True minus written place.
    Cause::new(
        Effect::StageOffset,
        ChainStage::Contact,
        Places::Rig,
        |_| ["x_mm", "y_mm"].map(|name| Parameter::additive(name, [-15.0, 15.0], 1e-2)).to_vec(),
        |_, values, _, chain| add(&mut chain.rig.offset_mm, values),
    ),
    // The stage is turned against the pad. From written to true place, counter-clockwise.
    Cause::new(
        Effect::StageRotation,
        ChainStage::Contact,
        Places::Rig,
        |_| vec![Parameter::additive("deg", [-180.0, 180.0], 0.01)],
        |_, values, _, chain| chain.rig.rotation_deg += values[0],
    ),
    // The stage moves farther, or less far, than it says. True over written distance.
    Cause::new(
        Effect::StageScale,
        ChainStage::Contact,
        Places::Rig,
        |_| vec![Parameter::factor("scale", [0.2, 5.0])],
        |_, values, _, chain| chain.rig.scale *= values[0],
    ),
    // Forces act above, or below, the plate's surface: an indenter with a cap, a hinge in the reference.
    Cause::new(
        Effect::ContactHeight,
        ChainStage::Mechanics,
        Places::Rig,
        |_| vec![Parameter::additive("mm", [-20.0, 50.0], 1e-2)],
        |_, values, _, chain| chain.mechanics.height_mm = values[0],
    ),
    // The load lies evenly on a disc of another radius than the model's: an indenter of another size, a soft finger.
    Cause::new(
        Effect::ContactSize,
        ChainStage::Mechanics,
        Places::Rig,
        |setting| {
            let none = setting.patch_radius_mm;
            vec![Parameter {
                name: "radius_mm",
                none,
                range: [1e-3, RADIUS_MAX_MM.max(2.0 * none)],
                step: 0.05 * none * none,
                coordinate: Coordinate::Square,
                shape: None,
            }]
        },
        // R² − R₀².
        |_, values, setting, chain| {
            chain.mechanics.patch_mm2 =
                values[0] * values[0] - setting.patch_radius_mm * setting.patch_radius_mm;
        },
    ),
    // The clock of what was written down is behind that of the channels, or ahead of it: places and forces are written too late.
    Cause::new(
        Effect::TimeLag,
        ChainStage::Contact,
        Places::Rig,
        |_| vec![Parameter::additive("ms", [-2000.0, 2000.0], 1.0)],
        |_, values, _, chain| chain.rig.lag_s += 1e-3 * values[0],
    )
    .with(Need::Series),
];

/// Adds to a number of each channel: of one, or of all for [`Target::Pad`].
fn each_channel(target: &Target, numbers: &mut [f64], value: f64) {
    match *target {
        Target::Channel(channel) => numbers[channel] += value,
        _ => numbers.iter_mut().for_each(|number| *number += value),
    }
}

/// The channels of a target: one, or all.
fn channels_of(target: &Target, setting: &Setting) -> std::ops::Range<usize> {
    match *target {
        Target::Channel(channel) => channel..channel + 1,
        _ => 0..setting.channels,
    }
}

/// Adds to these numbers of the device's module.
fn add_to_module(target: &Target, keys: &[&str], values: &[f64], setting: &Setting, chain: &mut Chain) {
    if let Target::Module(module) = *target {
        for (key, value) in keys.iter().zip(values) {
            chain.mechanics.add(setting, &format!("module.{module}.{key}"), *value);
        }
    }
}

fn add(numbers: &mut [f64], values: &[f64]) {
    numbers.iter_mut().zip(values).for_each(|(number, value)| *number += value);
}
