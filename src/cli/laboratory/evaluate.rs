//! `tactpad evaluate`: a decoder's errors on a measured file.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::files::device::PadOptions;
use crate::cli::files::field::field_of;
use crate::cli::files::labels::LabelOptions;
use crate::cli::files::tables;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{print_json, stdout};
use tactpad::counted::counted;
use tactpad::lab::evaluation::{Errors, Evaluation, EvaluationError};
use tactpad::lab::tangent::SimulatedPad;
use tactpad::pipeline::shipped;
use tactpad::tables::measured::Label;
use tactpad::tables::measured::columns::TableKind;

/// Arguments of `tactpad evaluate`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad evaluate --decoder pad.decoder --measured unseen.csv --truth truth.csv"
)]
pub(crate) struct Arguments {
    /// A decoder that `adapt` or `train` wrote; without it the one inside the program.
    #[arg(long, value_name = "FILE")]
    decoder: Option<PathBuf>,
    /// The measured file.
    #[arg(long, value_name = "M.csv")]
    measured: PathBuf,
    /// The true contacts of its rows, as `twin --truth` writes them.
    #[arg(long, value_name = "T.csv")]
    truth: Option<PathBuf>,
    #[command(flatten)]
    pad: PadOptions,
    #[command(flatten)]
    meant: LabelOptions,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { decoder, measured, truth, pad, meant, json } = arguments;
    let device = pad.read()?;
    let decoder = decoder.as_deref().map_or_else(|| Ok(shipped::decoder()), decoder_file::read)?;
    let rim_mm = device.plate.radius_mm();
    // One table at a time: of the truth the labels are enough.
    let truth = truth.as_ref().map(|path| tables::read(path, TableKind::Plan, rim_mm)).transpose()?;
    let truth: Option<Vec<Label>> = truth.map(|truth| truth.rows.iter().map(|row| row.label).collect());
    let table = meant.read(measured, &device)?;
    let field = field_of(&device)?;
    meant.ask(&measured.display().to_string(), &table, &SimulatedPad::known(&device, &field))?;
    let progress = Progress::begin("decoding the contacts");
    let evaluation = Evaluation::of(&decoder, table, truth.as_deref(), device.contact.full_scale_n)
        .map_err(|error| unusable(measured, &error))?;
    drop(progress);
    if *json { print_json(&evaluation) } else { print(&evaluation) }
}

/// Why the measured file cannot be judged by; it is the sentence's subject, or its place.
fn unusable(measured: &Path, error: &EvaluationError) -> Failure {
    let measured = measured.display();
    Failure::Unusable(match error {
        EvaluationError::OtherRows { .. } => format!("{measured} {error}"),
        _ => format!("{measured}: {error}"),
    })
}

fn print(report: &Evaluation) -> Result<(), Failure> {
    let mut to = stdout();
    writeln!(to, "{}", counted(report.by_labels.rows, "contact"))?;
    writeln!(to, "                 MAE mm  distance mm   RMSE mm   MAE N")?;
    let mut line = |name: &str, errors: &Errors| {
        let Errors { position_mae_mm, position_mean_euclid_mm, position_rmse_mm, force_mae_n, .. } = errors;
        writeln!(
            to,
            "{name:<14} {position_mae_mm:>8.3} {position_mean_euclid_mm:>12.3} {position_rmse_mm:>9.3} {force_mae_n:>7.4}"
        )
    };
    line("by its labels", &report.by_labels)?;
    if let Some(truth) = &report.truth {
        line("by the truth", &truth.errors)?;
        if let Some(coverage95) = truth.coverage95 {
            writeln!(to, "{:.1} % of the truths lie in the decoder's 95 % regions", 100.0 * coverage95)?;
        }
    }
    if let Some(warned) = report.warned {
        writeln!(to, "{:.1} % of the contacts are not one finger on the decoder's pad", 100.0 * warned)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Verb {
        #[command(flatten)]
        arguments: Arguments,
    }

    /// Evaluates a measured row and its true contact at these x, in millimetres.
    fn evaluated(measured_mm: f64, true_mm: f64) -> Result<(), Failure> {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        let channels: String = tactpad::quantity::CHANNEL_NAMES.map(|name| format!(",{name}_uv")).concat();
        let zeros = ",0".repeat(tactpad::quantity::CHANNELS);
        let label = |x_mm: f64| format!("{x_mm},0,0,0,1");
        let head = "x_mm,y_mm,fx_n,fy_n,fz_n";
        fs::write(
            path("m.csv"),
            format!("{head}{channels}\n0,0,0,0,0{zeros}\n{}{zeros}\n", label(measured_mm)),
        )
        .unwrap();
        fs::write(path("t.csv"), format!("{head}\n0,0,0,0,0\n{}\n", label(true_mm))).unwrap();
        let line = ["evaluate", "--measured", &path("m.csv"), "--truth", &path("t.csv"), "--json"];
        run(&Verb::parse_from(line).arguments)
    }

    #[test]
    fn places_end_at_the_plates_rim() {
        assert!(evaluated(29.9, -29.9).is_ok());
        for (measured_mm, true_mm, file) in
            [(30.1, 0.0, "m.csv:3"), (-59.0, 0.0, "m.csv:3"), (0.0, 30.1, "t.csv:3")]
        {
            let Err(Failure::Unusable(why)) = evaluated(measured_mm, true_mm) else {
                panic!("{measured_mm} and {true_mm} mm pass")
            };
            assert!(why.contains(file) && why.contains("-30 to 30 mm"), "{why}");
        }
    }
}
