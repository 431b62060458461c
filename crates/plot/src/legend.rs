//! Names of the series, in rows between title and chart.

use super::figure::{Figure, Path, Point, Stroke, Text};
use super::style::{HALF_DIGIT, MARGIN, NUMBER_SIZE, TEXT, mark};

const SAMPLE: f64 = 22.0;
const ENTRY_GAP: f64 = 16.0;
const ROW: f64 = 1.5 * NUMBER_SIZE;

/// A series as the legend shows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegendEntry<'s> {
    pub(super) name: &'s str,
    /// Its line, if it has one.
    pub(super) stroke: Option<Stroke>,
    /// The number of its mark, if it has marks.
    pub(super) mark: Option<usize>,
}

/// Draws the legend from its upper left corner and gives the height where it ends.
pub(super) fn draw(figure: &mut Figure, entries: &[LegendEntry<'_>], [left, top]: Point) -> f64 {
    let [mut x, mut y] = [left, top];
    let mut rows = 0.0;
    for entry in entries {
        let name = Text::new(entry.name, [x, y], NUMBER_SIZE, TEXT);
        let width = SAMPLE + 5.0 + name.width();
        if x > left && x + width > figure.size()[0] - MARGIN {
            [x, y] = [left, y + ROW];
        }
        rows = y - top + ROW;
        entry.draw(figure, [x, y + 0.5 * ROW]);
        x += width + ENTRY_GAP;
    }
    top + rows
}

impl LegendEntry<'_> {
    fn draw(&self, figure: &mut Figure, [x, middle]: Point) {
        if let Some(stroke) = self.stroke {
            figure.path(Path::strokes(vec![vec![[x, middle], [x + SAMPLE, middle]]], stroke));
        }
        if let Some(index) = self.mark {
            figure.add(mark([x + 0.5 * SAMPLE, middle], index));
        }
        let at = [x + SAMPLE + 5.0, middle + HALF_DIGIT * NUMBER_SIZE];
        figure.text(Text::new(self.name, at, NUMBER_SIZE, TEXT));
    }
}
