//! What a figure is made of, before it is SVG or PNG.

use super::colour::Rgb;

/// A place on the page in CSS pixels (1/96 inch): x right, y **down**, from the upper left corner.
pub type Point = [f64; 2];

/// Marks farther out than this are mistakes and are left out.
const FARTHEST: f64 = 1e6;

/// A white page with marks, the later ones above.
#[derive(Clone, Debug)]
pub struct Figure {
    width: f64,
    height: f64,
    description: String,
    marks: Vec<Mark>,
}

/// One thing on the page.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Lines and areas.
    Path(Path),
    /// A circle.
    Circle(Circle),
    /// A line of text.
    Text(Text),
}

/// Straight lines, filled, drawn, or both.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Their corners.
    pub lines: Vec<Vec<Point>>,
    /// What happens after the last corner of each.
    pub ends: Ends,
    /// Paint inside. A place is inside if a ray from it crosses the lines an odd number of times.
    pub fill: Option<Ink>,
    /// The line itself.
    pub stroke: Option<Stroke>,
}

/// What happens after the last corner of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// It ends.
    Open,
    /// It goes back to the first one.
    Closed,
}

/// A circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Its centre.
    pub centre: Point,
    /// Its radius.
    pub radius: f64,
    /// Paint inside.
    pub fill: Option<Ink>,
    /// The line around.
    pub stroke: Option<Stroke>,
}

/// A line of text. `_{…}` is an index, `^{…}` an exponent.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// What is written.
    pub text: String,
    /// A place on the baseline.
    pub at: Point,
    /// What stands at that place.
    pub anchor: Anchor,
    /// Height of an em.
    pub size: f64,
    /// Thickness of the letters.
    pub weight: Weight,
    /// Turn about the place, clockwise on the page.
    pub turn_deg: f64,
    /// Its colour.
    pub ink: Ink,
}

/// Which part of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// Thickness of letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// For all text but titles.
    Regular,
    /// For titles.
    SemiBold,
}

/// A colour with its opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink {
    /// The colour.
    pub colour: Rgb,
    /// From 0, invisible, to 1.
    pub opacity: f64,
}

/// How a line is drawn. Its joins are round and its ends flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub ink: Ink,
    /// Its width.
    pub width: f64,
    /// Length of a dash and of the gap after it, if it is dashed.
    pub dash: Option<[f64; 2]>,
}

impl Ink {
    /// Covers what is below.
    pub const fn opaque(colour: Rgb) -> Self {
        Self { colour, opacity: 1.0 }
    }
}

impl Stroke {
    /// An opaque line without gaps.
    pub const fn solid(colour: Rgb, width: f64) -> Self {
        Self { ink: Ink::opaque(colour), width, dash: None }
    }

    /// The same line with gaps.
    #[must_use]
    pub const fn dashed(mut self, dash: f64, gap: f64) -> Self {
        self.dash = Some([dash, gap]);
        self
    }
}

impl Path {
    /// Areas without lines around them.
    pub fn area(lines: Vec<Vec<Point>>, fill: Ink) -> Self {
        Self { lines, ends: Ends::Closed, fill: Some(fill), stroke: None }
    }

    /// Lines that end.
    pub fn strokes(lines: Vec<Vec<Point>>, stroke: Stroke) -> Self {
        Self { lines, ends: Ends::Open, fill: None, stroke: Some(stroke) }
    }

    /// A rectangle from its upper left corner.
    pub fn rectangle([x, y]: Point, [width, height]: [f64; 2]) -> Self {
        let corners = vec![[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
        Self { lines: vec![corners], ends: Ends::Closed, fill: None, stroke: None }
    }
}

impl Text {
    /// Regular, level text that starts at `at`.
    pub fn new(text: impl Into<String>, at: Point, size: f64, ink: Ink) -> Self {
        Self {
            text: text.into(),
            at,
            anchor: Anchor::Start,
            size,
            weight: Weight::Regular,
            turn_deg: 0.0,
            ink,
        }
    }

    /// The same with another anchor.
    #[must_use]
    pub fn anchored(mut self, anchor: Anchor) -> Self {
        self.anchor = anchor;
        self
    }

    /// The same in the weight of titles.
    #[must_use]
    pub fn semi_bold(mut self) -> Self {
        self.weight = Weight::SemiBold;
        self
    }

    /// The same, turned about its place.
    #[must_use]
    pub fn turned(mut self, turn_deg: f64) -> Self {
        self.turn_deg = turn_deg;
        self
    }
}

impl Figure {
    /// An empty page. Its sides are rounded up to whole pixels; a side that is no length is 0.
    pub fn new(width: f64, height: f64, description: impl Into<String>) -> Self {
        let [width, height] = [width, height].map(whole);
        Self { width, height, description: description.into(), marks: Vec::new() }
    }

    /// Width and height of the page.
    pub fn size(&self) -> [f64; 2] {
        [self.width, self.height]
    }

    /// What it shows, for those who cannot see it.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// Adds a mark above all others. Corners that are not finite numbers are left out and break their line;
    /// so are circles and texts with such numbers.
    pub fn add(&mut self, mark: Mark) {
        match mark {
            Mark::Path(mut path) => {
                path.lines = path.lines.into_iter().flat_map(on_page).collect();
                if !path.lines.is_empty() {
                    self.marks.push(Mark::Path(path));
                }
            }
            Mark::Circle(circle) if !(is_on_page(circle.centre) && circle.radius > 0.0) => {}
            Mark::Circle(circle) if circle.radius > FARTHEST => {}
            Mark::Text(text) if !(is_on_page(text.at) && is_on_page([text.size, text.turn_deg])) => {}
            Mark::Text(text) if text.text.is_empty() => {}
            mark => self.marks.push(mark),
        }
    }

    /// Adds lines or areas.
    pub fn path(&mut self, path: Path) {
        self.add(Mark::Path(path));
    }

    /// Adds a text.
    pub fn text(&mut self, text: Text) {
        self.add(Mark::Text(text));
    }

    /// Adds all of another figure, its upper left corner at `at`: figures beside each other make one.
    pub fn place(&mut self, other: Self, at: Point) {
        other.marks.into_iter().map(|mark| mark.moved(at)).for_each(|mark| self.add(mark));
    }

    /// What is on the page; every coordinate is a finite number.
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }
}

impl Mark {
    fn moved(mut self, [dx, dy]: Point) -> Self {
        let shift = |[x, y]: &mut Point| {
            *x += dx;
            *y += dy;
        };
        match &mut self {
            Self::Path(path) => path.lines.iter_mut().flatten().for_each(shift),
            Self::Circle(circle) => shift(&mut circle.centre),
            Self::Text(text) => shift(&mut text.at),
        }
        self
    }
}

fn whole(side: f64) -> f64 {
    if side.is_nan() { 0.0 } else { side.clamp(0.0, FARTHEST).ceil() }
}

fn is_on_page(point: Point) -> bool {
    point.iter().all(|coordinate| coordinate.abs() < FARTHEST)
}

/// The parts of a line between corners that cannot be drawn.
fn on_page(line: Vec<Point>) -> Vec<Vec<Point>> {
    if line.len() > 1 && line.iter().all(|&point| is_on_page(point)) {
        return vec![line];
    }
    let parts = line.split(|&point| !is_on_page(point));
    parts.filter(|part| part.len() > 1).map(<[Point]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::{AXIS, TEXT};

    #[test]
    fn what_is_not_finite_breaks_a_line() {
        let mut figure = Figure::new(10.0, 10.0, "");
        let line = vec![
            [0.0, 0.0],
            [1.0, 1.0],
            [f64::NAN, 2.0],
            [3.0, 3.0],
            [f64::INFINITY, 0.0],
            [4.0, 0.0],
            [5.0, 1.0],
        ];
        figure.path(Path::strokes(vec![line], AXIS));
        let [Mark::Path(path)] = figure.marks() else { panic!("{:?}", figure.marks()) };
        assert_eq!(path.lines, [[[0.0, 0.0], [1.0, 1.0]], [[4.0, 0.0], [5.0, 1.0]]]);
    }

    #[test]
    fn marks_that_cannot_be_drawn_are_left_out() {
        let mut figure = Figure::new(10.0, 10.0, "");
        for bad in [f64::NAN, f64::INFINITY, -1e300] {
            figure.path(Path::strokes(vec![vec![[bad, 0.0], [0.0, 0.0]]], AXIS));
            figure.add(Mark::Circle(Circle { centre: [0.0, 0.0], radius: bad, fill: None, stroke: None }));
            figure.text(Text::new("here", [bad, 0.0], 10.0, TEXT));
            figure.text(Text::new("here", [0.0, 0.0], bad, TEXT));
        }
        figure.text(Text::new("", [0.0, 0.0], 10.0, TEXT));
        assert_eq!(figure.marks(), []);
    }

    #[test]
    fn a_placed_figure_keeps_its_shape() {
        let mut inner = Figure::new(10.0, 10.0, "");
        inner.text(Text::new("here", [1.0, 2.0], 10.0, TEXT));
        inner.path(Path::rectangle([0.0, 0.0], [2.0, 1.0]));
        let mut page = Figure::new(100.0, 100.0, "");
        page.place(inner, [50.0, 20.0]);
        let [Mark::Text(text), Mark::Path(path)] = page.marks() else { panic!("{:?}", page.marks()) };
        assert_eq!(text.at, [51.0, 22.0]);
        assert_eq!(path.lines[0], [[50.0, 20.0], [52.0, 20.0], [52.0, 21.0], [50.0, 21.0]]);
    }
}
