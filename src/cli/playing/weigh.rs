//! `tactpad weigh`: the gain that a pad has lost since its calibration, by one known weight, kept in a decoder.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::profile;
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::files::destination::Destination;
use crate::cli::files::device::PadOptions;
use crate::cli::files::recording::{Profiles, Recording};
use crate::cli::files::tables;
use crate::cli::number;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{both_print, is_same, is_stdout, tell, written_over};
use tactpad::lab::play::weighing::{FileError, InFile, RestReader, RestedLoad, found, in_table};
use tactpad::pad::weight::Weight;
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::weighing::factor::is_possible;
use tactpad::pipeline::weighing::kept::kept;
use tactpad::tables::measured::columns::TableKind;

/// Arguments of `tactpad weigh`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad weigh --decoder my.decoder --weight-g 200 --play weigh.cap --out my.decoder"
)]
pub(crate) struct Arguments {
    /// The decoder of the pad as it was: a file that calibrate or adapt wrote.
    #[arg(long, value_name = "FILE")]
    decoder: PathBuf,
    /// The weight, in grams.
    #[arg(long, value_name = "G", value_parser = number::grams, required_unless_present = "factor", allow_hyphen_values = true)]
    weight_g: Option<f64>,
    /// A capture in which the weight rests on the plate for two seconds or more, anywhere.
    #[arg(long, value_name = "CAPTURE", required_unless_present_any = ["measured", "factor"], conflicts_with = "measured")]
    play: Option<PathBuf>,
    /// A CSV of measured contacts instead, all of whose loads are the weight: what its labels say of them does not count.
    #[arg(long, value_name = "TABLE.csv")]
    measured: Option<PathBuf>,
    /// The factor that `tactpad ctl weigh` found, instead of a file.
    #[arg(
        long,
        value_name = "S",
        requires = "deviation",
        conflicts_with_all = ["measured", "play", "weight_g"],
        value_parser = number::factor,
        allow_hyphen_values = true
    )]
    factor: Option<f64>,
    /// How sure `tactpad ctl weigh` was of its factor: the deviation that it printed, a share such as 0.01 or 1%.
    #[arg(long, value_name = "SHARE", value_parser = number::share, requires = "factor", allow_hyphen_values = true)]
    deviation: Option<f64>,
    /// The decoder to write; a file that is there is replaced, and - is standard output.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    pad: PadOptions,
    /// Print one JSON document: what came of it.
    #[arg(long)]
    json: bool,
}

/// The report of `tactpad weigh`.
#[derive(Serialize)]
struct WeighReport {
    factor: f64,
    deviation: f64,
    readings: Option<usize>,
    /// The moment that was taken.
    at_s: Option<f64>,
    place_mm: Option<[f64; 2]>,
}

/// Why a capture does not tell the gain.
enum CaptureFailure {
    Unread(Failure),
    Weigh(FileError),
}

impl From<FileError> for CaptureFailure {
    fn from(error: FileError) -> Self {
        Self::Weigh(error)
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { out, json, .. } = arguments;
    if *json && is_stdout(out) {
        return Err(both_print("--out -"));
    }
    arguments.spare()?;
    let decoder = decoder_file::read(&arguments.decoder)?;
    let to = Destination::of(out)?;
    let (decoder, outcome) = arguments.weighed(&decoder)?;
    let name = arguments.decoder.display();
    let note = format!("{name}, of a pad that reads {:.4} times as much", outcome.factor);
    to.write(&decoder.to_bytes(&note).unwrap_or_default())?;
    tell(&outcome, out, *json)
}

impl Arguments {
    /// Refuses to write over what is read. A decoder may be written over itself: it is read before.
    fn spare(&self) -> Result<(), Failure> {
        self.pad.spare(&self.out)?;
        for (read, what) in [(&self.play, "is the capture"), (&self.measured, "is the measured table")] {
            if read.as_ref().is_some_and(|read| is_same(read, &self.out)) {
                return Err(written_over(&self.out, what));
            }
        }
        Ok(())
    }

    /// The decoder of the pad as it is now, and what is told of it.
    fn weighed(&self, decoder: &Decoder) -> Result<(Decoder, WeighReport), Failure> {
        if let Some((factor, deviation)) = self.factor.zip(self.deviation) {
            return self.by_factor(decoder, factor, deviation);
        }
        let weight = Weight::of_g(self.weight_g.unwrap_or_default())
            .map_err(|why| Failure::Unusable(format!("--weight-g: {why}")))?;
        let found = match (&self.play, &self.measured) {
            (Some(capture), _) => in_capture(decoder, capture, weight),
            (None, table) => self.in_table(decoder, table.as_deref().unwrap_or(Path::new("")), weight),
        }?;
        let InFile { weighed, readings, at_s, decoder } = found;
        let place_mm = at_s.map(|_| [weighed.x_mm, weighed.y_mm]);
        let (factor, deviation) = (weighed.factor, weighed.deviation);
        Ok((decoder, WeighReport { factor, deviation, readings: Some(readings), at_s, place_mm }))
    }

    /// The decoder with the factor that a running bridge has found.
    fn by_factor(
        &self,
        decoder: &Decoder,
        factor: f64,
        deviation: f64,
    ) -> Result<(Decoder, WeighReport), Failure> {
        if !is_possible(factor) {
            let why = "--factor is what the pad reads over what it read, from 0.5 to 2";
            return Err(Failure::Unusable(why.into()));
        }
        let now = kept(decoder, factor, deviation)
            .ok_or_else(|| self.refused(&self.decoder, FileError::Decoder))?;
        Ok((now, WeighReport { factor, deviation, readings: None, at_s: None, place_mm: None }))
    }

    fn in_table(&self, decoder: &Decoder, path: &Path, weight: Weight) -> Result<InFile, Failure> {
        let device = self.pad.read()?;
        let table = tables::read(path, TableKind::Measured, device.plate.radius_mm())?;
        in_table(decoder, &table, weight, device.contact.full_scale_n)
            .map_err(|error| self.refused(path, error))
    }

    /// Why it cannot be done, with the file that it is about.
    fn refused(&self, path: &Path, error: FileError) -> Failure {
        let path = if error == FileError::Decoder { &self.decoder } else { path };
        Failure::Unusable(format!("{}: {error}", path.display()))
    }
}

fn in_capture(decoder: &Decoder, path: &Path, weight: Weight) -> Result<InFile, Failure> {
    let _progress = Progress::begin("reading the capture");
    found(decoder, weight, |decoder| rests(decoder, path).map_err(CaptureFailure::Unread)).map_err(|why| {
        match why {
            CaptureFailure::Unread(failure) => failure,
            CaptureFailure::Weigh(error) => Failure::Unusable(format!("{}: {error}", path.display())),
        }
    })
}

/// The loads that rest in a capture.
fn rests(decoder: &Decoder, path: &Path) -> Result<Vec<RestedLoad>, Failure> {
    let mut capture = Recording::open(path)?;
    // Only its filter counts, so any will do.
    let any = || profile::read("super-mario", OutputChoice::AsWritten).map(|read| read.profile().clone());
    let profile = capture.profile().or_else(|_| any())?;
    let mut reader = RestReader::new(decoder.clone(), profile);
    capture.each(Profiles::Skipped, |now, call| {
        reader.apply(now, call);
        Ok(())
    })?;
    Ok(reader.finish())
}

impl fmt::Display for WeighReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { factor, deviation, readings, at_s, place_mm } = self;
        if let (Some(at_s), Some([x_mm, y_mm])) = (at_s, place_mm) {
            writeln!(f, "The weight that rested until {at_s:.1} s, at about ({x_mm:.0}, {y_mm:.0}) mm:")?;
        } else if let Some(readings) = readings {
            writeln!(f, "{readings} readings of the weight:")?;
        }
        let (change, percent) = (100.0 * (factor - 1.0), 100.0 * deviation);
        let than = if change < 0.0 { "less" } else { "more" };
        write!(f, "the pad reads {:.1} % {than} than when it was calibrated (± {percent:.1} %)", change.abs())
    }
}
