//! Mean strains of a module's gauges, from what CalculiX prints.

use tactpad_core::pad::device::{Direction, GAUGES, Gauge};
use tactpad_mechanics::brick::slopes;
use tactpad_mechanics::mesh::{Brick, Mesh, half_sizes_mm};
use tactpad_mechanics::superelement::STRAINS;

use super::face::{GAUSS, shapes};
use super::results::Step;

/// The bricks on the film's underside over each gauge, as indices into the mesh.
pub(crate) struct Gauges<'m> {
    mesh: &'m Mesh,
    gauges: &'m [Gauge; GAUGES],
    bricks: [Vec<usize>; GAUGES],
}

impl<'m> Gauges<'m> {
    pub(crate) fn of(mesh: &'m Mesh, gauges: &'m [Gauge; GAUGES]) -> Self {
        let bricks = gauges.each_ref().map(|gauge| {
            let over = |brick: &Brick| is_on_underside(mesh, brick) && is_over(mesh, brick, gauge);
            (0..mesh.bricks.len()).filter(|index| over(&mesh.bricks[*index])).collect()
        });
        let found = Self { mesh, gauges, bricks };
        for (gauge, bricks) in gauges.iter().zip(&found.bricks) {
            let area: f64 = bricks.iter().map(|brick| area_mm2(&mesh.bricks[*brick])).sum();
            assert!((area / (gauge.length_mm * gauge.width_mm) - 1.0).abs() < 1e-9, "bricks cover the gauge");
        }
        found
    }

    /// All bricks over a gauge, each once.
    pub(crate) fn bricks(&self) -> Vec<usize> {
        let mut bricks: Vec<usize> = self.bricks.iter().flatten().copied().collect();
        bricks.sort_unstable();
        bricks.dedup();
        bricks
    }

    /// Strains along and across each gauge, from the displacement of each node of the mesh along the module's axes.
    pub(crate) fn by_nodes(&self, displacement: impl Fn(usize) -> [f64; 3]) -> [f64; STRAINS] {
        self.means(|brick, axis| {
            let brick = &self.mesh.bricks[brick];
            let moved = face_nodes(brick).map(|node| displacement(node)[axis]);
            face_mean(|place| {
                let slopes = shapes(place).map(|jet| jet[1 + axis] * 2.0 / brick.size_mm[axis]);
                slopes.iter().zip(moved).map(|(slope, moved)| slope * moved).sum()
            })
        })
    }

    /// Means at the height of the lower integration points, where CalculiX prints strains.
    pub(crate) fn by_points(&self, step: &Step) -> [f64; STRAINS] {
        self.means(|brick, axis| step.strain[&brick][..4].iter().map(|strain| strain[axis] / 4.0).sum())
    }

    /// The same from the displacement of each node of the mesh.
    pub(crate) fn above_face(&self, displacement: impl Fn(usize) -> [f64; 3]) -> [f64; STRAINS] {
        self.means(|brick, axis| {
            let brick = &self.mesh.bricks[brick];
            let moved = brick.nodes.map(|node| displacement(node)[axis]);
            let strain = |at: [f64; 3]| {
                let slopes = slopes(at)[axis];
                slopes.iter().zip(moved).map(|(slope, moved)| slope * moved).sum::<f64>() * 2.0
                    / brick.size_mm[axis]
            };
            let near = -1.0 / 3.0_f64.sqrt();
            let corners = [[near, near], [-near, near], [-near, -near], [near, -near]];
            corners.iter().map(|[x, y]| strain([*x, *y, near]) / 4.0).sum()
        })
    }

    /// Area means of what each brick says of the strain along an axis.
    fn means(&self, of: impl Fn(usize, usize) -> f64) -> [f64; STRAINS] {
        std::array::from_fn(|index| {
            let along = match self.gauges[index / 2].direction {
                Direction::X => 0,
                Direction::Y => 1,
            };
            let axis = if index % 2 == 0 { along } else { 1 - along };
            let (mut sum, mut area) = (0.0, 0.0);
            for brick in &self.bricks[index / 2] {
                let part = area_mm2(&self.mesh.bricks[*brick]);
                sum += part * of(*brick, axis);
                area += part;
            }
            sum / area
        })
    }
}

fn is_on_underside(mesh: &Mesh, brick: &Brick) -> bool {
    mesh.lattice[brick.nodes[0]][2] == mesh.underside
}

fn is_over(mesh: &Mesh, brick: &Brick, gauge: &Gauge) -> bool {
    let half_mm = half_sizes_mm(gauge);
    let corner = mesh.place_mm(brick.nodes[0]);
    [gauge.x_mm, gauge.y_mm].iter().enumerate().all(|(axis, centre)| {
        let middle = corner[axis] + brick.size_mm[axis] / 2.0;
        (middle - centre).abs() < half_mm[axis]
    })
}

fn area_mm2(brick: &Brick) -> f64 {
    brick.size_mm[0] * brick.size_mm[1]
}

/// The nodes of a brick's lower face.
fn face_nodes(brick: &Brick) -> [usize; 8] {
    [0, 1, 2, 3, 8, 9, 10, 11].map(|index| brick.nodes[index])
}

/// The mean of a function over the reference square.
fn face_mean(of: impl Fn([f64; 2]) -> f64) -> f64 {
    GAUSS.iter().flat_map(|(s, ws)| GAUSS.map(|(t, wt)| ws * wt / 4.0 * of([*s, t]))).sum()
}
