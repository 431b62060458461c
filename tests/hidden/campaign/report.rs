//! The campaign's table and figure.

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;
use tactpad::plot::svg;

use super::drawing;
use super::gates::Gate;
use crate::limits::Share;
use crate::program::folder;
use crate::sizes::CAUSES;

/// Writes table and figure, and gives the table.
pub(super) fn written(lines: &[Value], gates: &[Gate]) -> String {
    let mut text = String::from("| what must hold | found | |\n|---|---|---|\n");
    for Gate { what, found, held } in gates {
        writeln!(text, "| {what} | {found} | {} |", if *held { "yes" } else { "**no**" }).unwrap();
    }
    text += "\n| cause | 1×: found | named | 3×: found | named | wrong | no size |\n|---|---|---|---|---|---|---|\n";
    for effect in CAUSES {
        writeln!(text, "{}", row(lines, effect)).unwrap();
    }
    let seconds: Vec<f64> = lines.iter().filter_map(|line| line["seconds"].as_f64()).collect();
    let slowest = seconds.iter().copied().fold(0.0, f64::max);
    writeln!(text, "\n{} runs, the slowest {slowest:.1} s.", lines.len()).unwrap();
    fs::write(folder("").join("campaign.md"), &text).unwrap();
    fs::write(folder("").join("campaign.svg"), svg::text(&drawing::figure(lines))).unwrap();
    text
}

fn row(lines: &[Value], effect: &str) -> String {
    let own: Vec<&Value> =
        lines.iter().filter(|line| line["part"] == "sizes" && line["effect"] == effect).collect();
    let scored = |times: f64| {
        own.iter().filter(move |line| line["times"].as_f64() == Some(times) && line["score"].is_object())
    };
    let size = |line: &Value| line["score"]["set_sizes"][0].as_u64().unwrap_or_default();
    let share = |times: f64, hit: &dyn Fn(u64) -> bool| {
        let Share { hits, all } = Share::of(scored(times).map(|line| hit(size(line))));
        format!("{hits} of {all}")
    };
    let wrong =
        own.iter().filter(|line| line["score"]["wrong"].as_array().is_some_and(|wrong| !wrong.is_empty()));
    let without = own.iter().filter(|line| !line["score"].is_object()).count();
    format!(
        "| `{effect}` | {} | {} | {} | {} | {} | {without} |",
        share(1.0, &|size| size > 0),
        share(1.0, &|size| size == 1),
        share(3.0, &|size| size > 0),
        share(3.0, &|size| size == 1),
        wrong.count(),
    )
}
