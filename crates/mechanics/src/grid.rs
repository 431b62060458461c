//! Graded one-dimensional grids: fine at singular places, coarse elsewhere, with a line at every given place.

/// Element sizes about a singular place: `finest_mm` there, growing by `growth` per millimetre of distance, up to
/// `coarsest_mm`. So neighbours grow in proportion, and their number by the logarithm of `finest_mm` only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizing {
    /// Size at a singular place.
    pub finest_mm: f64,
    /// Growth of the size with the distance from the nearest singular place, dimensionless.
    pub growth: f64,
    /// Size far from every singular place.
    pub coarsest_mm: f64,
}

impl Sizing {
    /// The size at so great a distance from a singular place.
    pub fn at(self, distance_mm: f64) -> f64 {
        (self.finest_mm + self.growth * distance_mm).min(self.coarsest_mm)
    }

    /// Every size multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            finest_mm: factor * self.finest_mm,
            growth: factor * self.growth,
            coarsest_mm: factor * self.coarsest_mm,
        }
    }

    /// The size at a coordinate, by the nearest of the singular ones.
    pub fn near(self, singular_mm: &[f64], at_mm: f64) -> f64 {
        let distances = singular_mm.iter().map(|singular| (at_mm - singular).abs());
        self.at(distances.fold(f64::INFINITY, f64::min))
    }
}

/// Lines closer to each other than this are one line.
const MERGE_MM: f64 = 1e-6;

/// Coordinates of the grid lines from the least to the greatest of `lines_mm`, in ascending order.
///
/// Every one of `lines_mm` is a grid line. Between two of them the cells are about as large as `size_mm` says for
/// their place. Fewer than two distinct lines give no cell.
pub fn graded(lines_mm: &[f64], size_mm: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut lines = lines_mm.to_vec();
    lines.sort_by(f64::total_cmp);
    lines.dedup_by(|b, a| *b - *a < MERGE_MM);
    let mut grid: Vec<f64> = lines.first().copied().into_iter().collect();
    for span in lines.windows(2) {
        let &[start, end] = span else { continue };
        grid.extend(divided(start, end, &size_mm));
    }
    grid
}

/// The lines after `start` up to `end`.
fn divided(start: f64, end: f64, size_mm: impl Fn(f64) -> f64) -> Vec<f64> {
    // The number of cells up to a place is the integral of 1/size, here by the midpoint rule.
    const SLICES: usize = 400;
    let slice = (end - start) / SLICES as f64;
    let counts = (0..SLICES).scan(0.0, |count, i| {
        *count += slice / size_mm(start + (i as f64 + 0.5) * slice);
        Some(*count)
    });
    let counts: Vec<f64> = std::iter::once(0.0).chain(counts).collect();
    let total = counts.last().copied().unwrap_or(0.0);
    // A tenth over a whole number is not worth another cell.
    let cells = (total - 0.1).ceil().max(1.0) as usize;
    let place = |cell: usize| {
        let wanted = cell as f64 / cells as f64 * total;
        let before = counts.partition_point(|count| *count < wanted) - 1;
        let within = (wanted - counts[before]) / (counts[before + 1] - counts[before]);
        start + (before as f64 + within) * slice
    };
    (1..cells).map(place).chain([end]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZING: Sizing = Sizing { finest_mm: 0.05, growth: 0.5, coarsest_mm: 0.5 };

    #[test]
    fn every_line_is_in_the_grid_and_the_grid_ascends() {
        let lines = [3.0, -1.0, 0.4, 0.0, 0.4 + 1e-9];
        let grid = graded(&lines, |at| SIZING.near(&[0.4], at));
        for line in lines {
            assert!(grid.iter().any(|x| (x - line).abs() < 1e-6), "{line} is missing in {grid:?}");
        }
        assert!(grid.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn sizes_grow_away_from_the_singular_place() {
        let grid = graded(&[0.0, 4.0], |at| SIZING.at(at));
        let sizes: Vec<f64> = grid.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(sizes.is_sorted_by(|a, b| a <= &(b + 1e-9)), "{sizes:?}");
        assert!(sizes[0] < 0.08 && sizes.iter().all(|size| *size < 0.55), "{sizes:?}");
    }

    #[test]
    fn a_short_span_is_one_cell() {
        assert_eq!(graded(&[0.0, 0.01], |_| 0.5), [0.0, 0.01]);
        assert_eq!(graded(&[2.0], |_| 0.5), [2.0]);
        assert!(graded(&[], |_| 0.5).is_empty());
    }
}
