//! Each cause: what it is, how large, how sure.

use super::super::numbers::{carried, parts, rounded, with_unit};
use super::drawing::{Drawing, escaped};
use super::subject::Subject;
use super::words::{capital, cause, chance, none, sentence};
use tactpad::lab::diagnosis::report::{Estimate, Finding};

/// Size of the bars, in pixels.
const BAR: [f64; 2] = [200.0, 18.0];

/// The section.
pub(super) fn section(subject: &Subject<'_>) -> String {
    let findings = &subject.diagnosis.findings;
    if findings.is_empty() {
        return "<section id=\"causes\"><h2>Causes</h2><p>No cause of the catalogue was found.</p></section>"
            .to_owned();
    }
    let cards: String = findings.iter().map(|finding| card(subject, finding)).collect();
    format!(
        "<section id=\"causes\"><h2>Causes</h2>{}<ol class=\"causes\">{cards}</ol></section>",
        unnamed(subject)
    )
}

/// The part of the residuals that no cause explains.
fn unnamed(subject: &Subject<'_>) -> String {
    let share = subject.diagnosis.unnamed_share;
    if share > 0.0 {
        format!(
            "<p>{:.0} % of the residual above the noise has no cause in the catalogue.</p>",
            100.0 * share
        )
    } else {
        String::new()
    }
}

fn card(subject: &Subject<'_>, finding: &Finding) -> String {
    let channels = &subject.diagnosis.channels;
    let status = if finding.confounded_with.is_empty() {
        "<span class=\"status named\">named</span> no other cause of the catalogue explains it"
    } else {
        "<span class=\"status confounded\">confounded</span> other causes explain it as well: see below"
    };
    let place = escaped(&finding.target.name(channels));
    let rows: String = finding.parameters.iter().map(number).collect();
    let table = if rows.is_empty() { String::new() } else { table(&rows) };
    format!(
        "<li class=\"cause\"><h3>{}</h3><p>{status} <code>{} {place}</code></p>{table}{}</li>",
        escaped(&capital(&sentence(finding, channels))),
        escaped(finding.effect.name()),
        evidence(subject, finding)
    )
}

fn table(rows: &str) -> String {
    format!(
        "<table><thead><tr><td></td><th scope=\"col\" class=\"number\">value</th><th scope=\"col\" \
         class=\"number\">95 % interval</th><th scope=\"col\" class=\"wide\">from none</th></tr></thead><tbody>{rows}</tbody></table>"
    )
}

/// A number with its interval, as text and as a picture.
fn number(estimate: &Estimate) -> String {
    let Estimate { name, value, interval95 } = estimate;
    let (what, unit) = parts(name);
    let digits = carried(*value, *interval95);
    let [value_text, low, high] = [*value, interval95[0], interval95[1]].map(|it| rounded(it, digits));
    let what = if what.is_empty() { "size".to_owned() } else { what };
    let value_text = with_unit(&value_text, unit);
    format!(
        "<tr><th scope=\"row\">{}</th><td class=\"number\">{value_text}</td><td class=\"number\">{low} to {high}</td>\
         <td class=\"wide\">{}</td></tr>",
        escaped(&what),
        interval(estimate, &format!("{what} {value_text}, {low} to {high}"))
    )
}

/// A bar over the interval, a dot at the value, a line where there is no effect.
fn interval(estimate: &Estimate, title: &str) -> String {
    let Estimate { name, value, interval95: [low, high] } = *estimate;
    let none = none(name);
    let ends = [low, high, value].into_iter().chain(none);
    let (left, right) =
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(left, right), it| (left.min(it), right.max(it)));
    let [width, height] = BAR;
    let mut drawing = Drawing::new("interval", [0.0, 0.0, width, height], title);
    let x = |at: f64| 8.0 + (at - left) / (right - left) * (width - 16.0);
    let middle = 0.5 * height;
    drawing.line("rule", [0.0, middle], [width, middle]);
    if let Some(none) = none {
        drawing.line("none", [x(none), 1.0], [x(none), height - 1.0]);
    }
    drawing.line("range", [x(low), middle], [x(high), middle]);
    drawing.circle("value", [x(value), middle], 4.0);
    drawing.html()
}

/// The evidence for a finding.
fn evidence(subject: &Subject<'_>, finding: &Finding) -> String {
    let without = subject.diagnosis.gain.as_ref().and_then(|gain| {
        gain.per_cause.iter().find(|it| it.effect == finding.effect && it.target == finding.target)
    });
    let without = without.map_or_else(String::new, |it| {
        let percent = 100.0 * it.rmse_ratio;
        format!(
            "<div><dt>Error left without it</dt><dd>{}{percent:.0} %</dd></div>",
            bar(it.rmse_ratio, &format!("{percent:.0} % of the error"))
        )
    });
    format!(
        "<dl class=\"evidence\"><div><dt>By chance</dt><dd>{}</dd></div><div><dt>Share of the residual</dt>\
         <dd>{}{}</dd></div>{without}</dl>",
        chance(finding.p_value),
        bar(finding.share, &format!("{} of the residual", percent(finding.share))),
        percent(finding.share)
    )
}

/// A share in words.
fn percent(share: f64) -> String {
    match 100.0 * share {
        it if it.is_nan() => "unknown".to_owned(),
        it if it < 1.0 => "less than 1 %".to_owned(),
        it => format!("{it:.0} %"),
    }
}

/// A share as a bar.
pub(super) fn bar(share: f64, title: &str) -> String {
    let mut drawing = Drawing::new("bar", [0.0, 0.0, 100.0, 10.0], title);
    drawing.rectangle("whole", [0.0, 0.0], [100.0, 10.0]);
    drawing.rectangle("part", [0.0, 0.0], [100.0 * share.clamp(0.0, 1.0), 10.0]);
    drawing.html()
}

/// The causes that could not be told apart, and the next measurement.
pub(super) fn confounded(subject: &Subject<'_>) -> String {
    let sets = subject.diagnosis.findings.iter().filter(|it| !it.confounded_with.is_empty());
    let sets: String = sets.map(|finding| set(finding, &subject.diagnosis.channels)).collect();
    let body = match sets.as_str() {
        "" if subject.diagnosis.findings.is_empty() => {
            "<p>Nothing was found that could be mistaken for something else.</p>"
        }
        "" => "<p>Nothing: no other cause of the catalogue explains what was found.</p>",
        sets => sets,
    };
    format!("<section id=\"confounded\"><h2>What could not be told apart</h2>{body}</section>")
}

/// So many rivals are told at once.
const RIVALS_MAX: usize = 8;

fn set(finding: &Finding, channels: &[String]) -> String {
    let rivals: Vec<String> = finding
        .confounded_with
        .iter()
        .map(|(effect, target)| format!("<li>{}</li>", escaped(&cause(*effect, target, channels))))
        .collect();
    let (first, more) = rivals.split_at(rivals.len().min(RIVALS_MAX));
    let more = match more.len() {
        0 => String::new(),
        count => format!("<details><summary>{count} more</summary><ul>{}</ul></details>", more.concat()),
    };
    let next = finding.separate_by.as_ref().map_or_else(
        || "<p>No measurement that would tell them apart is known to this program.</p>".to_owned(),
        |how| {
            format!(
                "<p class=\"next\"><strong>Measure next:</strong> {}.</p>",
                escaped(how.trim_end_matches('.'))
            )
        },
    );
    format!(
        "<div class=\"set\"><h3>{}</h3><p>These rows would look the same with</p><ul>{}</ul>{more}{next}</div>",
        escaped(&capital(&sentence(finding, channels))),
        first.concat()
    )
}
