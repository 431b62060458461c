//! Gauges on the film's underside: mean strains as weights of displacements.

use crate::mesh::{Mesh, half_sizes_mm};
use tactpad_core::pad::device::{Direction, GAUGES, Gauge};

/// A displacement's share in a strain: node, axis, weight in 1/mm.
pub(super) type Weight = (usize, usize, f64);

/// The mean strain along and across each gauge's grid.
pub(super) fn gauge_weights(mesh: &Mesh, gauges: &[Gauge; GAUGES]) -> [Vec<Weight>; 2 * GAUGES] {
    let underside = Underside::of(mesh);
    std::array::from_fn(|index| {
        let gauge = &gauges[index / 2];
        let along = match gauge.direction {
            Direction::X => 0,
            Direction::Y => 1,
        };
        underside.mean_strain(gauge, if index % 2 == 0 { along } else { 1 - along })
    })
}

/// The nodes of the film's underside by their lattice place.
struct Underside<'m> {
    mesh: &'m Mesh,
    node_at: Vec<Option<usize>>,
    side: usize,
}

impl<'m> Underside<'m> {
    fn of(mesh: &'m Mesh) -> Self {
        let [side, rows] = [0, 1].map(|axis: usize| 2 * mesh.lines_mm[axis].len() - 1);
        let mut node_at = vec![None; side * rows];
        for (node, at) in mesh.lattice.iter().enumerate().filter(|(_, at)| at[2] == mesh.underside) {
            node_at[at[1] * side + at[0]] = Some(node);
        }
        Self { mesh, node_at, side }
    }

    /// Mean normal strain along `axis` over the gauge, as weights of displacements.
    ///
    /// By Gauss's theorem it is the displacement along the axis over the far edge minus that over the near one,
    /// divided by the area. On an element's edge the displacement is a parabola, so Simpson's rule is exact.
    fn mean_strain(&self, gauge: &Gauge, axis: usize) -> Vec<Weight> {
        let centre = [gauge.x_mm, gauge.y_mm];
        let half = half_sizes_mm(gauge);
        let area = 4.0 * half[0] * half[1];
        let mut weights = Vec::new();
        for sign in [-1.0, 1.0] {
            let across = self.line_near(axis, centre[axis] + sign * half[axis]);
            let ends =
                [-1.0, 1.0].map(|end| self.line_near(1 - axis, centre[1 - axis] + end * half[1 - axis]));
            for cell in ends[0]..ends[1] {
                let lines = &self.mesh.lines_mm[1 - axis];
                let length = lines[cell + 1] - lines[cell];
                for (step, simpson) in [(0, 1.0 / 6.0), (1, 4.0 / 6.0), (2, 1.0 / 6.0)] {
                    let mut at = [2 * across; 2];
                    at[1 - axis] = 2 * cell + step;
                    if let Some(node) = self.node_at[at[1] * self.side + at[0]] {
                        weights.push((node, axis, sign * simpson * length / area));
                    }
                }
            }
        }
        weights
    }

    /// The grid line nearest to a coordinate.
    fn line_near(&self, axis: usize, at_mm: f64) -> usize {
        let lines = &self.mesh.lines_mm[axis];
        let distance = |line: &usize| (lines[*line] - at_mm).abs();
        (0..lines.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::Fineness;
    use tactpad_core::pad::device::{Device, Module};

    use super::*;

    /// Asserts that every mean strain of a displacement over its gauge is the strain at a place on the gauge: for
    /// parabolas the centre.
    fn assert_strains(displacement: impl Fn([f64; 3]) -> [f64; 3], strain: impl Fn([f64; 2]) -> [f64; 2]) {
        let device = Device::nominal();
        let mesh = Mesh::of(&device, &Module::NOMINAL, Fineness::STANDARD.scaled(2.5));
        let weights = gauge_weights(&mesh, &device.gauges);
        for (index, weights) in weights.iter().enumerate() {
            let gauge = &device.gauges[index / 2];
            let [x, y] = strain([gauge.x_mm, gauge.y_mm]);
            let is_along_x = (gauge.direction == Direction::X) == (index % 2 == 0);
            let moved = |(node, axis, weight): &Weight| weight * displacement(mesh.place_mm(*node))[*axis];
            let found: f64 = weights.iter().map(moved).sum();
            let wanted = if is_along_x { x } else { y };
            assert!((found - wanted).abs() < 1e-14, "strain {index}: {found} instead of {wanted}");
        }
    }

    #[test]
    fn an_even_strain_is_its_own_mean() {
        assert_strains(
            |[x, y, z]| [2e-3 * x - 7e-4 * y, 5e-4 * x - 1e-3 * y, 3e-3 * x + z],
            |_| [2e-3, -1e-3],
        );
    }

    #[test]
    fn a_strain_that_grows_evenly_has_the_mean_of_the_centre() {
        assert_strains(
            |[x, y, _]| [1e-4 * x * x + 3e-4 * x * y - y * y, 2e-4 * y * y - 5e-4 * x * y + x * x, x * y],
            |[x, y]| [2e-4 * x + 3e-4 * y, 4e-4 * y - 5e-4 * x],
        );
    }
}
