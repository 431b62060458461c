//! A module when its foot moves: the displacements of its nodes and the strains between them.

use tactpad_core::pad::device::Material;

use super::brick::{NODES, lame_mpa, slopes};
use super::mesh::{Brick, Layer, Mesh};
use super::superelement::{MODES, Solution};

/// Strain in the module's frame: εxx, εyy, εzz and the engineering shears γyz, γzx, γxy.
pub type Strain = [f64; 6];

/// A module's shape under a unit of each mode of its foot, without what it took to solve it.
pub struct ModeShapes {
    /// The mesh it was solved on.
    pub mesh: Mesh,
    /// Displacements of each node, mm per mm.
    movements: Vec<[[f64; 3]; MODES]>,
}

impl ModeShapes {
    /// Keeps the displacements of a solution.
    pub fn of(solution: Solution<'_>) -> Self {
        let nodes = 0..solution.mesh.lattice.len();
        let of_node = |node| std::array::from_fn(|mode| solution.displacement(node, mode));
        let movements = nodes.map(of_node).collect();
        Self { movements, mesh: solution.mesh }
    }

    /// The module when its foot moves by these modes, mm.
    pub fn moved(&self, foot_mm: &[f64; MODES]) -> Deformed<'_> {
        let sum = |node: &[[f64; 3]; MODES]| {
            std::array::from_fn(|axis| foot_mm.iter().zip(node).map(|(by, shape)| by * shape[axis]).sum())
        };
        let displacements_mm = self.movements.iter().map(sum).collect();
        Deformed { mesh: &self.mesh, displacements_mm, bricks: bricks(&self.mesh) }
    }
}

/// A module with a displacement at each node.
pub struct Deformed<'m> {
    /// The mesh.
    pub mesh: &'m Mesh,
    /// Displacement of each node along the module's axes.
    pub displacements_mm: Vec<[f64; 3]>,
    /// The bricks in the cells of the mesh's grid: along x, then along y, then upwards.
    bricks: Vec<Option<usize>>,
}

impl Deformed<'_> {
    /// The strain at a place of a brick, given on the reference cube [−1, 1]³.
    pub fn strain(&self, brick: &Brick, place: [f64; 3]) -> Strain {
        let slopes = slopes(place);
        // ∂u/∂x as [component of u][axis of x]; the box maps to the cube axis by axis.
        let gradient: [[f64; 3]; 3] = std::array::from_fn(|component| {
            std::array::from_fn(|axis| {
                let along =
                    |node: usize| slopes[axis][node] * self.displacements_mm[brick.nodes[node]][component];
                (0..NODES).map(along).sum::<f64>() * 2.0 / brick.size_mm[axis]
            })
        });
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = gradient;
        [xx, yy, zz, yz + zy, zx + xz, xy + yx]
    }

    /// The strain of the film's underside at a place of the module's plane; `None` beside the film.
    ///
    /// Between two elements it may jump a little; there it is that of the one with the greater x or y.
    pub fn underside_strain(&self, place_mm: [f64; 2]) -> Option<Strain> {
        let lines_mm = &self.mesh.lines_mm;
        let [(i, x), (j, y)] = [cell_at(&lines_mm[0], place_mm[0])?, cell_at(&lines_mm[1], place_mm[1])?];
        Some(self.strain(self.brick([i, j, self.mesh.underside / 2])?, [x, y, -1.0]))
    }

    /// The strain at a place of the module, with the layer that is there; `None` beside the module.
    ///
    /// Between two elements it may jump; there it is that of the one with the greater coordinate.
    pub fn strain_at(&self, place_mm: [f64; 3]) -> Option<(Strain, Layer)> {
        let lines_mm = &self.mesh.lines_mm;
        let (i, x) = cell_at(&lines_mm[0], place_mm[0])?;
        let (j, y) = cell_at(&lines_mm[1], place_mm[1])?;
        let (k, z) = cell_at(&lines_mm[2], place_mm[2])?;
        let brick = self.brick([i, j, k])?;
        Some((self.strain(brick, [x, y, z]), brick.layer))
    }

    fn brick(&self, [i, j, k]: [usize; 3]) -> Option<&Brick> {
        let [columns, rows] = [0, 1].map(|axis| self.mesh.lines_mm[axis].len() - 1);
        self.mesh.bricks.get((*self.bricks.get((k * rows + j) * columns + i)?)?)
    }
}

/// The cell of a grid that a coordinate lies in, and where on [−1, 1] within it.
fn cell_at(lines_mm: &[f64], at_mm: f64) -> Option<(usize, f64)> {
    let (first, last) = (lines_mm.first()?, lines_mm.last()?);
    if !(*first..=*last).contains(&at_mm) {
        return None;
    }
    let cell = lines_mm.partition_point(|line| *line <= at_mm).clamp(1, lines_mm.len() - 1) - 1;
    let [low, high] = [lines_mm[cell], lines_mm[cell + 1]];
    Some((cell, (2.0 * at_mm - low - high) / (high - low)))
}

/// The brick in each cell of a mesh's grid.
fn bricks(mesh: &Mesh) -> Vec<Option<usize>> {
    let [columns, rows, layers] = mesh.lines_mm.each_ref().map(|lines| lines.len() - 1);
    let mut at = vec![None; columns * rows * layers];
    for (index, brick) in mesh.bricks.iter().enumerate() {
        let [i, j, k] = mesh.lattice[brick.nodes[0]].map(|twice| twice / 2);
        at[(k * rows + j) * columns + i] = Some(index);
    }
    at
}

/// Von Mises's equivalent stress of a strained material, MPa.
pub fn von_mises_mpa(strain: &Strain, material: Material) -> f64 {
    let (_, mu) = lame_mpa(material);
    let [xx, yy, zz, yz, zx, xy] = strain;
    let square = |a: f64| a * a;
    let normal = square(xx - yy) + square(yy - zz) + square(zz - xx);
    let shear = square(*yz) + square(*zx) + square(*xy);
    // Deviators of stress are 2μ those of strain, and an engineering shear is twice the tensor's.
    mu * (2.0 * normal + 3.0 * shear).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Fineness, Layer, half_sizes_mm};
    use tactpad_core::pad::device::{Device, Direction};

    fn shapes(device: &Device) -> (ModeShapes, crate::superelement::Superelement) {
        let solution = Solution::of(device, &device.modules[0], Fineness::STANDARD.scaled(3.0)).unwrap();
        let superelement = solution.superelement();
        (ModeShapes::of(solution), superelement)
    }

    /// Gauss-Legendre rule with two points: exact for the quadratic strain along a side.
    const GAUSS: [f64; 2] = [-0.577_350_269_189_625_8, 0.577_350_269_189_625_8];

    /// Places and lengths of a rule over the cells between two grid lines.
    fn rule(lines: &[f64], from: f64, to: f64) -> Vec<(f64, f64)> {
        let within = lines.windows(2).filter(|cell| cell[0] > from - 1e-6 && cell[1] < to + 1e-6);
        let points = |cell: &[f64]| {
            let (middle, half) = (f64::midpoint(cell[0], cell[1]), (cell[1] - cell[0]) / 2.0);
            GAUSS.map(|s| (middle + s * half, half))
        };
        within.flat_map(points).collect()
    }

    #[test]
    fn means_over_gauges_are_the_superelements_strains() {
        let device = Device::nominal();
        let (shapes, superelement) = shapes(&device);
        let foot: [f64; MODES] = std::array::from_fn(|mode| 1e-3 * (1.0 + (mode as f64).sin()));
        let module = shapes.moved(&foot);
        for (index, gauge) in device.gauges.iter().enumerate() {
            let half = half_sizes_mm(gauge);
            let [x, y] = [(0, gauge.x_mm), (1, gauge.y_mm)].map(|(axis, centre)| {
                rule(&module.mesh.lines_mm[axis], centre - half[axis], centre + half[axis])
            });
            let along = usize::from(gauge.direction == Direction::Y);
            for (row, axis) in [(2 * index, along), (2 * index + 1, 1 - along)] {
                let wanted: f64 = superelement.strains[row].iter().zip(foot).map(|(b, by)| b * by).sum();
                let places = x.iter().flat_map(|x| y.iter().map(move |y| (*x, *y)));
                let sum: f64 = places
                    .map(|((x, dx), (y, dy))| dx * dy * module.underside_strain([x, y]).unwrap()[axis])
                    .sum();
                let mean = sum / (4.0 * half[0] * half[1]);
                assert!((mean - wanted).abs() < 1e-9 * wanted.abs().max(1e-4), "{row}: {mean} {wanted}");
            }
        }
    }

    #[test]
    fn beside_the_film_there_is_no_strain() {
        let device = Device::nominal();
        let (shapes, _) = shapes(&device);
        let module = shapes.moved(&[0.0; MODES]);
        let [x, y] = [device.stack.film_length_x_mm / 2.0, device.stack.film_width_y_mm / 2.0];
        assert_eq!(module.underside_strain([x, y]), Some([0.0; 6]), "the film's corner");
        for place in [[x + 1e-6, 0.0], [0.0, -y - 1e-6], [f64::NAN, 0.0]] {
            assert_eq!(module.underside_strain(place), None);
        }
    }

    #[test]
    fn a_place_has_the_strain_and_the_layer_of_its_brick() {
        let device = Device::nominal();
        let (shapes, _) = shapes(&device);
        let module = shapes.moved(&std::array::from_fn(|mode| 1e-3 * (1.0 + (mode as f64).sin())));
        // On the underside both ways are the same.
        for place in [[0.3, 0.2], [-3.3, 0.1], [2.0, -1.4]] {
            let (strain, layer) = module.strain_at([place[0], place[1], 0.0]).unwrap();
            assert_eq!((Some(strain), layer), (module.underside_strain(place), Layer::Pi));
        }
        let stack = &device.stack;
        let film_mm = stack.pi_thickness_mm + stack.adh_thickness_mm + stack.fpc_thickness_mm;
        let layer = |place| module.strain_at(place).map(|(_, layer)| layer);
        assert_eq!(layer([0.0, 0.0, film_mm + 0.5]), Some(Layer::Post));
        assert_eq!(layer([4.5, 0.0, -0.1]), Some(Layer::Frame));
        assert_eq!(layer([0.0, 0.0, -0.1]), None, "the window");
        assert_eq!(layer([3.0, 0.0, film_mm + 0.5]), None, "beside the post");
    }

    #[test]
    fn one_axis_of_stress_is_its_own_equivalent() {
        let device = Device::nominal();
        let material = Layer::Post.material(&device, &device.modules[0]);
        let (stress, across) = (3.0, -material.nu * 3.0 / material.e_mpa);
        let pulled = [stress / material.e_mpa, across, across, 0.0, 0.0, 0.0];
        assert!((von_mises_mpa(&pulled, material) / stress - 1.0).abs() < 1e-12);
        let (_, mu) = lame_mpa(material);
        let sheared = [0.0, 0.0, 0.0, 0.0, stress / mu, 0.0];
        assert!((von_mises_mpa(&sheared, material) / stress - 3.0_f64.sqrt()).abs() < 1e-12);
    }
}
