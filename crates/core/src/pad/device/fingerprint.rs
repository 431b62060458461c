//! A short name for everything that a pad's influence field follows from, to keep computed fields under.

use std::fmt::Write;

use super::Device;
use super::behaviour::Behaviour;
use super::imperfection;
use super::parameter::Parameter;
use super::schema::{DIRECTIONS, Effect, GAUGE_NAMES, SIDES};
use crate::bytes::fnv1a;

impl Device {
    /// The text that [`Self::fingerprint`] is taken from: a line `name = value` for each parameter whose effect is
    /// [`Effect::Field`], in the order of [`Parameter::all`], then the gauges' directions, the open frames and the sides where bonds have come
    /// off.
    ///
    /// Values are the shortest decimals that read back equal, so two texts are equal exactly if all these values
    /// are. It holds neither the device's name, gains and offsets, nor how the bridges' signals are read out.
    pub fn field_text(&self) -> String {
        let mut text = String::new();
        for parameter in Parameter::all().filter(|parameter| parameter.effect() == Effect::Field) {
            // Negative zero is the same number as zero. Writing to a string cannot fail.
            let _ = writeln!(text, "{parameter} = {:?}", parameter.get(self) + 0.0);
        }
        for (gauge, name) in self.gauges.iter().zip(GAUGE_NAMES) {
            let word = DIRECTIONS.iter().find(|(_, direction)| *direction == gauge.direction);
            let _ = writeln!(text, "gauge.{name}.direction = {}", word.map_or("", |(word, _)| word));
        }
        for (index, module) in self.modules.iter().enumerate() {
            let debonded_side = module.debonded().map(|(side, _)| side);
            for (key, side) in [("frame_open", module.frame_open), ("debonded_side", debonded_side)] {
                let word = SIDES.iter().find(|(_, named)| Some(*named) == side);
                let _ = writeln!(text, "module.{index}.{key} = {}", word.map_or("none", |(word, _)| word));
            }
        }
        text
    }

    /// The 64-bit FNV-1a hash of [`Self::field_text`]: equal numbers, equal fingerprint, however the file is
    /// written. Unequal ones may share it, though hardly by chance; a file that is kept under it can hold the
    /// text, to be sure.
    pub fn fingerprint(&self) -> u64 {
        fnv1a(self.field_text().as_bytes())
    }

    /// The same of everything that the pad's channels follow from: the field, how the bridges are read out, and what the pad
    /// does beyond its mechanics. Whoever touches it, and the rig that measures it, are no part of it.
    pub fn pad_fingerprint(&self) -> u64 {
        let Behaviour { finger, rig, .. } = Behaviour::IDEAL;
        let alone = Self { behaviour: Behaviour { finger, rig, ..self.behaviour.clone() }, ..self.clone() };
        let mut text = self.field_text();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "bridge_nonlinearity = {}", self.circuit.bridge_nonlinearity);
        fnv1a((text + &imperfection::text(&alone)).as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::device::Side;
    use crate::pad::device::behaviour::OnChannels;
    use tactpad_numeric::memory::Relaxation;

    #[test]
    fn a_pads_fingerprint_knows_the_pad_and_neither_hand_nor_rig() {
        let nominal = Device::nominal();
        for parameter in Parameter::all() {
            let mut device = nominal.clone();
            let value = parameter.get(&nominal);
            parameter.set(&mut device, value + (value.abs() + 1.0) * 1e-12);
            let is_pads = ![Effect::Nothing, Effect::Dynamics].contains(&parameter.effect())
                && !["finger.", "rig."].iter().any(|table| parameter.name().starts_with(table));
            assert_eq!(device.pad_fingerprint() != nominal.pad_fingerprint(), is_pads, "{parameter}");
        }
        let mut crept = nominal.clone();
        let term = OnChannels::all(Relaxation { time_s: 8.0, share: 0.01 });
        crept.behaviour.creep.push(term);
        assert_ne!(crept.pad_fingerprint(), nominal.pad_fingerprint());
    }

    #[test]
    fn it_changes_with_the_field_and_with_nothing_else() {
        let nominal = Device::nominal();
        for parameter in Parameter::all() {
            let mut device = nominal.clone();
            let value = parameter.get(&nominal);
            parameter.set(&mut device, value + (value.abs() + 1.0) * 1e-12);
            let same = device.fingerprint() == nominal.fingerprint();
            assert_eq!(same, parameter.effect() != Effect::Field, "{parameter}");
        }
        let differs = |change: fn(&mut Device)| {
            let mut device = nominal.clone();
            change(&mut device);
            device.fingerprint() != nominal.fingerprint()
        };
        assert!(differs(|device| device.gauges[6].direction = crate::pad::device::Direction::Y));
        assert!(differs(|device| device.modules[1].frame_open = Some(Side::PlusX)));
        assert!(differs(|device| {
            device.modules[2].debonded_side = Some(Side::PlusX);
            device.modules[2].debonded_share = 0.2;
        }));
        assert!(!differs(|device| device.modules[2].debonded_side = Some(Side::PlusX)), "of a whole bond");
        assert!(!differs(|device| device.name.push('!')));
        assert!(!differs(|device| device.circuit.bridge_nonlinearity = true));
        assert!(!differs(|device| device.modules[0].radial_mm = -0.0));
    }
}
