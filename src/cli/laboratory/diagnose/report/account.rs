//! The gain of the causes on locked rows, notices from before the diagnosis, and how all of it was computed.

use super::super::numbers::{Decoded, carried, decoded, rounded};
use super::causes::bar;
use super::drawing::escaped;
use super::subject::Subject;
use super::words::{capital, cause};
use tactpad::lab::diagnosis::report::{Gain, Notice};

/// The section of the gain.
pub(super) fn gain(subject: &Subject<'_>) -> String {
    let head = "<section id=\"gain\"><h2>What it is worth</h2>";
    let Some(gain) = &subject.diagnosis.gain else {
        return format!("{head}<p>Nothing was found that would change the model.</p></section>");
    };
    let [ratio, low, high] = percent_left(gain);
    format!(
        "{head}<p>On {} rows that had no part in finding them, the causes bring the model’s error down to <strong>{ratio} %</strong> of \
         what it was ({low} to {high} %).</p>{}{}</section>",
        gain.rows_locked,
        table(subject, gain),
        contacts(gain)
    )
}

/// How far decoded contacts are off; empty where the model knows no contacts.
fn contacts(gain: &Gain) -> String {
    let row = |(of, it): (&str, Decoded)| {
        let [low, high] = &it.change;
        let cells = [&it.nominal, &it.extended, &format!("{low} to {high}")];
        let cells = cells.map(|cell| format!("<td class=\"number\">{}</td>", escaped(cell))).concat();
        format!("<tr><th scope=\"row\">{of}</th>{cells}</tr>")
    };
    let rows: String = decoded(gain).map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    format!(
        "<p>Contacts that the model decodes from the channels of these rows are off by so much: the mean of the magnitudes along each \
         axis, against what was written.</p><table><thead><tr><th scope=\"col\">decoded</th><th scope=\"col\" class=\"number\">by the \
         model as it is</th><th scope=\"col\" class=\"number\">with all causes</th><th scope=\"col\" class=\"number\">change, 95 % \
         interval</th></tr></thead><tbody>{rows}</tbody></table>"
    )
}

/// The part of the error that is left, and the ends of its interval, in per cent with as many digits as that carries.
pub(super) fn percent_left(gain: &Gain) -> [String; 3] {
    let [low, high] = gain.rmse_ratio_interval95.map(|it| 100.0 * it);
    let value = 100.0 * gain.rmse_ratio;
    let digits = carried(value, [low, high]).saturating_sub(1);
    [value, low, high].map(|it| rounded(it, digits))
}

/// The error with all causes, and without each of them.
fn table(subject: &Subject<'_>, gain: &Gain) -> String {
    let row = |what: &str, ratio: f64| {
        let percent = 100.0 * ratio;
        format!(
            "<tr><th scope=\"row\">{what}</th><td class=\"wide\">{}</td><td class=\"number\">{percent:.0} %</td></tr>",
            bar(ratio, &format!("{percent:.0} % of the error"))
        )
    };
    let mut rows = row("the model as it is", 1.0) + &row("with all causes", gain.rmse_ratio);
    for it in gain.per_cause.iter().filter(|_| gain.per_cause.len() > 1) {
        let without = cause(it.effect, &it.target, &subject.diagnosis.channels);
        rows += &row(&format!("all but: {}", escaped(&without)), it.rmse_ratio);
    }
    format!(
        "<table><thead><tr><th scope=\"col\">model</th><th scope=\"col\" class=\"wide\">error</th><th scope=\"col\" class=\"number\">of what it was</th></tr></thead><tbody>{rows}</tbody></table>"
    )
}

/// The notices of the checks before the diagnosis; empty where there are none.
pub(super) fn notices(subject: &Subject<'_>) -> String {
    if subject.diagnosis.gatekeepers.is_empty() {
        return String::new();
    }
    let row = |it: &Notice| {
        format!(
            "<li><strong>{}</strong> {} {}</li>",
            escaped(&capital(&it.check.replace('_', " "))),
            escaped(
                it.channel
                    .and_then(|channel| subject.diagnosis.channels.get(channel))
                    .map_or("", String::as_str)
            ),
            escaped(&it.detail)
        )
    };
    let rows: String = subject.diagnosis.gatekeepers.iter().map(row).collect();
    format!(
        "<section id=\"gatekeepers\"><h2>Noticed of the recording and of the fit</h2><ul>{rows}</ul></section>"
    )
}

/// How it was computed.
pub(super) fn method(subject: &Subject<'_>) -> String {
    let diagnosis = subject.diagnosis;
    let open = diagnosis.residuals.samples.len();
    let locked = diagnosis
        .gain
        .as_ref()
        .map_or_else(String::new, |it| format!(", and {} locked for the gain", it.rows_locked));
    let background = 100.0 * diagnosis.background_share;
    let length = if diagnosis.background_share > 0.0 {
        format!(", which changes over some {:.0} mm", diagnosis.background_mm)
    } else {
        String::new()
    };
    let ceiling = diagnosis.ceiling_share.filter(|it| it.is_finite()).map_or_else(String::new, |share| {
        format!(
            "<div><dt>Of what any smooth model could remove</dt><dd>the causes remove {:.0} %</dd></div>",
            100.0 * share
        )
    });
    format!(
        "<section id=\"method\"><h2>How it was computed</h2><dl><div><dt>Rows</dt><dd>{open} to find causes by{locked}</dd></div>\
         <div><dt>Noise</dt><dd>{:.1} {} rms</dd></div><div><dt>Background of the model</dt><dd>{background:.1} % of a channel’s rms{length}</dd></div>\
         {ceiling}<div><dt>False alarms</dt><dd>asked to be at most 3 % for all causes together</dd></div></dl><p>A cause is named if no other \
         cause of the catalogue explains what it explains. Locked rows have no part in choosing causes. Each channel’s zero is taken off \
         the residuals.</p>{}</section>",
        diagnosis.noise_floor,
        escaped(subject.unit),
        channels(subject)
    )
}

/// Noise and errors of each channel.
fn channels(subject: &Subject<'_>) -> String {
    let unit = if subject.unit.is_empty() { String::new() } else { format!(", {}", escaped(subject.unit)) };
    let row = |channel: usize| {
        let [before, after] = subject.errors(channel);
        let noise = subject.diagnosis.residuals.noise[channel];
        let cells: String =
            [noise, before, after].map(|it| format!("<td class=\"number\">{it:.1}</td>")).concat();
        format!("<tr><th scope=\"row\">{}</th>{cells}</tr>", escaped(&subject.diagnosis.channels[channel]))
    };
    let rows: String = subject.alive().into_iter().map(row).collect();
    format!(
        "<details><summary>All channels</summary><table><thead><tr><th scope=\"col\">channel</th><th scope=\"col\" class=\"number\">noise{unit}</th><th scope=\"col\" class=\"number\">error of the model as it is</th><th scope=\"col\" class=\"number\">with the causes</th></tr></thead><tbody>{rows}</tbody></table></details>"
    )
}
