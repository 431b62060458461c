//! How far the model misses each channel, before and after: one line each.

use super::drawing::Drawing;
use super::subject::Subject;
use tactpad::plot::scale::{Scale, linear_ticks};

/// A line's height, and where the axis begins and ends, in pixels.
const LINE: f64 = 20.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 340.0;
const WIDTH: f64 = 360.0;
const TOP: f64 = 8.0;
/// Longer names are cut.
const NAME_MAX: usize = 10;
/// More channels than this are not shown here: those with the largest errors are.
const CHANNELS_MAX: usize = 24;

/// The figure.
pub(super) fn figure(subject: &Subject<'_>) -> String {
    let mut channels = subject.alive();
    channels.sort_by(|one, other| subject.errors(*other)[0].total_cmp(&subject.errors(*one)[0]));
    channels.truncate(CHANNELS_MAX);
    channels.sort_unstable();
    let noise = |channel: &usize| subject.diagnosis.residuals.noise[*channel];
    let largest = channels.iter().map(|it| subject.errors(*it)[0].max(subject.errors(*it)[1]).max(noise(it)));
    let span = Scale::Linear.span(largest.chain([0.0]));
    let bottom = TOP + LINE * channels.len() as f64;
    let mut drawing = Drawing::new(
        "errors",
        [0.0, 0.0, WIDTH, bottom + 36.0],
        "Root mean square of each channel’s residuals",
    );
    let x = |value: f64| LEFT + value / span[1] * (RIGHT - LEFT);
    for tick in linear_ticks(span, 4.0) {
        drawing.line("rule", [x(tick.value), TOP], [x(tick.value), bottom]);
        drawing.text(
            "middle",
            [x(tick.value), bottom + 14.0],
            &tick.label.replace("^{", "^").replace('}', ""),
        );
    }
    drawing.text(
        "middle title",
        [0.5 * (LEFT + RIGHT), bottom + 30.0],
        &format!("rms residual in {}", subject.unit),
    );
    for (line, channel) in channels.iter().enumerate() {
        let y = TOP + LINE * (line as f64 + 0.5);
        drawing.text("end", [LEFT - 8.0, y + 4.0], &cut(&subject.diagnosis.channels[*channel]));
        let [before, after] = subject.errors(*channel).map(x);
        drawing.rectangle("noise", [x(0.0), y - 6.0], [x(noise(channel)), y + 6.0]);
        if subject.is_extended() {
            drawing.line("way", [before, y], [after, y]);
            drawing.circle("after", [after, y], 4.5);
        }
        drawing.circle("before", [before, y], 4.5);
    }
    format!("<figure class=\"overview\">{}{}</figure>", drawing.html(), legend(subject))
}

fn cut(name: &str) -> String {
    if name.chars().count() <= NAME_MAX {
        name.to_owned()
    } else {
        name.chars().take(NAME_MAX - 1).chain(['…']).collect()
    }
}

fn legend(subject: &Subject<'_>) -> String {
    let entry = |class: &str, what: &str| {
        let mut drawing = Drawing::new("swatch", [0.0, 0.0, 30.0, 14.0], what);
        if class == "noise" {
            drawing.rectangle(class, [1.0, 1.0], [29.0, 13.0]);
        } else {
            drawing.circle(class, [15.0, 7.0], 4.5);
        }
        format!("<span class=\"entry\">{}<span>{what}</span></span>", drawing.html())
    };
    let after = if subject.is_extended() { entry("after", "with the causes") } else { String::new() };
    format!(
        "<figcaption class=\"legend\">{}{after}{}</figcaption>",
        entry("before", "the model as it is"),
        entry("noise", "noise")
    )
}
