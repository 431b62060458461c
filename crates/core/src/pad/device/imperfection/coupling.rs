//! `[[crosstalk]]` and `[[module_crosstalk]]`: what leaks from a channel, or a module, into another one.

use crate::pad::device::Device;
use crate::pad::device::behaviour::{Crosstalk, ModuleCrosstalk};
use crate::pad::device::lines::{lines, quoted};
use crate::pad::device::reading::DeviceText;
use crate::pad::device::schema::Key;
use crate::pad::device::schema::behaviour::{CROSSTALK, MODULE_CROSSTALK};
use crate::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Placed, Section};

/// The key of the source.
const SOURCE: &str = "with";

/// A kind of coupling between things that are counted.
struct Coupling<T: 'static> {
    table: &'static str,
    /// The key of the receiver, which is also what the things are called.
    receiver: &'static str,
    /// How many there are.
    count: usize,
    /// What to write for one of them.
    help: &'static str,
    /// Which one a key names.
    read: fn(&Section<'_>, &'static str, &mut Findings<'_>) -> Option<Placed<usize>>,
    /// How the file writes one.
    write: fn(usize) -> String,
    keys: &'static [Key<T>],
    /// A coupling without number, of a receiver with a source.
    between: fn(usize, usize) -> T,
    /// Its receiver and its source.
    ends: fn(&T) -> [usize; 2],
}

static CHANNEL: Coupling<Crosstalk> = Coupling {
    table: "crosstalk",
    receiver: "channel",
    count: CHANNELS,
    help: "\"m0x\", or up to \"m2z\"",
    read: |section, key, findings| section.word(key, &channel_words(), findings),
    write: |channel| quoted(CHANNEL_NAMES[channel]),
    keys: &CROSSTALK,
    between: |channel, with| Crosstalk { channel, with, share: f64::NAN },
    ends: |it| [it.channel, it.with],
};

static MODULE: Coupling<ModuleCrosstalk> = Coupling {
    table: "module_crosstalk",
    receiver: "module",
    count: MODULES,
    help: "0, 1 or 2",
    read: read_module,
    write: |module| module.to_string(),
    keys: &MODULE_CROSSTALK,
    between: |module, with| ModuleCrosstalk { module, with, share: f64::NAN },
    ends: |it| [it.module, it.with],
};

/// The channels as the file writes them.
pub(super) fn channel_words() -> [(&'static str, usize); CHANNELS] {
    std::array::from_fn(|channel| (CHANNEL_NAMES[channel], channel))
}

fn read_module(
    section: &Section<'_>,
    key: &'static str,
    findings: &mut Findings<'_>,
) -> Option<Placed<usize>> {
    section.place_of(key)?;
    let bounds = Bounds { low: 0, high: MODULES as u32 - 1, default: 0 };
    section.whole(key, bounds, findings).map(|Placed { value, at }| Placed { value: value as usize, at })
}

pub(super) fn read_crosstalk(root: &Section<'_>, device: &mut Device, reading: &mut DeviceText<'_>) {
    CHANNEL.read_over(root, &mut device.behaviour.crosstalk, reading);
}

pub(super) fn crosstalk_text(device: &Device) -> String {
    CHANNEL.text(&device.behaviour.crosstalk)
}

pub(super) fn read_module_crosstalk(root: &Section<'_>, device: &mut Device, reading: &mut DeviceText<'_>) {
    MODULE.read_over(root, &mut device.behaviour.module_crosstalk, reading);
}

pub(super) fn module_crosstalk_text(device: &Device) -> String {
    MODULE.text(&device.behaviour.module_crosstalk)
}

impl<T> Coupling<T> {
    /// Puts the text's list in the place of `couplings`, if it has one.
    fn read_over(&self, root: &Section<'_>, couplings: &mut Vec<T>, reading: &mut DeviceText<'_>) {
        if root.place_of(self.table).is_none() {
            return;
        }
        couplings.clear();
        let known: Vec<_> =
            [self.receiver, SOURCE].into_iter().chain(self.keys.iter().map(|key| key.name)).collect();
        // One more than there are pairs: that one repeats a pair.
        let most = self.count * (self.count - 1) + 1;
        for table in root.tables(self.table, &known, most, &mut reading.findings) {
            let ends = self.read_ends(&table, couplings, reading);
            let [receiver, source] = ends.unwrap_or_default();
            let mut coupling = (self.between)(receiver, source);
            let path = format!("{}.{}", self.table, couplings.len());
            reading.require(&table, self.keys);
            reading.numbers(&table, &path, self.keys, &mut coupling);
            if ends.is_some() {
                couplings.push(coupling);
            }
        }
    }

    /// Receiver and source; `None` (and a finding) if the table does not say them, or says what cannot be.
    fn read_ends(
        &self,
        table: &Section<'_>,
        before: &[T],
        reading: &mut DeviceText<'_>,
    ) -> Option<[usize; 2]> {
        for (key, what) in [(self.receiver, "receives"), (SOURCE, "leaks")] {
            let help = format!("write {key} = {}, the {} that {what}", self.help, self.receiver);
            table.require(key, &help, &mut reading.findings);
        }
        let receiver = (self.read)(table, self.receiver, &mut reading.findings);
        let Placed { value: source, at } = (self.read)(table, SOURCE, &mut reading.findings)?;
        let receiver = receiver?.value;
        let (thing, to, from) = (self.receiver, (self.write)(receiver), (self.write)(source));
        if receiver == source {
            let message = format!("{thing} {to} cannot leak into itself");
            reading.findings.error(at, message, "that would be a gain: write \"gain\" in its [[module]]");
            return None;
        }
        if before.iter().any(|coupling| (self.ends)(coupling) == [receiver, source]) {
            let message = format!("what {thing} {to} has of {from} is written twice");
            reading.findings.error(at, message, "write one table with the sum of both shares");
            return None;
        }
        Some([receiver, source])
    }

    fn text(&self, couplings: &[T]) -> String {
        let one = |coupling: &T| {
            let [receiver, source] = (self.ends)(coupling).map(self.write);
            format!(
                "\n[[{}]]\n{} = {receiver}\n{SOURCE} = {source}\n{}",
                self.table,
                self.receiver,
                lines(self.keys, coupling)
            )
        };
        couplings.iter().map(one).collect()
    }
}
