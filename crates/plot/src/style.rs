//! The look that all figures share: lengths in CSS pixels (1/96 inch), few greys.

use super::colour::Rgb;
use super::figure::{Circle, Ends, Ink, Mark, Path, Point, Stroke};

/// Text that is read first.
pub(super) const TEXT: Ink = Ink::opaque(Rgb::new(0x1f, 0x24, 0x2b));
/// Numbers at axes, notes.
pub(super) const QUIET: Ink = Ink::opaque(Rgb::new(0x52, 0x5b, 0x66));

/// Lines of axes and frames.
pub(super) const AXIS: Stroke = Stroke::solid(Rgb::new(0x7b, 0x84, 0x8f), 0.8);
/// Lines behind the values.
pub(super) const GRID: Stroke = Stroke::solid(Rgb::new(0xe6, 0xe8, 0xeb), 0.8);

pub(super) const TITLE_SIZE: f64 = 13.0;
pub(super) const LABEL_SIZE: f64 = 11.0;
pub(super) const NUMBER_SIZE: f64 = 10.0;
pub(super) const SMALL_SIZE: f64 = 8.0;

/// From the baseline to the middle of a digit, as a share of the size.
pub(super) const HALF_DIGIT: f64 = 0.36;
pub(super) const TICK: f64 = 4.0;
pub(super) const MARGIN: f64 = 12.0;
/// Half the size of a mark.
const MARK: f64 = 3.2;

/// The mark of the series with this number: disc, square, diamond, triangles, by turns, with a white rim.
pub(super) fn mark([x, y]: Point, index: usize) -> Mark {
    let (fill, stroke) = (Some(Ink::opaque(Rgb::of_series(index))), Some(Stroke::solid(Rgb::WHITE, 0.8)));
    let (corners, turn_deg, size) = match index % 5 {
        0 => return Mark::Circle(Circle { centre: [x, y], radius: MARK, fill, stroke }),
        1 => (4, 45.0, 1.2),
        2 => (4, 0.0, 1.3),
        3 => (3, -90.0, 1.35),
        _ => (3, 90.0, 1.35),
    };
    let corner = |k: i32| {
        let (sin, cos) = (f64::from(k) * 360.0 / f64::from(corners) + turn_deg).to_radians().sin_cos();
        [x + MARK * size * cos, y + MARK * size * sin]
    };
    let lines = vec![(0..corners).map(corner).collect()];
    Mark::Path(Path { lines, ends: Ends::Closed, fill, stroke })
}
