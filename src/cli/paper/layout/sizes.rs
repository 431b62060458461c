//! `tactpad layout --sizes`: how large and how thick the plate should be.

use std::io::{self, Write};
use std::path::Path;

use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use crate::cli::printing::pictures;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::wrapped::hanging;
use crate::cli::printing::written::{print_json, stdout};
use tactpad::lab::layout::size_drawing;
use tactpad::lab::layout::sizes::{Law, RecommendedPad, SizeStudy, SizedPad};
use tactpad::pad::device::Device;

/// Where the study goes besides the screen.
pub(super) struct SizesOptions<'a> {
    /// Folder of the figures.
    pub(super) figures: Option<&'a Folder>,
    /// Folder of the device files.
    pub(super) devices: Option<&'a Path>,
    /// Whether one JSON document is printed.
    pub(super) json: bool,
}

pub(super) fn run(device: &Device, noise_uv: f64, options: &SizesOptions<'_>) -> Result<(), Failure> {
    let devices = options.devices.map(Folder::of).transpose()?;
    let sizes = simulated(device, noise_uv)?;
    if let Some(folder) = options.figures {
        pictures::write(folder, "size-sensitivity", &size_drawing::sensitivity(&sizes))?;
        pictures::write(folder, "size-error", &size_drawing::error(&sizes))?;
        pictures::write(folder, "size-frequency", &size_drawing::frequency(&sizes))?;
    }
    if let Some(folder) = &devices {
        for pad in &sizes.pads {
            if let Some(sized) = pad.size.on(device) {
                folder.write(&pad.size.file_name(), sized.to_toml().as_bytes())?;
            }
        }
    }
    if options.json { print_json(&sizes) } else { Ok(write(&mut stdout(), &sizes, options.devices)?) }
}

fn simulated(device: &Device, noise_uv: f64) -> Result<SizeStudy, Failure> {
    let progress = Progress::begin("solving the modules");
    SizeStudy::of(device, noise_uv, |done, of, what| progress.part(done, of, what))
        .map_err(|error| Failure::Failed(format!("the simulator: {error}")))
}

fn write(out: &mut impl Write, sizes: &SizeStudy, devices: Option<&Path>) -> io::Result<()> {
    writeln!(
        out,
        "Pads by size: press of 1 N, noise {} µV, converter at {} Hz",
        sizes.noise_uv, sizes.converter_hz
    )?;
    writeln!(
        out,
        "{:>5} {:>5} {:>7} {:>7} {:>8} {:>8} {:>7} {:<7} {:>8} {:>8} {:>8} stiff",
        "Ø mm",
        "h mm",
        "µV/N",
        "per mm",
        "worst mm",
        "rms mm",
        "1st Hz",
        "",
        "±3dB Hz",
        "of conv",
        "ground N"
    )?;
    sizes.pads.iter().try_for_each(|pad| write_pad(out, pad))?;
    writeln!(out)?;
    sizes.laws.iter().try_for_each(|law| write_law(out, law))?;
    writeln!(out)?;
    sizes.answers.iter().try_for_each(|answer| write_answer(out, answer))?;
    match devices {
        Some(folder) => {
            writeln!(out, "\n{} device files are written to {}", sizes.pads.len(), folder.display())
        }
        None => Ok(()),
    }
}

fn write_pad(out: &mut impl Write, pad: &SizedPad) -> io::Result<()> {
    writeln!(
        out,
        "{:>5} {:>5} {:>7.0} {:>7.1} {:>8.4} {:>8.4} {:>7.0} {:<7} {:>8.0} {:>7.0}% {:>8.1} {}",
        pad.size.diameter_mm,
        pad.size.thickness_mm,
        pad.sensitivity_uv_per_n,
        pad.change_uv_per_n_mm,
        pad.precision.worst_mm,
        pad.precision.rms_mm,
        pad.first_hz,
        pad.first_kind,
        pad.bandwidth_hz,
        100.0 * pad.bandwidth_of_converters,
        pad.grounding_n,
        if pad.is_stiff() { "yes" } else { "no" }
    )
}

fn write_law(out: &mut impl Write, law: &Law) -> io::Result<()> {
    let by = |name: &str, power: f64| {
        if power.abs() < 0.005 { String::new() } else { format!(" · {name}^{power:.2}") }
    };
    let text = format!(
        "{} = {} {}{}{}; within {:.2} % on the {} pads with a stiff plate, up to {:.1} % off on the others",
        law.quantity,
        significant(law.factor),
        law.unit,
        by("(Ø/60 mm)", law.diameter_power),
        by("(h/1 mm)", law.thickness_power),
        // Nothing is within nothing.
        law.residual_percent.max(0.01),
        law.pads,
        law.outside_percent
    );
    writeln!(out, "{}", hanging("law: ", &text))
}

/// Four digits.
fn significant(value: f64) -> String {
    let decimals = (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0);
    format!("{value:.*}", decimals as usize)
}

fn write_answer(
    out: &mut impl Write,
    RecommendedPad { user, pad, stiff, bears }: &RecommendedPad,
) -> io::Result<()> {
    let text = format!(
        "{} mm wide, {} mm thick{}: located within {:.2} mm at 1 N, first rings at {:.0} Hz; a firm press of {} N {}",
        pad.size.diameter_mm,
        pad.size.thickness_mm,
        if *stiff { "" } else { ", and still not stiff" },
        pad.precision.worst_mm,
        pad.first_hz,
        user.press_n,
        if *bears {
            format!("grounds no module, as {:.0} N at the worst place would", pad.grounding_n)
        } else {
            format!(
                "is too much for these modules, which ground at {:.0} N at the worst place",
                pad.grounding_n
            )
        }
    );
    writeln!(out, "{}", hanging(&format!("{}: ", user.name), &text))
}
