//! A function's values at the nodes of a grid over a disc or a rectangle.

use std::f64::consts::FRAC_1_SQRT_2;

use super::scale;

/// Nodes along one side; more would cost time and show nothing.
const NODES_MAX: usize = 1000;

/// Places and values, row by row. A value that is not finite leaves a hole.
#[derive(Clone, Debug)]
pub struct Grid {
    pub(super) columns: usize,
    pub(super) places: Vec<[f64; 2]>,
    pub(super) values: Vec<f64>,
    pub(super) edge: Edge,
}

/// The outline of the area that a grid covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Edge {
    /// Around the origin.
    Disc {
        /// Its radius.
        radius: f64,
    },
    /// Sides along the axes.
    Rectangle {
        /// Least and greatest x.
        x: [f64; 2],
        /// Least and greatest y.
        y: [f64; 2],
    },
}

impl Grid {
    /// `nodes` × `nodes` values of `value(x, y)` over the disc of this radius around the origin.
    ///
    /// The outer nodes lie on the rim. Source of the way from square to disc, x = u √(1 − v²/2) and likewise y:
    /// P. Nowell, "Mapping a square to a circle", 2005.
    pub fn over_disc(radius: f64, nodes: usize, value: impl FnMut(f64, f64) -> f64) -> Self {
        let place = |u: f64, v: f64| {
            let [u, v] = [2.0 * u - 1.0, 2.0 * v - 1.0];
            let narrowed = |across: f64| (1.0 - 0.5 * across * across).sqrt().max(FRAC_1_SQRT_2);
            [radius * u * narrowed(v), radius * v * narrowed(u)]
        };
        Self::over(Edge::Disc { radius }, [nodes, nodes], place, value)
    }

    /// Values of `value(x, y)` at `nodes` = columns and rows of nodes over a rectangle, its edge included.
    pub fn over_rectangle(
        x: [f64; 2],
        y: [f64; 2],
        nodes: [usize; 2],
        value: impl FnMut(f64, f64) -> f64,
    ) -> Self {
        let place = |u: f64, v: f64| [x[0] + u * (x[1] - x[0]), y[0] + v * (y[1] - y[0])];
        Self::over(Edge::Rectangle { x, y }, nodes, place, value)
    }

    /// `place` maps the unit square to the area. There are at least two nodes along a side.
    fn over(
        edge: Edge,
        nodes: [usize; 2],
        place: impl Fn(f64, f64) -> [f64; 2],
        mut value: impl FnMut(f64, f64) -> f64,
    ) -> Self {
        let [columns, rows] = nodes.map(|count| count.clamp(2, NODES_MAX));
        let share = |index: usize, count: usize| index as f64 / (count - 1) as f64;
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let places: Vec<_> = nodes.map(|(u, v)| place(share(u, columns), share(v, rows))).collect();
        let values = places.iter().map(|&[x, y]| value(x, y)).collect();
        Self { columns, places, values, edge }
    }

    /// Least and greatest finite value; `None` without one.
    pub fn span(&self) -> Option<[f64; 2]> {
        scale::span_of(self.values.iter().copied())
    }

    /// Greatest magnitude of a finite value; 0 without one.
    pub fn largest(&self) -> f64 {
        self.span().map_or(0.0, |[low, high]| high.max(-low))
    }

    pub(super) fn rows(&self) -> usize {
        self.values.len() / self.columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_covered_to_its_rim() {
        let grid = Grid::over_disc(30.0, 61, f64::hypot);
        let last = grid.columns - 1;
        for (index, &radius) in grid.values.iter().enumerate() {
            let outer = [index % 61, index / 61].iter().any(|&k| k == 0 || k == last);
            assert!(if outer { (radius - 30.0).abs() < 1e-9 } else { radius < 30.0 }, "{index}: {radius}");
        }
        assert_eq!(grid.values[30 * 61 + 30], 0.0);
    }

    #[test]
    fn holes_do_not_count() {
        let grid =
            Grid::over_rectangle(
                [0.0, 2.0],
                [-1.0, 1.0],
                [3, 3],
                |x, y| if x > 1.5 { f64::NAN } else { x - y },
            );
        assert_eq!(grid.span(), Some([-1.0, 2.0]));
        assert_eq!(grid.largest(), 2.0);
        let empty = Grid::over_disc(1.0, 0, |_, _| f64::INFINITY);
        assert_eq!((empty.rows(), empty.span(), empty.largest()), (2, None, 0.0));
    }
}
