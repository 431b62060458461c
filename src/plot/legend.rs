//! Names of the series, in rows between title and chart.

use super::chart::{Series, mark};
use super::colour::Rgb;
use super::figure::{Figure, Ink, Path, Point, Text};
use super::style::{HALF_DIGIT, MARGIN, NUMBER_SIZE, TEXT};

const SAMPLE: f64 = 22.0;
const ENTRY_GAP: f64 = 16.0;
const ROW: f64 = 1.5 * NUMBER_SIZE;

/// Draws the legend from its upper left corner and gives the height where it ends.
pub(super) fn draw(figure: &mut Figure, series: &[Series], [left, top]: Point) -> f64 {
    let [mut x, mut y] = [left, top];
    let named = series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
    let mut rows = 0.0;
    for (index, series) in named {
        let name = Text::new(&series.name, [x, y], NUMBER_SIZE, TEXT);
        let width = SAMPLE + 5.0 + name.width();
        if x > left && x + width > figure.size()[0] - MARGIN {
            [x, y] = [left, y + ROW];
        }
        rows = y - top + ROW;
        draw_entry(figure, series, index, [x, y + 0.5 * ROW]);
        x += width + ENTRY_GAP;
    }
    top + rows
}

fn draw_entry(figure: &mut Figure, series: &Series, index: usize, [x, middle]: Point) {
    let ink = Ink::opaque(Rgb::of_series(index));
    if let Some(stroke) = series.look.stroke(ink) {
        figure.path(Path::strokes(vec![vec![[x, middle], [x + SAMPLE, middle]]], stroke));
    }
    if series.look.has_points() {
        figure.add(mark([x + 0.5 * SAMPLE, middle], index));
    }
    let at = [x + SAMPLE + 5.0, middle + HALF_DIGIT * NUMBER_SIZE];
    figure.text(Text::new(&series.name, at, NUMBER_SIZE, TEXT));
}
