//! The arguments of `tactpad diagnose`, and the places of its files.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::cli::failure::Failure;
use crate::cli::files::destination::{Destination, Folder};
use crate::cli::files::device::PadOptions;
use crate::cli::files::labels::LabelOptions;
use crate::cli::number;
use crate::cli::printing::reports;
use crate::cli::printing::written::{both_print, is_same, is_stdout, written_over};
use tactpad::lab::diagnosis;
use tactpad::lab::effect::Effect;

/// Arguments of `tactpad diagnose`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad diagnose --measured measured.csv --save-device found.toml\n         \
                  tactpad diagnose --measured first.csv --next plan.csv\n         \
                  tactpad diagnose --measured first.csv --measured further.csv\n         \
                  tactpad diagnose --measured today.csv --against january.csv\n         \
                  tactpad diagnose --measured load-cell.csv --model predicted.csv\n         \
                  tactpad diagnose --play today.cap --against january.cap\n\n\
                  Without --device and --imperfections the model is the nominal pad. What the words mean stands in \
                  docs/diagnosis.md."
)]
pub(crate) struct Arguments {
    /// The measured file: raw channels, and what the reference wrote down. Given several times, further measurements of the same pad, each
    /// with zeros of its own.
    #[arg(long, value_name = "M.csv", required_unless_present = "play")]
    pub(super) measured: Vec<PathBuf>,
    /// A capture of play instead: what changed in the pad since an earlier one? Nobody needs to know what was pressed.
    #[arg(
        long,
        value_name = "CAPTURE",
        requires = "against",
        conflicts_with_all = ["measured", "labels", "channels", "save_device", "report", "without"]
    )]
    pub(super) play: Option<PathBuf>,
    /// An earlier recording of the same sensor, whatever sensor that is: what changed since? Neither a model nor forces are needed.
    ///
    /// With --play an earlier capture of the same pad.
    #[arg(long, value_name = "EARLIER", group = "held_against")]
    pub(super) against: Option<PathBuf>,
    /// What a model of one's own predicts for the same rows, in the same order, whatever sensor that is: why is it wrong?
    ///
    /// Predicted channels have the names of the measured ones.
    #[arg(long, value_name = "P.csv", requires = "measured", group = "held_against")]
    pub(super) model: Option<PathBuf>,
    /// With --model: what it gets wrong by itself, in per cent of what loads do to a channel; what is no larger is no finding.
    #[arg(long, value_name = "PERCENT", default_value_t = 0.5, value_parser = model_error, requires = "model")]
    pub(super) model_error: f64,
    /// With --model: a folder with what the model can vary, effects.toml and a table of derivatives EFFECT.csv for each.
    #[arg(long, value_name = "FOLDER", requires = "model")]
    pub(super) effects: Option<PathBuf>,
    /// With --against or --model: the columns that are labels; else those of docs/diagnosis.md that both files have.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "held_against")]
    pub(super) labels: Vec<String>,
    /// With --against or --model: the columns that are channels; else all other columns of numbers that both files have.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "held_against")]
    pub(super) channels: Vec<String>,
    #[command(flatten)]
    pub(super) pad: PadOptions,
    #[command(flatten)]
    pub(super) meant: LabelOptions,
    /// A plan to write: the cheapest further measurement that tells apart what these rows do not. - is standard output.
    #[arg(long, value_name = "PLAN.csv", conflicts_with_all = ["play", "held_against"])]
    pub(super) next: Option<PathBuf>,
    /// A device file to write: the model with the named causes in it; - is standard output.
    #[arg(long, value_name = "E.toml")]
    pub(super) save_device: Option<PathBuf>,
    /// A folder for report.html, one page with pictures of what was found, and report.json.
    #[arg(long, value_name = "DIR")]
    pub(super) report: Option<PathBuf>,
    /// Leave an effect out of what is asked for; may stand more than once.
    #[arg(long, value_name = "EFFECT", hide_possible_values = true, value_parser = effects_parser())]
    pub(super) without: Vec<Effect>,
    /// Print one JSON document.
    #[arg(long)]
    pub(super) json: bool,
}

impl Arguments {
    fn is_measured(&self, path: &Path) -> bool {
        self.measured.iter().any(|measured| is_same(measured, path))
    }
}

/// A share that a model may get wrong.
fn model_error(text: &str) -> Result<f64, String> {
    number::read(
        text,
        &["%"],
        |percent| (0.0..=50.0).contains(percent),
        "per cent from 0 to 50, such as 0.5 or 0.5%",
    )
}

/// Where the file of an option goes: nowhere that is read, and not between the lines of a document or of another file.
pub(super) fn destination(path: &Path, option: &str, arguments: &Arguments) -> Result<Destination, Failure> {
    let Arguments { json, next, save_device, pad, .. } = arguments;
    let is_both = [next, save_device].iter().all(|it| it.as_deref().is_some_and(is_stdout));
    if (*json || is_both) && is_stdout(path) {
        return Err(both_print(&format!("{option} -")));
    }
    pad.spare(path)?;
    if arguments.is_measured(path) {
        return Err(written_over(path, "is the measured table"));
    }
    if let (Some(next), Some(device)) = (next, save_device)
        && is_same(next, device)
        && !is_both
    {
        return Err(written_over(path, "is written by --next and --save-device alike"));
    }
    Destination::of(path)
}

/// The folder of the report: none whose files of these names are read or written by another option.
pub(super) fn folder(path: &Path, arguments: &Arguments) -> Result<Folder, Failure> {
    for file in [reports::PAGE, reports::DOCUMENT].map(|name| path.join(name)) {
        arguments.pad.spare(&file)?;
        if arguments.is_measured(&file) {
            return Err(written_over(&file, "is the measured table"));
        }
        if arguments.against.as_deref().is_some_and(|earlier| is_same(earlier, &file)) {
            return Err(written_over(&file, "is the earlier recording"));
        }
        if arguments.model.as_deref().is_some_and(|model| is_same(model, &file)) {
            return Err(written_over(&file, "is the table of predictions"));
        }
        if arguments.save_device.as_deref().is_some_and(|saved| is_same(saved, &file)) {
            return Err(written_over(&file, "is the device to save"));
        }
        if arguments.next.as_deref().is_some_and(|next| is_same(next, &file)) {
            return Err(written_over(&file, "is the plan to write"));
        }
    }
    Folder::of(path)
}

/// Takes the name of any effect that can be left out.
fn effects_parser() -> impl TypedValueParser<Value = Effect> {
    let mut effects: Vec<Effect> = diagnosis::effects().collect();
    effects.extend(diagnosis::against::effects().filter(|it| diagnosis::effects().all(|other| other != *it)));
    PossibleValuesParser::new(effects.into_iter().map(Effect::name))
        .try_map(|name| Effect::from_name(&name).ok_or("there is no such effect"))
}
