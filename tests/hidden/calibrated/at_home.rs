//! A calibration at home on another program's field: a thousand presses without labels, and 200 g on five marks.
//!
//! Goals: medians of 0.16 mm and 0.021 N on unseen contacts.

use tactpad::lab::field_cache;
use tactpad::lab::play::home::{AtHome, calibrated};
use tactpad::lab::play::weights::Placement;
use tactpad::lab::play::windows::{SampleContext, Window, WindowCollector};
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::quantity;

use super::UNSEEN;
use super::judged::{Summary, decoded_by};
use super::memory::Memory;
use super::pad::{Changes, Recorded, Wiring, full_scale, plan, recorded, weighed};
use crate::fields::NOMINAL;
use crate::plan::Contact;

const PRESSES: usize = 1000;
const WEIGHT_G: f64 = 200.0;
const WEIGHT_N: f64 = 9.806_65e-3 * WEIGHT_G;
const MARKS_MM: [[f64; 2]; 5] = [[0.0, 0.0], [15.0, 0.0], [-15.0, 0.0], [0.0, 15.0], [0.0, -15.0]];
/// Placed within 0.7 mm, as nineteen of twenty.
const OFF_MM: f64 = 0.35;
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

fn played(wiring: &Wiring, seed: u64) -> (Vec<Window>, Vec<Placement>) {
    let changes = Changes { table: &NOMINAL, memory: Memory::Nothing, rig: &[], background: None };
    let presses = apart(plan(PRESSES, seed, "calibrated at home"));
    let full_scale = full_scale(&presses);
    let weights = weighed(WEIGHT_N, &MARKS_MM, OFF_MM, seed);
    let [presses, weights] = [(presses, 2 * seed), (weights, 2 * seed + 1)]
        .map(|(rows, seed)| recorded(rows, &changes, wiring, &full_scale, seed));
    let (mut gatherer, mut at_s) = (WindowCollector::default(), 0.0);
    windows(&presses, PRESS_S, &mut gatherer, &mut at_s);
    let moments = windows(&weights, WEIGHT_S, &mut gatherer, &mut at_s);
    let placement =
        |(at_s, place_mm): (f64, [f64; 2])| Placement { line: 0, at_s, place_mm, weight_g: WEIGHT_G };
    (gatherer.finish(), moments.into_iter().zip(MARKS_MM).map(placement).collect())
}

/// The plan with a reading of the untouched pad behind each press: fingers lift.
fn apart(rows: Vec<crate::plan::Row>) -> Vec<crate::plan::Row> {
    let rest = rows[0].clone();
    rows.into_iter().flat_map(|row| [row, rest.clone()]).collect()
}

/// Errors of place and force against the truth, and the share of truths in the stated regions.
fn tried(seed: u64) -> Summary {
    let wiring = Wiring::drawn_wide(seed);
    let (windows, placements) = played(&wiring, seed);
    let nominal = PadField::nominal();
    let device = Device::nominal();
    let pad = SimulatedPad { solve: &field_cache::solve, ..SimulatedPad::known(&device, &nominal) };
    let found: AtHome = calibrated(&windows, &placements, &pad, None, &|_, _| ()).unwrap();
    let unseen = plan(UNSEEN, seed, "calibrated unseen");
    let full_scale = full_scale(&unseen);
    let changes = Changes { table: &NOMINAL, memory: Memory::Nothing, rig: &[], background: None };
    let unseen = recorded(unseen, &changes, &wiring, &full_scale, 2 * seed + 1_001);
    let decoded = decoded_by(&found.calibration.decoder(), unseen.measured.csv().as_bytes(), &unseen.truths);
    let summary = Summary::of(&decoded, |_| true);
    let Summary { place_mm, force_n, covered, .. } = summary;
    println!(
        "pad {seed:2}: {place_mm:.3} mm, {force_n:.4} N, {covered:.3} inside, {} presses",
        found.presses
    );
    summary
}

/// Of so many pads; the medians may be so many times their goals.
fn are_enough(pads: u64, most: f64) {
    let mut pads: Vec<Summary> = (1..=pads).map(tried).collect();
    let covered = pads.iter().map(|it| it.covered).sum::<f64>() / pads.len() as f64;
    let median = |pads: &mut [Summary], of: fn(&Summary) -> f64| {
        pads.sort_by(|one, other| of(one).total_cmp(&of(other)));
        let middle = pads.len() / 2;
        0.5 * (of(&pads[middle]) + of(&pads[(pads.len() - 1) / 2]))
    };
    let [place_mm, force_n] = [median(&mut pads, |it| it.place_mm), median(&mut pads, |it| it.force_n)];
    println!("medians {place_mm:.3} mm, {force_n:.4} N; {covered:.3} inside");
    assert!(place_mm <= most * 0.16 && force_n <= most * 0.021, "{place_mm} mm, {force_n} N");
    assert!((0.9..=1.0).contains(&covered), "{covered}");
}

#[test]
#[ignore = "proof: 30 s: tests/lab and tests/program have smaller ones on the simulator's field"]
fn a_thousand_presses_without_labels_and_a_weight() {
    // A single pad may be a quarter worse than the median of ten.
    are_enough(1, 1.25);
}

#[test]
#[ignore = "proof: 300 s: misses its goals, as docs/decoding.md says: ten pads instead of one"]
fn a_thousand_presses_without_labels_and_a_weight_on_ten_pads() {
    are_enough(10, 1.0);
}
