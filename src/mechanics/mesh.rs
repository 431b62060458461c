//! The mesh of one module: boxes of 20-node bricks on a graded tensor grid, with a grid line at every edge of the
//! geometry and of every gauge.
//!
//! Module frame; z = 0 is the underside of the film (where the gauges are), the frame hangs below it, the post and
//! the bond stand on it.

use crate::device::{Device, Direction, Gauge, Material, Module, Side, Stack};

use super::brick::{CORNERS, NODES};
use super::grid::{Sizing, graded};

/// A layer of a module, from bottom to top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Epoxy ring on the base.
    Frame,
    /// Polyimide.
    Pi,
    /// Adhesive.
    Adh,
    /// Flexible printed circuit.
    Fpc,
    /// The post.
    Post,
    /// Epoxy between post and plate.
    Bond,
}

impl Layer {
    /// All layers, from bottom to top.
    pub const ALL: [Self; 6] = [Self::Frame, Self::Pi, Self::Adh, Self::Fpc, Self::Post, Self::Bond];

    /// The layer's thickness.
    pub fn thickness_mm(self, stack: &Stack) -> f64 {
        match self {
            Self::Frame => stack.frame_thickness_mm,
            Self::Pi => stack.pi_thickness_mm,
            Self::Adh => stack.adh_thickness_mm,
            Self::Fpc => stack.fpc_thickness_mm,
            Self::Post => stack.post_height_mm,
            Self::Bond => stack.bond_thickness_mm,
        }
    }

    /// The layer's material in a module, with the module's own factors.
    pub fn material(self, device: &Device, module: &Module) -> Material {
        let materials = &device.material;
        let (material, factor) = match self {
            Self::Frame => (materials.epoxy, module.frame_e_factor),
            Self::Pi => (materials.pi, module.film_e_factor),
            Self::Adh => (materials.adh, module.film_e_factor),
            Self::Fpc => (materials.fpc, module.film_e_factor),
            Self::Post => (materials.pick, 1.0),
            Self::Bond => (materials.epoxy, module.bond_e_factor),
        };
        Material { e_mpa: factor * material.e_mpa, ..material }
    }
}

/// How fine a module is meshed. Lengths in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// In the film's plane: refined at the post's and the window's edges.
    pub plane: Sizing,
    /// Across the layers: refined at the film's underside and top.
    pub height: Sizing,
}

impl Fineness {
    /// The mesh that the program uses.
    pub const STANDARD: Self = Self {
        plane: Sizing { finest_mm: 0.03, growth: 0.7, coarsest_mm: 0.6 },
        height: Sizing { finest_mm: 0.025, growth: 0.7, coarsest_mm: 0.5 },
    };

    /// The same grading with every size multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        let scale = |sizing: Sizing| Sizing {
            finest_mm: factor * sizing.finest_mm,
            growth: factor * sizing.growth,
            coarsest_mm: factor * sizing.coarsest_mm,
        };
        Self { plane: scale(self.plane), height: scale(self.height) }
    }
}

/// One brick: its layer, its size and its nodes in the order of [`CORNERS`].
#[derive(Clone, Debug, PartialEq)]
pub struct Brick {
    /// The layer it belongs to.
    pub layer: Layer,
    /// Edge lengths along x, y, z.
    pub size_mm: [f64; 3],
    /// Indices of its nodes.
    pub nodes: [usize; NODES],
}

/// The mesh of one module.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Grid lines along x, y and z.
    pub lines_mm: [Vec<f64>; 3],
    /// Twice refined grid coordinates of each node: grid line k is 2k, the middle of a cell is odd.
    pub lattice: Vec<[usize; 3]>,
    /// The bricks.
    pub bricks: Vec<Brick>,
    /// z index (lattice) of the film's underside.
    pub underside: usize,
}

impl Mesh {
    /// Meshes a module of the device.
    pub fn of(stack: &Stack, gauges: &[Gauge], open: Option<Side>, fineness: Fineness) -> Self {
        let lines_mm =
            [lines_x(stack, gauges, fineness), lines_y(stack, gauges, fineness), lines_z(stack, fineness)];
        let cells = lines_mm.each_ref().map(|lines| lines.len() - 1);
        let mut numbering = Numbering::new(cells);
        let mut bricks = Vec::new();
        for k in 0..cells[2] {
            let layer = layer_at(stack, middle(&lines_mm[2], k));
            for j in 0..cells[1] {
                for i in 0..cells[0] {
                    if occupied(stack, open, layer, middle(&lines_mm[0], i), middle(&lines_mm[1], j)) {
                        let size_mm = [cell(&lines_mm[0], i), cell(&lines_mm[1], j), cell(&lines_mm[2], k)];
                        bricks.push(Brick { layer, size_mm, nodes: numbering.brick([i, j, k]) });
                    }
                }
            }
        }
        let underside = 2 * lines_mm[2].partition_point(|z| *z < -1e-9);
        Self { lines_mm, lattice: numbering.lattice, bricks, underside }
    }

    /// The place of a node in the module's frame.
    pub fn place_mm(&self, node: usize) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let (lines, at) = (&self.lines_mm[axis], self.lattice[node][axis]);
            if at % 2 == 0 { lines[at / 2] } else { middle(lines, at / 2) }
        })
    }

    /// Whether a node is fixed to the base.
    pub fn is_fixed(&self, node: usize) -> bool {
        self.lattice[node][2] == 0
    }

    /// Whether a node is on the bond's top, where the plate begins.
    pub fn is_top(&self, node: usize) -> bool {
        self.lattice[node][2] == 2 * (self.lines_mm[2].len() - 1)
    }
}

/// Numbers nodes as bricks ask for them.
struct Numbering {
    sides: [usize; 3],
    index: Vec<Option<usize>>,
    lattice: Vec<[usize; 3]>,
}

impl Numbering {
    fn new(cells: [usize; 3]) -> Self {
        let sides = cells.map(|n| 2 * n + 1);
        Self { sides, index: vec![None; sides.iter().product()], lattice: Vec::new() }
    }

    fn brick(&mut self, cell: [usize; 3]) -> [usize; NODES] {
        CORNERS.map(|corner| {
            let at: [usize; 3] =
                std::array::from_fn(|a| (2 * cell[a]).wrapping_add_signed(1 + isize::from(corner[a])));
            self.node(at)
        })
    }

    fn node(&mut self, at: [usize; 3]) -> usize {
        let slot = &mut self.index[(at[2] * self.sides[1] + at[1]) * self.sides[0] + at[0]];
        *slot.get_or_insert_with(|| {
            self.lattice.push(at);
            self.lattice.len() - 1
        })
    }
}

fn middle(lines: &[f64], cell: usize) -> f64 {
    f64::midpoint(lines[cell], lines[cell + 1])
}

fn cell(lines: &[f64], cell: usize) -> f64 {
    lines[cell + 1] - lines[cell]
}

/// A gauge's rectangle: half its size along x and y.
pub fn half_sizes_mm(gauge: &Gauge) -> [f64; 2] {
    match gauge.direction {
        Direction::X => [gauge.length_mm / 2.0, gauge.width_mm / 2.0],
        Direction::Y => [gauge.width_mm / 2.0, gauge.length_mm / 2.0],
    }
}

fn lines_x(stack: &Stack, gauges: &[Gauge], fineness: Fineness) -> Vec<f64> {
    let film = stack.film_length_x_mm / 2.0;
    let singular = [stack.post_length_x_mm / 2.0, film - stack.frame_width_mm];
    plane_lines(film, singular, gauges.iter().map(|gauge| (gauge.x_mm, half_sizes_mm(gauge)[0])), fineness)
}

fn lines_y(stack: &Stack, gauges: &[Gauge], fineness: Fineness) -> Vec<f64> {
    let film = stack.film_width_y_mm / 2.0;
    let singular = [stack.post_width_y_mm / 2.0, film - stack.frame_width_mm];
    plane_lines(film, singular, gauges.iter().map(|gauge| (gauge.y_mm, half_sizes_mm(gauge)[1])), fineness)
}

fn plane_lines(
    film: f64,
    singular: [f64; 2],
    gauges: impl Iterator<Item = (f64, f64)>,
    fineness: Fineness,
) -> Vec<f64> {
    let singular: Vec<f64> = singular.iter().flat_map(|at| [-at, *at]).collect();
    let mut lines = vec![-film, film];
    lines.extend(&singular);
    lines.extend(gauges.flat_map(|(centre, half)| [centre - half, centre + half]));
    graded(&lines, &singular, fineness.plane)
}

fn lines_z(stack: &Stack, fineness: Fineness) -> Vec<f64> {
    let mut lines = vec![-stack.frame_thickness_mm];
    for layer in Layer::ALL {
        let below = lines.last().copied().unwrap_or(0.0);
        lines.push(below + layer.thickness_mm(stack));
    }
    let film_top = lines[4];
    graded(&lines, &[0.0, film_top], fineness.height)
}

fn layer_at(stack: &Stack, z_mm: f64) -> Layer {
    let mut top = -stack.frame_thickness_mm;
    let reached = Layer::ALL.into_iter().find(|layer| {
        top += layer.thickness_mm(stack);
        z_mm < top
    });
    reached.unwrap_or(Layer::Bond)
}

/// Whether a layer fills the column at a place of the module's plane.
fn occupied(stack: &Stack, open: Option<Side>, layer: Layer, x_mm: f64, y_mm: f64) -> bool {
    match layer {
        Layer::Frame => {
            let half_x = stack.film_length_x_mm / 2.0 - stack.frame_width_mm;
            let half_y = stack.film_width_y_mm / 2.0 - stack.frame_width_mm;
            let in_window = x_mm.abs() < half_x && y_mm.abs() < half_y;
            let missing = match open {
                None => false,
                Some(Side::PlusX) => x_mm > half_x,
                Some(Side::MinusX) => x_mm < -half_x,
                Some(Side::PlusY) => y_mm > half_y,
                Some(Side::MinusY) => y_mm < -half_y,
            };
            !in_window && !missing
        }
        Layer::Pi | Layer::Adh | Layer::Fpc => true,
        Layer::Post | Layer::Bond => {
            x_mm.abs() < stack.post_length_x_mm / 2.0 && y_mm.abs() < stack.post_width_y_mm / 2.0
        }
    }
}
