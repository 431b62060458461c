//! A profile's layers: parts that are on only at times.

use super::dpad::{direction_tables, written_direction};
use crate::pipeline::control::OutputDevice;
use crate::pipeline::mapping::profile::{Direction, LAYERS_MAX, Layer, When};
use crate::pipeline::mapping::read::common::binding::Outputs;
use crate::pipeline::mapping::read::common::conflict::{Owner, Use};
use crate::pipeline::mapping::read::common::named;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::Section;

const LAYER_KEYS: [&str; 3] = ["name", "gamepad", "keyboard"];
/// The name of what is on while no layer is.
pub(crate) const BASE: &str = "base";

/// A layer while it is read.
pub(crate) struct LayerDraft {
    pub(crate) name: String,
    /// Byte offset of its header.
    pub(crate) at: usize,
    /// In the order of [`Direction::ALL`].
    directions: [Option<Outputs>; Direction::NAMES.len()],
}

impl LayerDraft {
    /// Reads all `[[layer]]`s; one without a name is left out and reported.
    pub(crate) fn read_all(root: &Section<'_>, has_dpad: bool, findings: &mut Findings<'_>) -> Vec<Self> {
        let tables = root.tables("layer", &LAYER_KEYS, LAYERS_MAX + 1, findings);
        named::check_count(&tables, "layer", LAYERS_MAX, findings);
        let mut layers: Vec<Self> = Vec::new();
        for table in &tables {
            let is_taken = |name: &str| layers.iter().any(|layer| layer.name == name);
            let name = named::read(table, "layer", is_taken, findings);
            if let (Some(BASE), Some(at)) = (name.as_deref(), table.place_of("name")) {
                let message = format!("\"{BASE}\" is what is on while no layer is");
                findings.error(at, message, "give the layer another name");
            }
            let directions = read_directions(table, has_dpad, findings);
            layers.extend(name.map(|name| Self { name, at: table.at, directions }));
        }
        layers
    }

    /// Controls that the directions of this layer, the `number`th from 0, drive.
    pub(crate) fn uses(&self, number: usize) -> impl Iterator<Item = Use> + use<> {
        Direction::NAMES.into_iter().zip(self.directions).filter_map(move |(name, outputs)| {
            let owner = Owner::Direction(name);
            Some(Use { owner, outputs: outputs?, toggles: false, place: None, when: When::Layer(number) })
        })
    }

    /// The layer on `device`.
    pub(crate) fn settle(self, device: OutputDevice) -> Layer {
        let [up, down, left, right] = self.directions.map(|outputs| outputs?.settle(device));
        Layer { name: self.name, up, down, left, right }
    }
}

fn read_directions(
    table: &Section<'_>,
    has_dpad: bool,
    findings: &mut Findings<'_>,
) -> [Option<Outputs>; Direction::NAMES.len()] {
    let tables = direction_tables(table, &table.title, findings);
    if let (false, Some(at)) = (has_dpad, tables.iter().flatten().map(|table| table.at).next()) {
        let message = format!("the directions of {} do nothing without [dpad]", table.title);
        findings.error(at, message, "add a [dpad], or remove them");
    }
    Direction::NAMES.map(|name| {
        let written = tables.iter().flatten().find_map(|table| table.place_of(name))?;
        if tables.iter().any(|table| table.as_ref().is_none_or(|table| table.place_of(name).is_none())) {
            let message = format!("{} names \"{name}\" on one device only", table.title);
            findings.error(written, message, "name it under both gamepad and keyboard");
        }
        Some(written_direction(&tables, name, None, findings))
    })
}
