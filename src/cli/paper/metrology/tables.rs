//! The verb's table for people.

use std::io::{self, Write};

use super::report::MetrologyReport;
use crate::cli::printing::wrapped::{hanging, lines};
use crate::cli::printing::written::stdout;
use tactpad::lab::metrology::dynamics::{InSeries, PadDynamics};
use tactpad::lab::metrology::report::{Conflict, ReportEntry, Status};

pub(super) fn print(report: &MetrologyReport) -> io::Result<()> {
    write(&mut stdout(), report)
}

/// Longer names go on in a line of their own.
const NAME_COLUMNS: usize = 35;

fn write(out: &mut impl Write, report: &MetrologyReport) -> io::Result<()> {
    writeln!(out, "{}", hanging("", &report.statement))?;
    if let [first, .., last] = report.seeds.as_slice() {
        writeln!(out, "Seeds {first} to {last}: mean and standard deviation.")?;
    }
    writeln!(out, "The difference from the paper, and the most that it may be, are in percent.\n")?;
    let found = if report.seeds.is_empty() { "found" } else { "twin" };
    let heads = ["unit", "paper", found, "±", "diff.", "max", "status"].map(str::to_owned);
    write_line(out, "figure", &heads)?;
    let needs = needs(&report.rows);
    report.rows.iter().try_for_each(|entry| write_entry(out, entry, &needs))?;
    if !needs.is_empty() {
        writeln!(out)?;
    }
    for (number, need) in (1..).zip(&needs) {
        writeln!(out, "{}", hanging(&format!("open {number:<2} "), need))?;
    }
    report.rows.iter().filter_map(|entry| entry.conflict.as_ref()).try_for_each(|conflict| {
        writeln!(out)?;
        write_conflict(out, conflict)
    })?;
    if let Some(dynamics) = &report.dynamics {
        writeln!(out)?;
        write_dynamics(out, dynamics)?;
    }
    report.plots.iter().try_for_each(|file| writeln!(out, "{file} is written, and the same as PNG"))
}

/// The pad's own dynamics, and what they change behind the filter.
fn write_dynamics(out: &mut impl Write, found: &PadDynamics) -> io::Result<()> {
    let [low, high] = found.damping_range;
    let text = format!(
        "The pad's own dynamics, which the rows above have not: the simulated plate first {} at {:.0} Hz; a press in the middle \
         rings with the motion at {:.0} Hz ({}), which is {:.1} % of the output. At a damping ratio of {} the plate itself \
         overshoots by {:.0} %, settles to 2 % in {:.0} ms and follows within ±3 dB up to {:.0} Hz.",
        found.motions.first().map_or("rings", |first| first.kind),
        found.motions.first().map_or(f64::NAN, |first| first.frequency_hz),
        found.dominating.frequency_hz,
        found.dominating.kind,
        100.0 * found.dominating.output_share,
        found.damping_ratio,
        100.0 * found.overshoot,
        found.settling_ms,
        found.plate_bandwidth_hz
    );
    writeln!(out, "{}", hanging("", &text))?;
    writeln!(
        out,
        "{:<28} {:>9} {:>6} {:>8} {:>6} {:>13}",
        "a step at any instant", "delay ms", "±", "rise ms", "±", "bandwidth Hz"
    )?;
    let [least, most] = found.with_pad_by_damping;
    write_in_series(out, "the filter alone", &found.filter_alone)?;
    write_in_series(out, &format!("with the pad, damping {}", found.damping_ratio), &found.with_pad)?;
    write_in_series(out, &format!("with the pad, damping {low}"), &least)?;
    write_in_series(out, &format!("with the pad, damping {high}"), &most)
}

fn write_in_series(out: &mut impl Write, name: &str, found: &InSeries) -> io::Result<()> {
    writeln!(
        out,
        "{name:<28} {:>9.2} {:>6.2} {:>8.2} {:>6.2} {:>13.5}",
        found.delay_ms, found.delay_deviation_ms, found.rise_ms, found.rise_deviation_ms, found.bandwidth_hz
    )
}

/// The needs of open figures, each once, in their order.
fn needs(rows: &[ReportEntry]) -> Vec<String> {
    let mut needs: Vec<String> = Vec::new();
    for need in rows.iter().filter_map(|entry| entry.needs).map(|needs| needs.to_string()) {
        if !needs.contains(&need) {
            needs.push(need);
        }
    }
    needs
}

fn write_entry(out: &mut impl Write, entry: &ReportEntry, needs: &[String]) -> io::Result<()> {
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), significant);
    let percent = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.0}"));
    let cells = [
        entry.unit.to_owned(),
        number(entry.paper),
        number(entry.mean),
        number(entry.spread),
        entry.difference_percent.map_or_else(String::new, difference),
        percent(entry.bound_percent),
        status(entry, needs),
    ];
    let mut lines = lines(entry.name, NAME_COLUMNS);
    let last = lines.pop().unwrap_or_default();
    lines.iter().try_for_each(|line| writeln!(out, "{line}"))?;
    let indent = if lines.is_empty() { "" } else { "  " };
    write_line(out, &format!("{indent}{last}"), &cells)
}

fn write_line(out: &mut impl Write, name: &str, cells: &[String; 7]) -> io::Result<()> {
    let [unit, paper, found, spread, difference, bound, status] = cells;
    let numbers = format!("{unit:>4} {paper:>5} {found:>6} {spread:>6} {difference:>6} {bound:>3}");
    writeln!(out, "{}", format!("{name:<NAME_COLUMNS$} {numbers} {status}").trim_end())
}

/// A tenth of a percent counts, unless it is far off.
fn difference(percent: f64) -> String {
    if percent.abs() < 1000.0 { format!("{percent:+.1}") } else { format!("{percent:+.0}") }
}

/// Three digits that count, or four decimals; three of them behind a minus.
fn significant(value: f64) -> String {
    let digits = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    let most = if value < 0.0 { 3.0 } else { 4.0 };
    let decimals = (2.0 - digits).clamp(0.0, most) as usize;
    format!("{value:.decimals$}")
}

fn status(entry: &ReportEntry, needs: &[String]) -> String {
    let needed = entry.needs.map(|needs| needs.to_string());
    let number = needs.iter().position(|need| Some(need) == needed.as_ref());
    match entry.status {
        Status::Inside => "inside".into(),
        Status::Outside => "OUTSIDE".into(),
        Status::Conflict => "conflict".into(),
        Status::Open => number.map_or_else(|| "open".into(), |number| format!("open {}", number + 1)),
        Status::Unpublished => String::new(),
    }
}

fn write_conflict(out: &mut impl Write, conflict: &Conflict) -> io::Result<()> {
    writeln!(out, "{}", hanging("", &format!("{} is in conflict: {}", conflict.row, conflict.reason)))?;
    writeln!(out, "  fitted alone it reaches {}", significant(conflict.alone))?;
    conflict
        .leaving
        .iter()
        .try_for_each(|leaving| writeln!(out, "  then {} reads {}", leaving.row, significant(leaving.value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::printing::wrapped::COLUMNS;
    use tactpad::lab::metrology::Needs;
    use tactpad::lab::metrology::report::Leaving;

    fn entry(status: Status, mean: Option<f64>) -> ReportEntry {
        ReportEntry {
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

    fn text(rows: Vec<ReportEntry>) -> String {
        let statement = "A numerical twin of the pad; no hardware was measured.".to_owned();
        let report = MetrologyReport {
            statement,
            seeds: vec![1, 2, 3],
            rows,
            figures: vec![],
            dynamics: None,
            plots: vec![],
        };
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
            text.lines().skip(5).map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(words[0][4..], ["%", "3.10", "3.20", "0.123", "+3.2", "15", "inside"]);
        assert_eq!(words[1][4..], ["%", "3.10", "–", "–", "15", "open", "1"]);
        assert!(text.contains("\nopen 1  needs a decoder\n"), "{text}");
    }

    #[test]
    fn no_line_is_too_long() {
        let far = |status, name| ReportEntry {
            name,
            unit: "µV/N",
            paper: Some(0.820),
            mean: Some(-0.0006),
            spread: Some(12_345.0),
            difference_percent: Some(-12_345.6),
            needs: Some(Needs::Rows(
                "presses of many kinds, at many places, in many sessions, each of them measured twice",
            )),
            ..entry(status, None)
        };
        let name = "sensitivity, x, y channels, mean of all places";
        let text =
            text(vec![far(Status::Open, name), far(Status::Conflict, name), far(Status::Outside, "short")]);
        assert!(text.lines().all(|line| line.chars().count() <= COLUMNS), "{text}");
        assert!(text.contains("sensitivity, x, y channels, mean of\n  all places "), "{text}");
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
        let text = text(vec![ReportEntry { conflict: Some(conflict), ..entry(Status::Conflict, Some(0.5)) }]);
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
