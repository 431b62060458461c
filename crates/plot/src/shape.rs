//! What is drawn over a map or alone: outlines of parts, regions, places, lengths.

use std::f64::consts::TAU;

use super::colour::Rgb;
use super::figure::{Anchor, Circle, Ends, Figure, Ink, Mark, Path, Point, Stroke, Text};
use super::style::{HALF_DIGIT, LABEL_SIZE, TEXT};

/// A thing in the coordinates of a plan: x right, y up, in the plan's unit of length.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A circle.
    Circle {
        /// Its centre.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
        /// Its paint.
        look: PaintStyle,
    },
    /// A turned rectangle.
    Rectangle {
        /// Its centre.
        centre: [f64; 2],
        /// Its sides along x and y before the turn.
        size: [f64; 2],
        /// Turn about its centre, counter-clockwise.
        turn_deg: f64,
        /// Its paint.
        look: PaintStyle,
    },
    /// Straight lines.
    Line {
        /// Corners.
        corners: Vec<[f64; 2]>,
        /// What happens after the last one.
        ends: Ends,
        /// Their paint.
        look: PaintStyle,
    },
    /// Dots.
    Dots {
        /// Where they are.
        places: Vec<[f64; 2]>,
        /// Their radius in pixels.
        radius_px: f64,
        /// Their paint.
        look: PaintStyle,
    },
    /// Text around a place.
    Label {
        /// Its middle.
        place: [f64; 2],
        /// What is written.
        text: String,
    },
    /// A length between two places with arrows at both.
    Dimension {
        /// One place.
        from: [f64; 2],
        /// The other place.
        to: [f64; 2],
        /// What is written in its middle.
        text: String,
    },
}

/// Paint inside and around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintStyle {
    /// Paint inside.
    pub fill: Option<Ink>,
    /// The line.
    pub stroke: Option<Stroke>,
}

/// From a plan's coordinates to the page.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// The plan's origin on the page.
    pub(super) origin: Point,
    /// Pixels per unit of length.
    pub(super) scale: f64,
    /// What lies below the shapes.
    pub(super) ground: Ground,
}

/// What lies below the shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ground {
    /// The white page.
    Page,
    /// Colours, light and dark.
    Field,
}

/// Lines over colours have a pale rim, so that they show on dark ones.
const RIM: Ink = Ink { colour: Rgb::WHITE, opacity: 0.6 };
const RIM_WIDTH: f64 = 1.6;
const ARROW: [f64; 2] = [7.0, 2.2];

impl PaintStyle {
    /// A line without paint inside.
    pub const fn line(stroke: Stroke) -> Self {
        Self { fill: None, stroke: Some(stroke) }
    }

    /// Paint without a line.
    pub const fn fill(ink: Ink) -> Self {
        Self { fill: Some(ink), stroke: None }
    }
}

impl Window {
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> Point {
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }

    pub(super) fn line(&self, corners: &[[f64; 2]]) -> Vec<Point> {
        corners.iter().map(|&corner| self.at(corner)).collect()
    }

    /// What is drawn first for a line of this look.
    fn rim(&self, look: PaintStyle) -> Option<PaintStyle> {
        let stroke = look.stroke.filter(|_| self.ground == Ground::Field)?;
        Some(PaintStyle::line(Stroke { ink: RIM, width: stroke.width + RIM_WIDTH, dash: None }))
    }

    fn circle(&self, figure: &mut Figure, centre: Point, radius: f64, look: PaintStyle) {
        for PaintStyle { fill, stroke } in self.rim(look).into_iter().chain([look]) {
            figure.add(Mark::Circle(Circle { centre, radius, fill, stroke }));
        }
    }

    fn path(&self, figure: &mut Figure, corners: &[[f64; 2]], ends: Ends, look: PaintStyle) {
        for PaintStyle { fill, stroke } in self.rim(look).into_iter().chain([look]) {
            figure.path(Path { lines: vec![self.line(corners)], ends, fill, stroke });
        }
    }
}

impl Shape {
    /// Its lines on the page, closed ones with their first corner at the end too.
    pub(super) fn lines(&self, window: &Window) -> Vec<Vec<Point>> {
        let closed =
            |corners: &[[f64; 2]]| window.line(&[corners, &corners[..1.min(corners.len())]].concat());
        match self {
            Self::Circle { centre, radius, .. } => vec![closed(&around(*centre, *radius))],
            Self::Rectangle { centre, size, turn_deg, .. } => {
                vec![closed(&turned_corners(*centre, *size, *turn_deg))]
            }
            Self::Line { corners, ends: Ends::Closed, .. } => vec![closed(corners)],
            Self::Line { corners, ends: Ends::Open, .. } => vec![window.line(corners)],
            Self::Dots { places, .. } => places.iter().map(|&place| window.line(&[place, place])).collect(),
            Self::Label { place, .. } => vec![window.line(&[*place, *place])],
            Self::Dimension { from, to, .. } => vec![window.line(&[*from, *to])],
        }
    }

    pub(super) fn draw(&self, figure: &mut Figure, window: &Window) {
        match self {
            Self::Circle { centre, radius, look } => {
                window.circle(figure, window.at(*centre), radius * window.scale, *look);
            }
            Self::Rectangle { centre, size, turn_deg, look } => {
                window.path(figure, &turned_corners(*centre, *size, *turn_deg), Ends::Closed, *look);
            }
            Self::Line { corners, ends, look } => window.path(figure, corners, *ends, *look),
            Self::Dots { places, radius_px, look } => {
                places.iter().for_each(|&place| window.circle(figure, window.at(place), *radius_px, *look));
            }
            Self::Label { place, text } => {
                let text = label(text, window.at(*place));
                if window.ground == Ground::Field {
                    figure.path(behind(&text));
                }
                figure.text(text);
            }
            Self::Dimension { from, to, text } => {
                draw_dimension(figure, [window.at(*from), window.at(*to)], text);
            }
        }
    }
}

fn label(text: &str, [x, y]: Point) -> Text {
    Text::new(text, [x, y + HALF_DIGIT * LABEL_SIZE], LABEL_SIZE, TEXT).anchored(Anchor::Middle)
}

/// A pale field behind a label, so that it can be read on dark colours.
fn behind(text: &Text) -> Path {
    let [width, height] = [text.width() + 4.0, 1.2 * LABEL_SIZE];
    let corner = [text.at[0] - 0.5 * width, text.at[1] - HALF_DIGIT * LABEL_SIZE - 0.5 * height];
    Path { fill: Some(RIM), ..Path::rectangle(corner, [width, height]) }
}

/// Corners of a circle, for distances.
fn around([x, y]: [f64; 2], radius: f64) -> [[f64; 2]; 60] {
    std::array::from_fn(|k| {
        let (sin, cos) = (k as f64 * TAU / 60.0).sin_cos();
        [x + radius * cos, y + radius * sin]
    })
}

fn turned_corners(centre: [f64; 2], size: [f64; 2], turn_deg: f64) -> [[f64; 2]; 4] {
    let (sin, cos) = turn_deg.to_radians().sin_cos();
    [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[u, v]| {
        let [x, y] = [u * size[0], v * size[1]];
        [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y]
    })
}

fn draw_dimension(figure: &mut Figure, [from, to]: [Point; 2], text: &str) {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
    let place = |origin: Point, ahead: f64, aside: f64| {
        [origin[0] + ahead * along[0] - aside * along[1], origin[1] + ahead * along[1] + aside * along[0]]
    };
    let [long, half] = ARROW;
    let half_gap = 0.5 * Text::new(text, from, LABEL_SIZE, TEXT).width() + 3.0;
    let middle = place(from, 0.5 * length, 0.0);
    // A level text takes less of a steep line.
    let half_gap = if text.is_empty() { 0.0 } else { half_gap.min(LABEL_SIZE * 0.8 / along[1].abs()) };
    let stroke = Stroke { ink: TEXT, width: 0.9, dash: None };
    let halves = vec![
        vec![place(from, long, 0.0), place(middle, -half_gap, 0.0)],
        vec![place(middle, half_gap, 0.0), place(to, -long, 0.0)],
    ];
    figure.path(Path::strokes(halves, stroke));
    let heads = [(from, long), (to, -long)];
    let heads = heads.map(|(tip, back)| vec![tip, place(tip, back, half), place(tip, back, -half)]);
    figure.path(Path::area(heads.to_vec(), TEXT));
    figure.text(label(text, middle));
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window { origin: [100.0, 50.0], scale: 2.0, ground: Ground::Page };

    #[test]
    fn y_is_up_and_turns_are_counter_clockwise() {
        assert_eq!(WINDOW.at([10.0, 5.0]), [120.0, 40.0]);
        let corners = turned_corners([1.0, 0.0], [4.0, 2.0], 90.0);
        let wanted = [[2.0, -2.0], [2.0, 2.0], [0.0, 2.0], [0.0, -2.0]];
        for (corner, wanted) in corners.iter().zip(wanted) {
            assert!((corner[0] - wanted[0]).hypot(corner[1] - wanted[1]) < 1e-12, "{corners:?}");
        }
    }

    #[test]
    fn a_dimension_without_length_draws_only_its_text() {
        let mut figure = Figure::new(10.0, 10.0, "");
        Shape::Dimension { from: [1.0, 1.0], to: [1.0, 1.0], text: "d".to_owned() }
            .draw(&mut figure, &WINDOW);
        assert!(
            figure.marks().is_empty() || matches!(figure.marks(), [Mark::Text(_)]),
            "{:?}",
            figure.marks()
        );
        let mut figure = Figure::new(10.0, 10.0, "");
        Shape::Dimension { from: [0.0, 0.0], to: [30.0, 0.0], text: "d".to_owned() }
            .draw(&mut figure, &WINDOW);
        assert_eq!(figure.marks().len(), 3);
    }
}
