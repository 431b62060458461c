//! Marching squares: where a function on a grid is at least as large as a level.
//!
//! Source: W. Lorensen and H. Cline, "Marching cubes", 1987, in two dimensions; a saddle is joined if the mean of
//! its corners reaches the level. The grid is framed by nodes of value −∞, and a hole counts as −∞ too, so that
//! every border is a closed loop.

use super::figure::Point;
use super::grid::Grid;

/// A corner of a border.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Crossing {
    at: Point,
    /// Whether it lies at the edge of the grid or of a hole instead of between two values.
    edge: bool,
}

/// The borders of the area where the function is at least `level`. Each has the area on its left if y is up; by
/// the even-odd rule they enclose it.
pub(super) fn borders(grid: &Grid, level: f64) -> Vec<Vec<Point>> {
    let loops = Framed { grid, level }.loops();
    let corners = loops.into_iter().map(|corners| corners.into_iter().map(|corner| corner.at).collect());
    corners.map(without_repeats).filter(|corners| corners.len() > 2).collect()
}

/// The lines where the function is `level`: the borders without what follows the grid's edge. A line that comes
/// back has the same first and last corner.
pub(super) fn isolines(grid: &Grid, level: f64) -> Vec<Vec<Point>> {
    let loops = Framed { grid, level }.loops();
    loops.into_iter().flat_map(|corners| parts(&corners)).collect()
}

/// Cuts a loop at the grid's edge.
fn parts(corners: &[Crossing]) -> Vec<Vec<Point>> {
    let Some(first) = corners.iter().position(|corner| corner.edge) else {
        return vec![corners.iter().chain(corners.first()).map(|corner| corner.at).collect()];
    };
    let mut turned = corners.to_vec();
    turned.rotate_left(first);
    let inside = turned.split(|corner| corner.edge).map(|part| part.iter().map(|corner| corner.at).collect());
    inside.filter(|part: &Vec<Point>| part.len() > 1).collect()
}

fn without_repeats(mut corners: Vec<Point>) -> Vec<Point> {
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    corners
}

/// A grid with a frame around it, at a level. Nodes count from the frame.
struct Framed<'a> {
    grid: &'a Grid,
    level: f64,
}

/// A node's column and row.
type Node = [usize; 2];

impl Framed<'_> {
    fn columns(&self) -> usize {
        self.grid.columns + 2
    }

    fn rows(&self) -> usize {
        self.grid.rows() + 2
    }

    /// −∞ in the frame and in holes.
    fn value(&self, [column, row]: Node) -> f64 {
        let inside = (1..=self.grid.columns).contains(&column) && (1..=self.grid.rows()).contains(&row);
        let value = inside.then(|| self.grid.values.get((row - 1) * self.grid.columns + column - 1));
        value.flatten().copied().filter(|value| value.is_finite()).unwrap_or(f64::NEG_INFINITY)
    }

    fn place(&self, [column, row]: Node) -> Point {
        let index = row.saturating_sub(1) * self.grid.columns + column.saturating_sub(1);
        self.grid.places.get(index).copied().unwrap_or([f64::NAN; 2])
    }

    fn is_inside(&self, node: Node) -> bool {
        self.value(node) >= self.level
    }

    /// The number of the edge between two neighbours, the same in both directions.
    fn edge(&self, from: Node, to: Node) -> usize {
        let first = [from[0].min(to[0]), from[1].min(to[1])];
        2 * (first[1] * self.columns() + first[0]) + usize::from(from[0] == to[0])
    }

    fn crossing(&self, inner: Node, outer: Node) -> Crossing {
        let [from, to] = [self.value(inner), self.value(outer)];
        if to == f64::NEG_INFINITY {
            return Crossing { at: self.place(inner), edge: true };
        }
        let share = (self.level - from) / (to - from);
        let [a, b] = [self.place(inner), self.place(outer)];
        Crossing { at: [0, 1].map(|k| a[k] + share * (b[k] - a[k])), edge: false }
    }

    /// Follows the borders from edge to edge.
    fn loops(&self) -> Vec<Vec<Crossing>> {
        let mut next = self.steps();
        let mut loops = Vec::new();
        for start in 0..next.len() {
            let mut corners = Vec::new();
            let mut edge = start;
            while let Some((crossing, onward)) = next.get_mut(edge).and_then(Option::take) {
                corners.push(crossing);
                edge = onward;
            }
            loops.push(corners);
        }
        loops.retain(|corners| !corners.is_empty());
        loops
    }

    /// For each edge that a border crosses, the crossing and the edge that comes next.
    fn steps(&self) -> Vec<Option<(Crossing, usize)>> {
        let mut next = vec![None; 2 * self.columns() * self.rows()];
        let cells =
            (0..self.rows() - 1).flat_map(|row| (0..self.columns() - 1).map(move |column| [column, row]));
        for [column, row] in cells {
            let corners = [[column, row], [column + 1, row], [column + 1, row + 1], [column, row + 1]];
            self.cell_steps(corners, &mut next);
        }
        next
    }

    /// Around a cell counter-clockwise, a border starts where the way leaves the area and ends where it comes back.
    fn cell_steps(&self, corners: [Node; 4], next: &mut [Option<(Crossing, usize)>]) {
        let inside = corners.map(|corner| self.is_inside(corner));
        let joined = corners.map(|corner| self.value(corner)).iter().sum::<f64>() / 4.0 >= self.level;
        let onward = if joined { [1, 2, 3] } else { [3, 2, 1] };
        for side in (0..4).filter(|&side| inside[side] && !inside[(side + 1) % 4]) {
            let back = onward.map(|step| (side + step) % 4);
            let Some(back) = back.into_iter().find(|&side| !inside[side] && inside[(side + 1) % 4]) else {
                continue;
            };
            let [inner, outer] = [corners[side], corners[(side + 1) % 4]];
            let leaves = self.edge(inner, outer);
            let returns = self.edge(corners[back], corners[(back + 1) % 4]);
            if let Some(step) = next.get_mut(leaves) {
                *step = Some((self.crossing(inner, outer), returns));
            }
        }
    }
}

/// The line with those corners left out that are nowhere farther than `tolerance` from it.
///
/// Source: D. Douglas and T. Peucker, "Algorithms for the reduction of the number of points required to represent
/// a digitized line", 1973.
pub(super) fn simplified(line: &[Point], tolerance: f64) -> Vec<Point> {
    let mut kept = vec![false; line.len()];
    let mut spans = vec![(0, line.len().saturating_sub(1))];
    while let Some((first, last)) = spans.pop() {
        for end in [first, last] {
            if let Some(kept) = kept.get_mut(end) {
                *kept = true;
            }
        }
        if let Some(middle) = farthest(line, first, last, tolerance) {
            spans.extend([(first, middle), (middle, last)]);
        }
    }
    line.iter().zip(kept).filter_map(|(point, kept)| kept.then_some(*point)).collect()
}

/// The corner between two others that is farthest from their connection, if that is more than `tolerance`.
fn farthest(line: &[Point], first: usize, last: usize, tolerance: f64) -> Option<usize> {
    let (from, to) = (*line.get(first)?, *line.get(last)?);
    let between = (first + 1..last).filter_map(|index| Some((index, distance(*line.get(index)?, from, to))));
    let worst = between.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (worst.1 > tolerance).then_some(worst.0)
}

/// From a point to a segment.
pub(super) fn distance(point: Point, from: Point, to: Point) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let off = [point[0] - from[0], point[1] - from[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = ((off[0] * along[0] + off[1] * along[1]) / squared.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (off[0] - share * along[0]).hypot(off[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Signed area, positive counter-clockwise.
    fn area(borders: &[Vec<Point>]) -> f64 {
        let doubled = |corners: &Vec<Point>| -> f64 {
            (0..corners.len())
                .map(|k| (corners[k], corners[(k + 1) % corners.len()]))
                .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
                .sum()
        };
        borders.iter().map(doubled).sum::<f64>() / 2.0
    }

    #[test]
    fn areas_above_a_level_are_those_of_rings() {
        let grid = Grid::over_disc(10.0, 81, f64::hypot);
        for level in [2.0, 5.0, 9.0] {
            let (found, wanted) = (area(&borders(&grid, level)), PI * (100.0 - level * level));
            assert!((found / wanted - 1.0).abs() < 2e-3, "{level}: {found} for {wanted}");
        }
        assert!((area(&borders(&grid, -1.0)) / (100.0 * PI) - 1.0).abs() < 1e-3);
        assert_eq!(borders(&grid, 11.0), Vec::<Vec<Point>>::new());
    }

    #[test]
    fn isolines_lie_on_their_level_and_come_back() {
        let grid = Grid::over_disc(10.0, 81, f64::hypot);
        let lines = isolines(&grid, 5.0);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        assert!(lines[0].iter().all(|point| (point[0].hypot(point[1]) - 5.0).abs() < 0.02));
        let across = isolines(&Grid::over_disc(10.0, 81, |x, _| x), 3.0);
        let [line] = across.as_slice() else { panic!("{across:?}") };
        let ends = [line[0], line[line.len() - 1]].map(|end| end[0].hypot(end[1]));
        assert!(ends.iter().all(|radius| (radius - 10.0).abs() < 0.02), "{ends:?}");
        assert!(line.iter().all(|point| (point[0] - 3.0).abs() < 1e-9));
    }

    #[test]
    fn holes_stay_empty_and_have_no_isolines() {
        let hole = |x: f64, y: f64| if x.hypot(y) < 3.0 { f64::NAN } else { 1.0 };
        let grid = Grid::over_rectangle([-5.0, 5.0], [-5.0, 5.0], [101, 101], hole);
        let borders = borders(&grid, 0.0);
        assert_eq!(borders.len(), 2);
        assert!((area(&borders) - (100.0 - 9.0 * PI)).abs() < 1.5, "{}", area(&borders));
        assert_eq!(isolines(&grid, 0.0), Vec::<Vec<Point>>::new());
    }

    #[test]
    fn a_saddle_is_cut_once() {
        let saddle = |x: f64, y: f64| x * y;
        let grid = Grid::over_rectangle([-1.0, 1.0], [-1.0, 1.0], [2, 2], saddle);
        assert_eq!(borders(&grid, 0.5).len(), 2, "the mean is below the level");
        assert_eq!(borders(&grid, -0.5).len(), 1, "the mean is above the level");
    }

    #[test]
    fn simplified_lines_stay_within_the_tolerance() {
        let line: Vec<Point> = (0..=200).map(|k| f64::from(k) * 0.05).map(|x| [x, x.sin()]).collect();
        let few = simplified(&line, 0.01);
        assert!(few.len() < 40, "{}", few.len());
        for &point in &line {
            let off = few.windows(2).map(|pair| distance(point, pair[0], pair[1])).fold(f64::MAX, f64::min);
            assert!(off <= 0.01, "{point:?} is {off} off");
        }
        assert_eq!(simplified(&[], 1.0), Vec::<Point>::new());
        assert_eq!(simplified(&[[1.0, 1.0]], 1.0), [[1.0, 1.0]]);
    }
}
