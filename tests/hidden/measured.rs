//! A measured table with a hidden effect.

use std::fmt::Write as _;

use crate::background::{background, rms_of};
use crate::effects::{electrical, mechanical, memory, rig, taken, warmth};
use crate::fields::{NOMINAL, signals};
use crate::plan::{Contact, Row};
use crate::random::Random;
use crate::truth::{CHANNELS, Truth};

/// How good the measurement and the simulator are, beside what is hidden.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quality {
    /// Share of a channel's rms, and length in mm.
    pub(crate) background: [f64; 2],
    /// Additive and multiplicative noise of each channel, as shares of its rms and of its signal.
    pub(crate) noise: [[f64; 2]; 9],
    /// Correlation of the noise with that of the sample before, in a series.
    pub(crate) memory: f64,
    /// Factors of the kinds of channel: within the table's own numerical error.
    pub(crate) kinds: [f64; 3],
    /// Static samples are means of so many readings, of which the samples of a series beside them are one each.
    pub(crate) readings: f64,
}

impl Quality {
    /// The quality for which the smallest sizes that are asked for are stated.
    pub(crate) const STATED: Self = Self {
        background: [0.015, 14.0],
        noise: [[0.004; 2]; 9],
        memory: 0.0,
        kinds: [1.0; 3],
        readings: 1.0,
    };

    /// Background of 1 to 3 % and 10 to 20 mm, noise of 0.2 to 0.8 % each, correlated up to a half from sample to sample of
    /// a series, the table's stated error, and static samples of 1 to 16 readings.
    pub(crate) fn drawn(random: &mut Random) -> Self {
        Self {
            background: [random.between(0.01, 0.03), random.between(10.0, 20.0)],
            noise: std::array::from_fn(|_| [random.between(0.002, 0.008), random.between(0.002, 0.008)]),
            memory: random.between(0.0, 0.5),
            kinds: [0.005, 0.003, 0.005].map(|error| 1.0 + random.between(-error, error)),
            readings: random.between(1.0, 16.0),
        }
    }
}

/// Which columns a table has beside places, forces and channels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Columns {
    pub(crate) temp_c: bool,
    pub(crate) cycle: bool,
}

impl Columns {
    /// Those that the causes need.
    pub(crate) fn of(truths: &[Truth]) -> Self {
        let needed = |names: &[&str]| truths.iter().any(|truth| names.contains(&truth.effect.as_str()));
        Self { temp_c: needed(&["thermal_zero", "thermal_gain"]), cycle: needed(&["ageing"]) }
    }
}

/// The measured channels and what the reference wrote, row for row.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    pub(crate) rows: Vec<Row>,
    pub(crate) labels: Vec<Contact>,
    pub(crate) channels: Vec<[f64; 9]>,
    pub(crate) columns: Columns,
}

/// Adds a contribution of no catalogue to the strain.
pub(crate) type Unknown<'a> = &'a dyn Fn(&[Contact], &mut [[f64; 9]]);

/// Which pad and which recording of it: the background belongs to the pad, noise and phases to the recording.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seeds {
    pub(crate) pad: u64,
    pub(crate) recording: u64,
}

/// Carries out a plan on the pad with its hidden effects.
pub(crate) fn measured(
    rows: Vec<Row>,
    truths: &[Truth],
    quality: &Quality,
    unknown: Unknown,
    seeds: Seeds,
) -> Measured {
    let drawn = |name: &str| Random::new(seeds.recording, name);
    let rms = typical(&rows);
    let full_scale = largest(&rows);
    let contacts = rig::true_contacts(truths, &rows);
    let mut signal = strain(truths, &contacts, quality);
    let smooth =
        background(&rows, &contacts, &rms, quality.background, &mut Random::new(seeds.pad, "background"));
    for (signal, smooth) in signal.iter_mut().flatten().zip(smooth.iter().flatten()) {
        *signal += smooth;
    }
    unknown(&contacts, &mut signal);
    memory::remember(truths, &rows, &mut signal, &full_scale);
    electrical::conduct(truths, &rows, &mut signal, &full_scale, &mut drawn("connectors"));
    warmth::warm(truths, &rows, &mut signal);
    electrical::add(truths, &rows, &mut signal, &mut drawn("mains"));
    add_noise(truths, &rows, &mut signal, &rms, quality, &mut drawn("noise"));
    electrical::convert(truths, &mut signal, &mut drawn("wires"));
    let labels = rig::labels(truths, &rows);
    Measured { rows, labels, channels: signal, columns: Columns::of(truths) }
}

/// Noise of each channel; within a series it remembers the sample before.
fn add_noise(
    truths: &[Truth],
    rows: &[Row],
    signals: &mut [[f64; 9]],
    rms: &[f64; 9],
    quality: &Quality,
    random: &mut Random,
) {
    let is_mixed = rows.iter().any(|row| row.in_trial_s.is_none());
    let mut last = [0.0; 9];
    for (index, signal) in signals.iter_mut().enumerate() {
        let goes_on =
            rows[index].in_trial_s.is_some() && index > 0 && rows[index - 1].trial == rows[index].trial;
        let in_series = is_mixed && rows[index].in_trial_s.is_some();
        let kind = if in_series { quality.readings.sqrt() } else { 1.0 };
        let memory = if goes_on { quality.memory } else { 0.0 };
        for channel in 0..9 {
            last[channel] = memory * last[channel] + (1.0 - memory * memory).sqrt() * random.normal();
            let [additive, multiplicative] = quality.noise[channel];
            let deviation = (additive * rms[channel]).hypot(multiplicative * signal[channel]);
            signal[channel] += kind * deviation * electrical::noise_factor(truths, channel) * last[channel];
        }
    }
}

/// What the mechanics make of the contacts.
pub(crate) fn strain(truths: &[Truth], contacts: &[Contact], quality: &Quality) -> Vec<[f64; 9]> {
    let read = |contact: &Contact| {
        let mut signal = signals(&mechanical::influence(truths, contact.place), contact.force);
        signal.iter_mut().enumerate().for_each(|(channel, signal)| *signal *= quality.kinds[channel % 3]);
        signal
    };
    let mut signals: Vec<[f64; 9]> = contacts.iter().map(read).collect();
    taken::add(truths, contacts, &mut signals);
    signals
}

fn nominal(rows: &[Row]) -> Vec<[f64; 9]> {
    rows.iter().map(|row| signals(&NOMINAL.at(row.contact.place), row.contact.force)).collect()
}

/// The rms of each channel over a plan's loaded rows.
pub(crate) fn typical(rows: &[Row]) -> [f64; 9] {
    let nominal = nominal(rows);
    std::array::from_fn(|channel| rms_of(rows, &nominal, channel))
}

/// The largest magnitude of each channel over a plan: its full scale.
pub(crate) fn largest(rows: &[Row]) -> [f64; 9] {
    let nominal = nominal(rows);
    std::array::from_fn(|channel| {
        nominal.iter().fold(0.0, |largest, row| f64::max(largest, row[channel].abs()))
    })
}

impl Measured {
    /// The table as a file.
    pub(crate) fn csv(&self) -> String {
        let mut text = String::from("trial,session,t_s,");
        text += if self.columns.temp_c { "temp_c," } else { "" };
        text += if self.columns.cycle { "cycle," } else { "" };
        text += "x_mm,y_mm,fx_n,fy_n,fz_n";
        CHANNELS.iter().for_each(|channel| write!(text, ",{channel}_uv").unwrap());
        text += ",dwell_s,approach,turned_deg,weight_g\n";
        for ((row, label), channels) in self.rows.iter().zip(&self.labels).zip(&self.channels) {
            write!(text, "{},{},{:.4}", row.trial, row.session, row.time_s).unwrap();
            if self.columns.temp_c {
                write!(text, ",{:.3}", row.temp_c).unwrap();
            }
            if self.columns.cycle {
                write!(text, ",{}", row.cycle).unwrap();
            }
            label.place.iter().for_each(|place| write!(text, ",{place:.3}").unwrap());
            label.force.iter().for_each(|force| write!(text, ",{force:.4}").unwrap());
            channels.iter().for_each(|channel| write!(text, ",{channel:.3}").unwrap());
            let approach = match (row.in_trial_s.is_some() || !row.loaded(), row.unloading) {
                (true, _) => "",
                (_, true) => "unloading",
                (_, false) => "loading",
            };
            let weight_g = row.weight_g.map_or_else(String::new, |weight_g| weight_g.to_string());
            writeln!(text, ",{},{approach},{},{weight_g}", row.dwell_s, row.turned_deg).unwrap();
        }
        text
    }
}
