//! `tactpad simulate`: what the channels read for given contacts, or for the paper's dataset; and the pad under a press,
//! in figures and in ParaView's files.

mod dataset_picture;
mod module;
mod pictures;
mod shown;

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args, ValueEnum};
use serde::Serialize;

use crate::cli::failure::Failure;
use crate::cli::files::destination::{Destination, Folder};
use crate::cli::files::device::PadOptions;
use crate::cli::files::field::field_of;
use crate::cli::files::tables;
use crate::cli::number;
use crate::cli::printing::pictures::write as pictures_of;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::summary::{ChannelReport, Summary};
use crate::cli::printing::written::{both_print, is_same, is_stdout, print_json, say, stdout, written_over};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::readout::Readout;
use tactpad::pad::twin::bridges;
use tactpad::quantity::Contact;
use tactpad::tables::dataset;
use tactpad::tables::measured::columns::{Column, TableKind};
use tactpad::tables::measured::write::Writer;
use tactpad::tables::measured::{Label, Row, Table};

/// Arguments of `tactpad simulate`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad simulate --dataset paper --seed 1 --out paper.csv")]
#[command(override_usage = "tactpad simulate [OPTIONS] --contacts C.csv --out S.csv\n       \
                            tactpad simulate [OPTIONS] --dataset paper --out S.csv\n       \
                            tactpad simulate [OPTIONS] [--figures DIR] [--vtk DIR] [--at X,Y]")]
#[command(group = ArgGroup::new("wanted").args(["contacts", "dataset", "figures", "vtk"]).required(true).multiple(true))]
#[group(skip)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    pad: PadOptions,
    /// A number that the dataset's draws follow from: the same seed draws the same contacts.
    #[arg(long, default_value = "0", value_parser = number::seed, allow_hyphen_values = true, conflicts_with = "contacts")]
    seed: u64,
    /// The measured CSV to write; a file that is there is replaced, and - is standard output.
    #[arg(long, value_name = "FILE", requires = "Source")]
    out: Option<PathBuf>,
    #[command(flatten)]
    folders: Folders,
    /// Print one JSON document: rows, and each channel's largest magnitude and root mean square; files beside them.
    #[arg(long)]
    json: bool,
}

/// Where the contacts come from.
#[derive(Debug, Args)]
#[group(multiple = false)]
struct Source {
    /// A CSV of contacts: t_s,x_mm,y_mm,fx_n,fy_n,fz_n.
    ///
    /// The first line names the columns; others are ignored. t_s may be missing. A contact that would reach over the
    /// plate's rim is refused.
    #[arg(long, value_name = "FILE", requires = "out")]
    contacts: Option<PathBuf>,
    /// Contacts that the program draws itself.
    #[arg(long, value_name = "NAME", requires = "out")]
    dataset: Option<Dataset>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Dataset {
    /// The paper's 14,400 contacts on the plate: 7,200 with forces along three axes, 7,200 normal, each force 0 to 5 N.
    Paper,
}

/// Where the pressed pad is shown.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("shown").args(["figures", "vtk"]).multiple(true))]
#[group(skip)]
struct Folders {
    /// A folder for figures, SVG and PNG: the plate's deflection and stress under a press of 1 N, strain and stress of
    /// module 0, its gauges one by one, and the 27 influence maps; with --dataset how its contacts are drawn, instead.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// A folder for ParaView's files of the pad under a press of 1 N: the plate and the three modules.
    #[arg(long, value_name = "DIR")]
    vtk: Option<PathBuf>,
    /// Where the pad is pressed for figures and ParaView's files, in millimetres.
    #[arg(long, value_name = "X,Y", default_value = "12,5", value_parser = parse_place, allow_hyphen_values = true)]
    #[arg(requires = "shown")]
    at: [f64; 2],
}

/// The report of `tactpad simulate`.
#[derive(Serialize)]
struct SimulateReport {
    #[serde(flatten)]
    table: Option<ChannelReport>,
    /// Figures and meshes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<String>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { out, folders, json, .. } = arguments;
    let prints_table = out.as_deref().is_some_and(is_stdout);
    if *json && prints_table {
        return Err(both_print("--out -"));
    }
    let device = arguments.pad.read()?;
    tables::within_the_rim(folders.at, &device.contact)
        .map_err(|why| Failure::Unusable(format!("--at {},{}: {why}", folders.at[0], folders.at[1])))?;
    let contacts = out.as_ref().map(|out| contacts(arguments, out, &device)).transpose()?;
    let to = out.as_deref().map(Destination::of).transpose()?;
    let [figures, vtk] = folders.tried()?;
    let mut files = Vec::new();
    let shown = match (&contacts, &figures) {
        (Some(contacts), Some(folder)) if arguments.source.dataset.is_some() => {
            let labels: Vec<Label> = contacts.rows.iter().map(|row| row.label).collect();
            files.extend(pictures_of(folder, "dataset", &dataset_picture::of(&labels, &device))?);
            None
        }
        _ => figures.as_ref(),
    };
    let table = contacts.zip(to).map(|(contacts, to)| table(&contacts, &to, &device)).transpose()?;
    files.extend(folders.fill(&device, shown, vtk.as_ref())?);
    let outcome = SimulateReport { table, files };
    match (json, prints_table) {
        (true, _) => print_json(&outcome),
        (false, true) => {
            say(&outcome);
            Ok(())
        }
        (false, false) => Ok(writeln!(stdout(), "{outcome}")?),
    }
}

impl Folders {
    /// The folders for figures and for meshes.
    fn tried(&self) -> Result<[Option<Folder>; 2], Failure> {
        let tried = |folder: &Option<PathBuf>| folder.as_deref().map(Folder::of).transpose();
        Ok([tried(&self.figures)?, tried(&self.vtk)?])
    }

    /// Writes what is wanted, and says which files these are.
    fn fill(
        &self,
        device: &Device,
        figures: Option<&Folder>,
        vtk: Option<&Folder>,
    ) -> Result<Vec<String>, Failure> {
        if figures.is_none() && vtk.is_none() {
            return Ok(Vec::new());
        }
        shown::fill(device, self.at, figures, vtk)
    }
}

fn parse_place(text: &str) -> Result<[f64; 2], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let place_mm = numbers.ok().and_then(|numbers| <[f64; 2]>::try_from(numbers).ok());
    let place_mm = place_mm.filter(|place_mm| place_mm.iter().all(|mm| mm.is_finite()));
    place_mm.ok_or_else(|| "write x and y in millimetres with a comma between, as in 12,-5".into())
}

impl fmt::Display for SimulateReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let files = self.files.iter().map(|file| format!("{file} is written"));
        let lines: Vec<String> = self.table.iter().map(ChannelReport::to_string).chain(files).collect();
        f.write_str(&lines.join("\n"))
    }
}

/// Writes the measured table of these contacts.
fn table(contacts: &Table, to: &Destination, device: &Device) -> Result<ChannelReport, Failure> {
    let field = field_of(device)?;
    let _progress = Progress::begin("computing the channels");
    let mut writing = to.begin()?;
    let report = measure(contacts, &field, device, &mut writing)?;
    writing.finish()?;
    Ok(report)
}

/// Writes what the channels read for each contact.
fn measure(
    contacts: &Table,
    field: &PadField,
    device: &Device,
    out: impl Write,
) -> io::Result<ChannelReport> {
    let readout = Readout::of(device);
    let reference_c = device.behaviour.thermal.reference_c;
    let mut summary = Summary::default();
    let timed = contacts.columns().into_iter().filter(|column| *column == Column::Time);
    let mut table = Writer::begin(out, &timed.chain([Column::Channels]).collect::<Vec<_>>(), contacts)?;
    for row in &contacts.rows {
        let bridges = bridges(field, &row.label.into());
        let channels_uv = readout.read_uv(&bridges, reference_c);
        table.row(&Row { uv: Some(channels_uv), ..*row }, contacts)?;
        summary.add(&channels_uv, &bridges, device.circuit.excitation_v);
    }
    table.end()?;
    Ok(summary.report())
}

/// The contacts that were asked for, all of them on the plate.
fn contacts(arguments: &Arguments, out: &Path, device: &Device) -> Result<Table, Failure> {
    arguments.pad.spare(out)?;
    let Arguments { source: Source { contacts, dataset }, seed, .. } = arguments;
    match (contacts, dataset) {
        (Some(path), _) if is_same(path, out) => Err(written_over(out, "is the table of contacts")),
        (Some(path), _) => tables::on_the_plate(path, TableKind::Contacts, device),
        (None, Some(Dataset::Paper)) => Ok(drawn(&dataset::paper(&device.contact, *seed))),
        (None, None) => Err(Failure::Unusable("give --contacts or --dataset".into())),
    }
}

/// Drawn contacts as a table.
fn drawn(contacts: &[Contact]) -> Table {
    let rows = contacts.iter().map(|contact| {
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = [x_mm, y_mm, fx_n, fy_n, fz_n].map(decimal);
        Row::of(Label { x_mm, y_mm, fx_n, fy_n, fz_n })
    });
    Table { rows: rows.collect(), ..Table::default() }
}

/// The number with the fewest digits that still means `number`: a table shall not be full of digits that mean nothing.
fn decimal(number: f32) -> f64 {
    number.to_string().parse().unwrap_or_else(|_| f64::from(number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad::quantity::CHANNELS;

    fn row(x_mm: f64, y_mm: f64, fz_n: f64) -> Row {
        Row::of(Label { x_mm, y_mm, fx_n: 0.5, fy_n: -1.0, fz_n })
    }

    /// The channels that are written for a few contacts, and the report.
    fn measured(device: &Device, field: &PadField) -> (Vec<[f64; CHANNELS]>, serde_json::Value) {
        let rows = vec![row(0.0, 0.0, 5.0), row(20.0, 0.0, 3.0), row(-9.0, 21.0, 1.0)];
        let mut text = Vec::new();
        let contacts = Table { rows, ..Table::default() };
        let report = measure(&contacts, field, device, &mut text).unwrap();
        let numbers = |line: &str| {
            let numbers: Vec<f64> = line.split(',').skip(5).map(|number| number.parse().unwrap()).collect();
            numbers.try_into().unwrap()
        };
        let table = String::from_utf8(text).unwrap().lines().skip(1).map(numbers).collect();
        (table, serde_json::to_value(report).unwrap())
    }

    /// A field whose sums are the signals themselves: s = S/δ.
    fn field() -> PadField {
        let nominal = PadField::nominal();
        PadField { sums: nominal.signals.clone(), ..nominal }
    }

    #[test]
    fn an_exact_bridge_writes_what_the_report_says_it_adds() {
        let linear = Device::nominal();
        let mut exact = linear.clone();
        exact.circuit.bridge_nonlinearity = true;
        let ((linear_uv, linear_report), (exact_uv, exact_report)) =
            (measured(&linear, &field()), measured(&exact, &field()));
        let mut max_uv = [0.0_f64; CHANNELS];
        for (linear_uv, exact_uv) in linear_uv.iter().zip(&exact_uv) {
            for channel in 0..CHANNELS {
                let wanted_uv = linear_uv[channel] / (1.0 + linear_uv[channel] / 5.6e6);
                assert!((exact_uv[channel] - wanted_uv).abs() < 0.002, "{wanted_uv} {exact_uv:?}");
                max_uv[channel] = max_uv[channel].max((wanted_uv - linear_uv[channel]).abs());
            }
        }
        for (channel, max_uv) in max_uv.into_iter().enumerate() {
            let told = |report: &serde_json::Value| {
                report["channels"][channel]["bridge_nonlinearity"]["max_uv"].as_f64().unwrap()
            };
            assert!(
                (told(&linear_report) - max_uv).abs() < 0.002 && told(&exact_report) == told(&linear_report)
            );
        }
        assert!(
            max_uv.into_iter().fold(0.0, f64::max) > 1.0,
            "5 N over a module bend the bridge: {max_uv:?}"
        );
    }

    #[test]
    fn gains_and_offsets_are_the_modules() {
        let nominal = Device::nominal();
        let mut other = nominal.clone();
        other.modules[1].gain = [1.0, 2.0, 1.0];
        other.modules[2].offset_uv = [0.0, 0.0, -300.0];
        let ((nominal_uv, _), (other_uv, _)) = (measured(&nominal, &field()), measured(&other, &field()));
        for (nominal_uv, other_uv) in nominal_uv.into_iter().zip(other_uv) {
            let mut wanted_uv = nominal_uv;
            wanted_uv[4] *= 2.0;
            wanted_uv[8] -= 300.0;
            for (wanted_uv, other_uv) in wanted_uv.into_iter().zip(other_uv) {
                assert!((wanted_uv - other_uv).abs() < 0.002, "{wanted_uv} {other_uv}");
            }
        }
    }
}
