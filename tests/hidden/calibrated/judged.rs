//! What came of a calibration: errors, stated regions by axis, and stated numbers beside the truth.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tactpad::lab::evaluation::strain;
use tactpad::pipeline::contact::{Decoder, read};
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::read::table;
use tactpad::tables::recording::Recording;

use super::pad::{FORCES_N, REACH_MM, Recorded, Wiring};
use crate::plan::Contact;
use crate::program::{calibrated, evaluated};
use crate::score::{Found, Score};
use crate::truth::{Truth, channel};

/// From the middle to the end of an interval at 95 %, in deviations.
const HALF_WIDTH: f64 = 1.959_964;
/// χ² of five numbers below which 95 % of all cases lie.
const CHI_SQUARE_95: f64 = 11.0705;
/// The pad's largest force, and its plate's radius.
const FULL_SCALE_N: f64 = 5.0;
const RIM_MM: f64 = 30.0;

/// One unseen contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decoded {
    radius_mm: f64,
    force_n: f64,
    /// Magnitudes of the errors of x, y, Fx, Fy, Fz, and the deviations that the decoder states for them.
    errors: [f64; 5],
    deviations: [f64; 5],
    /// It lies in the decoder's 95 % region of all five.
    covered: bool,
}

/// Over many contacts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Summary {
    pub(super) place_mm: f64,
    pub(super) force_n: f64,
    /// Shares of the truths in the region of all five numbers, and in the interval of each.
    pub(super) covered: f64,
    pub(super) by_axis: [f64; 5],
}

/// A stated number that the data tell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stated {
    /// Among [`KINDS`].
    pub(super) kind: usize,
    /// Its error over its stated deviation.
    pub(super) off: f64,
}

/// Kinds of stated numbers.
pub(super) const KINDS: [&str; 5] = ["gains", "device", "crosstalk", "blur", "rig"];

/// What came of one pad.
#[derive(Debug)]
pub(super) struct Judged {
    pub(super) decoded: Vec<Decoded>,
    pub(super) stated: Vec<Stated>,
    /// How many hidden causes `adapt` names.
    pub(super) named: usize,
    /// What it names and nothing is hidden of.
    pub(super) wrong: Vec<String>,
}

/// Calibrates by one recording and tries the other, through the program. `change` tells the true change of a number of
/// the device or the rig by its name, where that is known.
pub(super) fn judged(
    known: &Recorded,
    unseen: &Recorded,
    hidden: &[Truth],
    wiring: &Wiring,
    change: &dyn Fn(&str) -> Option<f64>,
) -> Judged {
    let folder = tempfile::tempdir().unwrap();
    let [known_csv, unseen_csv, truth_csv, decoder] =
        ["known.csv", "unseen.csv", "truth.csv", "decoder"].map(|name| folder.path().join(name));
    fs::write(&known_csv, known.measured.csv()).unwrap();
    fs::write(&unseen_csv, unseen.measured.csv()).unwrap();
    fs::write(&truth_csv, written(&unseen.truths)).unwrap();
    let pad = &calibrated(&known_csv, &decoder)["pad"];
    assert_eq!(pad["not_diagnosed"], Value::Array(Vec::new()), "causes were looked for");
    let decoded = decoded(&decoder, &unseen_csv, &unseen.truths);
    agree(&evaluated(&decoder, &unseen_csv, &truth_csv), &decoded);
    let Score { found, wrong, .. } = Score::of(pad, hidden);
    let named = found.into_iter().filter(|found| *found == Found::Named).count();
    Judged { decoded, stated: stated(pad, wiring, change), named, wrong }
}

fn written(truths: &[Contact]) -> String {
    let mut text = String::from("x_mm,y_mm,fx_n,fy_n,fz_n\n");
    for Contact { place: [x, y], force: [fx, fy, fz] } in truths {
        writeln!(text, "{x},{y},{fx},{fy},{fz}").unwrap();
    }
    text
}

/// Decodes each contact. The verb says its covariance to nobody, so the library is asked.
fn decoded(decoder: &Path, unseen: &Path, truths: &[Contact]) -> Vec<Decoded> {
    decoded_by(&read::decoder(&fs::read(decoder).unwrap()).unwrap(), &fs::read(unseen).unwrap(), truths)
}

/// The same of a measured table by its bytes.
pub(super) fn decoded_by(decoder: &Decoder, unseen: &[u8], truths: &[Contact]) -> Vec<Decoded> {
    let table = table(unseen, TableKind::Measured, RIM_MM).unwrap();
    let recording = Recording::of(table, FULL_SCALE_N).unwrap();
    let rows = recording.taken(decoder).rows;
    let one = |at: usize| {
        let Contact { place: [x, y], force } = truths[at];
        let truth = [x, y, force[0], force[1], force[2]];
        let estimate = decoder.inverse().unwrap().estimate(&strain(&rows[at])).unwrap();
        let found = estimate.contact;
        let found = [found.x_mm, found.y_mm, found.fx_n, found.fy_n, found.fz_n].map(f64::from);
        Decoded {
            radius_mm: x.hypot(y),
            force_n: force.iter().map(|force| force * force).sum::<f64>().sqrt(),
            errors: std::array::from_fn(|axis| (found[axis] - truth[axis]).abs()),
            deviations: std::array::from_fn(|axis| estimate.covariance[axis][axis].sqrt()),
            covered: estimate.distance_square(&truth).is_some_and(|square| square <= CHI_SQUARE_95),
        }
    };
    recording.contacts().into_iter().map(one).collect()
}

/// The verb and the library say the same.
fn agree(evaluation: &Value, decoded: &[Decoded]) {
    let Summary { place_mm, force_n, covered, .. } = Summary::of(decoded, |_| true);
    let verb = ["position_mae_mm", "force_mae_n", "coverage95"]
        .map(|key| evaluation["truth"][key].as_f64().unwrap());
    let library = [place_mm, force_n, covered];
    let same = verb.iter().zip(library).all(|(verb, library)| (verb - library).abs() < 1e-6 + 1e-3 * library);
    assert!(same, "evaluate: {verb:?}, the library: {library:?}");
}

/// Numbers that the data tell, and whose truth is known.
fn stated(pad: &Value, wiring: &Wiring, change: &dyn Fn(&str) -> Option<f64>) -> Vec<Stated> {
    let numbers = pad["numbers"].as_array().unwrap().iter();
    let told = numbers.filter(|number| number["told_by"] == "data");
    let one = |number: &Value| {
        let at = |key: &str| number[key].as_str().and_then(channel);
        let name = number["name"].as_str()?;
        let [value, deviation, expected] =
            ["value", "deviation", "expected"].map(|key| number[key].as_f64().unwrap());
        let (kind, truth) = match name {
            "gain" => (0, wiring.gains[at("target")?]),
            "crosstalk" => (2, leaked(wiring, at("target")?, at("with")?)),
            "blur_mm2" => (3, 0.0),
            name if ["module.", "plate.", "material."].iter().any(|part| name.starts_with(part)) => {
                (1, expected + change(name)?)
            }
            name if name.contains('.') => (4, expected + change(name)?),
            _ => return None,
        };
        Some(Stated { kind, off: (value - truth) / deviation })
    };
    told.filter_map(one).collect()
}

/// What a channel has of what another one reads.
fn leaked(wiring: &Wiring, into: usize, from: usize) -> f64 {
    wiring.leaks.iter().find(|leak| (leak.0, leak.1) == (into, from)).map_or(0.0, |leak| leak.2)
}

impl Summary {
    /// Over the contacts that a question chooses.
    pub(super) fn of<'d>(
        decoded: impl IntoIterator<Item = &'d Decoded>,
        chosen: impl Fn(&Decoded) -> bool,
    ) -> Self {
        let chosen: Vec<&Decoded> = decoded.into_iter().filter(|it| chosen(it)).collect();
        let mean = |of: &dyn Fn(&Decoded) -> f64| {
            chosen.iter().map(|it| of(it)).sum::<f64>() / chosen.len().max(1) as f64
        };
        Self {
            place_mm: mean(&|it| (it.errors[0] + it.errors[1]) / 2.0),
            force_n: mean(&|it| (it.errors[2] + it.errors[3] + it.errors[4]) / 3.0),
            covered: mean(&|it| f64::from(u8::from(it.covered))),
            by_axis: std::array::from_fn(|axis| {
                mean(&|it| f64::from(u8::from(it.errors[axis] <= HALF_WIDTH * it.deviations[axis])))
            }),
        }
    }
}

impl Decoded {
    /// Its third of the forces, which are even, and its third of the plate's area.
    pub(super) fn thirds(&self) -> [usize; 2] {
        let third = |share: f64| ((3.0 * share) as usize).min(2);
        let [least, most] = FORCES_N;
        [(self.force_n - least) / (most - least), (self.radius_mm / REACH_MM).powi(2)].map(third)
    }
}

/// Share of numbers that are farther than two deviations from the truth, and the root mean square of errors over
/// deviations. None where there are none.
pub(super) fn calibration_of(stated: impl Iterator<Item = Stated>) -> Option<[f64; 3]> {
    let off: Vec<f64> = stated.map(|stated| stated.off).collect();
    let count = off.len() as f64;
    let far = off.iter().filter(|off| off.abs() > 2.0).count() as f64 / count;
    let rms = (off.iter().map(|off| off * off).sum::<f64>() / count).sqrt();
    (!off.is_empty()).then_some([count, far, rms])
}
