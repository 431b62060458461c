//! From a [`Device`] to a device file's text.

use super::imperfection;
use super::lines::{assignment, lines, quoted};
use super::schema::{DIRECTIONS, GAUGE, GAUGE_NAMES, MATERIALS, REPORTED, SCHEMA, TABLES, Table};
use super::{Device, Gauge};
use crate::quantity::{CHANNEL_NAMES, MODULES};

const HEAD: &str = "\
# A pad: three strain modules between a rigid base and a round plate.
# Lengths in mm, moduli in MPa, densities in kg/m3, forces in N, signals in microvolts (uV); ratios have no unit.
# Pad frame: origin at the centre of the plate's top surface, +x right, +y up seen from above, +z out of the plate.
# Module frame: x tangential, counter-clockwise; y radial, outwards; z the pad's. It is left-handed.
";

impl Device {
    /// The device as a complete device file. What was read from a file reads back equal, to the last digit.
    ///
    /// Imperfections are written only where there are any.
    pub fn to_toml(&self) -> String {
        let mut text = format!("{HEAD}\nschema = {}\nname = {}\n", quoted(SCHEMA), quoted(&self.name));
        for table in &TABLES {
            text += &format!("\n[{}]\n", table.path);
            text += &self.words(table);
            text += &lines(table.keys, self);
        }
        text += "\n[material]\n";
        MATERIALS.iter().for_each(|table| text += &self.material(table));
        for (gauge, name) in self.gauges.iter().zip(GAUGE_NAMES) {
            text += &gauge_table(gauge, name);
        }
        if let Some(reported) = &self.reported {
            text += "\n# What was measured on hardware; nothing is computed from it.\n[reported]\n";
            text += &lines(&REPORTED, reported);
        }
        text + &imperfection::text(self)
    }

    /// The lines of a table that are no numbers of the device.
    fn words(&self, table: &Table<Self>) -> String {
        let line = |word: &&str| match *word {
            "count" => format!("count = {MODULES}\n"),
            "channel_order" => format!("channel_order = {CHANNEL_NAMES:?}\n"),
            "bridge_nonlinearity" => format!("bridge_nonlinearity = {}\n", self.circuit.bridge_nonlinearity),
            _ => String::new(),
        };
        table.words.iter().map(line).collect()
    }

    fn material(&self, table: &Table<Self>) -> String {
        let numbers: Vec<_> = table.keys.iter().map(|key| assignment(key, self)).collect();
        let key = table.path.trim_start_matches("material.");
        format!("{key} = {{ {} }}\n", numbers.join(", "))
    }
}

fn gauge_table(gauge: &Gauge, name: &str) -> String {
    let direction = DIRECTIONS.iter().find(|(_, direction)| *direction == gauge.direction);
    let direction = direction.map_or("", |(word, _)| word);
    format!(
        "\n[[gauge]]\nname = {}\n{}direction = {} # the grid's\n",
        quoted(name),
        lines(&GAUGE, gauge),
        quoted(direction)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::device::parameter::Parameter;
    use crate::pad::device::{Direction, Reported, Side};

    #[test]
    fn the_nominal_device_reads_back_equal() {
        let device = Device::nominal();
        let (read, found) = Device::from_toml(&device.to_toml());
        assert_eq!((read, found), (Some(device), vec![]));
    }

    #[test]
    fn every_number_and_word_reads_back_to_the_last_digit() {
        let mut device = Device::nominal();
        for parameter in Parameter::all() {
            let value = parameter.get(&device);
            parameter.set(&mut device, value + (value.abs() + 1.0) / 3.0 * 1e-6);
        }
        device.name = "a \"quoted\" name \\ ä".to_owned();
        device.circuit.bridge_nonlinearity = true;
        device.gauges[6].direction = Direction::Y;
        device.modules[1].frame_open = Some(Side::MinusY);
        device.modules.iter_mut().for_each(|module| module.debonded_side = Some(Side::PlusX));
        device.contact.max_centre_radius_mm = 20.0;
        device.reported = device.reported.map(|it| Reported { force_resolution_n: 0.1 + 0.2, ..it });
        let (read, found) = Device::from_toml(&device.to_toml());
        assert_eq!((read, found), (Some(device.clone()), vec![]));
        device.reported = None;
        assert_eq!(Device::from_toml(&device.to_toml()).0, Some(device));
    }
}
