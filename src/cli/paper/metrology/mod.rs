//! `tactpad metrology`: the paper's figures of merit, of the twin or of a measured file.

mod decoders;
mod report;
mod tables;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use clap::Args;

use self::report::MetrologyReport;
use crate::cli::failure::Failure;
use crate::cli::files::destination::{Destination, Folder};
use crate::cli::files::device::PadOptions;
use crate::cli::files::field::field_of;
use crate::cli::files::tables::{read, write};
use crate::cli::printing::pictures;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{is_stdout, print_json, say};
use tactpad::lab::metrology::bench::Bench;
use tactpad::lab::metrology::decoders::{Decoders, by};
use tactpad::lab::metrology::dynamics::PadDynamics;
use tactpad::lab::metrology::figures::{Evidence, Figures, Simulation};
use tactpad::lab::metrology::report::entries;
use tactpad::lab::metrology::{Decode, conflicts, drawing, procedures};
use tactpad::mechanics::mesh::Fineness;
use tactpad::mechanics::simulator::{PLATE_DEGREE, Simulator};
use tactpad::numeric::zernike::jets;
use tactpad::pad::device::Device;
use tactpad::tables::measured::columns::TableKind;

/// Arguments of `tactpad metrology`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad metrology --seeds 11-40 --figures figures")]
#[group(skip)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pad: PadOptions,
    /// A measured file; without it the twin of the pad carries out the paper's procedures.
    #[arg(long, value_name = "M.csv")]
    measured: Option<PathBuf>,
    /// The twin's seeds, from the first one to the last one: each is another pad, measured anew.
    ///
    /// The imperfections that reproduce the paper's figures were fitted with the seeds 1 to 10, so other seeds are shown.
    #[arg(long, value_name = "A-B", default_value = "11-40", value_parser = parse_seeds)]
    #[arg(conflicts_with = "measured")]
    seeds: RangeInclusive<u64>,
    /// A decoder that adapt wrote, for the figures that need one.
    ///
    /// Without it the paper's network is adapted to each of the twin's pads, by 648 contacts of its own.
    #[arg(long, value_name = "FILE")]
    decoder: Option<PathBuf>,
    /// The paper's network as train wrote it. Without it and --decoder one is trained for the twin: half a minute.
    #[arg(long, value_name = "FILE")]
    network: Option<PathBuf>,
    /// Leave open what needs a network: nothing is trained.
    #[arg(long, conflicts_with_all = ["network", "decoder"])]
    no_network: bool,
    /// Write the plots into this folder, as SVG and PNG: those of the first seed, and the forces' errors of all.
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
    write(&Destination::of(path)?, &plan)?;
    if !is_stdout(path) {
        say(format_args!("{} rows are written to {}", plan.rows.len(), path.display()));
    }
    Ok(())
}

/// The figures of a file. The pad that it is compared with is the device with its imperfections.
fn of_file(arguments: &Arguments, path: &Path) -> Result<MetrologyReport, Failure> {
    let device = arguments.pad.read()?;
    let table = read(path, TableKind::Measured, device.plate.radius_mm())?;
    let decoders = arguments.decoders()?;
    let folder = arguments.folder()?;
    let field = field_of(&device)?;
    let simulation = decoders.simulation();
    let (given, simulation) = (decoders.given.as_ref().map(by), simulation.as_ref().map(by));
    let evidence = Evidence {
        table: &table,
        signals: &field.signals,
        decoder: given.as_ref().map(|decode| decode as Decode),
        simulation: simulation.as_ref().map(|decode| Simulation { contacts: &table, decode }),
    };
    let progress = Progress::begin("finding the figures of merit");
    let figures = Figures::of(&evidence);
    drop(progress);
    let mut plots = plots(folder.as_ref(), &evidence, &figures)?;
    plots.extend(errors_plot(folder.as_ref(), std::slice::from_ref(&figures))?);
    let statement = format!(
        "Figures of {}. Whose data these are, and whether hardware was measured, this program cannot know.",
        path.display()
    );
    Ok(MetrologyReport {
        statement,
        seeds: vec![],
        rows: entries(std::slice::from_ref(&figures), &[]),
        figures: vec![figures],
        // It is of the simulated pad, and a module takes more memory than a table of a million rows.
        dynamics: None,
        plots,
    })
}

/// The figures of the twin.
fn of_twin(arguments: &Arguments) -> Result<MetrologyReport, Failure> {
    let (designed, device) = (arguments.pad.designed()?, arguments.pad.read_imperfect()?);
    let (given, folder) = (arguments.decoders()?, arguments.folder()?);
    let (nominal, field) = (field_of(&designed)?, field_of(&device)?);
    let decoders = match given {
        Decoders { given: None, network: None } if !arguments.no_network => {
            decoders::trained(&designed, &nominal)
        }
        given => given,
    };
    let dynamics = dynamics(&device)?;
    let bench = Bench { device, field, nominal, decoders };
    let seeds: Vec<u64> = arguments.seeds.clone().collect();
    let progress = Progress::begin("measuring the twin's pads");
    let report = |done: usize| {
        let what = format_args!("{done} of the twin's {} pads are measured", seeds.len());
        progress.part(done, seeds.len(), what);
    };
    report(0);
    let (figures, plots) =
        bench.all(&seeds, |evidence, figures| plots(folder.as_ref(), evidence, figures), report)?;
    // The line goes before anything is printed.
    drop(progress);
    let mut plots = plots.unwrap_or_default();
    plots.extend(errors_plot(folder.as_ref(), &figures)?);
    let conflicts = if arguments.pad.is_papers()? { conflicts::all() } else { Vec::new() };
    Ok(MetrologyReport {
        statement: "A numerical twin of the pad; no hardware was measured.".to_owned(),
        seeds,
        rows: entries(&figures, &conflicts),
        figures,
        dynamics,
        plots,
    })
}

/// The device's natural motions, and what they do to its step response.
fn dynamics(device: &Device) -> Result<Option<PadDynamics>, Failure> {
    let _progress = Progress::begin("looking for the pad's natural motions");
    let mut simulator = Simulator::new(Fineness::STANDARD);
    let unsolved = |error| Failure::Failed(format!("the simulator: {error}"));
    let motions = simulator.natural_motions(device).map_err(unsolved)?;
    let signals = simulator.pad(device).map_err(unsolved)?.signals();
    let middle = jets(PLATE_DEGREE, [0.0; 2]);
    let still_uv_per_n = [2, 5, 8].iter().map(|channel: &usize| signals[*channel][2].value(&middle)).sum();
    Ok(PadDynamics::of(&motions, still_uv_per_n))
}

impl Arguments {
    fn decoders(&self) -> Result<Decoders, Failure> {
        decoders::given(self.decoder.as_deref(), self.network.as_deref())
    }

    /// The folder of the plots.
    fn folder(&self) -> Result<Option<Folder>, Failure> {
        self.figures.as_deref().map(Folder::of).transpose()
    }
}

/// Writes the plots that the figures allow, and says their names.
fn plots(folder: Option<&Folder>, evidence: &Evidence, figures: &Figures) -> Result<Vec<String>, Failure> {
    let Some(folder) = folder else { return Ok(Vec::new()) };
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
            let [svg, _] = pictures::write(folder, name, &chart.figure())?;
            written.push(svg);
        }
    }
    Ok(written)
}

/// Writes the plot of the forces' errors, which is of all pads.
fn errors_plot(folder: Option<&Folder>, figures: &[Figures]) -> Result<Option<String>, Failure> {
    let Some((folder, columns)) = folder.zip(drawing::by_axis(figures)) else { return Ok(None) };
    let [svg, _] = pictures::write(folder, "metrology-rmse", &columns.figure())?;
    Ok(Some(svg))
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
