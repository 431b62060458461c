//! `[[hysteresis]]` and `[[creep]]`: terms that a channel's strain is the sum of.

use super::coupling::channel_words;
use crate::pad::device::Device;
use crate::pad::device::behaviour::OnChannels;
use crate::pad::device::lines::{lines, quoted};
use crate::pad::device::reading::DeviceText;
use crate::pad::device::schema::Key;
use crate::pad::device::schema::behaviour::{CREEP, HYSTERESIS};
use crate::quantity::{CHANNEL_NAMES, CHANNELS};
use crate::toml_text::section::Section;
use tactpad_numeric::memory::{PlayOperator, Relaxation};

/// The key of the channels that have a term.
const WHERE: &str = "channels";

/// More terms than this are no model of anything: 16 in each channel.
const TERMS_MAX: usize = 16 * CHANNELS;

/// A kind of term.
struct Term<T: 'static> {
    table: &'static str,
    keys: &'static [Key<OnChannels<T>>],
    /// A law without numbers.
    unread: T,
}

static PLAY: Term<PlayOperator> = Term {
    table: "hysteresis",
    keys: &HYSTERESIS,
    unread: PlayOperator { threshold: f64::NAN, share: f64::NAN },
};

static RELAXATION: Term<Relaxation> =
    Term { table: "creep", keys: &CREEP, unread: Relaxation { time_s: f64::NAN, share: f64::NAN } };

pub(super) fn read_hysteresis(root: &Section<'_>, device: &mut Device, reading: &mut DeviceText<'_>) {
    PLAY.read_over(root, &mut device.behaviour.hysteresis, reading);
}

pub(super) fn hysteresis_text(device: &Device) -> String {
    PLAY.text(&device.behaviour.hysteresis)
}

pub(super) fn read_creep(root: &Section<'_>, device: &mut Device, reading: &mut DeviceText<'_>) {
    RELAXATION.read_over(root, &mut device.behaviour.creep, reading);
}

pub(super) fn creep_text(device: &Device) -> String {
    RELAXATION.text(&device.behaviour.creep)
}

impl<T: Copy> Term<T> {
    /// Puts the text's list in the place of `terms`, if it has one.
    fn read_over(&self, root: &Section<'_>, terms: &mut Vec<OnChannels<T>>, reading: &mut DeviceText<'_>) {
        if root.place_of(self.table).is_none() {
            return;
        }
        terms.clear();
        let known: Vec<_> = self.keys.iter().map(|key| key.name).chain([WHERE]).collect();
        for table in root.tables(self.table, &known, TERMS_MAX + 1, &mut reading.findings) {
            let mut term = OnChannels::all(self.unread);
            reading.require(&table, self.keys);
            reading.numbers(&table, &format!("{}.{}", self.table, terms.len()), self.keys, &mut term);
            read_channels(&table, &mut term.channels, reading);
            if terms.len() == TERMS_MAX {
                let message = format!("there are more than {TERMS_MAX} tables [[{}]]", self.table);
                reading.findings.error(table.at, message, "write the sum of several as one");
            }
            terms.push(term);
        }
    }

    fn text(&self, terms: &[OnChannels<T>]) -> String {
        let one = |term: &OnChannels<T>| {
            let channels = channels_line(term.channels);
            format!("\n[[{}]]\n{}{channels}", self.table, lines(self.keys, term))
        };
        terms.iter().map(one).collect()
    }
}

fn read_channels(table: &Section<'_>, channels: &mut [bool; CHANNELS], reading: &mut DeviceText<'_>) {
    let Some(written) = table.words(WHERE, &channel_words(), &mut reading.findings) else { return };
    *channels = [false; CHANNELS];
    for channel in written {
        let chosen = &mut channels[channel.value];
        if *chosen {
            let message = format!("channel \"{}\" is listed twice", CHANNEL_NAMES[channel.value]);
            reading.findings.error(channel.at, message, "list each channel once, or none to have all");
        }
        *chosen = true;
    }
}

/// The line that tells which channels have a term; none where all have.
fn channels_line(channels: [bool; CHANNELS]) -> String {
    if channels == [true; CHANNELS] {
        return String::new();
    }
    let chosen = CHANNEL_NAMES.iter().zip(channels).filter(|(_, chosen)| *chosen);
    let names: Vec<_> = chosen.map(|(name, _)| quoted(name)).collect();
    format!("{WHERE} = [{}]\n", names.join(", "))
}
