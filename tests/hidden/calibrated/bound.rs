//! How near the decoder comes to the Cramér–Rao bound on pads whose field is off smoothly from any simulator's, seed by seed.
//!
//! The bound is that of the table at hand: unseen contacts are read once, with the noise of their readings, by somebody who
//! knows field, gains and leaks. Its mean errors are √(2/π) deviations.

use std::f64::consts::FRAC_2_PI;
use std::ops::RangeInclusive;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::judged::{Decoded, Summary, decoded_by};
use super::memory::Memory;
use super::pad::{Changes, Wiring, full_scale, noise_uv, plan, recorded};
use crate::background::Smooth;
use crate::fields::{NOMINAL, Table, signals};
use crate::plan::Contact;
use crate::random::Random;

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
        Self { maps }
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

/// Mean errors of place (mm) and force (N) at the bound.
fn bound(contacts: &[Contact], table: &Table, background: &Background, wiring: &Wiring) -> [f64; 2] {
    let read = |numbers: [f64; 5]| {
        let [x, y, fx, fy, fz] = numbers;
        let contact = Contact { place: [x, y], force: [fx, fy, fz] };
        let mut strain = signals(&table.at(contact.place), contact.force);
        strain.iter_mut().zip(background.uv(&contact)).for_each(|(strain, uv)| *strain += uv);
        wiring.beyond_zero(&strain)
    };
    let mut sums = [0.0; 2];
    for contact in contacts {
        let Contact { place: [x, y], force: [fx, fy, fz] } = *contact;
        let numbers = [x, y, fx, fy, fz];
        let weights = read(numbers).map(|uv| noise_uv(uv).powi(-2));
        let slopes: [[f64; 9]; 5] = std::array::from_fn(|axis| {
            let step = 1e-3;
            let [below, above] = [-step, step].map(|by| {
                let mut moved = numbers;
                moved[axis] += by;
                read(moved)
            });
            std::array::from_fn(|channel| (above[channel] - below[channel]) / (2.0 * step))
        });
        // (JᵀWJ)⁻¹
        let information: [[f64; 5]; 5] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..9).map(|k| slopes[i][k] * weights[k] * slopes[j][k]).sum())
        });
        let variances = inverse_diagonal(information);
        let mean = |axes: std::ops::Range<usize>| {
            let count = axes.len() as f64;
            axes.map(|axis| (FRAC_2_PI * variances[axis]).sqrt()).sum::<f64>() / count
        };
        sums[0] += mean(0..2);
        sums[1] += mean(2..5);
    }
    sums.map(|sum| sum / contacts.len() as f64)
}

/// The diagonal of a matrix's inverse, by Gauss and Jordan's elimination.
fn inverse_diagonal(mut matrix: [[f64; 5]; 5]) -> [f64; 5] {
    let mut inverse: [[f64; 5]; 5] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for pivot in 0..5 {
        let own = matrix[pivot][pivot];
        matrix[pivot] = matrix[pivot].map(|value| value / own);
        inverse[pivot] = inverse[pivot].map(|value| value / own);
        for row in (0..5).filter(|row| *row != pivot) {
            let factor = matrix[row][pivot];
            for column in 0..5 {
                matrix[row][column] -= factor * matrix[pivot][column];
                inverse[row][column] -= factor * inverse[pivot][column];
            }
        }
    }
    std::array::from_fn(|axis| inverse[axis][axis])
}

/// What came of a seed: errors over the bound, and the share in the regions.
#[derive(Debug, Clone, Copy)]
#[expect(dead_code, reason = "printed where it is too far")]
struct Outcome {
    seed: u64,
    place: f64,
    force: f64,
    covered: f64,
}

fn outcome(contacts: usize, share: f64, length_mm: f64, seed: u64) -> Outcome {
    let wiring = Wiring::drawn_wide(seed);
    let background = Background::drawn(&NOMINAL, share, length_mm, seed);
    let plans = [plan(contacts, seed, "bound known"), plan(super::UNSEEN, seed, "bound unseen")];
    let full_scale = full_scale(&plans[0]);
    let changes =
        Changes { table: &NOMINAL, memory: Memory::Nothing, rig: &[], background: Some(&background) };
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
    let [place_mm, force_n] = bound(&loaded, &NOMINAL, &background, &wiring);
    let (place, force) = (found.place_mm / place_mm, found.force_n / force_n);
    println!(
        "{contacts} labels, {:.1} % of {length_mm} mm, seed {seed}: {:.3} mm ({place:.2} of the bound), {:.4} N ({force:.2}), {:.3} in \
         the regions",
        100.0 * share,
        found.place_mm,
        found.force_n,
        found.covered
    );
    Outcome { seed, place, force, covered: found.covered }
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

/// Two seeds at a time.
fn outcomes(contacts: usize, share: f64, length_mm: f64, seeds: RangeInclusive<u64>) -> Vec<Outcome> {
    let seeds: Vec<u64> = seeds.collect();
    let (done, next) = (Mutex::new(Vec::new()), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(seed) = seeds.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let outcome = outcome(contacts, share, length_mm, *seed);
                    done.lock().unwrap().push(outcome);
                }
            });
        }
    });
    done.into_inner().unwrap()
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
    every_seed_is_near_the_bound(&outcomes(648, 0.015, 14.0, 401..=401));
}

#[test]
#[ignore = "proof: 900 s: forty seeds instead of one"]
fn fields_that_are_off_smoothly_cost_little() {
    let outcomes = outcomes(648, 0.015, 14.0, 401..=440);
    let (medians, covered) = pooled(&outcomes);
    every_seed_is_near_the_bound(&outcomes);
    assert!(COVERED_POOLED.contains(&covered));
    assert!(medians.iter().all(|median| *median <= MEDIAN_MOST));
}

#[test]
#[ignore = "proof: 400 s: backgrounds of other sizes and lengths, and fewer labels"]
fn other_smooth_errors_cost_little() {
    for (contacts, share, length_mm) in
        [(648, 0.0, 14.0), (648, 0.005, 20.0), (648, 0.03, 10.0), (73, 0.015, 14.0), (20, 0.015, 14.0)]
    {
        let outcomes = outcomes(contacts, share, length_mm, 441..=444);
        pooled(&outcomes);
        assert!(outcomes.iter().all(|it| it.covered >= COVERED_LEAST), "{outcomes:?}");
    }
}
