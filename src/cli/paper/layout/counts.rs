//! `tactpad layout --modules`: the same plate on fewer modules and on more.

use std::io::{self, Write};

use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use crate::cli::printing::pictures;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{print_json, stdout};
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

/// Compares the pads, draws them into the folder if there is one, and prints them, for people or as JSON.
pub(super) fn run(
    device: &Device,
    counts: &Counts,
    noise_uv: f64,
    folder: Option<&Folder>,
    json: bool,
) -> Result<(), Failure> {
    let found = simulated(device, counts, noise_uv)?;
    if let Some(folder) = folder {
        pictures::write(folder, "layout-modules", &drawing::module_counts(&found))?;
    }
    if json { print_json(&found) } else { Ok(write(&mut stdout(), &found)?) }
}

fn simulated(device: &Device, Counts(counts): &Counts, noise_uv: f64) -> Result<ModuleCounts, Failure> {
    let progress = Progress::begin("solving the modules");
    Ok(ModuleCounts::of(device, counts, noise_uv, |what| progress.step(what))?)
}

fn write(out: &mut impl Write, found: &ModuleCounts) -> io::Result<()> {
    let ([fx, fy, fz], noise_uv) = (found.press_n, found.noise_uv);
    writeln!(out, "Modules at equal angles, {} mm from the axis", found.centre_radius_mm)?;
    writeln!(out, "Location error at best (Cramér–Rao), press of {fx}, {fy}, {fz} N, noise {noise_uv} µV")?;
    let heads = [
        "modules",
        "read as",
        "readings",
        "rank",
        "condition",
        "worst mm",
        "rms mm",
        "one lost",
        "signal µV",
    ];
    write_line(out, heads)?;
    for row in &found.rows {
        write_row(out, row)?;
    }
    let radius_mm = found.plate_radius_mm;
    writeln!(
        out,
        "rank (of {UNKNOWNS}) and condition number over the plate: places in shares of {radius_mm} mm,"
    )?;
    writeln!(out, "forces in shares of the press; one lost: worst mm if one module is not read")
}

fn write_row(out: &mut impl Write, row: &Ringed) -> io::Result<()> {
    let Ringed { modules, wiring, readings, conditioning, precision, worst_without_one_mm } = *row;
    let wiring = match wiring {
        Wiring::Bridges => "bridges",
        Wiring::Gauges => "gauges",
    };
    let rank = range(conditioning.rank.map(|rank| rank.to_string()));
    let condition = range(conditioning.condition.map(ratio));
    let [worst, rms, lost] = [precision.worst_mm, precision.rms_mm, worst_without_one_mm].map(length);
    let (modules, readings, uv) =
        (modules.to_string(), readings.to_string(), format!("{:.0}", precision.largest_uv));
    write_line(out, [&modules, wiring, &readings, &rank, &condition, &worst, &rms, &lost, &uv])
}

fn write_line(out: &mut impl Write, cells: [&str; 9]) -> io::Result<()> {
    let [modules, wiring, readings, rank, condition, worst, rms, lost, uv] = cells;
    writeln!(
        out,
        "{modules:<7} {wiring:<7} {readings:>8} {rank:>6} {condition:>10} {worst:>8} {rms:>8} {lost:>8} {uv:>9}"
    )
}

/// One value, or from where to where.
fn range([from, to]: [String; 2]) -> String {
    if from == to { from } else { format!("{from} to {to}") }
}

/// A condition number; a great one by its size alone.
fn ratio(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "none".to_owned(),
        _ if value < 1e4 => format!("{value:.0}"),
        _ => format!("{value:.0e}"),
    }
}

/// Millimetres; the more there are, the fewer digits mean something.
fn length(value_mm: f64) -> String {
    match value_mm {
        _ if !value_mm.is_finite() => "none".to_owned(),
        _ if value_mm < 10.0 => format!("{value_mm:.4}"),
        _ => format!("{value_mm:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad::lab::layout::conditioning::Conditioning;
    use tactpad::lab::layout::precision::Precision;

    #[test]
    fn ranges_and_what_cannot_be_located() {
        let precision =
            Precision { worst_mm: f64::INFINITY, worst_at_mm: [0.0; 2], rms_mm: 17.3, largest_uv: 6150.4 };
        let row = Ringed {
            modules: 2,
            wiring: Wiring::Bridges,
            readings: 6,
            conditioning: Conditioning { rank: [4, 5], condition: [14.2, f64::INFINITY] },
            precision,
            worst_without_one_mm: 36_937.1,
        };
        let mut bytes = Vec::new();
        write_row(&mut bytes, &row).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let words: Vec<_> = text.split_whitespace().collect();
        let wanted = "2 bridges 6 4 to 5 14 to none none 17 36937 6150";
        assert_eq!(words.join(" "), wanted);
        assert_eq!([ratio(7.4), ratio(1_066_317.0), length(0.196_84)], ["7", "1e6", "0.1968"]);
        assert_eq!(range(["5".to_owned(), "5".to_owned()]), "5");
    }
}
