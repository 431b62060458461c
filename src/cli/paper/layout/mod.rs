//! `tactpad layout`: where the three modules should stand, by the paper's rule and by the pad's mechanics.

mod counts;
mod report;
mod sizes;
mod tables;

use std::path::PathBuf;

use clap::Args;

use self::counts::Counts;
use self::report::LayoutReport;
use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use crate::cli::files::device::PadOptions;
use crate::cli::number;
use crate::cli::printing::pictures;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::print_json;
use tactpad::lab::layout::drawing;
use tactpad::lab::layout::published::{PARTS, PublishedPart, area_rows};
use tactpad::lab::layout::region::THRESHOLD;
use tactpad::lab::layout::spacing::Radii;
use tactpad::lab::layout::study::{Simulated, SpacingAnswers, StudyError};
use tactpad::pad::device::Device;
use tactpad::quantity::MODULES;
use tactpad::virtual_pad::front_end::NOISE_RMS_UV;

/// Arguments of `tactpad layout`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad layout --figures figures")]
#[group(skip)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pad: PadOptions,
    /// Radii of the modules' effective regions in millimetres: only the paper's rule for them, and no simulation.
    #[arg(long, value_name = "R1,R2,R3", value_parser = parse_radii, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["threshold", "noise_uv", "imperfections"])]
    radii: Option<Radii>,
    /// Say instead how well the same plate locates on this number of modules at equal angles; several numbers are compared.
    #[arg(long, value_name = "N,N", value_parser = Counts::parse, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["radii", "threshold", "seed"])]
    modules: Option<Counts>,
    /// Share of a press that a module must carry to count as effective.
    #[arg(long, value_name = "SHARE", default_value_t = THRESHOLD, value_parser = number::share)]
    #[arg(allow_hyphen_values = true)]
    threshold: f64,
    /// Noise of each channel, standard deviation in microvolts.
    #[arg(long, value_name = "UV", default_value_t = NOISE_RMS_UV, value_parser = parse_noise)]
    #[arg(allow_hyphen_values = true)]
    noise_uv: f64,
    /// Say instead how large and how thick the plate should be: pads of 30 to 150 mm and 0.5 to 3 mm with these modules.
    #[arg(long, conflicts_with_all = ["radii", "threshold", "seed"])]
    sizes: bool,
    /// Write the device file of each of these pads into this folder, for simulate --device.
    #[arg(long, value_name = "DIR", requires = "sizes")]
    devices: Option<PathBuf>,
    /// The swarm's seed; the same seed gives the same answer.
    #[arg(long, default_value_t = 1, value_parser = number::seed, allow_hyphen_values = true)]
    seed: u64,
    /// Write the figures layout-swarm, layout-scan and layout-regions into this folder, as SVG and PNG; with --radii layout-swarm
    /// alone; with --modules, layout-modules; with --sizes, size-sensitivity, size-error and size-frequency.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// More than the bridges' whole range.
const NOISE_MAX_UV: f64 = 1e6;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let device = arguments.pad.read()?;
    let folder = arguments.figures.as_deref().map(Folder::of).transpose()?;
    if let Some(counts) = &arguments.modules {
        return counts::run(&device, counts, arguments.noise_uv, folder.as_ref(), arguments.json);
    }
    if arguments.sizes {
        let (figures, devices) = (folder.as_ref(), arguments.devices.as_deref());
        let options = sizes::SizesOptions { figures, devices, json: arguments.json };
        return sizes::run(&device, arguments.noise_uv, &options);
    }
    let (spacing, simulated) = match &arguments.radii {
        Some(radii) => (SpacingAnswers::of(radii, arguments.seed), None),
        None => simulated(arguments, &device).map(|(spacing, pad)| (spacing, Some(pad)))?,
    };
    let at_best = simulated.as_ref().and_then(|pad| pad.as_built.precision);
    let report = LayoutReport {
        seed: arguments.seed,
        spacing,
        area_per_channel: area_rows(device.plate.diameter_mm, at_best.map(|found| found.rms_mm)),
        parts: PARTS,
        parts_usd: PARTS.iter().map(PublishedPart::price_usd).sum(),
        simulated,
    };
    if let Some(folder) = &folder {
        draw(folder, &report, &device)?;
    }
    if arguments.json { print_json(&report) } else { Ok(tables::print(&report)?) }
}

fn draw(folder: &Folder, report: &LayoutReport, device: &Device) -> Result<(), Failure> {
    let radii = Radii::new(report.spacing.radii_mm).map_err(StudyError::Radius)?;
    pictures::write(folder, "layout-swarm", &drawing::swarms(&radii, report.seed))?;
    if let Some(pad) = &report.simulated {
        pictures::write(folder, "layout-scan", &drawing::scan(pad))?;
        pictures::write(folder, "layout-regions", &drawing::regions(pad, &report.spacing, device))?;
    }
    Ok(())
}

/// The effective regions of the simulated pad, the paper's rule for them, and the search for better placements.
fn simulated(arguments: &Arguments, device: &Device) -> Result<(SpacingAnswers, Simulated), Failure> {
    let Arguments { threshold, noise_uv, seed, .. } = *arguments;
    let progress = Progress::begin("solving the modules");
    Ok(Simulated::of(device, threshold, noise_uv, seed, |what| progress.step(what))?)
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::NoRegion { .. } | StudyError::Crowded { .. } => Self::Unusable(error.to_string()),
            _ => Self::Failed(error.to_string()),
        }
    }
}

fn parse_radii(text: &str) -> Result<Radii, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let radii_mm = numbers.ok().and_then(|numbers| <[f64; MODULES]>::try_from(numbers).ok());
    let radii_mm = radii_mm.ok_or("write three radii in millimetres with commas between, as in 30,30,36")?;
    Radii::new(radii_mm).map_err(|error| error.to_string())
}

fn parse_noise(text: &str) -> Result<f64, String> {
    let example = format_args!("microvolts above 0 and up to {NOISE_MAX_UV}, such as 6 or 6uV");
    number::read(text, &["uV", "µV"], |uv| *uv > 0.0 && *uv <= NOISE_MAX_UV, example)
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
    fn numbers_of_modules_are_small_and_once() {
        assert!(Counts::parse("2, 3,12").is_ok());
        for text in ["", "0", "13", "3,", "-3", "3.5", "three", "3;4", "99999999999999999999"] {
            assert!(Counts::parse(text).unwrap_err().contains("as in 2,3,4,6"), "{text}");
        }
        assert!(Counts::parse("3,4,3").unwrap_err().starts_with("3 is there twice"));
    }

    #[test]
    fn noise_has_its_range() {
        assert_eq!((parse_noise("6"), parse_noise("6,5 µV")), (Ok(6.0), Ok(6.5)));
        for text in ["0", "-6", "nan", "inf", "", "1e7"] {
            assert!(parse_noise(text).is_err(), "{text}");
        }
    }
}
