//! From a device file's text to a [`Device`]: keys, types and ranges. All findings are reported at once.
//!
//! While it is read, a device holds NaN wherever the text has no usable number. So what is checked across
//! numbers needs no case for those that are missing: nothing compares with NaN.

use super::behaviour::Behaviour;
use super::imperfection;
use super::possible;
use super::reading::Reading;
use super::schema::{DIRECTIONS, GAUGE, GAUGE_NAMES, MATERIALS, REPORTED, SCHEMA, TABLES, Table};
use super::{
    Circuit, Device, Direction, GAUGES, Gauge, GaugeLaw, Material, Materials, Module, Patch, Plate, Reported,
    Sites, Stack,
};
use crate::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};
use crate::toml_text;
use crate::toml_text::diag::Diagnostic;
use crate::toml_text::section::{Bounds, Placed, Section};

const GAUGE_WORDS: [&str; 2] = ["name", "direction"];

/// Reads a complete device; see [`Device::from_toml`].
pub(super) fn device(text: &str) -> (Option<Device>, Vec<Diagnostic>) {
    let mut reading = Reading::new(text);
    let help = "a device is some hundred lines of TOML";
    let Some(tree) = toml_text::parse(text, help, &mut reading.report) else {
        return (None, reading.report.finish());
    };
    let own = ["schema", "name", "material", "gauge", "reported"].into_iter();
    let known: Vec<_> =
        own.chain(TABLES.iter().map(|table| table.path)).chain(imperfection::tables()).collect();
    let root = Section::root(&tree, "the device", &known, &mut reading.report);
    let mut device = UNREAD;
    root.require("schema", "write schema = \"sstid-device/1\"", &mut reading.report);
    read_schema(&root, &mut reading);
    root.require("name", "write name = \"…\", what people call the device", &mut reading.report);
    device.name = root.name("name", &mut reading.report).unwrap_or_default().to_owned();
    TABLES.iter().for_each(|table| read_table(&root, table, &mut device, &mut reading));
    read_materials(&root, &mut device, &mut reading);
    read_gauges(&root, &mut device.gauges, &mut reading);
    device.reported = read_reported(&root, &mut reading);
    imperfection::read(&root, &mut device, &mut reading);
    settle(device, reading)
}

/// Reads tables of imperfections over `device`; see [`Device::with_imperfections`].
pub(super) fn imperfections(mut device: Device, text: &str) -> (Option<Device>, Vec<Diagnostic>) {
    let mut reading = Reading::new(text);
    let help = "imperfections are a few lines of TOML";
    let Some(tree) = toml_text::parse(text, help, &mut reading.report) else {
        return (None, reading.report.finish());
    };
    let known: Vec<_> = ["schema"].into_iter().chain(imperfection::tables()).collect();
    let root = Section::root(&tree, "the file of imperfections", &known, &mut reading.report);
    read_schema(&root, &mut reading);
    imperfection::read(&root, &mut device, &mut reading);
    settle(device, reading)
}

/// The device, if nothing speaks against it, and all findings.
fn settle(device: Device, mut reading: Reading<'_>) -> (Option<Device>, Vec<Diagnostic>) {
    possible::check(&device, &mut reading);
    let device = (!reading.report.failed()).then_some(device);
    (device, reading.report.finish())
}

fn read_schema(root: &Section<'_>, reading: &mut Reading<'_>) {
    root.word("schema", &[(SCHEMA, ())], &mut reading.report);
}

/// Reads the numbers of `table`, and its words if it has any.
fn read_table(
    root: &Section<'_>,
    table: &'static Table<Device>,
    device: &mut Device,
    reading: &mut Reading<'_>,
) {
    let Table { path, words, keys } = *table;
    root.require(path, &format!("write a table headed [{path}]"), &mut reading.report);
    let known: Vec<_> = words.iter().copied().chain(keys.iter().map(|key| key.name)).collect();
    let Some(section) = root.table(path, format!("[{path}]"), &known, &mut reading.report) else { return };
    reading.require(&section, keys);
    reading.numbers(&section, path, keys, device);
    if words.contains(&"count") {
        read_count(&section, reading);
    }
    if words.contains(&"channel_order") {
        read_circuit(&section, &mut device.circuit, reading);
    }
}

fn read_count(modules: &Section<'_>, reading: &mut Reading<'_>) {
    const COUNT: u32 = MODULES as u32;
    modules.require("count", "write count = 3", &mut reading.report);
    modules.whole("count", Bounds { low: COUNT, high: COUNT, default: COUNT }, &mut reading.report);
}

fn read_circuit(table: &Section<'_>, circuit: &mut Circuit, reading: &mut Reading<'_>) {
    let help = format!("write channel_order = {CHANNEL_NAMES:?}");
    table.require("channel_order", &help, &mut reading.report);
    let order = table.texts("channel_order", CHANNELS, &mut reading.report).unwrap_or_default();
    if let Some((name, wanted)) = order.iter().zip(CHANNEL_NAMES).find(|(name, wanted)| name.value != *wanted)
    {
        let message = format!("\"channel_order\" must have \"{wanted}\" here: the wire has this order");
        reading.report.error(name.at, message, help);
    }
    table.require(
        "bridge_nonlinearity",
        "write bridge_nonlinearity = false for the bridges' linear signals, or true for their exact voltages",
        &mut reading.report,
    );
    circuit.bridge_nonlinearity =
        table.flag("bridge_nonlinearity", &mut reading.report).unwrap_or(circuit.bridge_nonlinearity);
}

fn read_materials(root: &Section<'_>, device: &mut Device, reading: &mut Reading<'_>) {
    let key_of = |table: &Table<Device>| table.path.trim_start_matches("material.");
    root.require("material", "write a table headed [material]", &mut reading.report);
    let known = MATERIALS.each_ref().map(key_of);
    let Some(section) = root.table("material", "[material]".to_owned(), &known, &mut reading.report) else {
        return;
    };
    for table in &MATERIALS {
        let key = key_of(table);
        let keys: Vec<_> = table.keys.iter().map(|key| key.name).collect();
        section.require(key, &format!("write {key} = {{ e_mpa = …, nu = … }}"), &mut reading.report);
        let title = format!("\"{key}\" of [material]");
        if let Some(material) = section.table(key, title, &keys, &mut reading.report) {
            reading.require(&material, table.keys);
            reading.numbers(&material, table.path, table.keys, device);
        }
    }
}

fn read_gauges(root: &Section<'_>, gauges: &mut [Gauge; GAUGES], reading: &mut Reading<'_>) {
    const HELP: &str = "a module has the gauges R1 to R7, each in a table headed [[gauge]]";
    root.require("gauge", HELP, &mut reading.report);
    let known: Vec<_> = GAUGE_WORDS.into_iter().chain(GAUGE.iter().map(|key| key.name)).collect();
    // One more than there can be: that one repeats a name.
    let tables = root.tables("gauge", &known, GAUGES + 1, &mut reading.report);
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
        reading.report.misplaced(at, format!("the device lacks {plural} {}", missing.join(", ")), HELP);
    }
}

/// Which gauge the table describes; `None` (and a report) if it does not say so or another table did.
fn read_gauge_name(
    table: &Section<'_>,
    named: &mut [bool; GAUGES],
    reading: &mut Reading<'_>,
) -> Option<usize> {
    let mut number = 0..;
    let words = GAUGE_NAMES.map(|name| (name, number.next().unwrap_or(0)));
    table.require("name", "write name = \"R1\", or up to \"R7\"", &mut reading.report);
    let Placed { value: index, at } = table.word("name", &words, &mut reading.report)?;
    let seen = named.get_mut(index)?;
    if *seen {
        let message = format!("gauge {} is described twice", GAUGE_NAMES.get(index)?);
        reading.report.error(at, message, "a module has the gauges R1 to R7, each once");
        return None;
    }
    *seen = true;
    Some(index)
}

fn read_gauge(table: &Section<'_>, index: Option<usize>, gauge: &mut Gauge, reading: &mut Reading<'_>) {
    let name = index.and_then(|index| GAUGE_NAMES.get(index)).copied().unwrap_or_default();
    reading.require(table, &GAUGE);
    reading.numbers(table, &format!("gauge.{name}"), &GAUGE, gauge);
    table.require(
        "direction",
        "write direction = \"x\" or direction = \"y\", the grid's",
        &mut reading.report,
    );
    if let Some(direction) = table.word("direction", &DIRECTIONS, &mut reading.report) {
        gauge.direction = direction.value;
    }
}

fn read_reported(root: &Section<'_>, reading: &mut Reading<'_>) -> Option<Reported> {
    let known = REPORTED.each_ref().map(|key| key.name);
    let section = root.table("reported", "[reported]".to_owned(), &known, &mut reading.report)?;
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

const UNREAD_MATERIAL: Material = Material { e_mpa: f64::NAN, nu: f64::NAN };

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
        plate: UNREAD_MATERIAL,
        pick: UNREAD_MATERIAL,
        fpc: UNREAD_MATERIAL,
        adh: UNREAD_MATERIAL,
        pi: UNREAD_MATERIAL,
        epoxy: UNREAD_MATERIAL,
        gauge: UNREAD_MATERIAL,
    },
    gauge_law: GaugeLaw { gauge_factor: f64::NAN, transverse_ratio: f64::NAN },
    gauges: [UNREAD_GAUGE; GAUGES],
    circuit: Circuit { excitation_v: f64::NAN, bridge_nonlinearity: false },
    contact: Patch { patch_radius_mm: f64::NAN, max_centre_radius_mm: f64::NAN, full_scale_n: f64::NAN },
    reported: None,
    modules: [Module::NOMINAL; MODULES],
    behaviour: Behaviour::IDEAL,
};
