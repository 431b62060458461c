//! `tactpad adapt`: fits a decoder to a pad by measured contacts.

pub(crate) mod at_home;
mod checks;
mod measured;
mod method;
mod named;
mod numbers;
mod open;
mod own;
pub(crate) mod play;
mod scdf;
mod thermal;

use std::borrow::Cow;
use std::fmt;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use self::measured::{Measured, RowDraw};
use self::method::Method;
use self::named::NamedCauses;
use self::numbers::FoundPad;
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::files::destination::{Destination, Folder};
use crate::cli::files::device::PadOptions;
use crate::cli::files::field::{field_of, flaws, solve};
use crate::cli::files::labels::LabelOptions;
use crate::cli::number;
use crate::cli::printing::pictures;
use crate::cli::printing::written::{both_print, is_same, is_stdout, say, tell, written_over};
use tactpad::counted::counted;
use tactpad::lab::tangent::SimulatedPad;

/// Arguments of `tactpad adapt`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad adapt --method scdf --measured m.csv --from scdf.onnx --out mine.onnx, or \
                  tactpad adapt --play game.cap --weights w.csv --out mine.decoder"
)]
pub(crate) struct Arguments {
    /// The method; a capture of play can be fitted by inverse alone.
    #[arg(long, value_name = "METHOD", required_unless_present = "play")]
    method: Option<Method>,
    /// A CSV of measured contacts with all nine channels, raw.
    ///
    /// Where it has readings of the untouched pad (session zero, or forces near 0), channels are taken relative to them. Given
    /// several times, the tables are read one after the other, each with its own zeros.
    #[arg(long, value_name = "FILE", required_unless_present = "play")]
    measured: Vec<PathBuf>,
    /// A capture of play instead: presses all over the plate, which nobody wrote down.
    #[arg(long, value_name = "CAPTURE", conflicts_with_all = ["measured", "rows"])]
    play: Option<PathBuf>,
    /// A CSV of placements of a known weight while the capture was made: t_s,x_mm,y_mm,weight_g.
    ///
    /// t_s is any moment while it rests, in seconds on the pad's clock from the capture's first sample. Presses alone do not say how
    /// strong a newton is.
    #[arg(long, value_name = "W.csv", requires = "play")]
    weights: Option<PathBuf>,
    /// Take N of the contacts only, drawn by the seed.
    #[arg(long, value_name = "N", value_parser = parse_rows, allow_hyphen_values = true)]
    rows: Option<usize>,
    /// A number that all random draws follow from: the same seed gives the same file.
    #[arg(long, default_value = "0", value_parser = number::seed, allow_hyphen_values = true)]
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
    pad: PadOptions,
    #[command(flatten)]
    meant: LabelOptions,
    /// Write the figure adapt-loss, how scdf learns, into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR", conflicts_with = "play")]
    figures: Option<PathBuf>,
    /// Print one JSON document: what came of it.
    #[arg(long)]
    json: bool,
}

/// The report of `tactpad adapt`.
#[derive(Serialize)]
struct AdaptReport {
    method: Method,
    rows: usize,
    /// Whether channels were taken relative to the untouched pad.
    tared: bool,
    /// Faults of the pad that was measured, as far as they show.
    warnings: Vec<String>,
    #[serde(flatten)]
    fit: FitReport,
}

/// The result of each kind of method.
#[derive(Serialize)]
#[serde(untagged)]
enum FitReport {
    Network(scdf::ScdfFit),
    /// The inverse decoder's calibration; nothing for the other methods.
    Own {
        #[serde(skip_serializing_if = "Option::is_none")]
        pad: Option<Box<FoundPad>>,
    },
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { out, json, .. } = arguments;
    if *json && is_stdout(out) {
        return Err(both_print("--out -"));
    }
    arguments.spare()?;
    let device = arguments.pad.read()?;
    if let Some(play) = &arguments.play {
        let (weights, from) = (arguments.weights.as_deref(), arguments.from.as_deref());
        let options = play::PlayOptions { method: arguments.method, play, weights, from, out, json: *json };
        return play::run(&options, &device);
    }
    let method = &arguments.method.unwrap_or(Method::Inverse);
    let draw = RowDraw { rows: arguments.rows, seed: arguments.seed };
    let measured = Measured::read(&arguments.measured, &arguments.meant, &device, draw, *method)?;
    let to = Destination::of(out)?;
    let folder = arguments.folder(*method)?;
    let from = arguments.from.as_deref();
    let earlier = own::earlier(*method, from)?;
    let field = field_of(&device)?;
    measured.ask(&arguments.meant, &SimulatedPad::known(&device, &field))?;
    let fault = measured.contacts.screened(&device, &field).map_err(|why| measured.refused(why))?;
    let fit = if *method == Method::Scdf {
        let (network, fit) = scdf::adapt(&measured, from, arguments.seed)?;
        decoder_file::write_network(&to, &network)?;
        if let Some(folder) = &folder {
            pictures::write(folder, "adapt-loss", &fit.drawn())?;
        }
        FitReport::Network(fit)
    } else {
        let flaws = flaws(&device);
        let model = SimulatedPad { device: &device, field: &field, flaws: &flaws, solve: &solve };
        // Nobody asks for causes where a decoder has no pad of its own.
        let tables =
            if *method == Method::Inverse { measured.tables(arguments.rows) } else { Cow::default() };
        // Neither waits for the other: what is named has no part in the fit.
        let (adapted, named) = rayon::join(
            || own::adapt(*method, &measured, earlier.as_ref(), &model),
            || NamedCauses::by(&tables, &model),
        );
        let (decoder, found) = adapted?;
        let note = format!("{} of {}", counted(measured.contacts.count(), "contact"), measured.names);
        to.write(&decoder.to_bytes(&note).unwrap_or_default())?;
        let pad = found.map(|found| FoundPad::of(found, named));
        FitReport::Own { pad: pad.map(Box::new) }
    };
    let (rows, tared) = (measured.contacts.count(), measured.contacts.is_tared());
    let warnings: Vec<String> = fault.map(|fault| measured.warning(fault)).into_iter().collect();
    warnings.iter().for_each(|warning| say(format_args!("warning: {warning}")));
    let outcome = AdaptReport { method: *method, rows, tared, warnings, fit };
    tell(&outcome, out, *json)
}

fn parse_rows(text: &str) -> Result<usize, String> {
    number::whole(
        text,
        &[],
        1..=usize::MAX,
        "how many contacts to take, 1 or more; without --rows all are taken",
    )
}

impl Arguments {
    /// The folder of the figure; only the network's training has one.
    fn folder(&self, method: Method) -> Result<Option<Folder>, Failure> {
        if self.figures.is_some() && method != Method::Scdf {
            let why = "--figures shows how a network learns: give it with --method scdf";
            return Err(Failure::Unusable(why.into()));
        }
        self.figures.as_deref().map(Folder::of).transpose()
    }

    /// Refuses to write over what is read. A decoder may be written over itself: it is read before.
    fn spare(&self) -> Result<(), Failure> {
        self.pad.spare(&self.out)?;
        if self.measured.iter().any(|measured| is_same(measured, &self.out)) {
            return Err(written_over(&self.out, "is the measured table"));
        }
        let is_out = |path: &Option<PathBuf>| path.as_ref().is_some_and(|path| is_same(path, &self.out));
        if is_out(&self.play) {
            return Err(written_over(&self.out, "is the capture"));
        }
        if is_out(&self.weights) {
            return Err(written_over(&self.out, "is the table of weights"));
        }
        Ok(())
    }
}

impl fmt::Display for FitReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Network(fit) => fit.fmt(f),
            Self::Own { pad: Some(pad) } => pad.fmt(f),
            Self::Own { pad: None } => f.write_str("fitted"),
        }
    }
}

impl fmt::Display for AdaptReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let taken = if self.tared {
            "relative to the untouched pad"
        } else {
            "raw, as the table has no reading of the untouched pad"
        };
        write!(f, "{} contacts, channels {taken}\n{}", self.rows, self.fit)
    }
}
