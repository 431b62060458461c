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
use crate::measured::Row;
use crate::measured::columns::Kind;
use crate::network::Zero;
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
    /// Where it has readings of the untouched pad (session zero, or all forces 0), channels are taken relative to them. Given
    /// several times, the tables are read one after the other, each with its own zeros.
    #[arg(long, value_name = "FILE", required = true)]
    measured: Vec<PathBuf>,
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
    /// The whole tables.
    recording: Recording,
    /// Places of the contacts that are fitted to.
    places: Vec<usize>,
    /// These contacts, relative to what the channels are taken relative to.
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
    let (rows, tared) = (contacts.rows.len(), contacts.recording.is_tared());
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
        if self.measured.iter().any(|measured| is_same(measured, &self.out)) {
            return Err(written_over(&self.out, "is the measured table"));
        }
        Ok(())
    }

    /// The contacts of the tables, tared if they read the untouched pad.
    fn contacts(&self, device: &Device) -> Result<Contacts, Failure> {
        let recordings = self.measured.iter().map(|path| {
            let table = tables::read(path, Kind::Measured, 0.5 * device.plate.diameter_mm)?;
            let full_scale_n = device.contact.full_scale_n;
            Ok(Recording::of(table.clone(), full_scale_n)
                .unwrap_or_else(|| Recording::raw(table, full_scale_n)))
        });
        let recordings = recordings.collect::<Result<Vec<Recording>, Failure>>()?;
        let tared = recordings.iter().filter(|recording| recording.is_tared()).count();
        if tared != 0 && tared != recordings.len() {
            return Err(Failure::Unusable(format!(
                "{}: {tared} of these {} tables read the untouched pad; give those that do, or those that do not",
                self.measured_names(),
                recordings.len()
            )));
        }
        let recording = recordings.into_iter().reduce(Recording::then);
        let recording = recording.ok_or_else(|| Failure::Unusable("adapt needs --measured".into()))?;
        let mut places = recording.contacts();
        if let Some(count) = self.rows {
            SplitMix64::named(self.seed, "rows").shuffle(&mut places);
            places.truncate(count);
        }
        let rows = recording.tared().rows_at(&places);
        Ok(Contacts { recording, places, rows })
    }

    /// The measured tables, for people.
    fn measured_names(&self) -> String {
        let names: Vec<String> = self.measured.iter().map(|path| path.display().to_string()).collect();
        names.join(", ")
    }
}

impl Contacts {
    /// What the rows' channels are relative to.
    fn zero(&self) -> Zero {
        if self.recording.is_tared() { Zero::Tared } else { Zero::Raw }
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
