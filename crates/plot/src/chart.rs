//! Curves and points over two axes.

use super::colour::Rgb;
use super::figure::{Anchor, Figure, Ink, Path, Point, Stroke, Text};
use super::legend::{self, LegendEntry};
use super::scale::{Axis, Scale};
use super::style::{
    AXIS, GRID, HALF_DIGIT, LABEL_SIZE, MARGIN, NUMBER_SIZE, QUIET, SMALL_SIZE, TEXT, TICK, TITLE_SIZE, mark,
};

/// Curves and points over two axes, and lines across.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Width of the page in pixels.
    pub width: f64,
    /// Height of the page in pixels.
    pub height: f64,
    /// The horizontal axis.
    pub x: Side,
    /// The vertical axis.
    pub y: Side,
    /// The curves, the later ones above.
    pub series: Vec<Series>,
    /// Limits and marks of interest.
    pub guides: Vec<GuideLine>,
}

/// An axis as the caller describes it.
#[derive(Clone, Debug)]
pub struct Side {
    /// Name and unit.
    pub label: String,
    /// How values lie on it.
    pub scale: Scale,
    /// Values that the axis shows besides those of series and guides, such as 0.
    pub also: Vec<f64>,
}

/// Values that belong together.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend; without one it has no entry.
    pub name: String,
    /// Its values.
    pub values: Vec<Value>,
    /// How they are drawn.
    pub look: SeriesLook,
}

/// A value with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// Ends of the error bar; equal to `y` if there is none.
    pub y_range: [f64; 2],
}

/// How the values of a series are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeriesLook {
    /// Connected.
    Line,
    /// Connected by dashes.
    Dashes,
    /// Connected by a wide pale line, on which others can be seen.
    Broad,
    /// Connected by thin dashes, those of the next series of another length: where curves lie on each other, each shows.
    ThinDashes,
    /// Each one by a mark.
    Points,
    /// Connected, each one with a mark.
    LineAndPoints,
}

/// A line across the chart.
#[derive(Clone, Debug)]
pub struct GuideLine {
    /// Where it is.
    pub at: GuidePlace,
    /// What is written at it.
    pub label: String,
}

/// Where a guide is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GuidePlace {
    /// Vertical, at this x.
    X(f64),
    /// Horizontal, at this y.
    Y(f64),
}

impl Value {
    /// A value without an error bar.
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y, y_range: [y, y] }
    }
}

const BOTTOM: f64 = 46.0;
const CURVE: f64 = 1.6;
const BROAD: f64 = 6.0;
const PALE: f64 = 0.3;
const THIN: f64 = 1.2;
/// Their periods have no common one that is short.
const THIN_DASHES: [[f64; 2]; 3] = [[9.0, 4.0], [5.0, 3.0], [2.0, 2.0]];
const CAP: f64 = 3.0;
const GUIDE_GAP: f64 = 4.0;

/// The chart's axes on the page.
struct Field {
    x: Axis,
    y: Axis,
}

impl Chart {
    /// The chart. Values that an axis cannot show are left out.
    pub fn figure(&self) -> Figure {
        let mut figure = Figure::new(self.width, self.height, self.title.clone());
        let title = [MARGIN, MARGIN + TITLE_SIZE];
        figure.text(Text::new(&self.title, title, TITLE_SIZE, TEXT).semi_bold());
        let top = MARGIN + if self.title.is_empty() { 0.0 } else { 2.0 * TITLE_SIZE };
        let top = legend::draw(&mut figure, &self.legend(), [MARGIN, top]);
        let field = self.field(top + NUMBER_SIZE);
        self.draw_axes(&mut figure, &field);
        let curves: Vec<Point> = self.series.iter().flat_map(|series| series.covered(&field)).collect();
        self.guides.iter().for_each(|guide| guide.draw(&mut figure, &field, &curves));
        for (index, series) in self.series.iter().enumerate() {
            series.draw(&mut figure, &field, index);
        }
        figure
    }

    /// The named series, with the numbers that give them their colours and marks.
    fn legend(&self) -> Vec<LegendEntry<'_>> {
        let named = self.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
        named.map(|(index, series)| series.entry(index)).collect()
    }

    fn field(&self, top: f64) -> Field {
        let values = || self.series.iter().flat_map(|series| &series.values);
        let guides = || self.guides.iter().map(|guide| guide.at);
        let guides_x = guides().filter_map(|at| if let GuidePlace::X(x) = at { Some(x) } else { None });
        let guides_y = guides().filter_map(|at| if let GuidePlace::Y(y) = at { Some(y) } else { None });
        let xs = values().map(|value| value.x).chain(guides_x).chain(self.x.also.iter().copied());
        let ys = values().flat_map(|value| [value.y, value.y_range[0], value.y_range[1]]);
        let ys = ys.chain(guides_y).chain(self.y.also.iter().copied());
        let axis = |side: &Side, span, page| Axis { scale: side.scale, span, page };
        let y = axis(&self.y, self.y.scale.span(ys), [self.height - BOTTOM, top]);
        let widest = y.ticks().iter().map(|tick| number(&tick.label, [0.0; 2]).width()).fold(0.0, f64::max);
        let left = MARGIN + 1.8 * LABEL_SIZE + widest + TICK + 3.0;
        Field { x: axis(&self.x, self.x.scale.span(xs), [left, self.width - 1.5 * MARGIN]), y }
    }

    fn draw_axes(&self, figure: &mut Figure, field: &Field) {
        let [[left, right], [bottom, top]] = [field.x.page, field.y.page];
        let [mut grid, mut ticks] = [Vec::new(), vec![vec![[left, top], [left, bottom], [right, bottom]]]];
        for tick in field.x.ticks() {
            let x = field.x.at(tick.value);
            let labelled = !tick.label.is_empty();
            grid.extend(labelled.then(|| vec![[x, bottom], [x, top]]));
            ticks.push(vec![[x, bottom], [x, bottom + if labelled { TICK } else { 0.5 * TICK }]]);
            let below = [x, bottom + TICK + 1.2 * NUMBER_SIZE];
            figure.text(number(&tick.label, below).anchored(Anchor::Middle));
        }
        for tick in field.y.ticks() {
            let y = field.y.at(tick.value);
            let labelled = !tick.label.is_empty();
            grid.extend(labelled.then(|| vec![[left, y], [right, y]]));
            ticks.push(vec![[left, y], [left - if labelled { TICK } else { 0.5 * TICK }, y]]);
            let beside = [left - TICK - 3.0, y + HALF_DIGIT * NUMBER_SIZE];
            figure.text(number(&tick.label, beside).anchored(Anchor::End));
        }
        figure.path(Path::strokes(grid, GRID));
        figure.path(Path::strokes(ticks, AXIS));
        let below = [0.5 * (left + right), self.height - MARGIN];
        figure.text(Text::new(&self.x.label, below, LABEL_SIZE, TEXT).anchored(Anchor::Middle));
        let beside = [MARGIN + 0.6 * LABEL_SIZE, 0.5 * (top + bottom)];
        let name = Text::new(&self.y.label, beside, LABEL_SIZE, TEXT).anchored(Anchor::Middle);
        figure.text(name.turned(-90.0));
    }
}

fn number(label: &str, at: Point) -> Text {
    Text::new(label, at, NUMBER_SIZE, QUIET)
}

impl GuideLine {
    /// Its label stands at the end that is farther from all curves.
    fn draw(&self, figure: &mut Figure, field: &Field, curves: &[Point]) {
        let [[left, right], [bottom, top]] = [field.x.page, field.y.page];
        let size = SMALL_SIZE + 1.0;
        let half = 0.5 * Text::new(&self.label, [0.0; 2], size, QUIET).width() + GUIDE_GAP;
        let (line, turn_deg, ends) = match self.at {
            GuidePlace::X(x) => {
                let x = field.x.at(x);
                let ends = [top + half, bottom - half].map(|y| [x - GUIDE_GAP, y]);
                (vec![[x, bottom], [x, top]], -90.0, ends)
            }
            GuidePlace::Y(y) => {
                let y = field.y.at(y);
                let ends = [right - half, left + half].map(|x| [x, y - GUIDE_GAP]);
                (vec![[left, y], [right, y]], 0.0, ends)
            }
        };
        let clear =
            |[x, y]: Point| curves.iter().map(|at| (at[0] - x).hypot(at[1] - y)).fold(f64::MAX, f64::min);
        let at = if clear(ends[0]) >= clear(ends[1]) { ends[0] } else { ends[1] };
        figure.path(Path::strokes(vec![line], Stroke { ink: QUIET, width: 0.9, dash: Some([2.0, 2.0]) }));
        figure.text(Text::new(&self.label, at, size, QUIET).anchored(Anchor::Middle).turned(turn_deg));
    }
}

impl Series {
    /// How the legend shows it as the series with this number.
    fn entry(&self, index: usize) -> LegendEntry<'_> {
        let stroke = self.look.stroke(index);
        LegendEntry { name: &self.name, stroke, mark: self.look.has_points().then_some(index) }
    }

    /// Places along the curve and at the ends of the error bars.
    fn covered(&self, field: &Field) -> Vec<Point> {
        let place = |x: f64, y: f64| [field.x.at(x), field.y.at(y)];
        let corners: Vec<Point> = self.values.iter().map(|value| place(value.x, value.y)).collect();
        let bars = self.values.iter().flat_map(|value| value.y_range.map(|y| place(value.x, y)));
        let between = corners.windows(2).flat_map(|pair| {
            let [a, b] = [pair[0], pair[1]];
            (0..10).map(move |k| [0, 1].map(|axis| a[axis] + f64::from(k) / 10.0 * (b[axis] - a[axis])))
        });
        between.chain(bars).collect()
    }

    fn draw(&self, figure: &mut Figure, field: &Field, index: usize) {
        let ink = Ink::opaque(Rgb::of_series(index));
        let place = |x: f64, y: f64| [field.x.at(x), field.y.at(y)];
        let line: Vec<Point> = self.values.iter().map(|value| place(value.x, value.y)).collect();
        let ranged = self.values.iter().filter(|value| value.y_range != [value.y, value.y]);
        let bars = ranged.map(|value| value.y_range.map(|y| place(value.x, y)));
        figure
            .path(Path::strokes(bars.flat_map(error_bar).collect(), Stroke { ink, width: 1.0, dash: None }));
        if let Some(stroke) = self.look.stroke(index) {
            figure.path(Path::strokes(vec![line.clone()], stroke));
        }
        if self.look.has_points() {
            let marks = line.into_iter().filter(|at| at.iter().all(|coordinate| coordinate.is_finite()));
            marks.for_each(|at| figure.add(mark(at, index)));
        }
    }
}

impl SeriesLook {
    /// Its line as the series with this number.
    fn stroke(self, index: usize) -> Option<Stroke> {
        let ink = Ink::opaque(Rgb::of_series(index));
        let line = Stroke { ink, width: CURVE, dash: None };
        match self {
            Self::Line | Self::LineAndPoints => Some(line),
            Self::Dashes => Some(line.dashed(5.0, 3.0)),
            Self::Broad => Some(Stroke { ink: Ink { opacity: PALE, ..ink }, width: BROAD, dash: None }),
            Self::ThinDashes => {
                let [dash, gap] = THIN_DASHES[index % THIN_DASHES.len()];
                Some(Stroke { width: THIN, ..line }.dashed(dash, gap))
            }
            Self::Points => None,
        }
    }

    fn has_points(self) -> bool {
        matches!(self, Self::Points | Self::LineAndPoints)
    }
}

/// A bar with a cap at both ends.
fn error_bar([from, to]: [Point; 2]) -> [Vec<Point>; 3] {
    let cap = |[x, y]: Point| vec![[x - CAP, y], [x + CAP, y]];
    [vec![from, to], cap(from), cap(to)]
}
