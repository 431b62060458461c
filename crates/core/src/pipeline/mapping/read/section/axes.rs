//! A profile's sticks and triggers.

use super::dpad::read_gate;
use super::plate;
use crate::pipeline::control::OutputDevice;
use crate::pipeline::mapping::profile::Zone;
use crate::pipeline::mapping::profile::words::{SIDES, SOURCES};
use crate::pipeline::mapping::profile::{Side, Source, Stick, Trigger};
use crate::pipeline::mapping::read::common::labels::LABEL;
use crate::pipeline::mapping::read::common::limits::{
    FULL_RADIUS_MM, SHEAR_FULL_N, SHEAR_REST_N, STICK_CENTRE_MM, STICK_CURVE, TRIGGER_FROM_N, TRIGGER_FULL_N,
};
use crate::pipeline::mapping::read::common::named;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Placed, Section};

const STICK_KEYS: [&str; 10] = [
    "stick",
    "from",
    "centre_radius_mm",
    "full_radius_mm",
    "centre_n",
    "full_n",
    "curve",
    "min_force_n",
    "release_force_n",
    LABEL,
];
const TRIGGER_KEYS: [&str; 6] = ["trigger", "from_n", "full_n", "curve", "zone", LABEL];
/// The numbers of each source.
const PLACE_KEYS: [&str; 2] = ["centre_radius_mm", "full_radius_mm"];
const SHEAR_KEYS: [&str; 2] = ["centre_n", "full_n"];

/// Reads all `[[stick]]`s; `None` for one that is unusable.
pub(crate) fn read_sticks(root: &Section<'_>, findings: &mut Findings<'_>) -> Vec<Option<Stick>> {
    let tables = read_tables(root, "stick", &STICK_KEYS, findings);
    let sides = read_sides(&tables, "stick", findings);
    tables.iter().zip(sides).map(|(table, side)| read_stick(table, side, findings)).collect()
}

/// Reads all `[[trigger]]`s; `None` for one that is unusable.
pub(crate) fn read_triggers(
    root: &Section<'_>,
    zones: &[Zone],
    has_dpad: bool,
    findings: &mut Findings<'_>,
) -> Vec<Option<Trigger>> {
    let tables = read_tables(root, "trigger", &TRIGGER_KEYS, findings);
    let sides = read_sides(&tables, "trigger", findings);
    tables
        .iter()
        .zip(sides)
        .map(|(table, side)| read_trigger(table, side, zones, has_dpad, findings))
        .collect()
}

/// Their tables; reports more than a gamepad has, and such of a profile that plays keys.
fn read_tables<'t>(
    root: &Section<'t>,
    kind: &'static str,
    keys: &[&'static str],
    findings: &mut Findings<'_>,
) -> Vec<Section<'t>> {
    let tables = root.tables(kind, keys, SIDES.len() + 1, findings);
    named::check_count(&tables, kind, SIDES.len(), findings);
    let plays_keys = root.word_is("output", OutputDevice::Keyboard.name());
    if let (true, Some(at)) = (plays_keys, root.place_of(kind)) {
        let message = format!("the keyboard has no {kind}");
        findings.warning(at, message, "it moves only where the gamepad is played: output = \"gamepad\"");
    }
    tables
}

/// Which side each is on; reports a side that is taken twice.
fn read_sides(tables: &[Section<'_>], kind: &'static str, findings: &mut Findings<'_>) -> Vec<Option<Side>> {
    let mut sides: Vec<Option<Side>> = Vec::new();
    for table in tables {
        table.require(kind, &format!("write {kind} = \"left\" or {kind} = \"right\""), findings);
        let word = table.word(kind, &SIDES, findings);
        let side = word.as_ref().map(|word| word.value);
        if let Some(Placed { at, .. }) = word.filter(|_| sides.contains(&side)) {
            findings.error(at, format!("this {kind} stands above already"), "a gamepad has one on each side");
        }
        sides.push(side);
    }
    sides
}

fn read_stick(table: &Section<'_>, side: Option<Side>, findings: &mut Findings<'_>) -> Option<Stick> {
    let source = match table.place_of("from") {
        Some(_) => table.word("from", &SOURCES, findings).map(|word| word.value),
        None => Some(Source::Place),
    };
    let place = read_way(table, PLACE_KEYS, [STICK_CENTRE_MM, FULL_RADIUS_MM], findings);
    let shear = read_way(table, SHEAR_KEYS, [SHEAR_REST_N, SHEAR_FULL_N], findings);
    let curve = table.number("curve", STICK_CURVE, findings);
    let (min_force_n, release_force_n) = read_gate(table, findings);
    let (way, (others, word)) = match source? {
        Source::Place => (place, (SHEAR_KEYS, "place")),
        Source::Shear => (shear, (PLACE_KEYS, "shear")),
    };
    if let Some((key, at)) = others.iter().find_map(|key| Some((key, table.place_of(key)?))) {
        findings.error(at, format!("\"{key}\" does nothing with from = \"{word}\""), "remove it");
    }
    let [rest, full] = way?;
    Some(Stick {
        side: side?,
        source: source?,
        rest,
        full,
        curve: curve?.value,
        min_force_n: min_force_n?,
        release_force_n: release_force_n?,
    })
}

fn read_trigger(
    table: &Section<'_>,
    side: Option<Side>,
    zones: &[Zone],
    has_dpad: bool,
    findings: &mut Findings<'_>,
) -> Option<Trigger> {
    let way = read_way(table, ["from_n", "full_n"], [TRIGGER_FROM_N, TRIGGER_FULL_N], findings);
    let curve = table.number("curve", STICK_CURVE, findings);
    let place = match table.text("zone", findings) {
        Some(name) => Some(plate::find(name, zones, has_dpad, findings)?),
        None => None,
    };
    let [from_n, full_n] = way?;
    Some(Trigger { side: side?, from_n, full_n, curve: curve?.value, place })
}

/// Where an axis begins to move, and where it is at its end.
fn read_way(
    table: &Section<'_>,
    keys: [&'static str; 2],
    bounds: [Bounds<f32>; 2],
    findings: &mut Findings<'_>,
) -> Option<[f32; 2]> {
    let [rest, full] = [0, 1].map(|at| table.number(keys[at], bounds[at], findings));
    table.require_less((keys[0], rest), (keys[1], full), findings);
    Some([rest?.value, full?.value])
}
