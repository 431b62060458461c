//! A module as the plate sees it: stiffness and gauge strains for the movements of the bond's top face.
//!
//! The plate is some hundred times stiffer than the bond, so the bond's top moves as the plate's underside does:
//! smoothly. Each of its three displacements (along the module's x, y, z) is a Legendre polynomial in the place on
//! the face. For each of these *modes* the film, frame, post and bond are solved once, in 3-D. That gives the
//! stiffness K (force on mode j for a unit of mode k; symmetric) and the gauges' strains B for a unit of each mode.
//! Static condensation: R. J. Guyan, AIAA J. 3 (1965) 380.

use faer::Mat;

use crate::device::{Device, Direction, GAUGES, Gauge, Module};

use super::brick::{DOFS, Stiffness, box_stiffness, box_stiffness_per_height};
use super::mesh::{Brick, Fineness, Layer, Mesh, half_sizes_mm};
use super::system::{Factor, Freedoms, SolveError};

/// Strains of a module's gauges: along the grid and across it, for R1, R2, … R7.
pub const STRAINS: usize = 2 * GAUGES;

/// The foot's polynomials: their degrees along x and y.
pub const FOOT_SHAPES: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// Modes of the bond's top: mode 3 p + c moves along axis c by polynomial p of [`FOOT_SHAPES`].
pub const MODES: usize = 3 * FOOT_SHAPES.len();

/// Stiffness and gauge strains of a module; also their derivatives with respect to some number.
#[derive(Clone, Debug, PartialEq)]
pub struct Superelement {
    /// Force on mode j for a unit of mode k, N/mm.
    pub stiffness: [[f64; MODES]; MODES],
    /// Strain of each gauge for a unit of each mode, 1/mm.
    pub strains: [[f64; MODES]; STRAINS],
}

impl Superelement {
    pub(super) const ZERO: Self = Self { stiffness: [[0.0; MODES]; MODES], strains: [[0.0; MODES]; STRAINS] };

    /// Adds a multiple of another one.
    pub(super) fn add(&mut self, factor: f64, other: &Self) {
        let pairs = self.stiffness.iter_mut().flatten().zip(other.stiffness.iter().flatten());
        pairs.for_each(|(k, other)| *k += factor * other);
        let pairs = self.strains.iter_mut().flatten().zip(other.strains.iter().flatten());
        pairs.for_each(|(strain, other)| *strain += factor * other);
    }
}

/// Values of the foot's polynomials at a place given in half sizes of the foot, −1 … 1.
pub fn foot_shapes(place: [f64; 2]) -> [f64; FOOT_SHAPES.len()] {
    FOOT_SHAPES.map(|[a, b]| legendre(a, place[0]) * legendre(b, place[1]))
}

/// Legendre polynomials of degree 0 to 3.
fn legendre(degree: usize, x: f64) -> f64 {
    match degree {
        0 => 1.0,
        1 => x,
        2 => (3.0 * x * x - 1.0) / 2.0,
        _ => (5.0 * x * x - 3.0) * x / 2.0,
    }
}

/// A solved module: the displacements of all nodes for a unit of each mode.
pub struct Solution<'d> {
    device: &'d Device,
    module: &'d Module,
    /// The mesh it was solved on.
    pub mesh: Mesh,
    freedoms: Freedoms,
    factor: Factor,
    /// Free displacements, one column for each mode.
    fields: Mat<f64>,
}

impl<'d> Solution<'d> {
    /// Meshes and solves a module of the device.
    ///
    /// # Errors
    /// What the solver says about memory or a stiffness that is not positive definite.
    pub fn of(device: &'d Device, module: &'d Module, fineness: Fineness) -> Result<Self, SolveError> {
        let mesh = Mesh::of(&device.stack, &device.gauges, module.frame_open, fineness);
        let freedoms = Freedoms::of(&mesh);
        let factor = Factor::of(&mesh, &freedoms, |brick| stiffness_of(device, module, brick))?;
        let fields = Mat::zeros(freedoms.unknowns(), MODES);
        let mut solution = Self { device, module, mesh, freedoms, factor, fields };
        let mut right = solution.top_loads();
        solution.factor.solve(&mut right)?;
        solution.fields = right;
        Ok(solution)
    }

    /// Numbers in the factorised stiffness.
    pub fn factor_entries(&self) -> usize {
        self.factor.entries()
    }

    /// Number of unknown displacements.
    pub fn unknowns(&self) -> usize {
        self.freedoms.unknowns()
    }

    /// Displacement of a node for a unit of a mode, mm per mm.
    pub fn displacement(&self, node: usize, mode: usize) -> [f64; 3] {
        if let Some(first) = self.freedoms.first(node) {
            return std::array::from_fn(|axis| self.fields[(first + axis, mode)]);
        }
        let mut given = [0.0; 3];
        if self.mesh.is_top(node) {
            given[mode % 3] = self.top_shapes(node)[mode / 3];
        }
        given
    }

    /// Forces on the free nodes that hold a unit of each mode at the top: −K_ib u_b.
    fn top_loads(&self) -> Mat<f64> {
        let mut right = Mat::zeros(self.freedoms.unknowns(), MODES);
        for brick in self.top_bricks() {
            let stiffness = stiffness_of(self.device, self.module, brick);
            for mode in 0..MODES {
                let forces = product(&stiffness, &self.gather(brick, mode));
                for (node, force) in brick.nodes.iter().zip(forces.as_chunks::<3>().0) {
                    let Some(first) = self.freedoms.first(*node) else { continue };
                    for axis in 0..3 {
                        right[(first + axis, mode)] -= force[axis];
                    }
                }
            }
        }
        right
    }

    /// The bricks under the plate.
    fn top_bricks(&self) -> impl Iterator<Item = &Brick> {
        self.mesh.bricks.iter().filter(|brick| brick.nodes.iter().any(|node| self.mesh.is_top(*node)))
    }

    fn top_shapes(&self, node: usize) -> [f64; FOOT_SHAPES.len()] {
        let [x, y, _] = self.mesh.place_mm(node);
        let stack = &self.device.stack;
        foot_shapes([2.0 * x / stack.post_length_x_mm, 2.0 * y / stack.post_width_y_mm])
    }

    fn gather(&self, brick: &Brick, mode: usize) -> [f64; DOFS] {
        let nodes = brick.nodes.map(|node| self.displacement(node, mode));
        std::array::from_fn(|dof| nodes[dof / 3][dof % 3])
    }

    /// Condenses the module to its modes.
    pub fn superelement(&self) -> Superelement {
        let mut condensed = Superelement::ZERO;
        for brick in self.top_bricks() {
            let stiffness = stiffness_of(self.device, self.module, brick);
            for k in 0..MODES {
                let forces = product(&stiffness, &self.gather(brick, k));
                for (node, force) in brick.nodes.iter().zip(forces.as_chunks::<3>().0) {
                    if self.mesh.is_top(*node) {
                        let shapes = self.top_shapes(*node);
                        for (j, row) in condensed.stiffness.iter_mut().enumerate() {
                            row[k] += shapes[j / 3] * force[j % 3];
                        }
                    }
                }
            }
        }
        for (row, gauge) in condensed.strains.iter_mut().zip(self.gauge_weights()) {
            for (mode, strain) in row.iter_mut().enumerate() {
                *strain = gauge.iter().map(|(node, axis, w)| w * self.displacement(*node, mode)[*axis]).sum();
            }
        }
        condensed
    }

    /// The gauges' strains as weights of displacements: (node, axis, 1/mm).
    fn gauge_weights(&self) -> [Vec<(usize, usize, f64)>; STRAINS] {
        let underside = Underside::of(&self.mesh);
        std::array::from_fn(|index| {
            let gauge = &self.device.gauges[index / 2];
            let along = match gauge.direction {
                Direction::X => 0,
                Direction::Y => 1,
            };
            underside.mean_strain(gauge, if index % 2 == 0 { along } else { 1 - along })
        })
    }

    /// Derivatives with respect to each layer's modulus (per MPa) and thickness (per mm), in the order of
    /// [`Layer::ALL`].
    ///
    /// With u the field of a mode and z the field that a gauge's weights load, dK = uᵀ ∂K u and dB = −zᵀ ∂K u.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn derivatives(&self) -> Result<Vec<LayerDerivatives>, SolveError> {
        let adjoint = self.adjoint()?;
        let mut derivatives =
            Layer::ALL.map(|_| LayerDerivatives { per_mpa: Superelement::ZERO, per_mm: Superelement::ZERO });
        for brick in &self.mesh.bricks {
            let slot = &mut derivatives[brick.layer as usize];
            let material = brick.layer.material(self.device, self.module);
            let fields: Vec<_> = (0..MODES).map(|mode| self.gather(brick, mode)).collect();
            let loads: Vec<_> =
                (0..STRAINS).map(|gauge| self.gather_adjoint(&adjoint, brick, gauge)).collect();
            let mut per_mpa = box_stiffness(brick.size_mm, material);
            per_mpa.iter_mut().flatten().for_each(|k| *k /= material.e_mpa);
            add_derivative(&per_mpa, &fields, &loads, &mut slot.per_mpa);
            // All elements of a layer grow in proportion.
            let mut per_mm = box_stiffness_per_height(brick.size_mm, material);
            let share = brick.size_mm[2] / brick.layer.thickness_mm(&self.device.stack);
            per_mm.iter_mut().flatten().for_each(|k| *k *= share);
            add_derivative(&per_mm, &fields, &loads, &mut slot.per_mm);
        }
        Ok(derivatives.into())
    }

    /// Fields that the gauges' weights load, one column for each strain.
    fn adjoint(&self) -> Result<Mat<f64>, SolveError> {
        let mut right = Mat::zeros(self.freedoms.unknowns(), STRAINS);
        for (column, weights) in self.gauge_weights().iter().enumerate() {
            for (node, axis, weight) in weights {
                if let Some(first) = self.freedoms.first(*node) {
                    right[(first + axis, column)] += weight;
                }
            }
        }
        self.factor.solve(&mut right)?;
        Ok(right)
    }

    fn gather_adjoint(&self, adjoint: &Mat<f64>, brick: &Brick, column: usize) -> [f64; DOFS] {
        let first = brick.nodes.map(|node| self.freedoms.first(node));
        std::array::from_fn(|dof| first[dof / 3].map_or(0.0, |first| adjoint[(first + dof % 3, column)]))
    }
}

/// How a module changes with one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerDerivatives {
    /// Per MPa of the layer's modulus.
    pub per_mpa: Superelement,
    /// Per mm of its thickness.
    pub per_mm: Superelement,
}

fn add_derivative(slope: &Stiffness, fields: &[[f64; DOFS]], loads: &[[f64; DOFS]], sum: &mut Superelement) {
    for (k, field) in fields.iter().enumerate() {
        let forces = product(slope, field);
        for (row, other) in sum.stiffness.iter_mut().zip(fields) {
            row[k] += dot(other, &forces);
        }
        for (row, load) in sum.strains.iter_mut().zip(loads) {
            row[k] -= dot(load, &forces);
        }
    }
}

fn stiffness_of(device: &Device, module: &Module, brick: &Brick) -> Box<Stiffness> {
    box_stiffness(brick.size_mm, brick.layer.material(device, module))
}

fn product(stiffness: &Stiffness, displacement: &[f64; DOFS]) -> [f64; DOFS] {
    std::array::from_fn(|row| dot(&stiffness[row], displacement))
}

fn dot(a: &[f64; DOFS], b: &[f64; DOFS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
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
    fn mean_strain(&self, gauge: &Gauge, axis: usize) -> Vec<(usize, usize, f64)> {
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
