//! The verb's table: for people, and as CSV.

use std::io::{self, Write};

use super::report::{AblationReport, DecoderErrors, DecoderRow};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Folder;
use crate::cli::printing::written::stdout;
use tactpad::lab::evaluation::{Errors, PerAxis};
use tactpad::lab::metrology::table3::PublishedErrors;

pub(super) fn print(report: &AblationReport) -> io::Result<()> {
    write(&mut stdout(), report)
}

fn write(out: &mut impl Write, report: &AblationReport) -> io::Result<()> {
    writeln!(out, "{}", report.statement)?;
    writeln!(
        out,
        "Decoders learn from twin --plan paper --seed {} --state pad.state, and the pad goes on from there;\n\
         errors are means over each axis.",
        report.seed
    )?;
    let tables = report.rows.first().map_or(0, |row| row.unseen.len());
    for table in 0..tables {
        write_table(out, &report.rows, table)?;
    }
    write_conflicts(out, &report.rows)?;
    report.files.iter().try_for_each(|file| writeln!(out, "{file} is written"))
}

fn write_table(out: &mut impl Write, rows: &[DecoderRow], table: usize) -> io::Result<()> {
    let tried: Vec<(&DecoderRow, &DecoderErrors)> =
        rows.iter().filter_map(|row| Some((row, row.unseen.get(table)?))).collect();
    let Some((_, DecoderErrors { plan, seed, contacts, bound, .. })) = tried.first() else { return Ok(()) };
    writeln!(out, "\n{contacts} unseen contacts: twin --plan {plan} --seed {seed} --state pad.state")?;
    let (mm, n) = (bound.position_mae_mm, bound.force_mae_n);
    writeln!(out, "The noise allows no less than {mm:.3} mm and {n:.4} N.\n")?;
    writeln!(
        out,
        "{:<22} {:>10} {:>17} {:>18} {:>4}",
        "", "the paper", "against the truth", "against the labels", "in"
    )?;
    writeln!(
        out,
        "{:<22} {:>5} {:>4} {:>5} {:>5} {:>5} {:>5} {:>5} {:>5} {:>5} {:>4}",
        "decoder", "mm", "N", "mm", "dist.", "N", "mm", "dist.", "N", "95 %", "µs"
    )?;
    tried.into_iter().try_for_each(|(row, tried)| write_row(out, row, tried))
}

/// Writes the published figures that no pad reaches.
fn write_conflicts(out: &mut impl Write, rows: &[DecoderRow]) -> io::Result<()> {
    let conflict = |row: &DecoderRow| Some((row.entry.to_string(), row.entry.paper?, row.entry.conflict?));
    let conflicts: Vec<_> = rows.iter().filter_map(conflict).collect();
    if conflicts.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n* Conflicts with the paper's other figures. As far off as a pad may be, it comes to")?;
    for (name, paper, reached) in conflicts {
        let PublishedErrors { position_mae_mm, force_mae_n } = reached;
        writeln!(
            out,
            "  {name:<23} {position_mae_mm:.2} mm {force_mae_n:.3} N in place of {:.2} mm {:.2} N",
            paper.position_mae_mm, paper.force_mae_n
        )?;
    }
    writeln!(out, "  and then it is off in other figures: docs/network.md. These mm are the distance.")
}

fn write_row(out: &mut impl Write, row: &DecoderRow, tried: &DecoderErrors) -> io::Result<()> {
    let optional = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "–".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let paper = row.entry.paper;
    let mark = if row.entry.conflict.is_some() { "*" } else { "" };
    write!(
        out,
        "{:<22} {:>5} {:>4}",
        format!("{}{mark}", row.entry),
        optional(paper.map(|paper| paper.position_mae_mm), 2),
        optional(paper.map(|paper| paper.force_mae_n), 2)
    )?;
    for Errors { position_mae_mm, position_mean_euclid_mm, force_mae_n, .. } in [&tried.truth, &tried.labels]
    {
        let [place, distance] = [position_mae_mm, position_mean_euclid_mm].map(|mm| fitting(*mm, 2, 5));
        write!(out, " {place:>5} {distance:>5} {:>5}", fitting(*force_mae_n, 3, 5))?;
    }
    let coverage = optional(tried.coverage95.map(|share| 100.0 * share), 1);
    let decode = row.decode_us.map_or_else(|| "–".to_owned(), |us| fitting(us, 1, 4));
    writeln!(out, " {coverage:>5} {decode:>4}")
}

/// The number with so many decimals, or fewer where `width` characters have no room for them.
fn fitting(value: f64, decimals: usize, width: usize) -> String {
    let text = format!("{value:.decimals$}");
    let missing = text.len().saturating_sub(width);
    // The point goes with the last of its decimals.
    if missing == 0 { text } else { format!("{value:.*}", decimals.saturating_sub(missing)) }
}

/// A row for each decoder and each table of unseen contacts. Gives the file's name.
pub(super) fn write_csv(folder: &Folder, rows: &[DecoderRow]) -> Result<String, Failure> {
    let tried = rows.iter().flat_map(|row| row.unseen.iter().map(move |tried| (row, tried)));
    let lines = std::iter::once(columns()).chain(tried.map(|(row, tried)| cells(row, tried)));
    let text: String = lines.map(|cells| cells.join(",") + "\n").collect();
    folder.write("ablation.csv", text.as_bytes())
}

fn columns() -> Vec<String> {
    let errors = |of: &str| {
        ["position_mae_mm", "distance_mean_mm", "force_mae_n", "x_mm", "y_mm", "fx_n", "fy_n", "fz_n"]
            .map(|name| format!("{of}_{name}"))
    };
    let first =
        ["decoder", "samples", "plan", "seed", "contacts", "paper_position_mae_mm", "paper_force_mae_n"];
    let last = ["bound_position_mae_mm", "bound_force_mae_n", "coverage95", "decode_us"];
    let names = first.iter().map(ToString::to_string).chain(errors("truth")).chain(errors("labels"));
    names.chain(last.iter().map(ToString::to_string)).collect()
}

fn cells(row: &DecoderRow, tried: &DecoderErrors) -> Vec<String> {
    let optional = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let paper = row.entry.paper;
    let mut cells = vec![
        row.entry.method.name().to_owned(),
        row.entry.samples.to_string(),
        tried.plan.to_owned(),
        tried.seed.to_string(),
        tried.contacts.to_string(),
        optional(paper.map(|paper| paper.position_mae_mm)),
        optional(paper.map(|paper| paper.force_mae_n)),
    ];
    for Errors { position_mae_mm, position_mean_euclid_mm, force_mae_n, per_axis, .. } in
        [tried.truth, tried.labels]
    {
        let PerAxis { x_mm, y_mm, fx_n, fy_n, fz_n } = per_axis;
        let numbers = [position_mae_mm, position_mean_euclid_mm, force_mae_n, x_mm, y_mm, fx_n, fy_n, fz_n];
        cells.extend(numbers.map(|number| number.to_string()));
    }
    cells.extend([tried.bound.position_mae_mm, tried.bound.force_mae_n].map(|number| number.to_string()));
    cells.extend([tried.coverage95, row.decode_us].map(optional));
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_numbers_give_up_decimals() {
        let texts = [(9.876, 2), (15.29, 2), (123.456, 2), (1234.5, 2), (0.516, 3), (12.3456, 3)];
        let texts = texts.map(|(value, decimals)| fitting(value, decimals, 5));
        assert_eq!(texts, ["9.88", "15.29", "123.5", "1234", "0.516", "12.35"]);
    }
}
