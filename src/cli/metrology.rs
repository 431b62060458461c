//! `tactpad metrology`: the paper's figures of merit, of the twin or of a measured file.

mod tables;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::device::Pad;
use super::field_cache::field_of;
use super::progress::Progress;
use super::tables::read;
use super::written::{create, is_stdout};
use super::{Failure, decoder_file, pictures, print_json};
use crate::contact::Decoder;
use crate::measured::columns::Kind;
use crate::measured::write;
use crate::metrology::figures::{Evidence, Figures};
use crate::metrology::report::{Entry, entries};
use crate::metrology::{Decode, drawing, procedures};
use crate::quantity::{CHANNELS, Strain};
use crate::twin::measurement;

/// Arguments of `tactpad metrology`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad metrology --seeds 1-10 --figures figures")]
#[group(skip)]
pub(super) struct Arguments {
    #[command(flatten)]
    pad: Pad,
    /// A measured file; without it the twin of the pad carries out the paper's procedures.
    #[arg(long, value_name = "M.csv")]
    measured: Option<PathBuf>,
    /// The twin's seeds, from the first one to the last one: each is another pad, measured anew.
    #[arg(long, value_name = "A-B", default_value = "1-10", value_parser = parse_seeds)]
    #[arg(conflicts_with = "measured")]
    seeds: RangeInclusive<u64>,
    /// A decoder that `adapt` or `train` wrote, for the figures that need one.
    #[arg(long, value_name = "FILE")]
    decoder: Option<PathBuf>,
    /// Write the plots into this folder, as SVG and PNG: those of the first seed.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Only write the plan of the paper's procedures, for `twin --plan` or for a rig.
    #[arg(long, value_name = "PLAN.csv", conflicts_with_all = ["measured", "seeds", "figures", "json"])]
    plan: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// So many seeds are enough for any spread.
const SEEDS_MAX: u64 = 1000;

/// Everything that the verb finds out.
#[derive(Serialize)]
struct Report {
    /// Whose figures these are.
    statement: String,
    /// None for a measured file.
    seeds: Vec<u64>,
    rows: Vec<Entry>,
    /// All that was found, by seed.
    figures: Vec<Figures>,
    /// Files of the plots.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    plots: Vec<String>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.plan {
        return write_plan(arguments, path);
    }
    let report = match &arguments.measured {
        Some(path) => of_file(arguments, path)?,
        None => of_twin(arguments)?,
    };
    if arguments.json { print_json(&report) } else { Ok(tables::print(&report)?) }
}

fn write_plan(arguments: &Arguments, path: &Path) -> Result<(), Failure> {
    arguments.pad.spare(path)?;
    let plan = procedures::plan(&arguments.pad.read()?.contact);
    write::table(create(path)?, &plan)?;
    if !is_stdout(path) {
        super::say(format_args!("{} rows are written to {}", plan.rows.len(), path.display()));
    }
    Ok(())
}

/// The figures of a file. The pad that it is compared with is the device with its imperfections.
fn of_file(arguments: &Arguments, path: &Path) -> Result<Report, Failure> {
    let device = arguments.pad.read()?;
    let table = read(path, Kind::Measured, 0.5 * device.plate.diameter_mm)?;
    let field = field_of(&device)?;
    let decoder = decoder(arguments)?;
    let decode = decoder.as_ref().map(|it| |uv: &[f64; CHANNELS]| it.decode(&strain(uv)));
    let decode = decode.as_ref().map(|decode| decode as Decode);
    let evidence =
        Evidence { table: &table, signals: &field.signals, decoder: decode, simulation_network: None };
    let figures = Figures::of(&evidence);
    let plots = plots(arguments, &evidence, &figures)?;
    let statement = format!(
        "Figures of {}. Whose data these are, and whether hardware was measured, this program cannot know.",
        path.display()
    );
    Ok(Report {
        statement,
        seeds: vec![],
        rows: entries(std::slice::from_ref(&figures), &[]),
        figures: vec![figures],
        plots,
    })
}

/// The figures of the twin. The pad that it is compared with is the device without imperfections.
fn of_twin(arguments: &Arguments) -> Result<Report, Failure> {
    let (designed, device) = (arguments.pad.designed()?, arguments.pad.read_imperfect()?);
    let (nominal, field) = (field_of(&designed)?, field_of(&device)?);
    let plan = procedures::plan(&device.contact);
    let decoder = decoder(arguments)?;
    let decode = decoder.as_ref().map(|it| |uv: &[f64; CHANNELS]| it.decode(&strain(uv)));
    let decode = decode.as_ref().map(|decode| decode as Decode);
    let mut progress = Progress::begin();
    let (mut all, mut files) = (Vec::new(), Vec::new());
    for seed in arguments.seeds.clone() {
        progress.step(format_args!("measuring the twin with seed {seed} of {}", arguments.seeds.end()));
        let table = measurement::carry_out(&plan, &device, &field, seed).table;
        let evidence =
            Evidence { table: &table, signals: &nominal.signals, decoder: decode, simulation_network: None };
        let figures = Figures::of(&evidence);
        if all.is_empty() {
            files = plots(arguments, &evidence, &figures)?;
        }
        all.push(figures);
    }
    let statement = "A numerical twin of the pad; no hardware was measured.".to_owned();
    Ok(Report {
        statement,
        seeds: arguments.seeds.clone().collect(),
        rows: entries(&all, &[]),
        figures: all,
        plots: files,
    })
}

fn decoder(arguments: &Arguments) -> Result<Option<Decoder>, Failure> {
    arguments.decoder.as_deref().map(decoder_file::read).transpose()
}

fn strain(uv: &[f64; CHANNELS]) -> Strain {
    Strain { uv: uv.map(|uv| uv as f32) }
}

/// Writes the plots that the figures allow, and says their names.
fn plots(arguments: &Arguments, evidence: &Evidence, figures: &Figures) -> Result<Vec<String>, Failure> {
    let Some(folder) = &arguments.figures else { return Ok(Vec::new()) };
    let charts = [
        ("metrology-force", drawing::by_force(evidence.table, evidence.signals)),
        ("metrology-temperature", figures.thermal_drift.as_ref().ok().map(drawing::by_temperature)),
        ("metrology-location", figures.location_spread.as_ref().ok().map(|s| drawing::by_place_decoded(s))),
        ("metrology-hysteresis", figures.hysteresis.as_ref().ok().map(drawing::by_loop)),
        ("metrology-ageing", figures.ageing.as_ref().ok().map(drawing::by_cycles)),
    ];
    let mut written = Vec::new();
    for (name, chart) in charts {
        if let Some(chart) = chart {
            pictures::write(folder, name, &chart.figure())?;
            written.push(folder.join(name).with_extension("svg").display().to_string());
        }
    }
    Ok(written)
}

fn parse_seeds(text: &str) -> Result<RangeInclusive<u64>, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let seed = |text: &str| text.trim().parse::<u64>().ok();
    match seed(first).zip(seed(last)) {
        Some((first, last)) if first <= last && last - first < SEEDS_MAX => Ok(first..=last),
        Some((first, last)) if first <= last => Err(format!("at most {SEEDS_MAX} seeds")),
        _ => Err("write the first and the last seed, as in 1-10".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_a_range() {
        assert_eq!((parse_seeds("1-10"), parse_seeds("7")), (Ok(1..=10), Ok(7..=7)));
        for text in ["", "-", "10-1", "1-", "-3", "a-b", "1-2-3", "1.5"] {
            assert!(parse_seeds(text).unwrap_err().contains("as in 1-10"), "{text}");
        }
        assert!(parse_seeds("0-1000").unwrap_err().contains("at most"));
    }
}
