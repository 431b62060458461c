//! A calibration at home on another program's fields, whose map is off smoothly besides: a thousand presses without labels, and
//! 200 g on five marks.
//!
//! Goals, on unseen contacts of twenty pads: medians of 0.21 mm and 0.025 N, no pad beyond 0.35 mm, 90 to 98 % in the regions and no pad
//! below 80 %. What such presses tell at best stands beside them ([`Information`]): of a pad whose moduli are not known, less than that of forces.

use std::ops::RangeInclusive;

use tactpad::lab::field_cache;
use tactpad::lab::play::home::{AtHome, calibrated};
use tactpad::lab::play::weights::Placement;
use tactpad::lab::play::windows::{SampleContext, Window, WindowCollector};
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::quantity;

use super::UNSEEN;
use super::bound::{Background, Hidden};
use super::cases::{CASES, FIELDS};
use super::judged::{Summary, decoded_by};
use super::memory::Memory;
use super::pad::{Changes, Recorded, Wiring, full_scale, plan, recorded, weighed};
use super::unlabelled::{Information, Labelled, Unknown};
use crate::fields::Table;
use crate::plan::Contact;

const PRESSES: usize = 1000;
const WEIGHT_G: f64 = 200.0;
const WEIGHT_N: f64 = 9.806_65e-3 * WEIGHT_G;
const MARKS_MM: [[f64; 2]; 5] = [[0.0, 0.0], [15.0, 0.0], [-15.0, 0.0], [0.0, 15.0], [0.0, -15.0]];
/// Placed within 0.7 mm, as nineteen of twenty.
const OFF_MM: f64 = 0.35;
/// How well its force is known, for the bound.
const WEIGHT_OFF_N: f64 = 1e-3;
/// A press lasts one window, a weight three seconds.
const SAMPLE_S: f64 = 0.01;
const PRESS_S: f64 = 0.1;
const WEIGHT_S: f64 = 3.0;
const REST_S: f64 = 0.4;

/// Windows of a recording, and the moments at which its contacts were there.
fn windows(recorded: &Recorded, press_s: f64, gatherer: &mut WindowCollector, at_s: &mut f64) -> Vec<f64> {
    let mut moments = Vec::new();
    for (contact, uv) in recorded.truths.iter().zip(&recorded.measured.channels) {
        let is_rest = contact.force == [0.0; 3];
        let lasting_s = if is_rest { REST_S } else { press_s };
        if !is_rest {
            moments.push(*at_s + 0.5 * lasting_s);
        }
        for _ in 0..(lasting_s / SAMPLE_S).round() as usize {
            gatherer.push(
                *at_s,
                uv,
                None,
                if is_rest { SampleContext::Nothing } else { SampleContext::Contact(said(contact)) },
            );
            *at_s += SAMPLE_S;
        }
    }
    moments
}

/// About what another pad's decoder says: a quarter too much force, a millimetre off.
fn said(contact: &Contact) -> quantity::Contact {
    let ([x, y], [fx, fy, fz]) = (contact.place, contact.force);
    let [x_mm, y_mm, fx_n, fy_n, fz_n] =
        [x + 0.7, y - 0.7, 1.25 * fx, 1.25 * fy, 1.25 * fz].map(|it| it as f32);
    quantity::Contact { x_mm, y_mm, fx_n, fy_n, fz_n }
}

/// By how much fields are off smoothly, as a share of each map's root mean square, and how smoothly.
const BACKGROUND: f64 = 0.015;
const BACKGROUND_MM: f64 = 14.0;

/// A pad of a seed, as it is played on and as it is tried.
struct Pad {
    name: &'static str,
    table: &'static Table,
    wiring: Wiring,
    background: Background,
    presses: Recorded,
    weights: Recorded,
    unseen: Recorded,
}

impl Pad {
    fn drawn(seed: u64) -> Self {
        let case = &CASES[..FIELDS][seed as usize % FIELDS];
        let table: &Table = case.table;
        let wiring = Wiring::drawn_wide(seed);
        let background = Background::drawn(table, BACKGROUND, BACKGROUND_MM, seed);
        let changes = Changes { table, memory: Memory::Nothing, rig: &[], background: Some(&background) };
        let presses = apart(plan(PRESSES, seed, "calibrated at home"));
        let weights = weighed(WEIGHT_N, &MARKS_MM, OFF_MM, seed);
        let unseen = plan(UNSEEN, seed, "calibrated unseen");
        let [pressed, tried] = [&presses, &unseen].map(|rows| full_scale(rows));
        let [presses, weights] = [(presses, 2 * seed), (weights, 2 * seed + 1)]
            .map(|(rows, seed)| recorded(rows, &changes, &wiring, &pressed, seed));
        let unseen = recorded(unseen, &changes, &wiring, &tried, 2 * seed + 1_001);
        Self { name: case.name, table, wiring, background, presses, weights, unseen }
    }

    fn played(&self) -> (Vec<Window>, Vec<Placement>) {
        let (mut gatherer, mut at_s) = (WindowCollector::default(), 0.0);
        windows(&self.presses, PRESS_S, &mut gatherer, &mut at_s);
        let moments = windows(&self.weights, WEIGHT_S, &mut gatherer, &mut at_s);
        let placement =
            |(at_s, place_mm): (f64, [f64; 2])| Placement { line: 0, at_s, place_mm, weight_g: WEIGHT_G };
        (gatherer.finish(), moments.into_iter().zip(MARKS_MM).map(placement).collect())
    }

    /// Mean errors of place (mm) and force (N) at the Bayesian Cramér–Rao bound of the presses and the weight.
    fn bound(&self, unknown: Unknown) -> [f64; 2] {
        let [mm, n] = [OFF_MM, WEIGHT_OFF_N].map(|deviation: f64| deviation.powi(-2));
        let presses = loaded(&self.presses).map(|contact| (contact, [0.0; 5]));
        let weights = loaded(&self.weights).map(|contact| (contact, [mm, mm, n, n, n]));
        let known: Vec<Labelled> = presses.chain(weights).collect();
        let hidden = Hidden { table: self.table, background: &self.background, wiring: &self.wiring };
        let information = Information::of(hidden, unknown, &known);
        let unseen: Vec<Contact> = loaded(&self.unseen).collect();
        hidden.bound(&unseen, |contact| information.unknown(contact))
    }
}

fn loaded(recorded: &Recorded) -> impl Iterator<Item = Contact> {
    recorded.truths.iter().copied().filter(|contact| contact.force != [0.0; 3])
}

/// The plan with a reading of the untouched pad behind each press: fingers lift.
fn apart(rows: Vec<crate::plan::Row>) -> Vec<crate::plan::Row> {
    let rest = rows[0].clone();
    rows.into_iter().flat_map(|row| [row, rest.clone()]).collect()
}

/// Errors of place and force against the truth, and the share of truths in the stated regions.
fn tried(seed: u64) -> Summary {
    let pad = Pad::drawn(seed);
    let (windows, placements) = pad.played();
    let nominal = PadField::nominal();
    let device = Device::nominal();
    let known = SimulatedPad { solve: &field_cache::solve, ..SimulatedPad::known(&device, &nominal) };
    let found: AtHome = calibrated(&windows, &placements, &known, None, &|_, _| ()).unwrap();
    let unseen = &pad.unseen;
    let decoded = decoded_by(&found.calibration.decoder(), unseen.measured.csv().as_bytes(), &unseen.truths);
    let summary = Summary::of(&decoded, |_| true);
    let Summary { place_mm, force_n, covered, .. } = summary;
    println!(
        "pad {seed:2}, {}: {place_mm:.3} mm, {force_n:.4} N, {covered:.3} inside, {} presses, background {:.2} %",
        pad.name,
        found.presses,
        100.0 * found.calibration.background
    );
    summary
}

const MEDIANS_MOST: [f64; 2] = [0.21, 0.025];
const WORST_MOST_MM: f64 = 0.35;
const COVERED_POOLED: RangeInclusive<f64> = 0.9..=0.98;
const COVERED_LEAST: f64 = 0.8;

#[test]
#[ignore = "proof: 60 s: tests/lab and tests/program have smaller ones on the simulator's field"]
fn a_thousand_presses_without_labels_and_a_weight() {
    let pad = tried(6);
    assert!(pad.place_mm <= WORST_MOST_MM && pad.covered >= COVERED_LEAST, "{pad:?}");
}

#[test]
#[ignore = "proof: 1500 s: misses its goals, as docs/decoding.md says: twenty pads instead of one"]
fn a_thousand_presses_without_labels_and_a_weight_on_twenty_pads() {
    let pads: Vec<Summary> = (1..=20).map(tried).collect();
    let covered = pads.iter().map(|it| it.covered).sum::<f64>() / pads.len() as f64;
    let median = |of: fn(&Summary) -> f64| {
        let mut values: Vec<f64> = pads.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        0.5 * (values[values.len() / 2] + values[(values.len() - 1) / 2])
    };
    let medians = [median(|it| it.place_mm), median(|it| it.force_n)];
    println!("medians {:.3} mm, {:.4} N; {covered:.3} inside", medians[0], medians[1]);
    assert!(medians.iter().zip(MEDIANS_MOST).all(|(median, most)| *median <= most), "{medians:?}");
    let far: Vec<&Summary> =
        pads.iter().filter(|it| it.place_mm > WORST_MOST_MM || it.covered < COVERED_LEAST).collect();
    assert!(far.is_empty(), "{far:?}");
    assert!(COVERED_POOLED.contains(&covered), "{covered}");
}

/// What is asked of forces is more than the presses tell where moduli and poses are known no better than hands and materials have them.
#[test]
#[ignore = "proof: 150 s: the bound of six pads, one of each field, with what is known of it and what is not"]
fn what_a_thousand_presses_without_labels_tell_at_best() {
    for seed in 1..=6 {
        let pad = Pad::drawn(seed);
        let bound = |background, device| pad.bound(Unknown { background, device });
        let bounds = [(false, false), (false, true), (true, false), (true, true)]
            .map(|(background, device)| bound(background, device));
        println!(
            "pad {seed}, {}: gains and leaks {:.3?}, device {:.3?}, background {:.3?}, all {:.3?}",
            pad.name, bounds[0], bounds[1], bounds[2], bounds[3]
        );
        // What is known cannot make it worse.
        assert!(bounds.iter().all(|[mm, n]| bounds[0][0] <= *mm && bounds[0][1] <= *n), "{bounds:?}");
        assert!(bounds[3][1] > MEDIANS_MOST[1], "{bounds:?}");
    }
}
