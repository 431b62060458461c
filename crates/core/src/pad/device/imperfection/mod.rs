//! Tables that say how a pad differs from the drawn one, in a device file or in a file laid over a device.
//!
//! A table that stands once is laid over the device number by number. A list of tables takes the place of the
//! device's; only `[[module]]`, whose tables are about one module each, is again laid over number by number.
//!
//! A new kind of list is a new entry of [`LISTS`], a new table that stands once one of [`BEHAVIOUR`]: both files then
//! know, read and write it.

use super::Device;
use super::behaviour::Behaviour;
use super::lines::lines_unlike;
use super::reading::DeviceText;
use super::schema::behaviour::BEHAVIOUR;
use super::schema::{PATCH, Table};
use crate::toml_text::section::Section;

mod coupling;
mod memory;
mod module;

/// A kind of tables that may stand more than once.
struct List {
    /// Their header.
    table: &'static str,
    /// Reads what the text's root has of them over the device.
    read: fn(&Section<'_>, &mut Device, &mut DeviceText<'_>),
    /// The text of what a device has of them; empty where that is nothing.
    write: fn(&Device) -> String,
}

static LISTS: [List; 5] = [
    List { table: "module", read: module::read, write: module::text },
    List { table: "crosstalk", read: coupling::read_crosstalk, write: coupling::crosstalk_text },
    List {
        table: "module_crosstalk",
        read: coupling::read_module_crosstalk,
        write: coupling::module_crosstalk_text,
    },
    List { table: "hysteresis", read: memory::read_hysteresis, write: memory::hysteresis_text },
    List { table: "creep", read: memory::read_creep, write: memory::creep_text },
];

/// The headers of all tables of imperfections.
pub(super) fn tables() -> impl Iterator<Item = &'static str> {
    LISTS.iter().map(|list| list.table).chain(BEHAVIOUR.iter().map(|table| table.path))
}

/// Reads what the text's root has of imperfections over the device.
pub(super) fn read(root: &Section<'_>, device: &mut Device, reading: &mut DeviceText<'_>) {
    LISTS.iter().for_each(|list| (list.read)(root, device, reading));
    BEHAVIOUR.iter().for_each(|table| read_table(root, table, device, reading));
}

fn read_table(
    root: &Section<'_>,
    table: &'static Table<Behaviour>,
    device: &mut Device,
    reading: &mut DeviceText<'_>,
) {
    let Table { path, words, keys } = *table;
    let known: Vec<_> = words.iter().copied().chain(keys.iter().map(|key| key.name)).collect();
    let Some(section) = root.table(path, format!("[{path}]"), &known, &mut reading.findings) else { return };
    reading.numbers(&section, path, keys, &mut device.behaviour);
    if words.contains(&PATCH[0].name) {
        // It is the contact's number, so what is said about it is found under the contact's name.
        reading.numbers(&section, "contact", &PATCH, device);
    }
}

/// The tables of all imperfections that a device has.
pub(super) fn text(device: &Device) -> String {
    let lists = LISTS.iter().map(|list| (list.write)(device));
    let tables = BEHAVIOUR.iter().map(|table| table_text(table, &device.behaviour));
    lists.chain(tables).collect()
}

fn table_text(table: &Table<Behaviour>, behaviour: &Behaviour) -> String {
    let lines = lines_unlike(table.keys, behaviour, &Behaviour::IDEAL);
    if lines.is_empty() { lines } else { format!("\n[{}]\n{lines}", table.path) }
}
