//! `--report`: one page that is read from the top, and the JSON document beside it.
//!
//! The page needs nothing but itself: no script, no font, no network. The style sheet is inside it, and drawings take their
//! colours from that, in light and in dark. It knows neither nine channels nor modules: these are drawn where there are any.

mod account;
mod causes;
mod circumstances;
mod dots;
mod drawing;
mod errors;
mod grid;
mod limits;
mod maps;
mod subject;
mod trends;
mod verdict;
mod words;

use self::drawing::escaped;
pub(super) use self::subject::{Plate, Subject};
use tactpad::lab::diagnosis::report::Diagnosis;

const STYLE: &str = include_str!("style.css");

/// The page. Equal subjects give equal bytes.
pub(super) fn page(subject: &Subject<'_>) -> String {
    let headline = escaped(&verdict::headline(subject));
    let measured = escaped(&subject.measured);
    let sections = [
        causes::section(subject),
        maps::section(subject),
        trends::section(subject),
        causes::confounded(subject),
        limits::sizes(subject),
        limits::untested(subject),
        account::notices(subject),
        account::gain(subject),
        account::method(subject),
    ];
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\"/>\n<meta name=\"color-scheme\" content=\"light dark\"/>\n\
         <title>{measured}: {headline}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<header><p class=\"of\">Diagnosis of \
         <strong>{measured}</strong> against {}</p><h1>{headline}</h1></header>\n{}\n{}\n</main>\n</body>\n</html>\n",
        escaped(&subject.model),
        overview(subject),
        sections.join("\n")
    )
}

/// The sizes that matter most, and each channel's.
fn overview(subject: &Subject<'_>) -> String {
    let Diagnosis { noise_floor, rmse_nominal, rmse_extended, unnamed_share, gain, .. } = subject.diagnosis;
    let unit = escaped(subject.unit);
    let figure = |value: String, what: &str| format!("<div><dt>{what}</dt><dd>{value}</dd></div>");
    let mut figures = figure(format!("{rmse_nominal:.1} {unit}"), "the model misses the channels by, rms");
    if subject.is_extended() {
        figures += &figure(format!("{rmse_extended:.1} {unit}"), "with the causes below");
    }
    figures += &figure(format!("{noise_floor:.1} {unit}"), "the channels’ noise");
    let background = format!("{:.1} %", 100.0 * subject.diagnosis.background_share);
    if background != "0.0 %" {
        figures += &figure(
            background,
            "of a channel’s rms is background: the smooth small error that every model leaves",
        );
    }
    if let Some(gain) = gain {
        let [left, low, high] = account::percent_left(gain);
        let what = format!("of the error is left on {} locked rows ({low} to {high} %)", gain.rows_locked);
        figures += &figure(format!("{left} %"), &what);
    }
    if *unnamed_share > 0.0 {
        figures += &figure(
            format!("{:.0} %", 100.0 * unnamed_share),
            "of the residual above noise has no known cause",
        );
    }
    format!("<div class=\"top\"><dl class=\"figures\">{figures}</dl>{}</div>", errors::figure(subject))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad::lab::diagnosis::data::target::Target;
    use tactpad::lab::diagnosis::report::{Estimate, Finding, Notice, Proposal, Residuals, Verdict};
    use tactpad::lab::effect::Effect;
    use tactpad::lab::inference::observations::Sample;

    /// A sensor with so many channels, of which the first reads a tenth too much.
    fn diagnosis(channels: usize, rows: usize) -> Diagnosis {
        let sample =
            |row: usize| Sample { load: [row as f64, 0.0, 0.0], t_s: Some(row as f64), ..Sample::default() };
        let wrong =
            |channel: usize, row: usize| if channel == 0 { 0.1 * row as f64 } else { (row % 3) as f64 - 1.0 };
        let residuals = |is_extended: bool| -> Vec<Vec<f64>> {
            let of =
                |channel| (0..rows).map(|row| wrong(if is_extended { 1 } else { channel }, row)).collect();
            (0..channels).map(of).collect()
        };
        Diagnosis {
            channels: (0..channels).map(|channel| format!("<s{channel}>&")).collect(),
            full_scale: Vec::new(),
            verdict: Verdict::Explained,
            noise_floor: 1.0,
            rmse_nominal: 5.0,
            rmse_extended: 1.0,
            background_mm: 10.0,
            background_share: 0.0,
            findings: vec![Finding {
                effect: Effect::ChannelGain,
                target: Target::Channel(0),
                parameters: vec![Estimate { name: "gain", value: 1.1, interval95: [1.09, f64::INFINITY] }],
                shapes: Vec::new(),
                p_value: 0.0,
                share: f64::NAN,
                confounded_with: vec![(Effect::ZeroDrift, Target::Pad)],
                separate_by: Some("measure <again>".to_owned()),
                labels: None,
            }],
            not_detected: Vec::new(),
            not_testable: Vec::new(),
            unnamed_share: 0.0,
            unnamed_by_channel: Vec::new(),
            ceiling_share: None,
            gatekeepers: vec![Notice { check: "stuck", channel: Some(1), detail: "a & b".to_owned() }],
            gain: None,
            residuals: Residuals {
                samples: (0..rows).map(sample).collect(),
                noise: vec![0.0; channels],
                nominal: residuals(false),
                extended: residuals(true),
            },
            next: Proposal::default(),
        }
    }

    fn of(diagnosis: &Diagnosis) -> String {
        page(&Subject {
            diagnosis,
            measured: "<script>.csv".to_owned(),
            model: "another".to_owned(),
            unit: "",
            load_unit: None,
            plate: None,
        })
    }

    #[test]
    fn sensors_without_a_plate_have_no_maps() {
        let page = of(&diagnosis(30, 200));
        assert!(page.contains("Against load and time") && !page.contains("id=\"maps\""));
        assert!(page.contains("18 more channels"), "12 are shown at once");
        assert!(page.contains("Stuck"), "notices are told");
        assert!(page.contains("Measure next:</strong> measure &lt;again&gt;."));
    }

    #[test]
    fn what_files_say_is_no_markup() {
        let page = of(&diagnosis(3, 60));
        for bad in ["<script", "<s0>", "<b>", "<again>", "a & b"] {
            assert!(!page.contains(bad), "{bad}");
        }
        assert!(!page.contains("NaN\"") && !page.contains("inf\""), "no number of a drawing is none");
    }

    #[test]
    fn no_rows_and_no_channels_are_a_page() {
        for (channels, rows) in [(0, 0), (1, 0), (2, 1), (1, 3)] {
            assert!(
                of(&diagnosis(channels, rows)).ends_with("</html>\n"),
                "{channels} channels, {rows} rows"
            );
        }
    }
}
