//! The verb's table: for people, and as CSV.

use std::io::{self, Write};

use super::report::{AblationReport, Row, Tried};
use crate::cli::destination::Folder;
use crate::cli::failure::Failure;
use crate::cli::written::stdout;
use tactpad::lab::evaluation::{Errors, PerAxis};
use tactpad::lab::metrology::table3::PublishedErrors;

pub(super) fn print(report: &AblationReport) -> io::Result<()> {
    write(&mut stdout(), report)
}

fn write(out: &mut impl Write, report: &AblationReport) -> io::Result<()> {
    writeln!(out, "{}", report.statement)?;
    writeln!(
        out,
        "Decoders learn from twin --plan paper --seed {}; errors are means over each axis.",
        report.seed
    )?;
    let tables = report.rows.first().map_or(0, |row| row.unseen.len());
    for table in 0..tables {
        write_table(out, &report.rows, table)?;
    }
    write_conflicts(out, &report.rows)?;
    report.files.iter().try_for_each(|file| writeln!(out, "{file} is written"))
}

fn write_table(out: &mut impl Write, rows: &[Row], table: usize) -> io::Result<()> {
    let tried: Vec<(&Row, &Tried)> =
        rows.iter().filter_map(|row| Some((row, row.unseen.get(table)?))).collect();
    let Some((_, Tried { plan, seed, contacts, .. })) = tried.first() else { return Ok(()) };
    writeln!(out, "\n{contacts} unseen contacts: twin --plan {plan} --seed {seed}")?;
    writeln!(
        out,
        "{:<23} {:>13} {:>20} {:>20} {:>14} {:>6} {:>6}",
        "", "the paper", "against the truth", "against the labels", "bound", "in", ""
    )?;
    writeln!(
        out,
        "{:<23} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6} {:>6} {:>6}",
        "decoder", "mm", "N", "mm", "dist.", "N", "mm", "dist.", "N", "mm", "N", "95 %", "µs"
    )?;
    tried.into_iter().try_for_each(|(row, tried)| write_row(out, row, tried))
}

/// What is published and no pad reaches.
fn write_conflicts(out: &mut impl Write, rows: &[Row]) -> io::Result<()> {
    let conflict = |row: &Row| Some((row.entry.to_string(), row.entry.paper?, row.entry.conflict?));
    let conflicts: Vec<_> = rows.iter().filter_map(conflict).collect();
    if conflicts.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "\n* Conflicts with the paper's other figures. As far off as a pad may be, the network comes to"
    )?;
    for (name, paper, reached) in conflicts {
        let PublishedErrors { position_mae_mm, force_mae_n } = reached;
        writeln!(
            out,
            "  {name:<23} {position_mae_mm:.2} mm {force_mae_n:.3} N in place of {:.2} mm {:.2} N",
            paper.position_mae_mm, paper.force_mae_n
        )?;
    }
    writeln!(out, "  and then it is off in other figures: docs/network.md. Its mm are the distance.")
}

fn write_row(out: &mut impl Write, row: &Row, tried: &Tried) -> io::Result<()> {
    let optional = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "–".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let paper = row.entry.paper;
    let mark = if row.entry.conflict.is_some() { "*" } else { "" };
    write!(
        out,
        "{:<23} {:>6} {:>6}",
        format!("{}{mark}", row.entry),
        optional(paper.map(|paper| paper.position_mae_mm), 2),
        optional(paper.map(|paper| paper.force_mae_n), 2)
    )?;
    for Errors { position_mae_mm, position_mean_euclid_mm, force_mae_n, .. } in [&tried.truth, &tried.labels]
    {
        write!(out, " {position_mae_mm:>6.2} {position_mean_euclid_mm:>6.2} {force_mae_n:>6.3}")?;
    }
    writeln!(
        out,
        " {:>7.3} {:>6.4} {:>6} {:>6}",
        tried.bound.position_mae_mm,
        tried.bound.force_mae_n,
        optional(tried.coverage95.map(|share| 100.0 * share), 1),
        optional(row.decode_us, 1)
    )
}

/// A row for each decoder and each table of unseen contacts. Gives the file's name.
pub(super) fn write_csv(folder: &Folder, rows: &[Row]) -> Result<String, Failure> {
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

fn cells(row: &Row, tried: &Tried) -> Vec<String> {
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
