//! The numbers of a text's tables, read by their keys, and where they stand.

use std::collections::BTreeMap;

use super::schema::Key;
use super::unit::shown;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Placed, Section};

/// What is found while a text is read, and where its numbers stand.
pub(super) struct DeviceText<'t> {
    pub(super) findings: Findings<'t>,
    /// Byte offsets of the numbers, under the names of their parameters.
    places: BTreeMap<String, usize>,
}

impl<'t> DeviceText<'t> {
    pub(super) const fn new(text: &'t str) -> Self {
        Self { findings: Findings::new(text), places: BTreeMap::new() }
    }

    /// The byte offset of the first of these parameters that the text writes; the text's start if it writes none.
    pub(super) fn place_of<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> usize {
        names.into_iter().find_map(|name| self.places.get(name)).copied().unwrap_or(0)
    }

    /// Reads the numbers of `keys` that the table has into `record`; `path` begins their parameters' names.
    pub(super) fn numbers<T>(
        &mut self,
        section: &Section<'_>,
        path: &str,
        keys: &'static [Key<T>],
        record: &mut T,
    ) {
        for key in keys.iter().filter(|key| section.place_of(key.name).is_some()) {
            let written = self.list(section, key).unwrap_or_default();
            let usable: Vec<_> = written.iter().map(|number| self.in_range(key, *number)).collect();
            let slots = (key.access.get_mut)(record).iter_mut().zip(key.elements);
            for (index, (slot, element)) in slots.enumerate() {
                // A single number stands for all.
                let index = if written.len() == 1 { 0 } else { index };
                if let Some(number) = written.get(index) {
                    self.places.insert(parameter_name(path, key.name, element), number.at);
                }
                *slot = usable.get(index).copied().flatten().unwrap_or(f64::NAN);
            }
        }
    }

    fn list<T>(&mut self, section: &Section<'_>, key: &Key<T>) -> Option<Vec<Placed<f64>>> {
        if key.takes_one_for_all() {
            section.reals_or_one(key.name, key.elements.len(), &mut self.findings)
        } else if key.elements.len() > 1 {
            section.reals(key.name, key.elements.len(), &mut self.findings)
        } else {
            section.real(key.name, &mut self.findings).map(|number| vec![number])
        }
    }

    /// Reports each of `keys` that the table lacks and must have.
    pub(super) fn require<T>(&mut self, section: &Section<'_>, keys: &'static [Key<T>]) {
        for key in keys.iter().filter(|key| !key.optional) {
            let unit = if key.unit.symbol().is_empty() { "" } else { ", in " };
            let help = format!("write {}{unit}{}", key.meaning, key.unit.symbol());
            section.require(key.name, &help, &mut self.findings);
        }
    }

    /// The number; `None` (and a finding) if it is outside the key's range.
    fn in_range<T>(&mut self, key: &Key<T>, Placed { value, at }: Placed<f64>) -> Option<f64> {
        let (low, high) = key.range;
        if (low..=high).contains(&value) {
            return Some(value);
        }
        let allowed = format!("{} to {} {}", shown(low), shown(high), key.unit.symbol());
        let allowed = allowed.trim_end();
        let message = if value.is_finite() {
            format!("\"{}\" is {}; it must be {allowed}", key.name, shown(value))
        } else {
            format!("\"{}\" must be {allowed}", key.name)
        };
        self.findings.error(at, message, why_not(key, value));
        None
    }
}

/// What was probably meant by a number outside the key's range, or why there is none.
fn why_not<T>(key: &Key<T>, value: f64) -> String {
    let (low, high) = key.range;
    if key.name == "nu" && (high..1.0).contains(&value) {
        return "at 0.5 a material would keep its volume under any pressure: its bulk modulus would be infinite"
            .to_owned();
    }
    match key.unit.meant(value, low, high) {
        Some((unit, meant)) => format!("if it is in {unit}, write {}", shown(meant)),
        None => format!("\"{}\" is {}", key.name, key.meaning),
    }
}

/// The name of a parameter: its table's path, its key and, in a list, its element.
pub(super) fn parameter_name(path: &str, key: &str, element: &str) -> String {
    let dot = if element.is_empty() { "" } else { "." };
    format!("{path}.{key}{dot}{element}")
}
