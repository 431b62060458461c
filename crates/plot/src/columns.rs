//! Columns from zero, side by side, each with its number.

use super::colour::Rgb;
use super::figure::{Anchor, Figure, Ink, Path, Stroke, Text};
use super::scale::{Axis, Scale};
use super::style::{AXIS, GRID, HALF_DIGIT, LABEL_SIZE, MARGIN, NUMBER_SIZE, QUIET, TEXT, TICK, TITLE_SIZE};

/// Columns over one axis.
#[derive(Clone, Debug)]
pub struct Columns {
    /// What they show.
    pub title: String,
    /// Width of the page in pixels.
    pub width: f64,
    /// Height of the page in pixels.
    pub height: f64,
    /// Name and unit of the vertical axis.
    pub y_label: String,
    /// From left to right.
    pub columns: Vec<Column>,
}

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Below it.
    pub name: String,
    /// Its height.
    pub value: f64,
    /// Ends of the error bar; equal to `value` if there is none.
    pub range: [f64; 2],
    /// Above it.
    pub label: String,
}

const BOTTOM: f64 = 34.0;
/// Of a column's place.
const COLUMN_SHARE: f64 = 0.55;
const CAP: f64 = 5.0;

impl Columns {
    /// The columns. Values that are not finite are left out.
    pub fn figure(&self) -> Figure {
        let mut figure = Figure::new(self.width, self.height, self.title.clone());
        let title = [MARGIN, MARGIN + TITLE_SIZE];
        figure.text(Text::new(&self.title, title, TITLE_SIZE, TEXT).semi_bold());
        let top = MARGIN + 2.0 * TITLE_SIZE + NUMBER_SIZE;
        let ends = self.columns.iter().flat_map(|column| [column.value, column.range[0], column.range[1]]);
        let span = Scale::Linear.span(ends.chain([0.0]));
        let y = Axis { scale: Scale::Linear, span, page: [self.height - BOTTOM, top] };
        let left = self.draw_axis(&mut figure, &y);
        let pitch = (self.width - MARGIN - left) / self.columns.len().max(1) as f64;
        for (index, column) in self.columns.iter().enumerate() {
            let middle = left + (index as f64 + 0.5) * pitch;
            column.draw(&mut figure, &y, middle, COLUMN_SHARE * pitch, index);
        }
        figure
    }

    /// Draws the vertical axis and gives its place.
    fn draw_axis(&self, figure: &mut Figure, y: &Axis) -> f64 {
        let ticks = y.ticks();
        let number = |label: &str, at| Text::new(label, at, NUMBER_SIZE, QUIET);
        let widest = ticks.iter().map(|tick| number(&tick.label, [0.0; 2]).width()).fold(0.0, f64::max);
        let left = MARGIN + 1.8 * LABEL_SIZE + widest + TICK + 3.0;
        let right = self.width - MARGIN;
        for tick in ticks.iter().filter(|tick| !tick.label.is_empty()) {
            let at = y.at(tick.value);
            figure.path(Path::strokes(vec![vec![[left, at], [right, at]]], GRID));
            figure.path(Path::strokes(vec![vec![[left - TICK, at], [left, at]]], AXIS));
            let beside = [left - TICK - 3.0, at + HALF_DIGIT * NUMBER_SIZE];
            figure.text(number(&tick.label, beside).anchored(Anchor::End));
        }
        let zero = y.at(0.0);
        let lines = vec![vec![[left, y.page[1]], [left, y.page[0]]], vec![[left, zero], [right, zero]]];
        figure.path(Path::strokes(lines, AXIS));
        let beside = [MARGIN + 0.6 * LABEL_SIZE, 0.5 * (y.page[0] + y.page[1])];
        let name = Text::new(&self.y_label, beside, LABEL_SIZE, TEXT).anchored(Anchor::Middle);
        figure.text(name.turned(-90.0));
        left
    }
}

impl Column {
    fn draw(&self, figure: &mut Figure, y: &Axis, middle: f64, width: f64, index: usize) {
        if !self.value.is_finite() {
            return;
        }
        let [zero, end] = [0.0, self.value].map(|value| y.at(value));
        let fill = Some(Ink::opaque(Rgb::of_series(index)));
        let corner = [middle - 0.5 * width, zero.min(end)];
        figure.path(Path { fill, ..Path::rectangle(corner, [width, (zero - end).abs()]) });
        let [low, high] = self.range.map(|value| y.at(value));
        if self.range != [self.value; 2] {
            let cap = |y: f64| vec![[middle - CAP, y], [middle + CAP, y]];
            let bar = vec![vec![[middle, low], [middle, high]], cap(low), cap(high)];
            figure.path(Path::strokes(bar, Stroke { ink: TEXT, width: 1.1, dash: None }));
        }
        let above = [middle, end.min(high) - 6.0];
        figure.text(Text::new(&self.label, above, LABEL_SIZE, TEXT).anchored(Anchor::Middle).semi_bold());
        let below = [middle, y.page[0] + 1.5 * LABEL_SIZE];
        figure.text(Text::new(&self.name, below, LABEL_SIZE, TEXT).anchored(Anchor::Middle));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Mark;

    fn column(name: &str, value: f64, half: f64) -> Column {
        Column { name: name.into(), value, range: [value - half, value + half], label: format!("{value}") }
    }

    #[test]
    fn heights_are_the_values() {
        let columns = vec![column("a", 2.0, 0.0), column("b", 4.0, 1.0)];
        let chart =
            Columns { title: String::new(), width: 300.0, height: 200.0, y_label: "N".into(), columns };
        let figure = chart.figure();
        let heights: Vec<f64> = figure
            .marks()
            .iter()
            .filter_map(|mark| match mark {
                Mark::Path(path) if path.fill.is_some() => Some(path.lines[0][2][1] - path.lines[0][0][1]),
                _ => None,
            })
            .collect();
        assert_eq!(heights.len(), 2);
        assert!((heights[1] / heights[0] - 2.0).abs() < 1e-9, "{heights:?}");
    }

    #[test]
    fn without_columns_or_numbers_there_is_a_frame() {
        for columns in [vec![], vec![column("a", f64::NAN, 0.0)]] {
            let chart =
                Columns { title: "t".into(), width: 300.0, height: 200.0, y_label: "N".into(), columns };
            let fills = |mark: &&Mark| matches!(mark, Mark::Path(path) if path.fill.is_some());
            assert_eq!(chart.figure().marks().iter().filter(fills).count(), 0);
        }
    }
}
