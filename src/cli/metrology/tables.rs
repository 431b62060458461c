//! The verb's table for people.

use std::io::{self, Write};

use super::report::MetrologyReport;
use crate::cli::written::stdout;
use tactpad::lab::metrology::report::{Conflict, Entry, Status};

pub(super) fn print(report: &MetrologyReport) -> io::Result<()> {
    write(&mut stdout(), report)
}

fn write(out: &mut impl Write, report: &MetrologyReport) -> io::Result<()> {
    writeln!(out, "{}", report.statement)?;
    if let [first, .., last] = report.seeds.as_slice() {
        writeln!(out, "Seeds {first} to {last}: mean and standard deviation.")?;
    }
    let found = if report.seeds.is_empty() { "found" } else { "twin" };
    writeln!(
        out,
        "\n{:<46} {:>5} {:>8} {found:>9} {:>8} {:>8} {:>7}  status",
        "figure", "unit", "paper", "±", "diff. %", "bound %"
    )?;
    report.rows.iter().try_for_each(|entry| write_entry(out, entry))?;
    report.rows.iter().filter_map(|entry| entry.conflict.as_ref()).try_for_each(|conflict| {
        writeln!(out)?;
        write_conflict(out, conflict)
    })?;
    report.plots.iter().try_for_each(|file| writeln!(out, "{file} is written, and the same as PNG"))
}

fn write_entry(out: &mut impl Write, entry: &Entry) -> io::Result<()> {
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), significant);
    let percent = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.0}"));
    let difference =
        entry.difference_percent.map_or_else(String::new, |difference| format!("{difference:+.1}"));
    writeln!(
        out,
        "{:<46} {:>5} {:>8} {:>9} {:>8} {difference:>8} {:>7}  {}",
        entry.name,
        entry.unit,
        number(entry.paper),
        number(entry.mean),
        number(entry.spread),
        percent(entry.bound_percent),
        status(entry)
    )
}

/// Three digits that count, or four decimals.
fn significant(value: f64) -> String {
    let digits = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    let decimals = (2.0 - digits).clamp(0.0, 4.0) as usize;
    format!("{value:.decimals$}")
}

fn status(entry: &Entry) -> String {
    let needs = entry.needs.map_or_else(String::new, |needs| needs.to_string());
    match entry.status {
        Status::Inside => "inside".into(),
        Status::Outside => "OUTSIDE".into(),
        Status::Conflict => "conflict: see below".into(),
        Status::Open => format!("open: {needs}"),
        Status::Unpublished => String::new(),
    }
}

fn write_conflict(out: &mut impl Write, conflict: &Conflict) -> io::Result<()> {
    writeln!(out, "{} is in conflict: {}", conflict.row, conflict.reason)?;
    writeln!(out, "  fitted alone it reaches {}", significant(conflict.alone))?;
    conflict
        .leaving
        .iter()
        .try_for_each(|leaving| writeln!(out, "  then {} reads {}", leaving.row, significant(leaving.value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad::lab::metrology::Needs;
    use tactpad::lab::metrology::report::Leaving;

    fn entry(status: Status, mean: Option<f64>) -> Entry {
        Entry {
            key: "hysteresis",
            name: "hysteresis, of 5 N",
            unit: "%",
            paper: Some(3.1),
            mean,
            spread: mean.map(|_| 0.123_456),
            difference_percent: mean.map(|mean| 100.0 * (mean / 3.1 - 1.0)),
            bound_percent: Some(15.0),
            status,
            needs: (status == Status::Open).then_some(Needs::Decoder),
            conflict: None,
        }
    }

    fn text(rows: Vec<Entry>) -> String {
        let statement = "A numerical twin of the pad; no hardware was measured.".to_owned();
        let report =
            MetrologyReport { statement, seeds: vec![1, 2, 3], rows, figures: vec![], plots: vec![] };
        let mut bytes = Vec::new();
        write(&mut bytes, &report).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn the_first_line_says_what_was_measured() {
        let text = text(vec![]);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].contains("no hardware was measured"), "{text}");
        assert!(lines[1].contains("Seeds 1 to 3"), "{text}");
    }

    #[test]
    fn each_line_has_its_numbers_and_its_status() {
        let text = text(vec![entry(Status::Inside, Some(3.2)), entry(Status::Open, None)]);
        let words: Vec<Vec<&str>> =
            text.lines().skip(4).map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(words[0][4..], ["%", "3.10", "3.20", "0.123", "+3.2", "15", "inside"]);
        assert_eq!(words[1][4..], ["%", "3.10", "–", "–", "15", "open:", "needs", "a", "decoder"]);
    }

    #[test]
    fn a_conflict_is_shown() {
        let leaving = vec![Leaving { row: "spread_3".into(), value: 1.5 }];
        let conflict = Conflict {
            row: "spread_5".into(),
            alone: 0.87,
            leaving,
            reason: "noise falls with the load".into(),
        };
        let text = text(vec![Entry { conflict: Some(conflict), ..entry(Status::Conflict, Some(0.5)) }]);
        assert!(text.contains("spread_5 is in conflict: noise falls with the load"), "{text}");
        assert!(
            text.contains("fitted alone it reaches 0.870") && text.contains("spread_3 reads 1.50"),
            "{text}"
        );
    }

    #[test]
    fn three_digits_count() {
        let texts = [0.0, 0.117, -19.04, 300.4, 1234.0, 0.001_23].map(significant);
        assert_eq!(texts, ["0.00", "0.117", "-19.0", "300", "1234", "0.0012"]);
    }
}
