//! One hidden case: what is hidden, where, how well it is measured; and the run of the program on it.

use std::fs;
use std::path::PathBuf;

use serde_json::{Value, json};

use crate::background::{Smooth, rms_of};
use crate::measured::{Columns, Measured, Quality, Seeds, measured};
use crate::plan::{Contact, Plan, Room, Row, carry_out};
use crate::program::{diagnosed, folder};
use crate::random::Random;
use crate::truth::Truth;

/// What no catalogue has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outside {
    Nothing,
    /// A smooth bump around one place in one module's channels.
    Dent,
    /// A term in fx·fy in all channels, with a map over the plate of its own.
    Product,
}

/// One hidden case.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    /// Its name, which no other has.
    pub(crate) key: String,
    pub(crate) seed: u64,
    pub(crate) plan: Plan,
    pub(crate) room: Room,
    pub(crate) quality: Quality,
    pub(crate) truths: Vec<Truth>,
    pub(crate) outside: Outside,
    /// Columns beyond those that the causes need.
    pub(crate) columns: Columns,
}

impl Case {
    pub(crate) fn new(key: &str, seed: u64, plan: Plan, truths: Vec<Truth>) -> Self {
        Self {
            key: key.to_owned(),
            seed,
            plan,
            room: Room::UpAndDown,
            quality: Quality::drawn(&mut Random::new(seed, "quality")),
            columns: Columns::of(&truths),
            truths,
            outside: Outside::Nothing,
        }
    }

    /// The plan as it is carried out.
    pub(crate) fn rows(&self) -> Vec<Row> {
        let mut rows = self.plan.rows(self.seed);
        carry_out(&mut rows, self.room, &mut Random::new(self.seed, "course"));
        // A large contact does not fit on the plate's edge.
        let radius = self.truths.iter().map(|truth| truth.value_or_zero("radius_mm")).fold(1.0, f64::max);
        rows.retain(|row| row.contact.place[0].hypot(row.contact.place[1]) <= 30.0 - radius);
        rows
    }

    /// The table; another recording of the same pad has other noise.
    pub(crate) fn table(&self, recording: u64) -> Measured {
        let rows = self.rows();
        let seeds = Seeds {
            pad: Random::new(self.seed, &self.key).below(1 << 40) as u64,
            recording: Random::new(self.seed, &format!("{} {recording}", self.key)).below(1 << 40) as u64,
        };
        let loaded = rows.clone();
        let unknown = |contacts: &[Contact], signals: &mut [[f64; 9]]| {
            let random = &mut Random::new(self.seed, "outside");
            let extra = match self.outside {
                Outside::Nothing => return,
                Outside::Dent => dent(contacts, signals, random),
                Outside::Product => product(contacts, random),
            };
            let share = random.between(0.08, 0.1);
            for channel in 0..9 {
                let [own, whole] = [&extra, &*signals].map(|values| rms_of(&loaded, values, channel));
                let scale = if own > 0.0 { share * whole / own } else { 0.0 };
                signals
                    .iter_mut()
                    .zip(&extra)
                    .for_each(|(signal, extra)| signal[channel] += scale * extra[channel]);
            }
        };
        let mut table = measured(rows, &self.truths, &self.quality, &unknown, seeds);
        table.columns = self.columns;
        table
    }

    /// Writes the table and gives its place.
    pub(crate) fn written(&self, recording: u64) -> PathBuf {
        let file = folder("tables").join(format!("{}-{recording}.csv", self.key));
        fs::write(&file, self.table(recording).csv()).unwrap();
        file
    }

    /// What the program finds in the table, which is taken away afterwards.
    pub(crate) fn diagnosed(&self, more: &[&str]) -> Result<Value, String> {
        let file = self.written(0);
        let found = diagnosed(&file, more);
        fs::remove_file(file).unwrap();
        found
    }

    /// What stands beside the table for people.
    pub(crate) fn truth(&self) -> Value {
        let truths: Vec<Value> = self.truths.iter().map(Truth::json).collect();
        json!({"plan": self.plan.name(), "seed": self.seed, "background": self.quality.background, "truths": truths})
    }
}

/// A bump 8 mm wide in what the channels of one module read.
fn dent(contacts: &[Contact], signals: &[[f64; 9]], random: &mut Random) -> Vec<[f64; 9]> {
    let module = random.below(3);
    let (sin, cos) = (120.0 * module as f64 + random.between(-50.0, 50.0)).to_radians().sin_cos();
    let radius = random.between(8.0, 20.0);
    let bump = |contact: &Contact| {
        let away = (contact.place[0] - radius * cos).hypot(contact.place[1] - radius * sin);
        (-away * away / (2.0 * 8.0 * 8.0)).exp()
    };
    let dented = |(contact, signal): (&Contact, &[f64; 9])| {
        std::array::from_fn(
            |channel| if channel / 3 == module { bump(contact) * signal[channel] } else { 0.0 },
        )
    };
    contacts.iter().zip(signals).map(dented).collect()
}

fn product(contacts: &[Contact], random: &mut Random) -> Vec<[f64; 9]> {
    let map = Smooth::new(15.0, random);
    let strengths: [f64; 9] = std::array::from_fn(|_| random.sign());
    let term = |contact: &Contact| {
        let value = map.at(contact.place) * contact.force[0] * contact.force[1];
        strengths.map(|strength| strength * value)
    };
    contacts.iter().map(term).collect()
}
