//! Tables of any sensor, and what is said of one.

use std::fs::File;
use std::io::BufReader;
use std::io::Write as _;
use std::path::Path;

use super::document::DiagnosisDocument;
use super::files::{file_name, write_report};
use super::{report, text};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use crate::cli::files::tables;
use crate::cli::printing::written::{print_json, reason, stdout};
use tactpad::lab::diagnosis::against::TEXTS;
use tactpad::lab::diagnosis::report::Diagnosis;
use tactpad::tables::measured::error::{Fault, ReadError};
use tactpad::tables::measured::sheet::{Sheet, sheet};

/// How names of columns end, and their unit.
const UNITS: [(&str, &str); 8] = [
    ("_uv", "µV"),
    ("_mv", "mV"),
    ("_v", "V"),
    ("_ut", "µT"),
    ("_mt", "mT"),
    ("_pf", "pF"),
    ("_n", "N"),
    ("_kpa", "kPa"),
];

/// Prints a diagnosis of channels that are held against this `model`, and writes its report.
pub(super) fn tell(
    diagnosis: &Diagnosis,
    measured: &Path,
    model: String,
    folder: Option<&Folder>,
    json: bool,
) -> Result<(), Failure> {
    let unit = unit(diagnosis);
    if let Some(folder) = folder {
        let has_places =
            diagnosis.residuals.samples.windows(2).any(|pair| pair[0].place_mm != pair[1].place_mm);
        let subject = report::Subject {
            diagnosis,
            measured: file_name(measured),
            model,
            unit,
            load_unit: has_places.then_some("N"),
            plate: None,
        };
        write_report(folder, &in_unit(&report::page(&subject), unit), diagnosis)?;
    }
    if json {
        return print_json(&DiagnosisDocument::of(diagnosis));
    }
    Ok(write!(stdout(), "{}", in_unit(&text::DiagnosisText(diagnosis).to_string(), unit))?)
}

/// Numbers of channels have the names that those of a pad have; what people read has the channels' own unit.
fn in_unit(text: &str, unit: &str) -> String {
    if unit.is_empty() { text.replace(" µV", "") } else { text.replace("µV", unit) }
}

/// The unit of all channels, by the ends of their names; none if they differ.
fn unit(diagnosis: &Diagnosis) -> &'static str {
    let of = |name: &String| UNITS.iter().find(|(end, _)| name.ends_with(end)).map_or("", |(_, unit)| unit);
    let mut units = diagnosis.channels.iter().map(of);
    let first = units.next().unwrap_or_default();
    if units.all(|unit| unit == first) { first } else { "" }
}

/// Reads a table of any sensor.
pub(super) fn read(path: &Path) -> Result<Sheet, Failure> {
    let refused = |ReadError { line, fault }: ReadError| {
        let path = path.display();
        Failure::Unusable(match fault {
            Fault::Io(error) => {
                format!("{path} cannot be read: {}; name a CSV file of a recording", reason(&error))
            }
            fault => format!("{path}:{line}: {fault}"),
        })
    };
    let file = File::open(path).map_err(|error| refused(ReadError { line: 1, fault: Fault::Io(error) }))?;
    let sheet = sheet(BufReader::new(file), &TEXTS).map_err(refused)?;
    tables::warn(path, sheet.open_end());
    Ok(sheet)
}
