//! The paper's layout problem by trying everything: slow, and no cleverness that could mislead.

use super::spacing::{PAIRS, Radii, SAME_AREA, Spacing, is_triangle};

/// Steps along each distance, at first and when looking closer.
const STEPS_FIRST: usize = 40;
const STEPS_CLOSER: usize = 10;

/// How often the search looks closer; each time at two cells of the grid before.
const CLOSER: usize = 10;

/// The best layout on a grid of the three distances, each from zero to its limit; then on finer grids around the best.
///
/// Distances that make no triangle are left out. The last grid's step is the limit / 40 / 5¹⁰: 10⁻⁷ mm for a pad.
/// Unlike [`super::swarm`], it knows nothing of what layouts look like.
pub fn search(radii: &Radii) -> Spacing {
    let mut around = radii.limits_mm().map(|limit| [0.0, limit]);
    let mut best = best_on_grid(radii, around, STEPS_FIRST, radii.spacing([0.0; PAIRS]));
    let mut steps = STEPS_FIRST;
    for _ in 0..CLOSER {
        let limits = radii.limits_mm();
        around = std::array::from_fn(|pair| {
            let [low, high] = around[pair];
            let (middle, cell) = (best.distances_mm[pair], (high - low) / steps as f64);
            [(middle - cell).max(0.0), (middle + cell).min(limits[pair])]
        });
        steps = STEPS_CLOSER;
        best = best_on_grid(radii, around, steps, best);
    }
    best
}

/// The best of one layout and all grid points within the ranges, ends included.
fn best_on_grid(radii: &Radii, ranges_mm: [[f64; 2]; PAIRS], steps: usize, mut best: Spacing) -> Spacing {
    let at = |pair: usize, step: usize| {
        let [low, high] = ranges_mm[pair];
        let share = step as f64 / steps as f64;
        low * (1.0 - share) + high * share
    };
    for first in 0..=steps {
        for second in 0..=steps {
            for third in 0..=steps {
                let distances = [at(0, first), at(1, second), at(2, third)];
                if !is_triangle(distances) {
                    continue;
                }
                let found = radii.spacing(distances);
                if is_better(&found, &best) {
                    best = found;
                }
            }
        }
    }
    best
}

/// Whether a layout covers more, or the same with longer distances. Without the second, rounding would choose among
/// the layouts of a disc within the others, and the finer grids could leave the longest distances behind.
fn is_better(found: &Spacing, best: &Spacing) -> bool {
    let gain = found.area_mm2 / best.area_mm2 - 1.0;
    let length = |spacing: &Spacing| spacing.distances_mm.iter().sum::<f64>();
    gain > SAME_AREA || (gain >= -SAME_AREA && length(found) > length(best))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sees that the grid, the swarm and the closed form agree on the area, and on distances that are not free.
    fn assert_confirmed(radii_mm: [f64; 3]) {
        let radii = Radii::new(radii_mm).unwrap();
        let (found, wanted) = (search(&radii), radii.widest());
        let scene = format!("{radii_mm:?}: {found:?} for {wanted:?}");
        assert!((found.area_mm2 / wanted.area_mm2 - 1.0).abs() < 1e-7, "{scene}");
        for (distance, [low, high]) in found.distances_mm.iter().zip(radii.optimal_ranges_mm()) {
            assert!(*distance >= low - 1e-5 * high && *distance <= high * (1.0 + 1e-12), "{scene}");
        }
    }

    #[test]
    fn the_grid_confirms_the_papers_triangle() {
        assert_confirmed([33.0; 3]);
        let found = search(&Radii::new([33.0; 3]).unwrap());
        assert!(found.distances_mm.iter().all(|d| (d - 33.0).abs() < 1e-9), "{found:?}");
    }

    #[test]
    fn the_grid_confirms_radii_of_any_ratio() {
        let root = |n: f64, step: u32| (n.sqrt() * f64::from(step)).fract();
        for step in 1..=25 {
            assert_confirmed([2.0, 3.0, 5.0].map(|n| 0.5 + 30.0 * root(n, step).powi(2)));
        }
    }

    #[test]
    fn the_grid_confirms_unequal_radii() {
        for radii_mm in [
            [3.0, 4.0, 5.0],
            [5.0, 4.0, 3.0],
            [4.0, 3.9, 4.1],
            [5.0, 5.0, 3.0],
            [1.0, 1.9, 1.95],
            [1.0, 3.0, 4.0],
            [4.0, 1.0, 3.0],
            [2.0, 1.0, 2.0],
            [1.0, 1.2, 3.0],
            [2.5, 1.0, 1.9],
            [0.01, 30.0, 35.0],
        ] {
            assert_confirmed(radii_mm);
        }
    }
}
