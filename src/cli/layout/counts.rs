//! `tactpad layout --modules`: the same plate on fewer modules and on more.

use std::io::{self, Write};

use super::Arguments;
use crate::cli::destination::Folder;
use crate::cli::failure::Failure;
use crate::cli::pictures;
#[cfg(feature = "simulator")]
use crate::cli::progress::Progress;
use crate::cli::written::{print_json, stdout};
use tactpad::lab::layout::conditioning::UNKNOWNS;
use tactpad::lab::layout::drawing;
use tactpad::lab::layout::module_count::{MODULES_MAX, ModuleCounts, Ringed, Wiring};
use tactpad::pad::device::Device;

/// Numbers of modules to compare.
#[derive(Clone, Debug)]
pub(super) struct Counts(Vec<usize>);

impl Counts {
    /// Reads numbers with commas between them.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let counts: Result<Vec<usize>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        let is_usable = |counts: &Vec<usize>| counts.iter().all(|count| (1..=MODULES_MAX).contains(count));
        let counts = counts.ok().filter(is_usable).ok_or_else(|| {
            format!("write numbers from 1 to {MODULES_MAX} with commas between, as in 2,3,4,6")
        })?;
        let mut once = Vec::with_capacity(counts.len());
        for count in counts {
            if once.contains(&count) {
                return Err(format!("{count} is there twice: once is enough"));
            }
            once.push(count);
        }
        Ok(Self(once))
    }
}

/// Compares the pads, prints them and draws them into the folder if there is one.
pub(super) fn run(
    arguments: &Arguments,
    device: &Device,
    counts: &Counts,
    folder: Option<&Folder>,
) -> Result<(), Failure> {
    let found = simulated(device, counts, arguments.noise_uv)?;
    if let Some(folder) = folder {
        pictures::write(folder, "layout-modules", &drawing::module_counts(&found))?;
    }
    if arguments.json { print_json(&found) } else { Ok(write(&mut stdout(), &found)?) }
}

#[cfg(feature = "simulator")]
fn simulated(device: &Device, Counts(counts): &Counts, noise_uv: f64) -> Result<ModuleCounts, Failure> {
    let progress = Progress::begin("solving the modules");
    Ok(ModuleCounts::of(device, counts, noise_uv, |what| progress.step(what))?)
}

#[cfg(not(feature = "simulator"))]
fn simulated(_device: &Device, _counts: &Counts, _noise_uv: f64) -> Result<ModuleCounts, Failure> {
    Err(Failure::Unusable(
        "this program was built without the simulator, which --modules needs: build it with the feature \
         \"simulator\""
            .into(),
    ))
}

fn write(out: &mut impl Write, found: &ModuleCounts) -> io::Result<()> {
    let ([fx, fy, fz], noise_uv) = (found.press_n, found.noise_uv);
    writeln!(out, "Modules at equal angles, {} mm from the axis", found.centre_radius_mm)?;
    writeln!(
        out,
        "Location error at best (Cramér–Rao), press of {fx}, {fy}, {fz} N, noise {noise_uv} µV on each reading"
    )?;
    writeln!(
        out,
        "{:<8} {:<8} {:>8} {:>7} {:>17} {:>9} {:>9} {:>14} {:>10}",
        "modules",
        "read as",
        "readings",
        "rank",
        "condition",
        "worst mm",
        "rms mm",
        "without one mm",
        "signal µV"
    )?;
    for row in &found.rows {
        write_row(out, row)?;
    }
    let radius_mm = found.plate_radius_mm;
    writeln!(
        out,
        "rank, of {UNKNOWNS}, and condition number over the plate, places in shares of {radius_mm} mm, forces in \
         shares of the press"
    )
}

fn write_row(out: &mut impl Write, row: &Ringed) -> io::Result<()> {
    let Ringed { modules, wiring, readings, conditioning, precision, worst_without_one_mm } = *row;
    let wiring = match wiring {
        Wiring::Bridges => "bridges",
        Wiring::Gauges => "gauges",
    };
    let [rank, condition] = [
        range(conditioning.rank.map(|rank| rank.to_string())),
        range(conditioning.condition.map(|condition| finite(condition, 0))),
    ];
    let [worst, rms, without] =
        [precision.worst_mm, precision.rms_mm, worst_without_one_mm].map(|mm| finite(mm, 4));
    writeln!(
        out,
        "{modules:<8} {wiring:<8} {readings:>8} {rank:>7} {condition:>17} {worst:>9} {rms:>9} {without:>14} {:>10.0}",
        precision.largest_uv
    )
}

/// One value, or from where to where.
fn range([from, to]: [String; 2]) -> String {
    if from == to { from } else { format!("{from} to {to}") }
}

/// A number, or that there is none.
fn finite(value: f64, digits: usize) -> String {
    if value.is_finite() { format!("{value:.digits$}") } else { "none".to_owned() }
}
