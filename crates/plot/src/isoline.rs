//! Isolines with numbers on them.

use super::bands::Bands;
use super::colour::Rgb;
use super::contour::{distance, isolines, simplified};
use super::figure::{Anchor, Figure, Ink, Path, Point, Stroke, Text};
use super::grid::Grid;
use super::shape::Window;
use super::style::{HALF_DIGIT, SMALL_SIZE, TEXT};

/// What is drawn where a field passes from one band to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isolines {
    /// Nothing but the colours.
    None,
    /// A thin line.
    Plain,
    /// A thin line with its value.
    Labelled,
}

/// Lines may leave their true way by this much, in pixels.
pub(super) const TOLERANCE: f64 = 0.05;
const WIDTH: f64 = 0.6;
/// Clear space around a label, in pixels.
const CLEAR: f64 = 3.0;
/// A label bends its line no more than this: chord by arc.
const STRAIGHT: f64 = 0.96;
/// What distance from a line's middle counts against straightness.
const OFF_MIDDLE: f64 = 0.02;
/// Labels keep this many times their length from each other.
const APART: f64 = 1.6;
/// Length of a line without its label, in labels.
const ROOM: f64 = 3.0;
/// Other lines keep this far from the middle of a label's digits, in pixels.
const HALF_HEIGHT: f64 = 5.0;
/// Below this luminance lines are white.
const DARK: f64 = 0.2;

/// A label that has found its place.
struct PositionedLabel {
    middle: Point,
    length: f64,
}

/// The isolines at all inner edges of the bands of a field.
pub(super) struct Layer<'a> {
    pub(super) grid: &'a Grid,
    pub(super) bands: &'a Bands,
    pub(super) window: &'a Window,
    pub(super) isolines: Isolines,
    /// Lines on the page that labels keep clear of.
    pub(super) obstacles: Vec<Vec<Point>>,
}

/// The lines of one level.
struct Level<'a> {
    lines: Vec<Vec<Point>>,
    ink: Ink,
    label: &'a str,
}

impl Layer<'_> {
    pub(super) fn draw(&self, figure: &mut Figure) {
        if self.isolines == Isolines::None {
            return;
        }
        let levels: Vec<Level> = self.levels().collect();
        let mut placed = Vec::new();
        for (index, level) in levels.iter().enumerate() {
            let others = levels.iter().enumerate().filter(|(other, _)| *other != index);
            let others = others.flat_map(|(_, other)| &other.lines).chain(&self.obstacles);
            let others: Vec<&[Point]> = others.map(Vec::as_slice).collect();
            let parts = level.lines.iter().flat_map(|line| level.write(figure, line, &others, &mut placed));
            let faint = Ink { opacity: 0.55, ..level.ink };
            let parts = parts.collect();
            figure.path(Path::strokes(parts, Stroke { ink: faint, width: WIDTH, dash: None }));
        }
    }

    fn levels(&self) -> impl Iterator<Item = Level<'_>> {
        let label =
            |index: usize| self.bands.labels.get(index).filter(|_| self.isolines == Isolines::Labelled);
        self.bands.inner_edges().map(move |(index, edge, colours)| {
            let lines = isolines(self.grid, edge).into_iter();
            let mut lines: Vec<_> =
                lines.map(|line| simplified(&self.window.line(&line), TOLERANCE)).collect();
            // The longest ones choose first.
            lines.sort_by(|a, b| length(b).total_cmp(&length(a)));
            Level { lines, ink: ink_over(colours), label: label(index).map_or("", String::as_str) }
        })
    }
}

/// Dark over light colours, white over dark ones.
fn ink_over(colours: [Rgb; 2]) -> Ink {
    let darkest = colours.map(Rgb::luminance).into_iter().fold(1.0, f64::min);
    if darkest < DARK { Ink::opaque(Rgb::WHITE) } else { TEXT }
}

impl Level<'_> {
    /// Writes the label on the line where there is room; gives the parts of the line that are left to draw.
    fn write(
        &self,
        figure: &mut Figure,
        line: &[Point],
        others: &[&[Point]],
        placed: &mut Vec<PositionedLabel>,
    ) -> Vec<Vec<Point>> {
        let mut text = Text::new(self.label, [0.0; 2], SMALL_SIZE, self.ink).anchored(Anchor::Middle);
        let needed = text.width() + 2.0 * CLEAR;
        let is_free = |[a, b]: [Point; 2]| {
            let apart =
                |label: &PositionedLabel| far(middle(a, b), label.middle, APART * label.length.max(needed));
            placed.iter().all(apart) && [a, middle(a, b), b].into_iter().all(|at| is_clear(at, others))
        };
        let place = straightest(line, needed, is_free).filter(|_| !self.label.is_empty());
        let Some(from) = place else { return vec![line.to_vec()] };
        let [a, b] = [from, from + needed].map(|s| at_length(line, s));
        text.turn_deg = upright((b[1] - a[1]).atan2(b[0] - a[0]).to_degrees());
        let (sin, cos) = text.turn_deg.to_radians().sin_cos();
        let (below, [x, y]) = (HALF_DIGIT * SMALL_SIZE, middle(a, b));
        text.at = [x - sin * below, y + cos * below];
        figure.text(text);
        placed.push(PositionedLabel { middle: [x, y], length: needed });
        vec![part(line, 0.0, from), part(line, from + needed, length(line))]
    }
}

/// Where on the line a stretch of this length begins that is free and has the least bend, as a length along the
/// line; `None` if there is none that is straight enough.
fn straightest(line: &[Point], needed: f64, is_free: impl Fn([Point; 2]) -> bool) -> Option<f64> {
    let room = length(line) - needed;
    if room < ROOM * needed {
        return None;
    }
    let steps = (room / 2.0).ceil().max(1.0);
    let starts = (1..steps as usize).map(|step| room * step as f64 / steps);
    let stretches = starts.filter_map(|from| {
        let [a, b] = [from, from + needed].map(|s| at_length(line, s));
        let straight = (b[0] - a[0]).hypot(b[1] - a[1]) / needed;
        let off_middle = (from / room - 0.5).abs();
        (straight > STRAIGHT && is_free([a, b])).then_some((straight - OFF_MIDDLE * off_middle, from))
    });
    stretches.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, from)| from)
}

fn middle(a: Point, b: Point) -> Point {
    [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]
}

/// Whether a label's part at this place touches none of the lines.
fn is_clear(at: Point, lines: &[&[Point]]) -> bool {
    let segments = lines.iter().flat_map(|line| line.windows(2));
    segments
        .filter_map(|pair| <[Point; 2]>::try_from(pair).ok())
        .all(|[from, to]| distance(at, from, to) > HALF_HEIGHT)
}

fn far(a: Point, b: Point, distance: f64) -> bool {
    (a[0] - b[0]).hypot(a[1] - b[1]) > distance
}

/// Text is never upside down, and along steep lines it reads upwards, so that neighbours read alike.
fn upright(turn_deg: f64) -> f64 {
    match turn_deg {
        turn if turn > 80.0 => turn - 180.0,
        turn if turn <= -100.0 => turn + 180.0,
        turn => turn,
    }
}

fn lengths(line: &[Point]) -> impl Iterator<Item = f64> {
    line.windows(2).map(|pair| match pair {
        [a, b] => (b[0] - a[0]).hypot(b[1] - a[1]),
        _ => 0.0,
    })
}

fn length(line: &[Point]) -> f64 {
    lengths(line).sum()
}

fn at_length(line: &[Point], wanted: f64) -> Point {
    let mut left = wanted;
    for (pair, length) in line.windows(2).zip(lengths(line)) {
        if left <= length && length > 0.0 {
            let share = left.max(0.0) / length;
            return [0, 1].map(|k| pair[0][k] + share * (pair[1][k] - pair[0][k]));
        }
        left -= length;
    }
    line.last().copied().unwrap_or([f64::NAN; 2])
}

/// The line from one length along it to another.
fn part(line: &[Point], from: f64, to: f64) -> Vec<Point> {
    let mut corners = vec![at_length(line, from)];
    let mut s = 0.0;
    for (corner, length) in line.iter().skip(1).zip(lengths(line)) {
        s += length;
        if s > from && s < to {
            corners.push(*corner);
        }
    }
    corners.push(at_length(line, to));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_lengths_of_a_line() {
        let line = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]];
        assert_eq!(length(&line), 7.0);
        assert_eq!(at_length(&line, 5.0), [3.0, 2.0]);
        assert_eq!(part(&line, 1.0, 5.0), [[1.0, 0.0], [3.0, 0.0], [3.0, 2.0]]);
        assert_eq!(at_length(&line, 99.0), [3.0, 4.0]);
    }

    #[test]
    fn a_label_takes_the_straight_stretch() {
        let bend = (0..=30).map(|k| f64::from(k) / 10.0).map(|t| [20.0 * t.cos() - 20.0, 20.0 * t.sin()]);
        let mut line: Vec<Point> = bend.collect();
        let [x, y] = line[line.len() - 1];
        line.push([x, y - 100.0]);
        let from = straightest(&line, 20.0, |_| true).unwrap();
        assert!(from >= 55.0 && from + 20.0 < length(&line), "{from}");
        assert!(straightest(&line[..20], 20.0, |_| true).is_none(), "too short and too bent");
        let below = |[a, _]: [Point; 2]| a[1] < -40.0;
        let from = straightest(&line, 20.0, below).unwrap();
        assert!(at_length(&line, from)[1] < -40.0);
        assert!(straightest(&line, 20.0, |_| false).is_none());
    }

    #[test]
    fn labels_read_upright() {
        assert_eq!([170.0, -170.0, 45.0, -90.0, 89.0].map(upright), [-10.0, 10.0, 45.0, -90.0, -91.0]);
    }
}
