//! `tactpad adapt --play`: a decoder from a capture of play.

use std::fmt;
use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::Arguments;
use super::method::Method;
use super::named::Named;
use super::numbers::Pad as FoundPad;
use super::own;
use crate::cli::decoder_file;
use crate::cli::destination::Destination;
use crate::cli::failure::Failure;
use crate::cli::field::field_of;
use crate::cli::profile;
use crate::cli::progress::Progress;
use crate::cli::recording::{Profiles, Recording};
use crate::cli::text_file;
use crate::cli::wrapped::hanging;
use crate::cli::written::{is_stdout, print_json, say, stdout};
use tactpad::lab::calibration::earlier::Earlier;
use tactpad::lab::play::home::{AtHome, HomeError, Region, calibrated};
use tactpad::lab::play::reader::Reader;
use tactpad::lab::play::weights::{self, Placement};
use tactpad::lab::play::windows::Window;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::mapping::check::OutputChoice;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::shipped;

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

pub(super) fn run(arguments: &Arguments, play: &Path, device: &Device) -> Result<(), Failure> {
    let Arguments { method, from, out, json, .. } = arguments;
    if method.is_some_and(|method| method != Method::Inverse) {
        return Err(Failure::Unusable(
            "from play there is only --method inverse: the others learn from labels".into(),
        ));
    }
    let reach_mm = device.contact.max_centre_radius_mm;
    let placements =
        arguments.weights.as_deref().map_or(Ok(Vec::new()), |path| read_weights(path, reach_mm))?;
    let to = Destination::of(out)?;
    let earlier = own::earlier(Method::Inverse, from.as_deref())?;
    let field = field_of(device)?;
    let windows = read(play, earlier.as_ref())?;
    let found = fitted(&windows, &placements, (device, &field), earlier.as_ref());
    let found = found.map_err(|error| {
        let name = arguments.weights.as_deref().unwrap_or(play);
        let is_placement = matches!(error, HomeError::Placement(_));
        let name = if is_placement { name } else { play };
        Failure::Unusable(format!("{}: {error}", name.display()))
    })?;
    let note = format!("{} presses of play, {} placements of a weight", found.presses, found.placements);
    to.write(&found.calibration.decoder().to_bytes(&note).unwrap_or_default())?;
    let outcome = Outcome::of(found, &windows);
    match (json, is_stdout(out)) {
        (true, _) => print_json(&outcome),
        (false, true) => {
            say(&outcome);
            Ok(())
        }
        (false, false) => Ok(writeln!(stdout(), "{outcome}\n{} is written", out.display())?),
    }
}

fn read_weights(path: &Path, reach_mm: f64) -> Result<Vec<Placement>, Failure> {
    let unusable = |why: String| Failure::Unusable(format!("{}: {why}", path.display()));
    let text = text_file::read(path).map_err(unusable)?;
    weights::read(&text, reach_mm).map_err(|why| unusable(why.to_string()))
}

/// The capture's windows. Touches are known by the earlier decoder, else by the nominal one.
fn read(path: &Path, earlier: Option<&Decoder>) -> Result<Vec<Window>, Failure> {
    let _progress = Progress::begin("reading the capture");
    let mut capture = Recording::open(path)?;
    let decoder = match earlier {
        Some(decoder) => decoder.clone(),
        None => decoder_file::read(Path::new(shipped::INVERSE))?,
    };
    // Only its filter counts, so any will do.
    let profile = capture.profile().or_else(|_| any_profile())?;
    let mut reader = Reader::new(decoder, profile);
    capture.each(Profiles::Skipped, |now, call| {
        reader.apply(now, call);
        Ok(())
    })?;
    Ok(reader.finish())
}

fn any_profile() -> Result<Profile, Failure> {
    profile::read("super-mario", OutputChoice::AsWritten).map(|read| read.profile().clone())
}

fn fitted(
    windows: &[Window],
    placements: &[Placement],
    pad: (&Device, &PadField),
    earlier: Option<&Decoder>,
) -> Result<AtHome, HomeError> {
    let progress = Progress::begin("fitting the pad's field");
    let report = |done: usize, of: usize| progress.part(done, of, "fitting the pad's field");
    calibrated(windows, placements, pad, earlier.and_then(Earlier::of), &report)
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
                           marks while you record, and give the moments with --weights."
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
