//! Graded one-dimensional grids: fine at singular places, coarse elsewhere, with a line at every given place.

/// Element sizes: `finest_mm` at a singular place, growing by `growth` per millimetre of distance, up to
/// `coarsest_mm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizing {
    /// Size at a singular place.
    pub finest_mm: f64,
    /// Growth of the size with the distance from the nearest singular place, dimensionless.
    pub growth: f64,
    /// Size far from every singular place.
    pub coarsest_mm: f64,
}

/// Lines closer to each other than this are one line.
const MERGE_MM: f64 = 1e-6;

/// Coordinates of the grid lines from the least to the greatest of `lines_mm`, in ascending order.
///
/// Every one of `lines_mm` is a grid line. Between two of them the sizes follow `sizing`, whose `singular_mm` are the
/// places to refine at. Fewer than two distinct lines give no cell.
pub fn graded(lines_mm: &[f64], singular_mm: &[f64], sizing: Sizing) -> Vec<f64> {
    let mut lines = lines_mm.to_vec();
    lines.sort_by(f64::total_cmp);
    lines.dedup_by(|b, a| *b - *a < MERGE_MM);
    let mut grid: Vec<f64> = lines.first().copied().into_iter().collect();
    for span in lines.windows(2) {
        let &[start, end] = span else { continue };
        grid.extend(divided(start, end, singular_mm, sizing));
    }
    grid
}

/// The lines after `start` up to `end`.
fn divided(start: f64, end: f64, singular_mm: &[f64], sizing: Sizing) -> Vec<f64> {
    // The number of elements up to a place is the integral of 1/size, here by the midpoint rule.
    const SLICES: usize = 400;
    let slice = (end - start) / SLICES as f64;
    let counts = (0..SLICES).scan(0.0, |count, i| {
        *count += slice / size_at(start + (i as f64 + 0.5) * slice, singular_mm, sizing);
        Some(*count)
    });
    let counts: Vec<f64> = counts.collect();
    let total = counts.last().copied().unwrap_or(0.0);
    // A tenth over a whole number is not worth another element.
    let cells = (total - 0.1).ceil().max(1.0);
    let place = |cell: usize| {
        let wanted = cell as f64 / cells * total;
        let after = counts.partition_point(|count| *count < wanted);
        let below = if after == 0 { 0.0 } else { counts.get(after - 1).copied().unwrap_or(total) };
        let above = counts.get(after).copied().unwrap_or(total);
        let within = if above > below { (wanted - below) / (above - below) } else { 0.0 };
        start + (after as f64 + within) * slice
    };
    (1..cells as usize).map(place).chain([end]).collect()
}

fn size_at(place: f64, singular_mm: &[f64], sizing: Sizing) -> f64 {
    let distance = singular_mm.iter().map(|singular| (place - singular).abs()).fold(f64::INFINITY, f64::min);
    (sizing.finest_mm + sizing.growth * distance).min(sizing.coarsest_mm)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZING: Sizing = Sizing { finest_mm: 0.05, growth: 0.5, coarsest_mm: 0.5 };

    #[test]
    fn every_line_is_in_the_grid_and_the_grid_ascends() {
        let lines = [3.0, -1.0, 0.4, 0.0, 0.4 + 1e-9];
        let grid = graded(&lines, &[0.4], SIZING);
        for line in lines {
            assert!(grid.iter().any(|x| (x - line).abs() < 1e-6), "{line} is missing in {grid:?}");
        }
        assert!(grid.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn sizes_grow_away_from_the_singular_place() {
        let grid = graded(&[0.0, 4.0], &[0.0], SIZING);
        let sizes: Vec<f64> = grid.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(sizes.is_sorted_by(|a, b| a <= &(b + 1e-9)), "{sizes:?}");
        assert!(sizes[0] < 0.08 && sizes.iter().all(|size| *size < 0.55), "{sizes:?}");
    }

    #[test]
    fn a_short_span_is_one_cell() {
        assert_eq!(graded(&[0.0, 0.01], &[], SIZING), [0.0, 0.01]);
        assert_eq!(graded(&[2.0], &[], SIZING), [2.0]);
        assert!(graded(&[], &[], SIZING).is_empty());
    }
}
