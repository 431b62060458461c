//! Where on the plate the residuals are: a map for each channel, before and after.

use super::dots::{Dot, DotScale, Place, level, places};
use super::drawing::Drawing;
use super::grid::Grid;
use super::subject::{Plate, Subject};
use tactpad::lab::inference::observations::Sample;

/// Space around a plate or the places, as a share of it.
const MARGIN: f64 = 0.05;
/// Places that lie within this share of their distance from the origin are one place.
const APART: f64 = 1e-6;
/// Width of a map on the page, in pixels: the legend's dots are as large as the maps'.
const MAP_PX: f64 = 172.0;

/// How far below a map's upper edge its name stands, as a share of its width.
const WHEN: f64 = 0.05;

/// The area of the maps: left, top, and width in millimetres, y down.
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
    let places_mm: Vec<[f64; 2]> = samples.iter().map(|it| it.place_mm).collect();
    let places = places(&places_mm, frame.width, subject.dots_of_map());
    let maps = Grid::of(subject).html(|channel| maps(subject, channel, &places, frame, scale));
    let lead = if subject.is_extended() {
        "Each pair of maps is one channel: before, that is the model as it is, and after, with the causes above."
    } else {
        "Each map is one channel."
    };
    format!(
        "<section id=\"maps\"><h2>Where on the plate</h2><p>{lead} One mark is one place; its area grows with the rms of the residuals \
         there.</p>{}{maps}</section>",
        legend(subject, scale)
    )
}

/// One channel's maps.
fn maps(subject: &Subject<'_>, channel: usize, places: &[Place], frame: Frame, scale: DotScale) -> String {
    let residuals = &subject.diagnosis.residuals;
    let name = &subject.diagnosis.channels[channel];
    let one = |of: &[Vec<f64>], when: &str| {
        let mut drawing = frame.drawing(&format!("Channel {name}: residuals on the plate, {when}"));
        if subject.is_extended() {
            drawing.text("start when", [frame.left, frame.top + WHEN * frame.width], when);
        }
        ground(&mut drawing, subject.plate.as_ref());
        let dot = |place: &Place| {
            let levels = place.rows.iter().map(|row| level(of[channel][*row], residuals.noise[channel]));
            let [x, y] = place.at;
            Dot::of([x, -y], levels)
        };
        scale.draw(&mut drawing, places.iter().filter_map(dot).collect(), frame.width);
        drawing.html()
    };
    let before = one(&residuals.nominal, "before");
    if subject.is_extended() { before + &one(&residuals.extended, "after") } else { before }
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
        let [x, y] =
            plate.map_or(ends, |it| [[-it.radius_mm, it.radius_mm]; 2]).map(|[low, high]| 0.5 * (low + high));
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

/// The legend: discs, rings and squares, their sizes, and the modules.
fn legend(subject: &Subject<'_>, scale: DotScale) -> String {
    let entry = |mark: String, what: &str| format!("<span class=\"entry\">{mark}<span>{what}</span></span>");
    let examples = scale.examples();
    let full = scale.full;
    let signs = [
        entry(mark(1.0, full, scale), "reads more than the model"),
        entry(mark(-1.0, full, scale), "reads less"),
        entry(mark(0.0, full, scale), "more and less, by the load"),
    ];
    let size = |level: &f64| format!("{}<span>{level:.0} ×</span>", mark(1.0, *level, scale));
    let sizes: String = examples.iter().map(size).collect();
    let sizes = format!("<span class=\"entry\">{sizes}<span>the channel’s noise</span></span>");
    format!("<div class=\"legend\">{}{}{sizes}</div>", key(subject), signs.concat())
}

/// A mark of the legend, as large as on the maps.
fn mark(sign: f64, level: f64, scale: DotScale) -> String {
    let what = ["a ring", "a square", "a disc"][(sign + 1.0) as usize];
    let mut drawing = Drawing::new("dot", [-9.0, -9.0, 18.0, 18.0], what);
    scale.draw(&mut drawing, vec![Dot { at: [0.0; 2], level, sign }], MAP_PX);
    drawing.html()
}

/// The plate with its modules' numbers and its axes.
fn key(subject: &Subject<'_>) -> String {
    let Some(plate) = &subject.plate else { return String::new() };
    let radius = plate.radius_mm;
    let mut drawing = Drawing::new(
        "key",
        [-1.5 * radius, -1.5 * radius, 3.0 * radius, 3.0 * radius],
        "The plate with its modules",
    );
    ground(&mut drawing, Some(plate));
    for (number, corners) in plate.modules_mm.iter().enumerate() {
        let middle = |axis: usize| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0;
        drawing.text("middle", [0.5 * middle(0), -0.5 * middle(1)], &number.to_string());
    }
    drawing.line("axis", [radius, 0.0], [1.2 * radius, 0.0]);
    drawing.text("start", [1.23 * radius, 0.0], "x");
    drawing.line("axis", [0.0, -radius], [0.0, -1.2 * radius]);
    drawing.text("above", [0.0, -1.26 * radius], "y");
    format!("<span class=\"entry\">{}<span>the modules</span></span>", drawing.html())
}
