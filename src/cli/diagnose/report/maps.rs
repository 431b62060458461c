//! Where on the plate the residuals are: a map for each channel, before and after.

use super::dots::{DotScale, level};
use super::drawing::{Drawing, escaped};
use super::grid::{Grid, is_drawn};
use super::{Plate, Subject};
use tactpad::lab::diagnosis::observations::Sample;

/// Space around a plate or the places, as a share of it.
const MARGIN: f64 = 0.05;
/// Places that lie within this share of their distance from the origin are one place.
const APART: f64 = 1e-6;
/// Width of a map on the page, in pixels: the legend's dots are as large as the maps'.
const MAP_PX: f64 = 172.0;

/// What the maps show: left, top, and width in millimetres, y down.
#[derive(Clone, Copy, Debug)]
struct Frame {
    left: f64,
    top: f64,
    width: f64,
}

/// The section; empty where the contacts are not spread over places.
pub(super) fn section(subject: &Subject<'_>) -> String {
    let samples = &subject.diagnosis.residuals.samples;
    let Some(frame) = Frame::of(samples, subject.plate.as_ref()) else { return String::new() };
    let scale = DotScale::of(&subject.diagnosis.residuals);
    let maps = Grid::of(subject).html(|channel| maps(subject, channel, frame, scale));
    let lead = if subject.is_extended() {
        "Each pair of maps is one channel: the model as it is, and with the causes above. One dot is one contact."
    } else {
        "Each map is one channel. One dot is one contact."
    };
    let some = if samples.len() > subject.drawn_rows() {
        format!(" Of {} rows {} are drawn, evenly picked.", samples.len(), subject.drawn_rows())
    } else {
        String::new()
    };
    format!(
        "<section id=\"maps\"><h2>Where on the plate</h2><p>{lead}{some}</p>{}{maps}</section>",
        legend(subject, scale)
    )
}

/// One channel's maps.
fn maps(subject: &Subject<'_>, channel: usize, frame: Frame, scale: DotScale) -> String {
    let residuals = &subject.diagnosis.residuals;
    let name = &subject.diagnosis.channels[channel];
    let one = |of: &[Vec<f64>], when: &str| {
        let mut drawing = frame.drawing(&format!("Channel {name}: residuals on the plate{when}"));
        ground(&mut drawing, subject.plate.as_ref());
        let rows = (0..residuals.samples.len()).filter(|row| is_drawn(*row, subject));
        let dot = |row: usize| {
            let [x, y] = residuals.samples[row].place_mm;
            ([x, -y], level(of[channel][row], residuals.noise[channel]))
        };
        scale.draw(&mut drawing, &rows.map(dot).collect::<Vec<_>>(), frame.width);
        drawing.html()
    };
    if !subject.is_extended() {
        return one(&residuals.nominal, "");
    }
    one(&residuals.nominal, ", the model as it is") + &one(&residuals.extended, ", with the causes")
}

impl Frame {
    /// The plate, or what holds all places; none where all are one.
    fn of(samples: &[Sample], plate: Option<&Plate>) -> Option<Self> {
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for sample in samples {
            for ([low, high], mm) in ends.iter_mut().zip(sample.place_mm) {
                (*low, *high) = (low.min(mm), high.max(mm));
            }
        }
        let spread = ends.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        let size = ends.iter().flatten().fold(0.0, |size: f64, end| size.max(end.abs()));
        if !(spread > APART * size && spread.is_finite()) {
            return None;
        }
        let [x, y] = plate.map_or(ends, |it| [[-it.radius_mm, it.radius_mm]; 2]).map(|[low, high]| 0.5 * (low + high));
        let width = plate.map_or(spread, |it| 2.0 * it.radius_mm) * (1.0 + 2.0 * MARGIN);
        Some(Self { left: x - 0.5 * width, top: -y - 0.5 * width, width })
    }

    fn drawing(&self, title: &str) -> Drawing {
        Drawing::new("map", [self.left, self.top, self.width, self.width], title)
    }
}

/// The plate's rim and the modules' places.
fn ground(drawing: &mut Drawing, plate: Option<&Plate>) {
    let Some(plate) = plate else { return };
    drawing.circle("plate", [0.0, 0.0], plate.radius_mm);
    for corners in &plate.modules_mm {
        drawing.corners("module", &corners.map(|[x, y]| [x, -y]), true);
    }
}

/// What discs and rings and their sizes mean, and which module is which.
fn legend(subject: &Subject<'_>, scale: DotScale) -> String {
    let examples = scale.examples();
    let size = |at: usize, level: f64| {
        let is_largest = at + 1 == examples.len();
        let times = format!("{level:.0}× noise{}", if is_largest { " and more" } else { "" });
        format!("<span class=\"entry\">{}{}<span>{times}</span></span>", dot(level, scale), dot(-level, scale))
    };
    let sizes: String = examples.iter().enumerate().map(|(at, level)| size(at, *level)).collect();
    let full = dot(scale.full, scale);
    let ring = dot(-scale.full, scale);
    format!(
        "<div class=\"legend\">{}<span class=\"entry\">{full}<span>reads more than the model</span></span>\
         <span class=\"entry\">{ring}<span>reads less</span></span>{sizes}</div>",
        key(subject)
    )
}

/// A dot of the legend.
fn dot(level: f64, scale: DotScale) -> String {
    let side = 2.5 * scale.radius(scale.full, MAP_PX);
    let what = if level < 0.0 { "ring" } else { "disc" };
    let mut drawing = Drawing::new("dot", [-0.5 * side, -0.5 * side, side, side], format!("a {what}"));
    scale.draw(&mut drawing, &[([0.0, 0.0], level)], MAP_PX);
    drawing.html()
}

/// The plate with its modules' numbers and its axes.
fn key(subject: &Subject<'_>) -> String {
    let Some(plate) = &subject.plate else { return String::new() };
    let radius = plate.radius_mm;
    let mut drawing = Drawing::new("key", [-1.5 * radius, -1.5 * radius, 3.0 * radius, 3.0 * radius], "The plate with its modules");
    ground(&mut drawing, Some(plate));
    for (number, corners) in plate.modules_mm.iter().enumerate() {
        let middle = |axis: usize| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0;
        drawing.text("middle", [middle(0), -middle(1)], &number.to_string());
    }
    drawing.line("axis", [radius, 0.0], [1.2 * radius, 0.0]);
    drawing.text("start", [1.23 * radius, 0.0], "x");
    drawing.line("axis", [0.0, -radius], [0.0, -1.2 * radius]);
    drawing.text("above", [0.0, -1.26 * radius], "y");
    format!("<span class=\"entry\">{}<span>{}</span></span>", drawing.html(), escaped("modules 0 to ") + &plate.modules_mm.len().saturating_sub(1).to_string())
}
