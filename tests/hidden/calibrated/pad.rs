//! A pad as a rig measures it: contacts, wiring, noise and labels, each with a stream of random numbers of its own, so that
//! the cases of a seed differ in nothing but what they are about.

use std::f64::consts::TAU;

use super::bound::Background;
use super::memory::Memory;
use crate::effects::rig;
use crate::fields::{Table, signals};
use crate::measured::{Columns, Measured, largest};
use crate::plan::{Contact, Room, Row, carry_out};
use crate::random::Random;
use crate::truth::{CHANNELS, Truth};

/// Contacts are even over the plate out to here, in mm …
pub(super) const REACH_MM: f64 = 26.0;
/// … even in solid angle up to here off the normal …
const TILT_MAX_DEG: f64 = 40.0;
/// … and even in force between these, in newtons. From above come half of those that leave it room.
pub(super) const FORCES_N: [f64; 2] = [0.5, 5.0];
const UNLOADING_MAX_N: f64 = 4.0;
/// How long they are held, in seconds.
const DWELLS_S: [f64; 2] = [2.0, 20.0];
/// Contacts from one reading of the untouched pad to the next.
const BETWEEN_ZEROS: usize = 24;
/// Deviation of the gains from 1.
const GAIN: f64 = 0.1;
pub(super) const WIDE_GAIN: f64 = 0.25;
/// Leaks from channel to channel: how many, and how large.
const LEAKS: usize = 10;
pub(super) const LEAK: f64 = 0.015;
/// What bridges are out of balance by, in µV.
const OFFSET_UV: f64 = 300.0;
/// Noise, new for each contact: a share of the signal, and µV.
const NOISE: f64 = 0.013;
const NOISE_UV: f64 = 5.0;
/// What the rig's labels are off by, along each axis.
pub(super) const LABEL_MM: f64 = 0.05;
pub(super) const LABEL_N: f64 = 0.01;

/// What the wires make of the strains.
#[derive(Debug, Clone)]
pub(super) struct Wiring {
    pub(super) gains: [f64; 9],
    /// Into, from, and the share of what the other channel reads.
    pub(super) leaks: Vec<(usize, usize, f64)>,
    offsets_uv: [f64; 9],
}

/// What a case changes of the nominal pad on a perfect rig.
#[derive(Debug)]
pub(super) struct Changes<'a> {
    pub(super) table: &'a Table,
    pub(super) memory: Memory,
    /// What the rig does wrong.
    pub(super) rig: &'a [Truth],
    /// By what the field is off from any simulator's.
    pub(super) background: Option<&'a Background>,
}

/// A recording, and what was really done.
#[derive(Debug)]
pub(super) struct Recorded {
    pub(super) measured: Measured,
    pub(super) truths: Vec<Contact>,
}

impl Wiring {
    pub(super) fn drawn(seed: u64) -> Self {
        let random = &mut Random::new(seed, "calibrated wiring");
        let gains = std::array::from_fn(|_| 1.0 + GAIN * random.normal());
        let offsets_uv = std::array::from_fn(|_| OFFSET_UV * random.normal());
        let mut leaks: Vec<(usize, usize, f64)> = Vec::new();
        while leaks.len() < LEAKS {
            let into = random.below(9);
            let from = (into + 1 + random.below(8)) % 9;
            if !leaks.iter().any(|leak| (leak.0, leak.1) == (into, from)) {
                leaks.push((into, from, LEAK * random.sign()));
            }
        }
        Self { gains, leaks, offsets_uv }
    }

    /// Gains off by up to a quarter, and a leak from each channel to each other one.
    pub(super) fn drawn_wide(seed: u64) -> Self {
        let random = &mut Random::new(seed, "calibrated wide wiring");
        let gains = std::array::from_fn(|_| random.between(1.0 - WIDE_GAIN, 1.0 + WIDE_GAIN));
        let pairs = (0..81).map(|index| (index / 9, index % 9)).filter(|(into, from)| into != from);
        let leaks = pairs.map(|(into, from)| (into, from, LEAK * random.normal())).collect();
        Self { gains, leaks, offsets_uv: std::array::from_fn(|_| OFFSET_UV * random.normal()) }
    }

    /// Gains, then leaks of what the others read, then what the bridges are out of balance by.
    fn conduct(&self, strain: &[f64; 9]) -> [f64; 9] {
        let read = self.beyond_zero(strain);
        std::array::from_fn(|channel| read[channel] + self.offsets_uv[channel])
    }

    /// The same without what bridges are out of balance by.
    pub(super) fn beyond_zero(&self, strain: &[f64; 9]) -> [f64; 9] {
        let own: [f64; 9] = std::array::from_fn(|channel| self.gains[channel] * strain[channel]);
        let mut read = own;
        self.leaks.iter().for_each(|(into, from, share)| read[*into] += share * own[*from]);
        read
    }

    /// What is hidden, in the program's words.
    pub(super) fn truths(&self) -> Vec<Truth> {
        let gain = |(name, gain): (&&str, f64)| Truth::new("channel_gain", name, &[("gain", gain)]);
        let offset = |(name, uv): (&&str, f64)| Truth::new("channel_offset", name, &[("offset_uv", uv)]);
        let leak = |(into, from, share): &(usize, usize, f64)| {
            Truth::new("channel_crosstalk", CHANNELS[*into], &[("share", *share)]).with(CHANNELS[*from])
        };
        let gains = CHANNELS.iter().zip(self.gains).map(gain);
        let offsets = CHANNELS.iter().zip(self.offsets_uv).map(offset);
        gains.chain(offsets).chain(self.leaks.iter().map(leak)).collect()
    }
}

/// A press at the centre.
pub(super) fn pressed(normal_n: f64, dwell_s: f64) -> Row {
    row(Contact { place: [0.0; 2], force: [0.0, 0.0, normal_n] }, dwell_s, false)
}

fn row(contact: Contact, dwell_s: f64, unloading: bool) -> Row {
    Row {
        trial: String::new(),
        session: if contact.force == [0.0; 3] { "zero" } else { "contacts" }.to_owned(),
        in_trial_s: None,
        time_s: 0.0,
        temp_c: 25.0,
        cycle: 0.0,
        contact,
        dwell_s,
        unloading,
        turned_deg: 0.0,
        weight_g: None,
    }
}

/// A weight of so many newtons on marks, off them along each axis by the given deviation, with the pad untouched between them.
pub(super) fn weighed(normal_n: f64, marks_mm: &[[f64; 2]], off_mm: f64, seed: u64) -> Vec<Row> {
    let random = &mut Random::new(seed, "calibrated weights");
    let placed = |mark_mm: &[f64; 2]| {
        let place = mark_mm.map(|mm| mm + off_mm * random.normal());
        [row(Contact { place, force: [0.0, 0.0, normal_n] }, DWELLS_S[0], false), pressed(0.0, DWELLS_S[0])]
    };
    let mut rows: Vec<Row> = marks_mm.iter().flat_map(placed).collect();
    carry_out(&mut rows, Room::UpAndDown, &mut Random::new(seed, "calibrated weights' room"));
    rows
}

/// So many contacts all over the plate, with readings of the untouched pad between them and at the end.
pub(super) fn plan(count: usize, seed: u64, name: &str) -> Vec<Row> {
    let random = &mut Random::new(seed, name);
    let mut rows = Vec::new();
    for index in 0..count {
        if index % BETWEEN_ZEROS == 0 {
            rows.push(pressed(0.0, DWELLS_S[0]));
        }
        rows.push(contact(random));
    }
    rows.push(pressed(0.0, DWELLS_S[0]));
    carry_out(&mut rows, Room::UpAndDown, &mut Random::new(seed, "calibrated room"));
    rows
}

fn contact(random: &mut Random) -> Row {
    let (radius, (sin, cos)) = (REACH_MM * random.unit().sqrt(), (TAU * random.unit()).sin_cos());
    let place = [radius * cos, radius * sin];
    let force_n = random.between(FORCES_N[0], FORCES_N[1]);
    let normal = random.between(TILT_MAX_DEG.to_radians().cos(), 1.0);
    let (sin, cos) = (TAU * random.unit()).sin_cos();
    let shear = (1.0 - normal * normal).sqrt();
    let force = [shear * cos, shear * sin, normal].map(|share| force_n * share);
    let [dwell_s, unloading] = [0.0, 1.0].map(|_| random.below(2));
    row(Contact { place, force }, DWELLS_S[dwell_s], unloading == 1 && force_n < UNLOADING_MAX_N)
}

/// Deviation of a reading so far beyond its zero.
pub(super) fn noise_uv(beyond_zero_uv: f64) -> f64 {
    (NOISE * beyond_zero_uv).hypot(NOISE_UV)
}

/// Carries out a plan. `full_scale` is each channel's, for what the pad remembers.
pub(super) fn recorded(
    rows: Vec<Row>,
    changes: &Changes,
    wiring: &Wiring,
    full_scale: &[f64; 9],
    seed: u64,
) -> Recorded {
    let truths = rig::true_contacts(changes.rig, &rows);
    let mut strains: Vec<[f64; 9]> =
        truths.iter().map(|contact| signals(&changes.table.at(contact.place), contact.force)).collect();
    if let Some(background) = changes.background {
        for (strain, contact) in strains.iter_mut().zip(&truths) {
            strain.iter_mut().zip(background.uv(contact)).for_each(|(strain, uv)| *strain += uv);
        }
    }
    changes.memory.remember(&rows, &mut strains, full_scale);
    let random = &mut Random::new(seed, "calibrated noise");
    let noisy = |strain: &[f64; 9]| {
        let signal = wiring.conduct(strain);
        std::array::from_fn(|channel| {
            let beyond_zero = signal[channel] - wiring.offsets_uv[channel];
            signal[channel] + NOISE * beyond_zero * random.normal() + NOISE_UV * random.normal()
        })
    };
    let channels = strains.iter().map(noisy).collect();
    let labels = written(&rows, changes.rig, &mut Random::new(seed, "calibrated labels"));
    Recorded { measured: Measured { rows, labels, channels, columns: Columns::default() }, truths }
}

/// What the rig writes. Of the untouched pad it knows that nothing touches it.
fn written(rows: &[Row], faults: &[Truth], random: &mut Random) -> Vec<Contact> {
    let mut labels = rig::labels(faults, rows);
    for (label, _) in labels.iter_mut().zip(rows).filter(|(_, row)| row.loaded()) {
        label.place.iter_mut().for_each(|place| *place += LABEL_MM * random.normal());
        label.force.iter_mut().for_each(|force| *force += LABEL_N * random.normal());
    }
    labels
}

/// Each channel's full scale on the nominal pad.
pub(super) fn full_scale(rows: &[Row]) -> [f64; 9] {
    largest(rows)
}
