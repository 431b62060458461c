//! How near the decoder comes to the Cramér–Rao bound on pads whose field is off smoothly from any simulator's, seed by seed.
//!
//! The bound is that of the table at hand: unseen contacts are read once, with the noise of their readings, by somebody who
//! knows field, gains and leaks. Its mean errors are √(2/π) deviations. Of few labels it is that of somebody who knows what pads
//! are drawn from, and of this one what its labels tell ([`Learned`]).

use std::f64::consts::FRAC_2_PI;
use std::ops::RangeInclusive;

use super::cases::{CASES, Case};
use super::device::DeviceChanges;
use super::judged::{Decoded, Summary, decoded_by};
use super::learned::{Learned, inverse};
use super::memory::Memory;
use super::pad::{Changes, Wiring, full_scale, noise_uv, plan, recorded};
use crate::background::Smooth;
use crate::fields::{Table, signals};
use crate::plan::Contact;
use crate::random::Random;
use crate::truth::Truth;
use crate::two;

use tactpad::lab::contacts::Contacts;
use tactpad::lab::field_cache::solve;
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pad::changes::FieldChanges;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pipeline::contact::Decoder;
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::read;
use tactpad::tables::recording::Recording;

/// A smooth error of each channel's map of each force.
#[derive(Debug)]
pub(super) struct Background {
    /// By channel and axis, with its size in µV/N.
    maps: Vec<(Smooth, f64)>,
    pub(super) length_mm: f64,
}

impl Background {
    /// Of this share of each map's root mean square over the plate, and this length in mm.
    pub(super) fn drawn(table: &Table, share: f64, length_mm: f64, seed: u64) -> Self {
        let random = &mut Random::new(seed, "calibrated background");
        let places: Vec<[f64; 2]> = (0..400)
            .map(|index| {
                let (radius, angle) =
                    (29.0 * (f64::from(index) / 400.0).sqrt(), f64::from(index) * 2.399_963);
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        let maps = (0..27)
            .map(|map| {
                let square = |place: &[f64; 2]| table.at(*place)[map / 3][map % 3].powi(2);
                let rms = (places.iter().map(square).sum::<f64>() / places.len() as f64).sqrt();
                (Smooth::new(length_mm, random), share * rms)
            })
            .collect();
        Self { maps, length_mm }
    }

    /// Deviation of a map, µV/N.
    pub(super) fn deviation(&self, channel: usize, axis: usize) -> f64 {
        self.maps[3 * channel + axis].1
    }

    /// What it adds to the channels, µV.
    pub(super) fn uv(&self, contact: &Contact) -> [f64; 9] {
        let map = |channel: usize, axis: usize| {
            let (smooth, size) = &self.maps[3 * channel + axis];
            size * smooth.at(contact.place) * contact.force[axis]
        };
        std::array::from_fn(|channel| (0..3).map(|axis| map(channel, axis)).sum())
    }
}

/// A pad with all that is hidden of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hidden<'h> {
    pub(super) table: &'h Table,
    pub(super) background: &'h Background,
    pub(super) wiring: &'h Wiring,
}

impl Hidden<'_> {
    /// The channels' strains, without gains and leaks.
    pub(super) fn strain(&self, contact: &Contact) -> [f64; 9] {
        let mut strain = signals(&self.table.at(contact.place), contact.force);
        strain.iter_mut().zip(self.background.uv(contact)).for_each(|(strain, uv)| *strain += uv);
        strain
    }

    /// What it reads beyond its zeros.
    fn read(&self, numbers: [f64; 5]) -> [f64; 9] {
        let [x, y, fx, fy, fz] = numbers;
        self.wiring.beyond_zero(&self.strain(&Contact { place: [x, y], force: [fx, fy, fz] }))
    }

    /// Derivatives of the channels by x, y, Fx, Fy, Fz, and the variances of a reading's noise.
    pub(super) fn linearised(&self, contact: &Contact) -> ([[f64; 9]; 5], [f64; 9]) {
        let Contact { place: [x, y], force: [fx, fy, fz] } = *contact;
        let numbers = [x, y, fx, fy, fz];
        let slopes = std::array::from_fn(|axis| {
            let step = 1e-3;
            let [below, above] = [-step, step].map(|by| {
                let mut moved = numbers;
                moved[axis] += by;
                self.read(moved)
            });
            std::array::from_fn(|channel| (above[channel] - below[channel]) / (2.0 * step))
        });
        (slopes, self.read(numbers).map(|uv| noise_uv(uv).powi(2)))
    }

    /// Covariance of a contact's readings by a fault of the rig that nobody knows of: normal, of its own size, and an offset of the
    /// stage no larger than three modules that were put down wrongly in the same way, which look like it.
    fn unknown_by_rig(&self, rig: &[Truth], contact: &Contact) -> [[f64; 9]; 9] {
        let mut covariance = [[0.0; 9]; 9];
        let mut add = |deviation: f64, slope: &[f64; 9]| {
            for (row, i) in covariance.iter_mut().zip(0..9) {
                row.iter_mut().zip(slope).for_each(|(entry, other)| {
                    *entry += deviation * deviation * slope[i] * other;
                });
            }
        };
        let (slopes, _) = self.linearised(contact);
        for fault in rig {
            let number = |name: &str| -> f64 {
                fault.parameters.iter().find(|(own, _)| own == name).map_or(0.0, |(_, value)| *value)
            };
            match &*fault.effect {
                "stage_offset" => {
                    let fault_mm = number("x_mm").hypot(number("y_mm")) / 2_f64.sqrt();
                    let modules_mm = POSE_MM / 3_f64.sqrt();
                    let told_mm = (fault_mm.powi(-2) + modules_mm.powi(-2)).powf(-0.5);
                    slopes[..2].iter().for_each(|slope| add(told_mm, slope));
                }
                "reference_gain" => {
                    let signals = std::array::from_fn(|channel| {
                        (0..3).map(|axis| contact.force[axis] * slopes[2 + axis][channel]).sum()
                    });
                    add(number("gain") - 1.0, &signals);
                }
                _ => (),
            }
        }
        covariance
    }

    /// Mean errors of place (mm) and force (N) at the bound, with what is not known of the pad.
    pub(super) fn bound(
        &self,
        contacts: &[Contact],
        unknown: impl Fn(&Contact) -> [[f64; 9]; 9],
    ) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for contact in contacts {
            let (slopes, variances) = self.linearised(contact);
            let mut covariance = unknown(contact);
            (0..9).for_each(|channel| covariance[channel][channel] += variances[channel]);
            let weights = inverse(covariance);
            // (JᵀWJ)⁻¹
            let information: [[f64; 5]; 5] = std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let weighted =
                        weights.map(|row| row.iter().zip(slopes[j]).map(|(w, slope)| w * slope).sum());
                    slopes[i]
                        .iter()
                        .zip(weighted)
                        .map(|(slope, weighted): (&f64, f64)| slope * weighted)
                        .sum()
                })
            });
            let of = inverse(information);
            let mean = |axes: std::ops::Range<usize>| {
                let count = axes.len() as f64;
                axes.map(|axis| (FRAC_2_PI * of[axis][axis]).sqrt()).sum::<f64>() / count
            };
            sums[0] += mean(0..2);
            sums[1] += mean(2..5);
        }
        sums.map(|sum| sum / contacts.len() as f64)
    }
}

/// What came of a seed: errors over the bound, and the share in the regions.
#[derive(Debug, Clone, Copy)]
#[expect(dead_code, reason = "printed where it is too far")]
struct Outcome {
    seed: u64,
    place: f64,
    force: f64,
    covered: f64,
    /// Errors over the bound that knows no more than the labels tell, of gains, leaks and background; 0 where that takes too long.
    learned: [f64; 2],
    /// The same of somebody to whom the numbers of the device are those of any pad, too, as `adapt` has it.
    declared: [f64; 2],
}

/// Of more labels the bound that has to learn takes too long, and is hardly another one.
const LEARNED_MAX: usize = 100;
/// By how much modules are put down wrongly along each axis.
const POSE_MM: f64 = 0.2;

/// Pads of this kind and so many labels each.
#[derive(Debug, Clone, Copy)]
struct Kind<'c> {
    contacts: usize,
    /// The background, as a share of each map's root mean square, and its length.
    share: f64,
    length_mm: f64,
    case: &'c Case,
}

impl Kind<'_> {
    const fn nominal(contacts: usize, share: f64, length_mm: f64) -> Self {
        Self { contacts, share, length_mm, case: &CASES[0] }
    }

    fn outcome(&self, seed: u64) -> Outcome {
        let Self { contacts, share, length_mm, case } = *self;
        let table: &Table = case.table;
        let wiring = Wiring::drawn_wide(seed);
        let background = Background::drawn(table, share, length_mm, seed);
        let plans = [plan(contacts, seed, "bound known"), plan(super::UNSEEN, seed, "bound unseen")];
        let full_scale = full_scale(&plans[0]);
        let rig = case.rig();
        let changes = Changes { table, memory: case.memory, rig: &rig, background: Some(&background) };
        let mut recording = 2 * seed;
        let [known, unseen] = plans.map(|plan| {
            recording += 1;
            recorded(plan, &changes, &wiring, &full_scale, recording)
        });
        let decoder = calibrated(known.measured.csv().as_bytes());
        let loaded: Vec<Contact> =
            unseen.truths.iter().copied().filter(|contact| contact.force != [0.0; 3]).collect();
        let decoded: Vec<Decoded> = decoded_by(&decoder, unseen.measured.csv().as_bytes(), &unseen.truths);
        let found = Summary::of(&decoded, |_| true);
        let hidden = Hidden { table, background: &background, wiring: &wiring };
        let over = |[place_mm, force_n]: [f64; 2]| [found.place_mm / place_mm, found.force_n / force_n];
        let [place, force] = over(hidden.bound(&loaded, |contact| hidden.unknown_by_rig(&rig, contact)));
        let [learned, declared] = [DeviceChanges::none(), DeviceChanges::of_any()].map(|device| {
            if contacts > LEARNED_MAX {
                return [0.0; 2];
            }
            let learned = Learned::of(hidden, device, &known.truths);
            over(hidden.bound(&loaded, |contact| learned.unknown(contact)))
        });
        println!(
            "{}, {contacts} labels, {:.1} % of {length_mm} mm, seed {seed}: {:.3} mm ({place:.2} of the bound), {:.4} N ({force:.2}), \
             {:.3} in the regions, over what labels tell {learned:.2?}, of the device, too, {declared:.2?}",
            case.name,
            100.0 * share,
            found.place_mm,
            found.force_n,
            found.covered
        );
        Outcome { seed, place, force, covered: found.covered, learned, declared }
    }

    fn outcomes(self, seeds: RangeInclusive<u64>) -> Vec<Outcome> {
        outcomes(&seeds.map(|seed| (self, seed)).collect::<Vec<_>>())
    }
}

fn outcomes(pads: &[(Kind<'_>, u64)]) -> Vec<Outcome> {
    two::at_a_time(pads, |(kind, seed)| kind.outcome(*seed))
}

/// What `adapt --method inverse` writes, without the names that it gives to causes beside.
fn calibrated(mut csv: &[u8]) -> Decoder {
    let (device, field) = (Device::nominal(), PadField::nominal());
    let changes = FieldChanges::nominal();
    let pad = SimulatedPad { device: &device, field: &field, flaws: &changes.0, solve: &solve };
    let table = read::table(&mut csv, TableKind::Measured, device.plate.radius_mm()).unwrap();
    let recording = Recording::tared_or_raw(table, device.contact.full_scale_n);
    let contacts = Contacts::of(vec![recording], None, 0).unwrap();
    contacts.calibration(&pad, None, &|_, _| {}).unwrap().decoder()
}

fn median(outcomes: &[Outcome], of: fn(&Outcome) -> f64) -> f64 {
    let mut values: Vec<f64> = outcomes.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// No seed's errors are further from the bound than this, and no seed's regions hold less than they should by more.
fn every_seed_is_near_the_bound(outcomes: &[Outcome]) {
    let far: Vec<&Outcome> = outcomes
        .iter()
        .filter(|it| it.place.max(it.force) > WORST_MOST || it.covered < COVERED_LEAST)
        .collect();
    assert!(far.is_empty(), "{far:?}");
}

/// Medians of place and force over the bound, and the mean share in the regions.
fn pooled(outcomes: &[Outcome]) -> ([f64; 2], f64) {
    let medians = [median(outcomes, |it| it.place), median(outcomes, |it| it.force)];
    let covered = outcomes.iter().map(|it| it.covered).sum::<f64>() / outcomes.len() as f64;
    println!("medians {medians:.3?}, {covered:.3} in the regions");
    (medians, covered)
}

const MEDIAN_MOST: f64 = 1.15;
const WORST_MOST: f64 = 1.6;
const COVERED_LEAST: f64 = 0.85;
const COVERED_POOLED: RangeInclusive<f64> = 0.92..=0.99;

#[test]
fn a_field_that_is_off_smoothly_costs_little() {
    every_seed_is_near_the_bound(&Kind::nominal(648, 0.015, 14.0).outcomes(401..=401));
}

/// The fit with a stage that is off by a third of it is a maximum, too.
#[test]
fn a_module_that_is_far_off_is_not_taken_for_a_stage() {
    let moved = CASES.iter().find(|case| case.name == "m0_moved").unwrap();
    let kind = Kind { case: moved, ..Kind::nominal(648, 0.015, 14.0) };
    every_seed_is_near_the_bound(&kind.outcomes(711..=711));
}

#[test]
#[ignore = "proof: 900 s: forty seeds instead of one"]
fn fields_that_are_off_smoothly_cost_little() {
    let outcomes = Kind::nominal(648, 0.015, 14.0).outcomes(401..=440);
    let (medians, covered) = pooled(&outcomes);
    every_seed_is_near_the_bound(&outcomes);
    assert!(COVERED_POOLED.contains(&covered));
    assert!(medians.iter().all(|median| *median <= MEDIAN_MOST));
}

/// With few labels: medians over the table's bound, and over that of who knows no more than the labels tell.
fn few_labels_are_used_well(contacts: usize, plain_most: f64, seeds: RangeInclusive<u64>) {
    let outcomes = Kind::nominal(contacts, 0.015, 14.0).outcomes(seeds);
    let (plain, covered) = pooled(&outcomes);
    let learned = [median(&outcomes, |it| it.learned[0]), median(&outcomes, |it| it.learned[1])];
    let declared = [median(&outcomes, |it| it.declared[0]), median(&outcomes, |it| it.declared[1])];
    println!("medians over what labels tell {learned:.3?}, of the device, too, {declared:.3?}");
    assert!(plain.iter().all(|median| *median <= plain_most), "{plain:?}");
    assert!(declared.iter().all(|median| *median <= MEDIAN_MOST), "{declared:?}");
    assert!(COVERED_POOLED.contains(&covered), "{covered}");
    assert!(outcomes.iter().all(|it| it.covered >= COVERED_LEAST), "{outcomes:?}");
}

#[test]
fn twenty_labels_of_a_field_that_is_off_smoothly_are_used_well() {
    let outcome = Kind::nominal(20, 0.015, 14.0).outcome(401);
    let [place, force] = outcome.declared;
    assert!(place.max(force) <= WORST_MOST && outcome.covered >= COVERED_LEAST, "{outcome:?}");
}

#[test]
#[ignore = "proof: 150 s: misses its goal of regions that hold at most 99 %, as docs/decoding.md says: forty seeds with 73 labels"]
fn seventy_three_labels_are_used_well() {
    few_labels_are_used_well(73, 1.5, 401..=440);
}

#[test]
#[ignore = "proof: 120 s: misses its goals over both bounds, as docs/decoding.md says: forty seeds with 20 labels"]
fn twenty_labels_are_used_well() {
    few_labels_are_used_well(20, 1.8, 401..=440);
}

#[test]
#[ignore = "proof: 60 s: backgrounds of other sizes and lengths"]
fn other_smooth_errors_cost_little() {
    for (share, length_mm) in [(0.0, 14.0), (0.005, 20.0)] {
        let outcomes = Kind::nominal(648, share, length_mm).outcomes(441..=444);
        pooled(&outcomes);
        assert!(outcomes.iter().all(|it| it.covered >= COVERED_LEAST), "{outcomes:?}");
    }
}

#[test]
#[ignore = "proof: 30 s: misses its goal on one pad of four, as docs/decoding.md says: a background that is larger and finer"]
fn a_large_and_fine_error_is_covered() {
    let outcomes = Kind::nominal(648, 0.03, 10.0).outcomes(441..=444);
    pooled(&outcomes);
    assert!(outcomes.iter().all(|it| it.covered >= COVERED_LEAST), "{outcomes:?}");
}

/// With a fault of the rig, the errors over the bound with that fault unknown.
const RIG_MOST: f64 = 1.3;

#[test]
#[ignore = "proof: 600 s: six fields, memories and rigs, with four backgrounds each"]
fn other_pads_and_rigs_cost_little() {
    const BACKGROUNDS: [(f64, f64); 4] = [(0.0, 14.0), (0.005, 20.0), (0.015, 14.0), (0.03, 20.0)];
    let kinds = CASES.iter().flat_map(|case| {
        BACKGROUNDS.iter().map(move |(share, length_mm)| Kind {
            contacts: 648,
            share: *share,
            length_mm: *length_mm,
            case,
        })
    });
    let pads: Vec<(Kind<'_>, u64)> = kinds.zip(701..).collect();
    let outcomes = outcomes(&pads);
    for (case, of_case) in CASES.iter().zip(outcomes.chunks(BACKGROUNDS.len())) {
        println!("{}:", case.name);
        pooled(of_case);
    }
    let too_far: Vec<&Outcome> = pads
        .iter()
        .zip(&outcomes)
        .filter(|((kind, _), outcome)| {
            let most = if kind.case.rig().is_empty() { WORST_MOST } else { RIG_MOST };
            kind.case.memory == Memory::Nothing && outcome.place.max(outcome.force) > most
                || outcome.covered < COVERED_LEAST
        })
        .map(|(_, outcome)| outcome)
        .collect();
    assert!(too_far.is_empty(), "{too_far:?}");
}
