//! A module as the plate sees it: stiffness and gauge strains for the movements of the bond's top face.
//!
//! The plate is some hundred times stiffer than the bond, so the bond's top moves as the plate's underside does:
//! smoothly. Each of its three displacements (along the module's x, y, z) is a Legendre polynomial in the place on
//! the face. For each of these *modes* the film, frame, post and bond are solved once, in 3-D. That gives the
//! stiffness K (force on mode j for a unit of mode k; symmetric) and the gauges' strains B for a unit of each mode.
//! Static condensation: R. J. Guyan, AIAA J. 3 (1965) 380.

use faer::Mat;

use tactpad_core::pad::device::{Device, GAUGES, Module};

use super::brick::{DOFS, Stiffness, box_stiffness, forces};
use super::mesh::{Brick, Fineness, Mesh};
use super::system::{DegreesOfFreedom, Factor, SolveError, add_holding_forces, gathered};

use self::gauge::gauge_weights;

mod derivative;
mod gauge;
mod mass;

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

/// How a module changes with one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerDerivatives {
    /// Per MPa of the layer's modulus.
    pub per_mpa: Superelement,
    /// Per mm of its thickness.
    pub per_mm: Superelement,
}

/// Mass of a module for its foot's modes: force on mode j for a unit of acceleration of mode k, t (N for mm/s²). The film and
/// post follow the foot as they do at rest.
pub type FootMass = [[f64; MODES]; MODES];

/// Values of the foot's polynomials at a place given in half sizes of the foot, −1 … 1.
pub fn foot_shapes(place: [f64; 2]) -> [f64; FOOT_SHAPES.len()] {
    FOOT_SHAPES.map(|[a, b]| legendre(a, place[0]) * legendre(b, place[1]))
}

/// Legendre polynomials of degree 0 to 2.
fn legendre(degree: usize, x: f64) -> f64 {
    match degree {
        0 => 1.0,
        1 => x,
        _ => (3.0 * x * x - 1.0) / 2.0,
    }
}

/// A solved module: the displacements of all nodes for a unit of each mode.
pub struct Solution<'d> {
    device: &'d Device,
    module: &'d Module,
    /// The mesh it was solved on.
    pub mesh: Mesh,
    freedoms: DegreesOfFreedom,
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
        let mesh = Mesh::of(device, module, fineness);
        Self::on(mesh, device, module)
    }

    /// Solves a module of the device on a given mesh of it.
    ///
    /// # Errors
    /// As for [`Self::of`].
    pub fn on(mesh: Mesh, device: &'d Device, module: &'d Module) -> Result<Self, SolveError> {
        let freedoms = DegreesOfFreedom::new(&mesh, |node| mesh.is_fixed(node) || mesh.is_top(node));
        let factor = Factor::of(&mesh, &freedoms, |brick| stiffness_of(device, module, brick))?;
        let fields = Mat::zeros(freedoms.unknowns(), MODES);
        let mut solution = Self { device, module, mesh, freedoms, factor, fields };
        // With the fields still zero, the displacements are the given ones.
        let mut right = Mat::zeros(solution.freedoms.unknowns(), MODES);
        add_holding_forces(
            solution.top_bricks(),
            &solution.freedoms,
            |brick| stiffness_of(device, module, brick),
            |node, mode| solution.displacement(node, mode),
            &mut right,
        );
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

    /// The bricks under the plate.
    fn top_bricks(&self) -> impl Iterator<Item = &Brick> {
        self.mesh.bricks.iter().filter(|brick| brick.nodes.iter().any(|node| self.mesh.is_top(*node)))
    }

    fn top_shapes(&self, node: usize) -> [f64; FOOT_SHAPES.len()] {
        let [x, y, _] = self.mesh.place_mm(node);
        let stack = &self.device.stack;
        foot_shapes([2.0 * x / stack.post_length_x_mm, 2.0 * y / stack.post_width_y_mm])
    }

    /// The forces on a brick's nodes for a unit of a mode.
    fn brick_forces(&self, brick: &Brick, stiffness: &Stiffness, mode: usize) -> [f64; DOFS] {
        forces(stiffness, &gathered(brick, |node| self.displacement(node, mode)))
    }

    /// Condenses the module to its modes.
    pub fn superelement(&self) -> Superelement {
        // K = Tᵀ (K_tt T + K_tf u_f): forces on the top's nodes t under a unit of each mode, weighted by the modes' shapes T.
        let mut condensed = Superelement::ZERO;
        for brick in self.top_bricks() {
            let stiffness = stiffness_of(self.device, self.module, brick);
            for k in 0..MODES {
                let forces = self.brick_forces(brick, &stiffness, k);
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
        for (row, gauge) in condensed.strains.iter_mut().zip(gauge_weights(&self.mesh, &self.device.gauges)) {
            for (mode, strain) in row.iter_mut().enumerate() {
                // B = w·u with the gauge's weights w.
                *strain = gauge.iter().map(|(node, axis, w)| w * self.displacement(*node, mode)[*axis]).sum();
            }
        }
        condensed
    }
}

fn stiffness_of(device: &Device, module: &Module, brick: &Brick) -> Box<Stiffness> {
    box_stiffness(brick.size_mm, brick.layer.material(device, module))
}
