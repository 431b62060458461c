//! `tactpad diagnose`: what measured contacts show that the model of the pad gets wrong, and why.

mod against;
mod document;
mod numbers;
mod report;
mod text;

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;

use self::document::Document;
use super::destination::{Destination, Folder};
use super::device::Pad;
use super::failure::Failure;
use super::field::{changes_of, field_of};
use super::progress::Progress;
use super::tables;
use super::written::{both_print, is_same, is_stdout, json_text, print_json, say, stdout, written_over};
use tactpad::lab::diagnosis::extension::extended;
use tactpad::lab::diagnosis::report::Diagnosis;
use tactpad::lab::diagnosis::{self, Unfit};
use tactpad::pad::changes::FieldChange;
use tactpad::pad::device::Device;
use tactpad::tables::measured::Table;
use tactpad::tables::measured::columns::Kind;

/// Arguments of `tactpad diagnose`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad diagnose --measured measured.csv --save-device found.toml\n         \
                  tactpad diagnose --measured today.csv --against january.csv\n\n\
                  Without --device and --imperfections the model is the nominal pad. What the words mean stands in \
                  docs/diagnosis.md."
)]
pub(super) struct Arguments {
    /// The measured file: raw channels, and what the reference wrote down.
    #[arg(long, value_name = "M.csv")]
    measured: PathBuf,
    /// An earlier recording of the same sensor, whatever sensor that is: what changed since? Neither a model nor forces are needed.
    #[arg(long, value_name = "EARLIER.csv")]
    against: Option<PathBuf>,
    /// With --against: the columns that are labels; else those of docs/diagnosis.md that both files have.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "against")]
    labels: Vec<String>,
    /// With --against: the columns that are channels; else all other columns of numbers that both files have.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "against")]
    channels: Vec<String>,
    #[command(flatten)]
    pad: Pad,
    /// A device file to write: the model with the named causes in it; - is standard output.
    #[arg(long, value_name = "E.toml")]
    save_device: Option<PathBuf>,
    /// A folder for report.html, one page with pictures of what was found, and report.json.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Leave an effect out of what is asked for; may stand more than once.
    #[arg(long, value_name = "EFFECT", hide_possible_values = true, value_parser = PossibleValuesParser::new(effects()))]
    without: Vec<String>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(earlier) = &arguments.against {
        return against::run(arguments, earlier);
    }
    let Arguments { measured, pad, save_device, report, without, json, .. } = arguments;
    let saved = save_device.as_deref().map(|path| destination(path, arguments)).transpose()?;
    let device = pad.read()?;
    let folder = report.as_deref().map(|path| folder(path, arguments)).transpose()?;
    let table = tables::read(measured, Kind::Measured, device.plate.radius_mm())?;
    // It takes a while until the engine itself could say so.
    diagnosis::check(&table).map_err(|why| unfit(measured, &why))?;
    let diagnosis = diagnosed(&table, &device, without).map_err(|why| match why {
        Why::Unfit(why) => unfit(measured, &why),
        Why::NoField(failure) => failure,
    })?;
    if let Some(to) = saved {
        save(&to, &device, &diagnosis, &table)?;
    }
    if let Some(folder) = folder {
        let subject = report::Subject {
            diagnosis: &diagnosis,
            measured: file_name(measured),
            model: format!("the model of {}", device.name),
            unit: "µV",
            load_unit: Some("N"),
            plate: Some(report::Plate::of(&device)),
        };
        write_report(&folder, &report::page(&subject), &diagnosis)?;
    }
    if *json {
        return print_json(&Document::of(&diagnosis));
    }
    if save_device.as_deref().is_some_and(is_stdout) {
        say(text::Report(&diagnosis));
        return Ok(());
    }
    use std::io::Write as _;
    Ok(write!(stdout(), "{}", text::Report(&diagnosis))?)
}

/// Where the device goes: nowhere that is read, and not between the lines of a document.
fn destination(path: &Path, arguments: &Arguments) -> Result<Destination, Failure> {
    if arguments.json && is_stdout(path) {
        return Err(both_print("--save-device -"));
    }
    arguments.pad.spare(path)?;
    if is_same(&arguments.measured, path) {
        return Err(written_over(path, "is the measured table"));
    }
    Destination::of(path)
}

/// The folder of the report: none whose files of these names are read or written by another option.
fn folder(path: &Path, arguments: &Arguments) -> Result<Folder, Failure> {
    for file in [report::PAGE, report::DOCUMENT].map(|name| path.join(name)) {
        arguments.pad.spare(&file)?;
        if is_same(&arguments.measured, &file) {
            return Err(written_over(&file, "is the measured table"));
        }
        if arguments.against.as_deref().is_some_and(|earlier| is_same(earlier, &file)) {
            return Err(written_over(&file, "is the earlier recording"));
        }
        if arguments.save_device.as_deref().is_some_and(|saved| is_same(saved, &file)) {
            return Err(written_over(&file, "is the device to save"));
        }
    }
    Folder::of(path)
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn write_report(folder: &Folder, page: &str, diagnosis: &Diagnosis) -> Result<(), Failure> {
    let page = folder.write(report::PAGE, page.as_bytes())?;
    let document =
        folder.write(report::DOCUMENT, format!("{}\n", json_text(&Document::of(diagnosis))?).as_bytes())?;
    say(format_args!("the report is {page}, its numbers are {document}"));
    Ok(())
}

/// All effects that can be left out.
fn effects() -> Vec<&'static str> {
    let mut effects: Vec<&str> = diagnosis::effects().collect();
    effects.extend(diagnosis::against::effects().filter(|it| diagnosis::effects().all(|other| other != *it)));
    effects
}

/// Why there is no diagnosis.
enum Why {
    Unfit(Unfit),
    NoField(Failure),
}

fn diagnosed(table: &Table, device: &Device, without: &[String]) -> Result<Diagnosis, Why> {
    let field = field_of(device).map_err(Why::NoField)?;
    let flaws = flaws(device);
    let solve = |device: &Device| field_of(device).ok();
    let pad = diagnosis::Pad { device, field: &field, flaws: &flaws, solve: &solve, without };
    let _progress = Progress::begin("looking for causes");
    diagnosis::diagnose(table, &pad).map_err(Why::Unfit)
}

/// What flaws of a module change; none where that cannot be had.
fn flaws(device: &Device) -> Vec<FieldChange> {
    match changes_of(device) {
        Ok(changes) => changes.0,
        Err(Failure::Failed(why) | Failure::Unusable(why)) => {
            say(format_args!("open frames and loose bonds are not looked for: {why}"));
            Vec::new()
        }
        Err(Failure::Unread) => Vec::new(),
    }
}

fn unfit(measured: &Path, why: &Unfit) -> Failure {
    Failure::Unusable(format!("{}: {why}", measured.display()))
}

fn save(to: &Destination, device: &Device, diagnosis: &Diagnosis, table: &Table) -> Result<(), Failure> {
    let last_cycle = table.rows.iter().filter_map(|row| row.cycle).reduce(f64::max);
    let (device, left_out) = extended(device, diagnosis, last_cycle);
    to.write(device.to_toml().as_bytes())?;
    if !left_out.is_empty() {
        say(format_args!(
            "named, but not in the saved device, which cannot hold it: {}",
            left_out.join(", ")
        ));
    }
    if diagnosis.findings.iter().any(|finding| !finding.confounded_with.is_empty()) {
        say("confounded causes are not in the saved device");
    }
    Ok(())
}
