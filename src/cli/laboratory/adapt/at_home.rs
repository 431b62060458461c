//! The fit of a decoder to presses without labels and a weight on marks, and its report.

use std::fmt;
use std::path::Path;

use serde::Serialize;

use super::method::Method;
use super::named::NamedCauses;
use super::numbers::FoundPad;
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::field::solve;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::wrapped::hanging;
use crate::cli::printing::written::tell;
use tactpad::counted::counted;
use tactpad::lab::calibration::data::earlier::EarlierCalibration;
use tactpad::lab::play::home::{AtHome, HomeError, calibrated};
use tactpad::lab::play::summary::{HEADING, PlatePart, Summary};
use tactpad::lab::play::weights::Placement;
use tactpad::lab::play::windows::Window;
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pipeline::contact::Decoder;

/// How a weight is put on the marks.
const WEIGHING: &str = "tactpad calibrate --weight-g says when and where; the moments of a recording of your own go to adapt --weights.";

/// The report of the fit.
#[derive(Serialize)]
struct AtHomeReport {
    method: Method,
    /// What makes the decoder less sure than it states.
    warnings: Vec<String>,
    #[serde(flatten)]
    summary: Summary,
    pad: FoundPad,
}

/// Fits; a bar shows how far it is.
pub(crate) fn fitted(
    windows: &[Window],
    placements: &[Placement],
    device: &Device,
    field: &PadField,
    earlier: Option<&Decoder>,
) -> Result<AtHome, HomeError> {
    let progress = Progress::begin("fitting the pad's field");
    let report = |done: usize, of: usize| progress.part(done, of, "fitting the pad's field");
    let pad = SimulatedPad { solve: &solve, ..SimulatedPad::known(device, field) };
    calibrated(windows, placements, &pad, earlier.and_then(EarlierCalibration::of), &report)
}

/// Writes the decoder, and says what came of it: on standard output, unless that gets the decoder.
pub(crate) fn write(
    found: AtHome,
    windows: &[Window],
    to: &Destination,
    out: &Path,
    json: bool,
) -> Result<(), Failure> {
    to.write(&found.file())?;
    let outcome = AtHomeReport::of(found, windows);
    tell(&outcome, out, json)
}

impl AtHomeReport {
    fn of(found: AtHome, windows: &[Window]) -> Self {
        Self {
            method: Method::Inverse,
            warnings: found.displaced_mm().map(displaced).into_iter().collect(),
            summary: Summary::of(&found, windows),
            pad: FoundPad::of(found.calibration, NamedCauses::none()),
        }
    }
}

fn displaced(mm: f64) -> String {
    format!(
        "the modules seem to be displaced by {mm:.1} mm each, more than pads are built off by. Presses do not tell that from a pad that gives way \
         otherwise, so places and forces are known less well than stated here; a table of labelled contacts tells (tactpad protocol)"
    )
}

impl fmt::Display for AtHomeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.summary.source())?;
        for warning in &self.warnings {
            writeln!(f, "{}", hanging("warning: ", warning))?;
        }
        writeln!(f, "{}", self.pad)?;
        writeln!(f, "\n{HEADING}")?;
        for PlatePart { name, deviation_mm, force_share, presses, open } in &self.summary.map {
            let mark = if *open { "  open" } else { "" };
            writeln!(
                f,
                "{name:<29} {deviation_mm:>5.2} mm {:>5.1} % of the force, {}{mark}",
                100.0 * force_share,
                counted(presses, "press")
            )?;
        }
        f.write_str(&hanging("", &self.summary.next(WEIGHING)))
    }
}
