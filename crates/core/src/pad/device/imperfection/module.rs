//! `[[module]]`: how one module differs from the nominal one.

use crate::pad::device::lines::{lines_unlike, quoted};
use crate::pad::device::reading::DeviceText;
use crate::pad::device::schema::{MODULE, SIDES};
use crate::pad::device::{Device, Module};
use crate::quantity::MODULES;
use crate::toml_text::section::{Bounds, Placed, Section};

pub(super) fn read(root: &Section<'_>, device: &mut Device, reading: &mut DeviceText<'_>) {
    let known: Vec<_> = ["index", "frame_open", "debonded_side"]
        .into_iter()
        .chain(MODULE.iter().map(|key| key.name))
        .collect();
    // One more than there can be: that one repeats an index.
    let tables = root.tables("module", &known, MODULES + 1, &mut reading.findings);
    let mut described = [false; MODULES];
    for table in &tables {
        let index = read_index(table, &mut described, reading);
        let mut spare = Module::NOMINAL;
        let module = index.and_then(|index| device.modules.get_mut(index)).unwrap_or(&mut spare);
        let path = index.map_or_else(String::new, |index| format!("module.{index}"));
        reading.numbers(table, &path, &MODULE, module);
        if let Some(side) = table.word("frame_open", &SIDES, &mut reading.findings) {
            module.frame_open = Some(side.value);
        }
        read_debonding(table, module, reading);
    }
}

/// Reads where the bond has come off; share and side say nothing without each other.
fn read_debonding(table: &Section<'_>, module: &mut Module, reading: &mut DeviceText<'_>) {
    if let Some(side) = table.word("debonded_side", &SIDES, &mut reading.findings) {
        module.debonded_side = Some(side.value);
    }
    if module.debonded_share > 0.0 && module.debonded_side.is_none() {
        let help = "write debonded_side = \"+x\", \"-x\", \"+y\" or \"-y\", where the bond has come off";
        table.require("debonded_side", help, &mut reading.findings);
    }
    if module.debonded_share == 0.0 && module.debonded_side.is_some() {
        let help = "write how much of the bond's area has come off, 0.5 for half of it; 0 for a whole bond";
        table.require("debonded_share", help, &mut reading.findings);
        // A whole bond has no such side.
        module.debonded_side = None;
    }
}

/// Which module the table is about; `None` (and a finding) if it does not say so or another table is.
fn read_index(
    table: &Section<'_>,
    described: &mut [bool; MODULES],
    reading: &mut DeviceText<'_>,
) -> Option<usize> {
    table.require("index", "write index = 0, 1 or 2: the module that differs", &mut reading.findings);
    let at = table.place_of("index")?;
    let bounds = Bounds { low: 0, high: MODULES as u32 - 1, default: 0 };
    let Placed { value: index, .. } = table.whole("index", bounds, &mut reading.findings)?;
    let described = described.get_mut(index as usize)?;
    if *described {
        let help = "write all of its keys into one table";
        reading.findings.error(at, format!("module {index} is described twice"), help);
        return None;
    }
    *described = true;
    Some(index as usize)
}

pub(super) fn text(device: &Device) -> String {
    let numbered = (0..).zip(&device.modules).filter(|(_, module)| **module != Module::NOMINAL);
    numbered
        .map(|(index, module)| format!("\n[[module]]\nindex = {index}\n{}", module_lines(module)))
        .collect()
}

/// The lines in which the module differs from the nominal one.
fn module_lines(module: &Module) -> String {
    let sides = [
        ("frame_open", module.frame_open, "the side where its frame is missing"),
        ("debonded_side", module.debonded_side, "the side where its bond has come off"),
    ];
    let word = |wanted| SIDES.iter().find(|(_, side)| Some(*side) == wanted);
    let sides = sides.into_iter().filter_map(|(key, side, meaning)| {
        word(side).map(|(word, _)| format!("{key} = {} # {meaning}\n", quoted(word)))
    });
    lines_unlike(&MODULE, module, &Module::NOMINAL) + &sides.collect::<String>()
}
