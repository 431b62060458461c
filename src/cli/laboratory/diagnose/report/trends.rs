//! Residuals against load, direction, time and temperature: for each channel, where eight of ten rows lie.

use super::circumstances::{self, Circumstance};
use super::drawing::{Drawing, escaped};
use super::grid::Grid;
use super::subject::Subject;
use super::words::listed;
use tactpad::plot::scale::{Scale, linear_ticks};

/// A panel's size, and the ends of its axes, in pixels.
const SIZE: [f64; 2] = [172.0, 116.0];
const LEFT: f64 = 36.0;
const RIGHT: f64 = 168.0;
const TOP: f64 = 6.0;
const BOTTOM: f64 = 84.0;
/// Where the numbers below the axis stand, and the axis' title.
const NUMBERS: f64 = 97.0;
const TITLE: f64 = 111.0;
/// Eight of ten rows lie between these quantiles.
const QUANTILES: [f64; 3] = [0.1, 0.5, 0.9];

/// A panel's axes: values at their ends.
#[derive(Clone, Copy, Debug)]
struct Axes {
    x: [f64; 2],
    y: [f64; 2],
}

/// The quantiles of a channel's residuals in each bin: where it is, and the three values.
type Band = Vec<(f64, [f64; 3])>;

/// The section; empty where nothing differs from row to row.
pub(super) fn section(subject: &Subject<'_>) -> String {
    let all = circumstances::all(subject);
    if all.is_empty() {
        return String::new();
    }
    let panels = Grid::of(subject).html(|channel| panels(subject, channel, &all));
    let titles: Vec<String> =
        all.iter().map(|it| it.title.split(" in ").next().unwrap_or_default().to_owned()).collect();
    format!(
        "<section id=\"trends\"><h2>Against {}</h2>{}{panels}</section>",
        escaped(&listed(&titles)),
        legend(subject)
    )
}

/// One channel against everything, all with the same residuals upwards.
fn panels(subject: &Subject<'_>, channel: usize, all: &[Circumstance]) -> String {
    let residuals = &subject.diagnosis.residuals;
    let bands: Vec<[Band; 2]> = all
        .iter()
        .map(|it| [&residuals.nominal, &residuals.extended].map(|of| band(it, &of[channel])))
        .collect();
    let noise = residuals.noise[channel];
    let shown = bands.iter().flatten().flatten().flat_map(|(_, values)| *values).chain([noise]);
    let largest = shown.map(f64::abs).filter(|it| it.is_finite()).fold(0.0, f64::max);
    let y = Scale::Linear.span([-largest, largest].into_iter());
    all.iter().zip(&bands).map(|(it, bands)| panel(subject, channel, it, bands, y)).collect()
}

fn band(circumstance: &Circumstance, residuals: &[f64]) -> Band {
    let of_bin = |bin: circumstances::Bin| {
        let mut values: Vec<f64> =
            bin.rows.iter().map(|row| residuals[*row]).filter(|it| it.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        Some((bin.value, QUANTILES.map(|share| values[(share * last as f64).round() as usize])))
    };
    circumstance.bins().into_iter().filter_map(of_bin).collect()
}

fn panel(
    subject: &Subject<'_>,
    channel: usize,
    it: &Circumstance,
    [before, after]: &[Band; 2],
    y: [f64; 2],
) -> String {
    let name = &subject.diagnosis.channels[channel];
    let title = format!("Channel {name}: residual in {} against {}", subject.unit, it.title);
    let mut drawing = Drawing::new("trend", [0.0, 0.0, SIZE[0], SIZE[1]], title);
    let axes = Axes { x: span(it, before), y };
    let noise = subject.diagnosis.residuals.noise[channel];
    drawing.rectangle("noise", axes.at([axes.x[0], noise]), axes.at([axes.x[1], -noise]));
    drawing.line("zero", axes.at([axes.x[0], 0.0]), axes.at([axes.x[1], 0.0]));
    draw(&mut drawing, axes, it, before, "before");
    if subject.is_extended() {
        draw(&mut drawing, axes, it, after, "after");
    }
    axes.draw(&mut drawing, it);
    drawing.html()
}

/// The ends of the axis: those of the values; names have room on both sides.
fn span(circumstance: &Circumstance, band: &Band) -> [f64; 2] {
    if !circumstance.names.is_empty() {
        return [-0.5, circumstance.names.len() as f64 - 0.5];
    }
    let [low, high] = [band.first(), band.last()].map(|it| it.map_or(0.0, |(value, _)| *value));
    if low < high { [low, high] } else { [low - 1.0, high + 1.0] }
}

/// A band with its median; bars where values are names.
fn draw(drawing: &mut Drawing, axes: Axes, it: &Circumstance, band: &Band, class: &str) {
    let line = |at: usize| band.iter().map(move |(value, values)| axes.at([*value, values[at]]));
    if it.names.is_empty() {
        let corners: Vec<[f64; 2]> = line(0).chain(line(2).rev()).collect();
        drawing.corners(class, &corners, true);
        drawing.corners(&format!("{class} median"), &line(1).collect::<Vec<_>>(), false);
        return;
    }
    let aside = if class == "before" { -0.15 } else { 0.15 };
    for (value, [low, middle, high]) in band {
        let [left, right] = [value + aside - 0.12, value + aside + 0.12];
        drawing.rectangle(class, axes.at([left, *low]), axes.at([right, *high]));
        drawing.line(&format!("{class} median"), axes.at([left, *middle]), axes.at([right, *middle]));
    }
}

impl Axes {
    /// Where a point is.
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        [LEFT + share(x, self.x) * (RIGHT - LEFT), BOTTOM - share(y, self.y) * (BOTTOM - TOP)]
    }

    /// Ticks, numbers and the title.
    fn draw(&self, drawing: &mut Drawing, circumstance: &Circumstance) {
        drawing.line("axis", [LEFT, TOP], [LEFT, BOTTOM]);
        drawing.line("axis", [LEFT, BOTTOM], [RIGHT, BOTTOM]);
        for tick in linear_ticks(self.y, 4.0) {
            let [_, y] = self.at([self.x[0], tick.value]);
            drawing.line("axis", [LEFT - 3.0, y], [LEFT, y]);
            drawing.text("end", [LEFT - 5.0, y + 3.5], &plain(&tick.label));
        }
        if circumstance.names.is_empty() {
            for tick in linear_ticks(self.x, 4.0) {
                let [x, _] = self.at([tick.value, 0.0]);
                drawing.line("axis", [x, BOTTOM], [x, BOTTOM + 3.0]);
                drawing.text("middle", [x, NUMBERS], &plain(&tick.label));
            }
        }
        for (value, name) in circumstance.names.iter().enumerate() {
            drawing.text("middle", [self.at([value as f64, 0.0])[0], NUMBERS], name);
        }
        drawing.text("middle title", [0.5 * (LEFT + RIGHT), TITLE], &circumstance.title);
    }
}

/// A number of an axis without the marks of its exponent.
fn plain(label: &str) -> String {
    label.replace("^{", "^").replace('}', "")
}

/// The legend: band, line and ground.
fn legend(subject: &Subject<'_>) -> String {
    let swatch = |class: &str, what: &str| {
        let mut drawing = Drawing::new("swatch", [0.0, 0.0, 30.0, 14.0], what);
        drawing.rectangle(class, [1.0, 1.0], [29.0, 13.0]);
        if class != "noise" {
            drawing.line(&format!("{class} median"), [1.0, 7.0], [29.0, 7.0]);
        }
        format!("<span class=\"entry\">{}<span>{what}</span></span>", drawing.html())
    };
    let after = if subject.is_extended() { swatch("after", "with the causes") } else { String::new() };
    let unit = if subject.unit.is_empty() { String::new() } else { format!(" in {}", subject.unit) };
    format!(
        "<p>Upwards: measured minus model{unit}, on each channel’s own scale. A band holds eight of ten rows, the line is their \
         median.</p><div class=\"legend\">{}{after}{}</div>",
        swatch("before", "the model as it is"),
        swatch("noise", "the channel’s noise, ± its rms")
    )
}
