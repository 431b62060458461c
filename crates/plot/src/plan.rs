//! A plan view: a field over the plate or a film, with outlines, seen from above at one scale in x and y.

use super::bands::Bands;
use super::colour_bar::ColourBar;
use super::contour::{borders, simplified};
use super::figure::{Anchor, Circle, Figure, Ink, Mark, Path, Point, Text};
use super::grid::{Edge, Grid};
use super::isoline::{self, Isolines};
use super::scale::linear_ticks;
use super::shape::{Ground, Shape, Window};
use super::style::{AXIS, HALF_DIGIT, LABEL_SIZE, MARGIN, NUMBER_SIZE, QUIET, TEXT, TICK, TITLE_SIZE};

/// What is seen from above.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What it shows.
    pub title: String,
    /// Least and greatest x.
    pub x: [f64; 2],
    /// Least and greatest y.
    pub y: [f64; 2],
    /// Name and unit of x, under its axis.
    pub x_label: String,
    /// Name and unit of y, beside its axis.
    pub y_label: String,
    /// The colours, if there are any.
    pub field: Option<Field>,
    /// What is drawn above them, the later ones above.
    pub shapes: Vec<Shape>,
}

/// A function's values with their colours.
#[derive(Clone, Debug)]
pub struct Field {
    /// The values.
    pub grid: Grid,
    /// Their colours.
    pub bands: Bands,
    /// What is drawn between two colours.
    pub isolines: Isolines,
    /// Name and unit of the values, at the colour bar.
    pub label: String,
}

/// Ticks along the shorter side.
const STEPS: f64 = 6.0;
const BAR_WIDTH: f64 = 12.0;
const BAR_HEIGHT_MAX: f64 = 320.0;
const BAR_GAP: f64 = 22.0;
const AXIS_GAP: f64 = 6.0;
const LEFT: f64 = 52.0;
const BOTTOM: f64 = 48.0;

impl Plan {
    /// The plan with axes and, if there is a field, its colour bar; `width` is that of the page in pixels.
    ///
    /// The height follows from the plan's sides. A plan without extent is an empty page.
    pub fn figure(&self, width: f64) -> Figure {
        let bar = self
            .field
            .as_ref()
            .map_or(0.0, |field| BAR_GAP + ColourBar::taken(&field.bands, BAR_WIDTH, NUMBER_SIZE));
        let top = MARGIN + if self.title.is_empty() { LABEL_SIZE } else { 2.2 * TITLE_SIZE };
        let panel = width - LEFT - bar - MARGIN;
        let height = self.height(panel);
        let mut figure = Figure::new(width, top + height + BOTTOM, self.title.clone());
        let title = [MARGIN, MARGIN + TITLE_SIZE];
        figure.text(Text::new(&self.title, title, TITLE_SIZE, TEXT).semi_bold());
        let window = self.window([LEFT, top], panel);
        self.draw(&mut figure, &window);
        self.draw_axes(&mut figure, &window);
        if let Some(Field { bands, label, .. }) = &self.field {
            // The bar's name needs the space over it.
            let inset = 2.0 * LABEL_SIZE;
            let bar_height = (height - inset).min(BAR_HEIGHT_MAX);
            let at = [LEFT + panel + BAR_GAP, top + inset + 0.5 * (height - inset - bar_height)];
            ColourBar { bands, label, at, width: BAR_WIDTH, height: bar_height, size: NUMBER_SIZE }
                .draw(&mut figure);
        }
        figure
    }

    /// The height of a panel of this width.
    pub(super) fn height(&self, width: f64) -> f64 {
        width * (self.y[1] - self.y[0]) / (self.x[1] - self.x[0])
    }

    /// The plan's place on the page by its upper left corner and width.
    pub(super) fn window(&self, [left, top]: [f64; 2], width: f64) -> Window {
        let scale = width / (self.x[1] - self.x[0]);
        let ground = if self.field.is_some() { Ground::Field } else { Ground::Page };
        Window { origin: [left - scale * self.x[0], top + scale * self.y[1]], scale, ground }
    }

    /// Field and shapes without axes.
    pub(super) fn draw(&self, figure: &mut Figure, window: &Window) {
        if let Some(field) = &self.field {
            let obstacles = self.shapes.iter().flat_map(|shape| shape.lines(window)).collect();
            field.draw(figure, window, obstacles);
        }
        self.shapes.iter().for_each(|shape| shape.draw(figure, window));
    }

    fn draw_axes(&self, figure: &mut Figure, window: &Window) {
        let [[left, bottom], [right, top]] =
            [window.at([self.x[0], self.y[0]]), window.at([self.x[1], self.y[1]])];
        let shorter = (self.x[1] - self.x[0]).min(self.y[1] - self.y[0]);
        let steps = |[low, high]: [f64; 2]| STEPS * (high - low) / shorter;
        let [x_axis, y_axis] = [bottom + AXIS_GAP, left - AXIS_GAP];
        let mut lines = vec![vec![[left, x_axis], [right, x_axis]], vec![[y_axis, bottom], [y_axis, top]]];
        for tick in linear_ticks(self.x, steps(self.x)) {
            let x = window.at([tick.value, 0.0])[0];
            lines.push(vec![[x, x_axis], [x, x_axis + TICK]]);
            let below = [x, x_axis + TICK + 1.2 * NUMBER_SIZE];
            figure.text(Text::new(tick.label, below, NUMBER_SIZE, QUIET).anchored(Anchor::Middle));
        }
        for tick in linear_ticks(self.y, steps(self.y)) {
            let y = window.at([0.0, tick.value])[1];
            lines.push(vec![[y_axis - TICK, y], [y_axis, y]]);
            let beside = [y_axis - TICK - 3.0, y + HALF_DIGIT * NUMBER_SIZE];
            figure.text(Text::new(tick.label, beside, NUMBER_SIZE, QUIET).anchored(Anchor::End));
        }
        figure.path(Path::strokes(lines, AXIS));
        let below = [0.5 * (left + right), bottom + BOTTOM - MARGIN];
        figure.text(Text::new(&self.x_label, below, LABEL_SIZE, TEXT).anchored(Anchor::Middle));
        let beside = [MARGIN + 0.5 * LABEL_SIZE, 0.5 * (top + bottom)];
        let name = Text::new(&self.y_label, beside, LABEL_SIZE, TEXT).anchored(Anchor::Middle);
        figure.text(name.turned(-90.0));
    }
}

impl Field {
    fn draw(&self, figure: &mut Figure, window: &Window, obstacles: Vec<Vec<Point>>) {
        self.paint(figure, window);
        let Self { grid, bands, isolines, .. } = self;
        isoline::Layer { grid, bands, window, isolines: *isolines, obstacles }.draw(figure);
        let outline = match self.grid.edge {
            Edge::Disc { radius } => Mark::Circle(Circle {
                centre: window.origin,
                radius: radius * window.scale,
                fill: None,
                stroke: Some(AXIS),
            }),
            Edge::Rectangle { x, y } => {
                let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
                let around = Path::area(vec![window.line(&corners)], TEXT);
                Mark::Path(Path { fill: None, stroke: Some(AXIS), ..around })
            }
        };
        figure.add(outline);
    }

    /// Each colour over everything that is at least as large, so that no gap shows between bands.
    fn paint(&self, figure: &mut Figure, window: &Window) {
        let lowest = self.bands.colours.first().map(|&colour| (f64::MIN, colour));
        let higher = self.bands.inner_edges().map(|(_, edge, [_, above])| (edge, above));
        let least = self.grid.span().map_or(f64::MAX, |[least, _]| least);
        let mut levels: Vec<_> = lowest.into_iter().chain(higher).collect();
        // Of the levels that everything reaches only the last one is seen.
        let covered = levels.iter().filter(|(edge, _)| *edge <= least).count();
        levels.drain(..covered.saturating_sub(1));
        for (edge, colour) in levels {
            let lines = borders(&self.grid, edge);
            let lines = lines.into_iter().map(|line| simplified(&window.line(&line), isoline::TOLERANCE));
            figure.path(Path::area(lines.collect(), Ink::opaque(colour)));
        }
    }
}
