//! From a device file's text to a [`Device`]: keys, types and ranges. All findings are reported at once.
//!
//! While it is read, a device holds NaN wherever the text has no usable number. So what is checked across
//! numbers needs no case for those that are missing: nothing compares with NaN.

use super::behaviour::Behaviour;
use super::imperfection;
use super::possible;
use super::reading::DeviceText;
use super::schema::{DIRECTIONS, GAUGE, GAUGE_NAMES, MATERIALS, REPORTED, SCHEMA, TABLES, Table};
use super::{
    Circuit, Device, Direction, GAUGES, Gauge, GaugeLaw, Material, Materials, Module, Patch, Plate, Reported,
    Sites, Stack,
};
use crate::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};
use crate::toml_text;
use crate::toml_text::diag::Diagnostic;
use crate::toml_text::section::{Bounds, Placed, Section};

const NOMINAL: &str = include_str!("../../../../../models/sstid.toml");

const GAUGE_WORDS: [&str; 2] = ["name", "direction"];

impl Device {
    /// Reads a device file.
    ///
    /// Returns what there is to say about the text, in its order; after 50 findings a closing one says that there
    /// is more. The device is `None` exactly if there is an error among it. Then all of its numbers are finite,
    /// within the ranges of `models/README.md`, and its parts fit together.
    pub fn from_toml(text: &str) -> (Option<Self>, Vec<Diagnostic>) {
        device(text)
    }

    /// This device with a file of imperfections laid over it: what the file does not write stays.
    ///
    /// Returns the same as [`Self::from_toml`]; the parts of the changed device must fit together, too.
    pub fn with_imperfections(&self, text: &str) -> (Option<Self>, Vec<Diagnostic>) {
        imperfections(self.clone(), text)
    }

    /// The pad in `models/sstid.toml`.
    #[expect(clippy::expect_used, reason = "the file is part of the program and a test reads it")]
    pub fn nominal() -> Self {
        Self::from_toml(NOMINAL).0.expect("models/sstid.toml is a device")
    }
}

/// Reads a complete device; see [`Device::from_toml`].
fn device(text: &str) -> (Option<Device>, Vec<Diagnostic>) {
    let mut reading = DeviceText::new(text);
    let help = "a device is some hundred lines of TOML";
    let Some(tree) = toml_text::parse(text, help, &mut reading.findings) else {
        return (None, reading.findings.finish());
    };
    let own = ["schema", "name", "material", "gauge", "reported"].into_iter();
    let known: Vec<_> =
        own.chain(TABLES.iter().map(|table| table.path)).chain(imperfection::tables()).collect();
    let root = Section::root(&tree, "the device", &known, &mut reading.findings);
    let mut device = UNREAD;
    root.require("schema", "write schema = \"sstid-device/1\"", &mut reading.findings);
    read_schema(&root, &mut reading);
    root.require("name", "write name = \"…\", what people call the device", &mut reading.findings);
    device.name = root.name("name", &mut reading.findings).unwrap_or_default().to_owned();
    TABLES.iter().for_each(|table| read_table(&root, table, &mut device, &mut reading));
    read_materials(&root, &mut device, &mut reading);
    read_gauges(&root, &mut device.gauges, &mut reading);
    device.reported = read_reported(&root, &mut reading);
    imperfection::read(&root, &mut device, &mut reading);
    settle(device, reading)
}

/// Reads tables of imperfections over `device`; see [`Device::with_imperfections`].
fn imperfections(mut device: Device, text: &str) -> (Option<Device>, Vec<Diagnostic>) {
    let mut reading = DeviceText::new(text);
    let help = "imperfections are a few lines of TOML";
    let Some(tree) = toml_text::parse(text, help, &mut reading.findings) else {
        return (None, reading.findings.finish());
    };
    let known: Vec<_> = ["schema"].into_iter().chain(imperfection::tables()).collect();
    let root = Section::root(&tree, "the file of imperfections", &known, &mut reading.findings);
    read_schema(&root, &mut reading);
    imperfection::read(&root, &mut device, &mut reading);
    settle(device, reading)
}

/// The device, if nothing speaks against it, and all findings.
fn settle(device: Device, mut reading: DeviceText<'_>) -> (Option<Device>, Vec<Diagnostic>) {
    possible::check(&device, &mut reading);
    let device = (!reading.findings.failed()).then_some(device);
    (device, reading.findings.finish())
}

fn read_schema(root: &Section<'_>, reading: &mut DeviceText<'_>) {
    root.word("schema", &[(SCHEMA, ())], &mut reading.findings);
}

/// Reads the numbers of `table`, and its words if it has any.
fn read_table(
    root: &Section<'_>,
    table: &'static Table<Device>,
    device: &mut Device,
    reading: &mut DeviceText<'_>,
) {
    let Table { path, words, keys } = *table;
    root.require(path, &format!("write a table headed [{path}]"), &mut reading.findings);
    let known: Vec<_> = words.iter().copied().chain(keys.iter().map(|key| key.name)).collect();
    let Some(section) = root.table(path, format!("[{path}]"), &known, &mut reading.findings) else { return };
    reading.require(&section, keys);
    reading.numbers(&section, path, keys, device);
    if words.contains(&"count") {
        read_count(&section, reading);
    }
    if words.contains(&"channel_order") {
        read_circuit(&section, &mut device.circuit, reading);
    }
}

fn read_count(modules: &Section<'_>, reading: &mut DeviceText<'_>) {
    const COUNT: u32 = MODULES as u32;
    modules.require("count", "write count = 3", &mut reading.findings);
    modules.whole("count", Bounds { low: COUNT, high: COUNT, default: COUNT }, &mut reading.findings);
}

fn read_circuit(table: &Section<'_>, circuit: &mut Circuit, reading: &mut DeviceText<'_>) {
    let help = format!("write channel_order = {CHANNEL_NAMES:?}");
    table.require("channel_order", &help, &mut reading.findings);
    let order = table.texts("channel_order", CHANNELS, &mut reading.findings).unwrap_or_default();
    if let Some((name, wanted)) = order.iter().zip(CHANNEL_NAMES).find(|(name, wanted)| name.value != *wanted)
    {
        let message = format!("\"channel_order\" must have \"{wanted}\" here: the wire has this order");
        reading.findings.error(name.at, message, help);
    }
    table.require(
        "bridge_nonlinearity",
        "write bridge_nonlinearity = false for the bridges' linear signals, or true for their exact voltages",
        &mut reading.findings,
    );
    circuit.bridge_nonlinearity =
        table.flag("bridge_nonlinearity", &mut reading.findings).unwrap_or(circuit.bridge_nonlinearity);
}

fn read_materials(root: &Section<'_>, device: &mut Device, reading: &mut DeviceText<'_>) {
    let key_of = |table: &Table<Device>| table.path.trim_start_matches("material.");
    root.require("material", "write a table headed [material]", &mut reading.findings);
    let known = MATERIALS.each_ref().map(key_of);
    let Some(section) = root.table("material", "[material]".to_owned(), &known, &mut reading.findings) else {
        return;
    };
    for table in &MATERIALS {
        let key = key_of(table);
        let keys: Vec<_> = table.keys.iter().map(|key| key.name).collect();
        section.require(key, &format!("write {key} = {{ e_mpa = …, nu = … }}"), &mut reading.findings);
        let title = format!("\"{key}\" of [material]");
        if let Some(material) = section.table(key, title, &keys, &mut reading.findings) {
            reading.require(&material, table.keys);
            reading.numbers(&material, table.path, table.keys, device);
        }
    }
}

fn read_gauges(root: &Section<'_>, gauges: &mut [Gauge; GAUGES], reading: &mut DeviceText<'_>) {
    const HELP: &str = "a module has the gauges R1 to R7, each in a table headed [[gauge]]";
    root.require("gauge", HELP, &mut reading.findings);
    let known: Vec<_> = GAUGE_WORDS.into_iter().chain(GAUGE.iter().map(|key| key.name)).collect();
    // One more than there can be: that one repeats a name.
    let tables = root.tables("gauge", &known, GAUGES + 1, &mut reading.findings);
    let mut named = [false; GAUGES];
    for table in &tables {
        let index = read_gauge_name(table, &mut named, reading);
        let mut spare = UNREAD_GAUGE;
        let gauge = index.and_then(|index| gauges.get_mut(index)).unwrap_or(&mut spare);
        read_gauge(table, index, gauge, reading);
    }
    let missing: Vec<_> =
        GAUGE_NAMES.iter().zip(named).filter(|(_, named)| !named).map(|(name, _)| *name).collect();
    // With as many tables as gauges, the missing ones are those whose names were refused.
    if !missing.is_empty() && (1..GAUGES).contains(&tables.len()) {
        let at = root.place_of("gauge").unwrap_or(root.at);
        let plural = if missing.len() > 1 { "gauges" } else { "gauge" };
        reading.findings.misplaced(at, format!("the device lacks {plural} {}", missing.join(", ")), HELP);
    }
}

/// Which gauge the table describes; `None` (and a finding) if it does not say so or another table did.
fn read_gauge_name(
    table: &Section<'_>,
    named: &mut [bool; GAUGES],
    reading: &mut DeviceText<'_>,
) -> Option<usize> {
    let mut number = 0..;
    let words = GAUGE_NAMES.map(|name| (name, number.next().unwrap_or(0)));
    table.require("name", "write name = \"R1\", or up to \"R7\"", &mut reading.findings);
    let Placed { value: index, at } = table.word("name", &words, &mut reading.findings)?;
    let seen = named.get_mut(index)?;
    if *seen {
        let message = format!("gauge {} is described twice", GAUGE_NAMES.get(index)?);
        reading.findings.error(at, message, "a module has the gauges R1 to R7, each once");
        return None;
    }
    *seen = true;
    Some(index)
}

fn read_gauge(table: &Section<'_>, index: Option<usize>, gauge: &mut Gauge, reading: &mut DeviceText<'_>) {
    let name = index.and_then(|index| GAUGE_NAMES.get(index)).copied().unwrap_or_default();
    reading.require(table, &GAUGE);
    reading.numbers(table, &format!("gauge.{name}"), &GAUGE, gauge);
    table.require(
        "direction",
        "write direction = \"x\" or direction = \"y\", the grid's",
        &mut reading.findings,
    );
    if let Some(direction) = table.word("direction", &DIRECTIONS, &mut reading.findings) {
        gauge.direction = direction.value;
    }
}

fn read_reported(root: &Section<'_>, reading: &mut DeviceText<'_>) -> Option<Reported> {
    let known = REPORTED.each_ref().map(|key| key.name);
    let section = root.table("reported", "[reported]".to_owned(), &known, &mut reading.findings)?;
    let mut reported = UNREAD_REPORTED;
    reading.require(&section, &REPORTED);
    reading.numbers(&section, "reported", &REPORTED, &mut reported);
    Some(reported)
}

const UNREAD_REPORTED: Reported = Reported {
    force_resolution_n: f64::NAN,
    thermal_drift_uv_per_10k: f64::NAN,
    repeatability_percent_fso: f64::NAN,
    hysteresis_percent_fso: f64::NAN,
};

/// A material of which a file may leave out the density: then it has this one, which is that of `models/sstid.toml`.
const fn unread_material(density_kg_m3: f64) -> Material {
    Material { e_mpa: f64::NAN, nu: f64::NAN, density_kg_m3 }
}

const UNREAD_GAUGE: Gauge = Gauge {
    x_mm: f64::NAN,
    y_mm: f64::NAN,
    length_mm: f64::NAN,
    width_mm: f64::NAN,
    direction: Direction::X,
    resistance_ratio: f64::NAN,
};

/// A device before its text is read.
const UNREAD: Device = Device {
    name: String::new(),
    plate: Plate { diameter_mm: f64::NAN, thickness_mm: f64::NAN },
    sites: Sites { angles_deg: [f64::NAN; MODULES], centre_radius_mm: f64::NAN },
    stack: Stack {
        film_length_x_mm: f64::NAN,
        film_width_y_mm: f64::NAN,
        frame_width_mm: f64::NAN,
        frame_thickness_mm: f64::NAN,
        pi_thickness_mm: f64::NAN,
        adh_thickness_mm: f64::NAN,
        fpc_thickness_mm: f64::NAN,
        post_length_x_mm: f64::NAN,
        post_width_y_mm: f64::NAN,
        post_height_mm: f64::NAN,
        bond_thickness_mm: f64::NAN,
    },
    material: Materials {
        plate: unread_material(7_930.0),
        pick: unread_material(1_330.0),
        fpc: unread_material(1_900.0),
        adh: unread_material(1_200.0),
        pi: unread_material(1_420.0),
        epoxy: unread_material(1_200.0),
        gauge: unread_material(8_900.0),
    },
    gauge_law: GaugeLaw { gauge_factor: f64::NAN, transverse_ratio: f64::NAN },
    gauges: [UNREAD_GAUGE; GAUGES],
    circuit: Circuit { excitation_v: f64::NAN, bridge_nonlinearity: false },
    contact: Patch { patch_radius_mm: f64::NAN, max_centre_radius_mm: f64::NAN, full_scale_n: f64::NAN },
    reported: None,
    modules: [Module::NOMINAL; MODULES],
    behaviour: Behaviour::IDEAL,
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_device_is_read_whole() {
        let (device, found) = Device::from_toml(NOMINAL);
        assert_eq!((device, found), (Some(Device::nominal()), vec![]));
        let device = Device::nominal();
        assert_eq!(device.name, "SSTID nominal");
        assert_eq!(device.sites, Sites { angles_deg: [0.0, 120.0, 240.0], centre_radius_mm: 20.0 });
        assert_eq!(device.stack.film_length_x_mm, 9.8);
        assert_eq!(device.material.epoxy, Material { e_mpa: 250.0, nu: 0.35, density_kg_m3: 1_200.0 });
        assert_eq!(device.gauge_law.transverse_ratio, 5.4 / 9.8);
        let ratios = device.gauges.map(|gauge| gauge.resistance_ratio);
        assert_eq!(ratios, [1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 1.0]);
        let Gauge { x_mm, y_mm, direction, .. } = device.gauges[3];
        assert_eq!((x_mm, y_mm, direction), (0.0, 1.0, Direction::Y));
        assert!(!device.circuit.bridge_nonlinearity);
        assert_eq!(device.reported.unwrap().hysteresis_percent_fso, 3.1);
        assert_eq!(device.modules, [Module::NOMINAL; MODULES]);
    }

    #[test]
    fn densities_may_be_left_out_and_are_checked_where_they_are_not() {
        let older: String = NOMINAL
            .lines()
            .map(|line| match line.split_once(", density_kg_m3") {
                Some((before, _)) => format!("{before} }}\n"),
                None => format!("{line}\n"),
            })
            .collect();
        assert!(!older.contains("density_kg_m3 ="));
        assert_eq!(Device::from_toml(&older), (Some(Device::nominal()), vec![]));
        let light = NOMINAL.replace("7930.0", "7.93");
        let (device, found) = Device::from_toml(&light);
        assert!(device.is_none() && found.len() == 1, "{found:?}");
        let said = format!("{:?}", found[0]);
        assert!(said.contains("7.93") && said.contains("grams per cubic centimetre"), "{said}");
    }
}
