//! `tactpad adapt`: fits a decoder to a pad by measured contacts.

mod own;
mod scdf;

use std::fmt;
use std::io::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::device::Pad;
use super::written::{both_print, is_same, is_stdout, stdout, written_over};
use super::{Failure, print_json, say, tables};
use crate::contact::recording::Recording;
use crate::device::Device;
use crate::measured::columns::Kind;
use crate::measured::{Row, zero};
use crate::random::SplitMix64;

/// Arguments of `tactpad adapt`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad adapt --method scdf --measured m.csv --from scdf.onnx --out mine.onnx"
)]
pub(super) struct Arguments {
    /// How it is done.
    #[arg(long, value_name = "METHOD")]
    method: Method,
    /// A CSV of measured contacts with all nine channels, raw.
    ///
    /// Where it has readings of the untouched pad (session zero, or all forces 0), channels are taken relative to them.
    #[arg(long, value_name = "FILE")]
    measured: PathBuf,
    /// Take N of the contacts only, drawn by the seed.
    #[arg(long, value_name = "N")]
    rows: Option<usize>,
    /// Draws what is random: the same seed gives the same file.
    #[arg(long, default_value = "0")]
    seed: u64,
    /// The decoder to begin with: for scdf what train wrote, for inverse another pad's inverse decoder.
    ///
    /// scdf needs one. To inverse it tells what pads of one kind share, so that fewer contacts are enough.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// The decoder to write; a file that is there is replaced, and - is standard output.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    pad: Pad,
    /// Print one JSON document: what came of it.
    #[arg(long)]
    json: bool,
}

/// Ways to fit a decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Method {
    /// Stage II of the paper's network: train it on, held to where it began.
    Scdf,
    /// The pad's own field, calibrated, and inverted for each reading.
    Inverse,
    /// Least squares from the channels to the forces and to x Fz and y Fz.
    Wrench,
    /// Least squares from the channels to the contact: a baseline.
    Linear,
    /// The mean of the five nearest contacts: a baseline.
    Knn,
}

/// Measured contacts as a method takes them.
struct Contacts {
    /// The whole table, if it ever reads the untouched pad.
    recording: Option<Recording>,
    /// Places of the contacts that are fitted to.
    places: Vec<usize>,
    /// These contacts, relative to the untouched pad if that was ever read.
    rows: Vec<Row>,
}

/// What came of it.
#[derive(Serialize)]
struct Outcome {
    method: Method,
    rows: usize,
    /// Whether channels were taken relative to the untouched pad.
    tared: bool,
    #[serde(flatten)]
    fit: Fit,
}

/// What each way found.
#[derive(Serialize)]
#[serde(untagged)]
enum Fit {
    Network(scdf::Fit),
    Own(Box<own::Fit>),
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { method, out, json, .. } = arguments;
    if *json && is_stdout(out) {
        return Err(both_print());
    }
    arguments.spare()?;
    let device = arguments.pad.read()?;
    let contacts = arguments.contacts(&device)?;
    let (rows, tared) = (contacts.rows.len(), contacts.recording.is_some());
    let fit = match method {
        Method::Scdf => Fit::Network(scdf::adapt(arguments, &contacts)?),
        _ => Fit::Own(Box::new(own::adapt(arguments, &device, &contacts)?)),
    };
    let outcome = Outcome { method: *method, rows, tared, fit };
    match (json, is_stdout(out)) {
        (true, _) => print_json(&outcome),
        (false, true) => {
            say(&outcome);
            Ok(())
        }
        (false, false) => Ok(writeln!(stdout(), "{outcome}\n{} is written", out.display())?),
    }
}

impl Arguments {
    /// Refuses to write over what is read. A decoder may be written over itself: it is read before.
    fn spare(&self) -> Result<(), Failure> {
        self.pad.spare(&self.out)?;
        if is_same(&self.measured, &self.out) {
            return Err(written_over(&self.out, "is the measured table"));
        }
        Ok(())
    }

    /// The contacts of the table, tared if it ever reads the untouched pad.
    fn contacts(&self, device: &Device) -> Result<Contacts, Failure> {
        let table = tables::read(&self.measured, Kind::Measured, 0.5 * device.plate.diameter_mm)?;
        let mut places = zero::contacts(&table);
        if let Some(count) = self.rows {
            SplitMix64::named(self.seed, "rows").shuffle(&mut places);
            places.truncate(count);
        }
        let recording = Recording::of(table.clone(), device.contact.full_scale_n);
        let taken = recording.as_ref().map_or(&table, Recording::tared);
        let rows = taken.rows_at(&places);
        Ok(Contacts { recording, places, rows })
    }
}

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Network(fit) => fit.fmt(f),
            Self::Own(fit) => fit.fmt(f),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let taken = if self.tared {
            "relative to the untouched pad"
        } else {
            "raw, as the table has no reading of the untouched pad"
        };
        write!(f, "{} contacts, channels {taken}\n{}", self.rows, self.fit)
    }
}
