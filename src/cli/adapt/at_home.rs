//! A decoder from presses without labels and a weight on marks: how it is fitted, and what is told of it.

use std::fmt;
use std::path::Path;

use serde::Serialize;

use super::method::Method;
use super::named::Named;
use super::numbers::Pad as FoundPad;
use crate::cli::destination::Destination;
use crate::cli::failure::Failure;
use crate::cli::progress::Progress;
use crate::cli::wrapped::hanging;
use crate::cli::written::tell;
use tactpad::lab::calibration::earlier::Earlier;
use tactpad::lab::play::home::{AtHome, HomeError, Region, calibrated};
use tactpad::lab::play::weights::Placement;
use tactpad::lab::play::windows::Window;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pipeline::contact::Decoder;

/// What came of it.
#[derive(Serialize)]
struct Outcome {
    method: Method,
    /// Windows of a tenth of a second with a press.
    presses: usize,
    placements: usize,
    /// Whether a weight said how strong a newton is.
    scale_known: bool,
    map: Vec<Part>,
    pad: FoundPad,
}

/// A part of the plate.
#[derive(Serialize)]
struct Part {
    name: &'static str,
    /// Standard deviation of the place by what is not known of the pad.
    deviation_mm: f64,
    /// The same of a force, as a share of it.
    force_share: f64,
    presses: usize,
    /// Whether more presses there help most.
    open: bool,
}

/// Fits; a bar shows how far it is.
pub(crate) fn fitted(
    windows: &[Window],
    placements: &[Placement],
    pad: (&Device, &PadField),
    earlier: Option<&Decoder>,
) -> Result<AtHome, HomeError> {
    let progress = Progress::begin("fitting the pad's field");
    let report = |done: usize, of: usize| progress.part(done, of, "fitting the pad's field");
    calibrated(windows, placements, pad, earlier.and_then(Earlier::of), &report)
}

/// Writes the decoder, and says what came of it: on standard output, unless that gets the decoder.
pub(crate) fn write(
    found: AtHome,
    windows: &[Window],
    (to, out): (&Destination, &Path),
    json: bool,
) -> Result<(), Failure> {
    let note = format!("{} presses of play, {} placements of a weight", found.presses, found.placements);
    to.write(&found.calibration.decoder().to_bytes(&note).unwrap_or_default())?;
    let outcome = Outcome::of(found, windows);
    tell(&outcome, out, json)
}

impl Outcome {
    fn of(found: AtHome, windows: &[Window]) -> Self {
        let regions = found.regions(windows);
        let open: Vec<&str> = AtHome::open(&regions).iter().map(|region| region.name).collect();
        let part = |region: &Region| Part {
            name: region.name,
            deviation_mm: region.deviation_mm,
            force_share: region.force_share,
            presses: region.presses,
            open: open.contains(&region.name),
        };
        Self {
            method: Method::Inverse,
            presses: found.presses,
            placements: found.placements,
            scale_known: found.knows_scale(),
            map: regions.iter().map(part).collect(),
            pad: FoundPad::of(found.calibration, Named::by(&[], &Device::nominal(), &PadField::nominal())),
        }
    }

    /// What is still open, and what helps most.
    fn next(&self) -> String {
        let open: Vec<&str> = self.map.iter().filter(|part| part.open).map(|part| part.name).collect();
        match (self.scale_known, open.as_slice()) {
            (false, _) => "The force's scale is unknown: presses alone never tell it. Next: put a known weight, 100 to 500 g, on five \
                           marks. tactpad calibrate --weight-g says when and where; the moments of a recording of your own go to \
                           adapt --weights."
                .into(),
            (true, []) => "No part of the plate is known much worse than the others. More play makes all of it better.".into(),
            (true, parts) => format!("Next: press more on {}. It is known worst there.", parts.join(", ")),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (presses, placements) = (self.presses, self.placements);
        writeln!(f, "{presses} tenths of a second of presses, {placements} placements of a weight")?;
        writeln!(f, "{}", self.pad)?;
        writeln!(f, "\nWhat is known of the pad, as what it leaves open of a press of 2.5 N:")?;
        for part in &self.map {
            let Part { name, deviation_mm, force_share, presses, open } = part;
            let mark = if *open { "  open" } else { "" };
            writeln!(
                f,
                "{name:<29} {deviation_mm:>5.2} mm {:>5.1} % of the force, {presses} presses{mark}",
                100.0 * force_share
            )?;
        }
        f.write_str(&hanging("", &self.next()))
    }
}
