//! `tactpad layout`: where the three modules should stand, by the paper's rule and by the pad's mechanics.

mod drawing;
#[cfg(feature = "simulator")]
mod mechanics;
mod tables;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

#[cfg(feature = "simulator")]
use self::mechanics::Study;
use super::device::Pad;
use super::{Failure, pictures, print_json};
use crate::device::Device;
use crate::layout::grid;
#[cfg(feature = "simulator")]
use crate::layout::placement::Placement;
use crate::layout::placement::{Candidate, Search};
use crate::layout::published::{PARTS, Part, WORKS, Work, area_per_channel_cm2, plate_area_cm2};
use crate::layout::region::{Isoline, Outline, THRESHOLD};
use crate::layout::spacing::{PAIRS, Radii, Spacing};
use crate::layout::swarm;
use crate::quantity::{CHANNELS, MODULES};
use crate::virtual_pad::front_end::NOISE_RMS_UV;

/// Arguments of `tactpad layout`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad layout --figures figures")]
#[group(skip)]
pub(super) struct Arguments {
    #[command(flatten)]
    pad: Pad,
    /// Radii of the modules' effective regions in millimetres: only the paper's rule for them, and no simulation.
    #[arg(long, value_name = "R1,R2,R3", value_parser = parse_radii, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["threshold", "noise_uv", "figures", "imperfections"])]
    radii: Option<Radii>,
    /// Share of a press that a module must carry to count as effective.
    #[arg(long, value_name = "SHARE", default_value_t = THRESHOLD, value_parser = parse_share)]
    #[arg(allow_hyphen_values = true)]
    threshold: f64,
    /// Noise of each channel, standard deviation in microvolts.
    #[arg(long, value_name = "UV", default_value_t = NOISE_RMS_UV, value_parser = parse_noise)]
    #[arg(allow_hyphen_values = true)]
    noise_uv: f64,
    /// The swarm's seed; the same seed gives the same answer.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true)]
    seed: u64,
    /// Write the figures layout-scan and layout-regions into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// More than the bridges' whole range.
const NOISE_MAX_UV: f64 = 1e6;

/// Everything that the verb finds out.
#[derive(Serialize)]
struct Report {
    seed: u64,
    spacing: SpacingReport,
    /// Nothing if the radii were given.
    #[serde(flatten)]
    simulated: Option<Simulated>,
    area_per_channel: Vec<AreaRow>,
    parts: [Part; PARTS.len()],
    parts_usd: f64,
}

/// The paper's layout problem and its three answers.
#[derive(Serialize)]
struct SpacingReport {
    radii_mm: [f64; MODULES],
    limits_mm: [f64; PAIRS],
    swarm: Spacing,
    grid: Spacing,
    closed_form: Spacing,
    /// Between what each distance of an optimal layout lies.
    optimal_ranges_mm: [[f64; 2]; PAIRS],
}

/// What the mechanics of a pad add.
#[derive(Serialize)]
struct Simulated {
    threshold: f64,
    noise_uv: f64,
    /// Per module; nothing where the isoline is not on the plate.
    isolines: [Option<Isoline>; MODULES],
    /// The isolines for pictures.
    #[serde(skip)]
    outlines: [Outline; MODULES],
    /// The force of the press whose location errors follow.
    press_n: [f64; 3],
    /// The pad as its device file has it.
    as_built: Candidate,
    /// The same with its modules where the paper's rule puts them.
    by_rule: Candidate,
    search: Search,
}

/// A row of the paper's Table 7, or of this pad beside it.
#[derive(Serialize)]
struct AreaRow {
    #[serde(flatten)]
    work: Work,
    area_per_channel_cm2: f64,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let device = arguments.pad.read()?;
    let (spacing, simulated) = match &arguments.radii {
        Some(radii) => (spacing(radii, arguments.seed)?, None),
        None => simulated(arguments, &device).map(|(spacing, pad)| (spacing, Some(pad)))?,
    };
    let report = Report {
        seed: arguments.seed,
        spacing,
        area_per_channel: area_rows(device.plate.diameter_mm),
        parts: PARTS,
        parts_usd: PARTS.iter().map(Part::price_usd).sum(),
        simulated,
    };
    if let (Some(folder), Some(pad)) = (&arguments.figures, &report.simulated) {
        pictures::write(folder, "layout-scan", &drawing::scan(pad))?;
        pictures::write(folder, "layout-regions", &drawing::regions(pad, &report.spacing, &device))?;
    }
    if arguments.json { print_json(&report) } else { Ok(tables::print(&report)?) }
}

/// The effective regions of the simulated pad, the paper's rule for them, and the search for better placements.
#[cfg(feature = "simulator")]
fn simulated(arguments: &Arguments, device: &Device) -> Result<(SpacingReport, Simulated), Failure> {
    let Arguments { threshold, noise_uv, seed, .. } = *arguments;
    let mut study = Study::of(device, noise_uv)?;
    let regions = study.regions(threshold);
    let isolines = regions.each_ref().map(|(isoline, _)| *isoline);
    let spacing = spacing(&radii(&isolines, threshold)?, seed)?;
    let placed = [Placement::of(device), Placement::by_rule(&spacing.closed_form)];
    let [as_built, by_rule] = placed.map(|placement| study.candidate(placement));
    let simulated = Simulated {
        threshold,
        noise_uv,
        isolines,
        outlines: regions.map(|(_, outline)| outline),
        press_n: study.press_n(),
        as_built: as_built?,
        by_rule: by_rule?,
        search: study.search()?,
    };
    Ok((spacing, simulated))
}

#[cfg(not(feature = "simulator"))]
fn simulated(_arguments: &Arguments, _device: &Device) -> Result<(SpacingReport, Simulated), Failure> {
    Err(Failure::Unusable(
        "this program was built without the simulator: give the radii of the effective regions, as in \
         --radii 33,33,33, or build it with the feature \"simulator\""
            .into(),
    ))
}

/// The paper's r of each module.
#[cfg(feature = "simulator")]
fn radii(isolines: &[Option<Isoline>; MODULES], threshold: f64) -> Result<Radii, Failure> {
    let [Some(r1), Some(r2), Some(r3)] = isolines.map(|isoline| isoline.map(|isoline| isoline.radius_mm))
    else {
        return Err(Failure::Unusable(format!(
            "at a threshold of {threshold} an isoline is not on the plate: choose another --threshold"
        )));
    };
    Radii::new([r1, r2, r3]).map_err(|error| Failure::Failed(error.to_string()))
}

fn spacing(radii: &Radii, seed: u64) -> Result<SpacingReport, Failure> {
    Ok(SpacingReport {
        radii_mm: radii.mm(),
        limits_mm: radii.limits_mm(),
        swarm: swarm::solve(radii, seed)
            .map_err(|error| Failure::Failed(format!("particle swarm: {error}")))?,
        grid: grid::search(radii),
        closed_form: radii.widest(),
        optimal_ranges_mm: radii.optimal_ranges_mm(),
    })
}

/// The paper's Table 7, with this pad before it.
fn area_rows(plate_diameter_mm: f64) -> Vec<AreaRow> {
    let own = Work {
        name: "this pad",
        principle: "sparse strain",
        channels: CHANNELS as u32,
        area_cm2: plate_area_cm2(plate_diameter_mm),
        printed_cm2: None,
    };
    let own = AreaRow { work: own, area_per_channel_cm2: area_per_channel_cm2(plate_diameter_mm) };
    let published = WORKS.map(|work| AreaRow { area_per_channel_cm2: work.area_per_channel_cm2(), work });
    [own].into_iter().chain(published).collect()
}

fn parse_radii(text: &str) -> Result<Radii, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let radii_mm = numbers.ok().and_then(|numbers| <[f64; MODULES]>::try_from(numbers).ok());
    let radii_mm = radii_mm.ok_or("write three radii in millimetres with commas between, as in 30,30,36")?;
    Radii::new(radii_mm).map_err(|error| error.to_string())
}

fn parse_share(text: &str) -> Result<f64, String> {
    let share = text.trim().parse().unwrap_or(f64::NAN);
    if share > 0.0 && share < 1.0 { Ok(share) } else { Err("write a share above 0 and below 1".into()) }
}

fn parse_noise(text: &str) -> Result<f64, String> {
    let noise_uv = text.trim().parse().unwrap_or(f64::NAN);
    if noise_uv > 0.0 && noise_uv <= NOISE_MAX_UV {
        Ok(noise_uv)
    } else {
        Err(format!("write a number of microvolts above 0 and up to {NOISE_MAX_UV}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_are_three_lengths() {
        assert_eq!(parse_radii("30, 30.5,36").unwrap().mm(), [30.0, 30.5, 36.0]);
        for text in ["", "30", "30,30", "30,30,30,30", "30;30;30", "a,b,c", "30,,30", "30,30,30,"] {
            assert!(parse_radii(text).unwrap_err().contains("as in 30,30,36"), "{text}");
        }
        for text in ["30,0,30", "30,-1,30", "30,nan,30", "30,inf,30", "30,1e300,30"] {
            assert!(parse_radii(text).unwrap_err().starts_with("R2 is "), "{text}");
        }
    }

    #[test]
    fn shares_and_noise_have_their_ranges() {
        assert_eq!((parse_share("0.01"), parse_noise("6")), (Ok(0.01), Ok(6.0)));
        for text in ["0", "1", "-0.1", "nan", "", "1%"] {
            assert!(parse_share(text).is_err(), "{text}");
        }
        for text in ["0", "-6", "nan", "inf", "", "1e7"] {
            assert!(parse_noise(text).is_err(), "{text}");
        }
    }
}
