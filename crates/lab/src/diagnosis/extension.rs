//! The device that a diagnosis makes of another: with the named causes in it.

use super::causes::memory::{plays, terms};
use super::report::Diagnosis;
use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::mechanics::side_share;
use crate::effect::{DeviceChange, Effect};
use tactpad_core::pad::device::behaviour::{Crosstalk, ModuleCrosstalk, OnChannels};
use tactpad_core::pad::device::parameter::Parameter;
use tactpad_core::pad::device::{Device, Module, Side};
use tactpad_core::quantity::{CHANNEL_NAMES, CHANNELS};
use tactpad_numeric::memory::{PlayOperator, Relaxation};

/// A device file opens the side of a frame or does not: from this part of the side on, open is nearer.
const NEARER_OPEN: f64 = 0.5;

/// `device` with the named findings, and the effects among them that a device file cannot hold. Confounded ones are left out.
///
/// `last_cycle` is the measurement's last: what `ageing` says of the end is said of that.
pub fn extended(device: &Device, diagnosis: &Diagnosis, last_cycle: Option<f64>) -> (Device, Vec<Effect>) {
    let (mut device, mut left_out) = (device.clone(), Vec::new());
    let circumstances = Circumstances { last_cycle, full_scale: &diagnosis.full_scale };
    for finding in diagnosis.findings.iter().filter(|finding| finding.confounded_with.is_empty()) {
        let asked = finding.parameters.iter().map(|it| (it.name, it.value));
        let numbers: Vec<_> = asked.chain(finding.shapes.iter().copied()).collect();
        match with(&device, finding.effect, finding.target, &numbers, &circumstances) {
            Some(changed) => device = changed,
            None => left_out.push(finding.effect),
        }
    }
    left_out.sort_unstable_by_key(|effect: &Effect| effect.name());
    left_out.dedup();
    (device, left_out)
}

/// What numbers are said of.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Circumstances<'m> {
    /// The measurement's last cycle of load.
    last_cycle: Option<f64>,
    /// Each channel's full scale.
    full_scale: &'m [f64],
}

/// Whether its file would be taken: all numbers within their ranges, all parts in their places.
fn reads_back(device: &Device) -> bool {
    Device::from_toml(&device.to_toml()).0.as_ref() == Some(device)
}

/// The device with one cause more, of these numbers; none where it has no number for it, or none within its range.
pub(super) fn with(
    device: &Device,
    effect: Effect,
    target: Target,
    numbers: &[(&str, f64)],
    circumstances: &Circumstances<'_>,
) -> Option<Device> {
    let mut device = device.clone();
    let (_, first) = *numbers.first()?;
    match (effect, target) {
        (Effect::ChannelCrosstalk, Target::Channels { into, from }) => {
            leak(&mut device.behaviour.crosstalk, Crosstalk { channel: into, with: from, share: first });
        }
        (Effect::ModuleCrosstalk, Target::Modules { into, from }) => {
            leak(
                &mut device.behaviour.module_crosstalk,
                ModuleCrosstalk { module: into, with: from, share: first },
            );
        }
        (Effect::ModuleFrameOpen, Target::ModuleSide(module, side)) => {
            open(&mut device, module, side, first)?;
        }
        (Effect::ModuleDebonded, Target::ModuleSide(module, side)) => {
            debond(&mut device, module, side, first)?;
        }
        (Effect::Hysteresis | Effect::Creep, _) => {
            remember(&mut device, effect, target, numbers, circumstances)?;
        }
        _ => set_numbers(&mut device, effect, target, numbers, circumstances.last_cycle)?,
    }
    if effect == Effect::ContactSize {
        // A wider finger leaves the plate earlier.
        let contact = &mut device.contact;
        let centre_mm = device.plate.radius_mm() - contact.patch_radius_mm;
        contact.max_centre_radius_mm = contact.max_centre_radius_mm.min(centre_mm);
    }
    Some(device).filter(reads_back)
}

/// A share of a source that appears in a receiver.
trait Leak {
    fn ends(&self) -> [usize; 2];
    fn share_mut(&mut self) -> &mut f64;
}

impl Leak for Crosstalk {
    fn ends(&self) -> [usize; 2] {
        [self.channel, self.with]
    }

    fn share_mut(&mut self) -> &mut f64 {
        &mut self.share
    }
}

impl Leak for ModuleCrosstalk {
    fn ends(&self) -> [usize; 2] {
        [self.module, self.with]
    }

    fn share_mut(&mut self) -> &mut f64 {
        &mut self.share
    }
}

/// Adds to what is there between the same two.
fn leak<T: Leak>(leaks: &mut Vec<T>, mut more: T) {
    match leaks.iter_mut().find(|leak| leak.ends() == more.ends()) {
        Some(leak) => *leak.share_mut() += *more.share_mut(),
        None => leaks.push(more),
    }
}

/// A module's frame is missing on one side at most, and there as a whole.
fn open(device: &mut Device, module: usize, side: Side, share: f64) -> Option<()> {
    let part = share / side_share(device, side);
    let frame_open = &mut device.modules.get_mut(module)?.frame_open;
    let is_held = part >= NEARER_OPEN && frame_open.is_none_or(|open| open == side);
    is_held.then(|| *frame_open = Some(side))
}

/// A module's bond has come off from one side at most.
fn debond(device: &mut Device, module: usize, side: Side, share: f64) -> Option<()> {
    let module = device.modules.get_mut(module)?;
    let (from, before) = module.debonded().unwrap_or((side, 0.0));
    (from == side)
        .then(|| *module = Module { debonded_side: Some(side), debonded_share: before + share, ..*module })
}

/// Adds play operators, or terms of creep, in each channel of the target.
fn remember(
    device: &mut Device,
    effect: Effect,
    target: Target,
    numbers: &[(&str, f64)],
    circumstances: &Circumstances<'_>,
) -> Option<()> {
    let values: Vec<f64> = numbers.iter().map(|(_, value)| *value).collect();
    let channels = match target {
        Target::Channel(channel) => channel..channel + 1,
        _ => 0..CHANNELS,
    };
    for channel in channels {
        let own = std::array::from_fn(|other| other == channel);
        if effect == Effect::Creep {
            let term =
                |[time_s, share]: [f64; 2]| OnChannels { channels: own, law: Relaxation { time_s, share } };
            device.behaviour.creep.extend(terms(&values).map(term));
        } else {
            let full_scale_uv = circumstances.full_scale.get(channel)?;
            let play = |[threshold, share]: [f64; 2]| OnChannels {
                channels: own,
                law: PlayOperator { threshold: threshold * full_scale_uv, share },
            };
            device.behaviour.hysteresis.extend(plays(&values).map(play));
        }
    }
    Some(())
}

fn set_numbers(
    device: &mut Device,
    effect: Effect,
    target: Target,
    numbers: &[(&str, f64)],
    last_cycle: Option<f64>,
) -> Option<()> {
    for (name, value) in numbers {
        let (_, number, change) = effect.device_numbers().iter().find(|(number, ..)| number == name)?;
        let mut value = *value;
        if effect == Effect::Ageing {
            // The device file says what is lost after its own number of cycles.
            value /= Some(device.behaviour.ageing.part(last_cycle?)).filter(|part| *part > 0.0)?;
        }
        for name in names(number, target) {
            let parameter: Parameter = name.parse().ok()?;
            let own = parameter.get(device);
            let changed = match change {
                DeviceChange::Add => own + value,
                DeviceChange::Multiply => own * value,
                DeviceChange::Replace => value,
            };
            parameter.set(device, changed);
        }
    }
    Some(())
}

/// The device's numbers of this name; where a channel's is wanted and the target is the whole pad, those of all channels.
fn names(number: &str, target: Target) -> Vec<String> {
    let of_channel = |channel: usize| {
        let name = CHANNEL_NAMES.get(channel).copied().unwrap_or_default();
        let module = number.replace("{module}", &(channel / 3).to_string());
        module.replace("{axis}", name.get(2..).unwrap_or_default()).replace("{channel}", name)
    };
    match target {
        Target::Channel(channel) => vec![of_channel(channel)],
        Target::Module(module) => vec![number.replace("{module}", &module.to_string())],
        _ if number.contains('{') => (0..CHANNELS).map(of_channel).collect(),
        _ => vec![number.to_owned()],
    }
}

#[cfg(test)]
mod tests {
    use super::super::report::{Estimate, Finding};
    use super::*;
    use tactpad_core::pad::device::behaviour::Behaviour;

    fn finding(effect: Effect, target: Target, parameters: &[(&'static str, f64)]) -> Finding {
        let estimate = |(name, value): &(&'static str, f64)| Estimate {
            name,
            value: *value,
            interval95: [value - 0.1, value + 0.1],
        };
        Finding { parameters: parameters.iter().map(estimate).collect(), ..Finding::of(effect, target) }
    }

    fn diagnosis(findings: Vec<Finding>) -> Diagnosis {
        Diagnosis::of(CHANNEL_NAMES.map(str::to_owned).to_vec(), vec![5000.0; CHANNELS], findings)
    }

    fn near(value: f64, wanted: f64) {
        assert!((value - wanted).abs() < 1e-9 * wanted.abs().max(1.0), "{value} instead of {wanted}");
    }

    fn mechanical() -> Vec<Finding> {
        vec![
            finding(
                Effect::ModuleDisplaced,
                Target::Module(0),
                &[("radial_mm", -0.7), ("tangential_mm", 0.9)],
            ),
            finding(Effect::ModuleRotated, Target::Module(1), &[("deg", -5.0)]),
            finding(
                Effect::ModuleTilted,
                Target::Module(1),
                &[("tangential_deg", 0.2), ("radial_deg", -0.3)],
            ),
            finding(Effect::ModuleStiffness, Target::Module(2), &[("factor", 0.6)]),
            finding(Effect::ModuleFrameOpen, Target::ModuleSide(0, Side::MinusX), &[("area_share", 0.18)]),
            finding(Effect::ModuleDebonded, Target::ModuleSide(2, Side::PlusY), &[("area_share", 0.3)]),
            finding(Effect::PlateStiffness, Target::Pad, &[("factor", 1.5)]),
            finding(Effect::ContactSize, Target::Rig, &[("radius_mm", 2.5)]),
        ]
    }

    #[test]
    fn mechanics_read_back() {
        let nominal = Device::nominal();
        let (device, left_out) = extended(&nominal, &diagnosis(mechanical()), None);
        assert_eq!(left_out, []);
        assert_eq!(Device::from_toml(&device.to_toml()), (Some(device.clone()), vec![]));
        let wanted = [
            Module { radial_mm: -0.7, tangential_mm: 0.9, frame_open: Some(Side::MinusX), ..Module::NOMINAL },
            Module { rotation_deg: -5.0, tilt_tangential_deg: 0.2, tilt_radial_deg: -0.3, ..Module::NOMINAL },
            Module {
                frame_e_factor: 0.6,
                debonded_side: Some(Side::PlusY),
                debonded_share: 0.3,
                ..Module::NOMINAL
            },
        ];
        assert_eq!(device.modules, wanted);
        near(device.material.plate.e_mpa, 1.5 * nominal.material.plate.e_mpa);
        assert_eq!([device.contact.patch_radius_mm, device.contact.max_centre_radius_mm], [2.5, 27.5]);
    }

    #[test]
    fn channels_and_rig_are_laid_over_what_the_device_has() {
        let mut device = Device::nominal();
        device.modules[1].gain = [1.0, 1.0, 1.1];
        device.behaviour.crosstalk.push(Crosstalk { channel: 0, with: 4, share: 0.02 });
        let findings = vec![
            finding(Effect::ChannelGain, Target::Channel(5), &[("gain", 1.2)]),
            finding(Effect::ExcitationGain, Target::Pad, &[("gain", 0.9)]),
            finding(Effect::ChannelOffset, Target::Channel(0), &[("offset_uv", 120.0)]),
            finding(Effect::ChannelCrosstalk, Target::Channels { into: 0, from: 4 }, &[("share", 0.05)]),
            finding(Effect::ModuleCrosstalk, Target::Modules { into: 2, from: 1 }, &[("share", 0.04)]),
            finding(Effect::ThermalZero, Target::Pad, &[("uv_per_c", 3.0)]),
            finding(Effect::ZeroDrift, Target::Channel(8), &[("uv_per_h", 40.0)]),
            finding(Effect::Ageing, Target::Channel(3), &[("share_at_end", 0.02)]),
            finding(Effect::ReferenceZero, Target::Rig, &[("fx_n", 0.1), ("fy_n", 0.2), ("fz_n", -0.1)]),
            finding(Effect::StageScale, Target::Rig, &[("scale", 1.02)]),
            finding(Effect::ChannelSkew, Target::Channel(1), &[("skew_us", 900.0)]),
            finding(Effect::TimeLag, Target::Rig, &[("ms", -40.0)]),
        ];
        let (extended, left_out) = extended(&device, &diagnosis(findings), Some(500.0));
        assert_eq!(left_out, []);
        assert_eq!(Device::from_toml(&extended.to_toml()).0.as_ref(), Some(&extended));
        near(extended.modules[1].gain[2], 1.1 * 1.2 * 0.9);
        near(extended.modules[2].gain[0], 0.9);
        assert_eq!(extended.modules[0].offset_uv, [120.0, 0.0, 0.0]);
        let behaviour = &extended.behaviour;
        near(behaviour.crosstalk[0].share, 0.07);
        assert_eq!(behaviour.module_crosstalk, [ModuleCrosstalk { module: 2, with: 1, share: 0.04 }]);
        assert_eq!(behaviour.thermal.zero_uv_per_c, [3.0; CHANNELS]);
        assert_eq!(behaviour.noise.drift_uv_per_h[8], 40.0);
        // After 500 cycles ln 2 of what is ln 101 after 50,000.
        near(behaviour.ageing.share[3], 0.02 * 101_f64.ln() / 2_f64.ln());
        assert_eq!(behaviour.rig.reference_zero_n, [0.1, 0.2, -0.1]);
        near(behaviour.rig.stage_scale, 1.02);
        near(behaviour.sampling.skew_us[1], 900.0);
        near(behaviour.rig.label_lag_ms, -40.0);
    }

    #[test]
    fn what_a_pad_remembers_is_as_high_and_as_slow_as_found() {
        let parts = ["part_0", "part_1", "part_2", "part_3", "part_4"].map(|name| (name, 1.0));
        let mut hysteresis = finding(Effect::Hysteresis, Target::Pad, &[("share_of_full_scale", 0.04)]);
        hysteresis.shapes = parts.into_iter().chain([("above", 1.0), ("full_scale", 1.0)]).collect();
        let mut creep = finding(Effect::Creep, Target::Channel(2), &[("share_at_20s", 0.03)]);
        creep.shapes = parts.to_vec();
        let (device, left_out) = extended(&Device::nominal(), &diagnosis(vec![hysteresis, creep]), None);
        assert_eq!(left_out, []);
        let Behaviour { hysteresis, creep, .. } = device.behaviour;
        // Σ 2 w r, and Σ c (1 − exp(−20 s/τ)).
        let height = |channel: usize| -> f64 {
            let own = hysteresis.iter().filter(|it| it.channels[channel]);
            own.map(|it| 2.0 * it.law.share * it.law.threshold).sum()
        };
        (0..CHANNELS).for_each(|channel| near(height(channel), 0.04 * 5000.0));
        near(creep.iter().map(|it| it.law.share * (1.0 - (-20.0 / it.law.time_s).exp())).sum(), 0.03);
        assert!(creep.iter().all(|it| it.channels[2] && !it.channels[0]));
    }

    #[test]
    fn what_no_file_holds_is_left_out_and_told() {
        let nominal = Device::nominal();
        let mut confounded = finding(Effect::ChannelGain, Target::Channel(0), &[("gain", 1.2)]);
        confounded.confounded_with.push((Effect::ReferenceGain, Target::Rig));
        let findings = vec![
            finding(Effect::GaugeNonlinearity, Target::Channel(0), &[("second_order_percent_fs", 2.0)]),
            finding(Effect::ContactHeight, Target::Rig, &[("mm", 1.0)]),
            finding(Effect::ModuleFrameOpen, Target::ModuleSide(0, Side::PlusX), &[("area_share", 0.05)]),
            finding(
                Effect::ModuleDisplaced,
                Target::Module(0),
                &[("radial_mm", 1e3), ("tangential_mm", 0.0)],
            ),
            finding(Effect::Ageing, Target::Pad, &[("share_at_end", 0.02)]),
            finding(Effect::ChannelGain, Target::Channel(1), &[("gain", f64::NAN)]),
            confounded,
        ];
        let (device, left_out) = extended(&nominal, &diagnosis(findings), None);
        assert_eq!(device, nominal);
        let wanted = [
            Effect::Ageing,
            Effect::ChannelGain,
            Effect::ContactHeight,
            Effect::GaugeNonlinearity,
            Effect::ModuleDisplaced,
            Effect::ModuleFrameOpen,
        ];
        assert_eq!(left_out, wanted);
    }
}
